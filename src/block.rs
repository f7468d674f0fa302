//! Blocks: friction laws and noises as named parts with named parameters.
//!
//! A block is a plain struct whose fields are numbers. [`Block`] says its
//! name, its fields with units and default priors, and how to build it from
//! values; that is all the language and the command need to know of it.

use smallvec::SmallVec;

/// The values of a parameter that is a list or a vector; up to eight without
/// touching the heap.
pub type List<S> = SmallVec<[S; 8]>;

/// One field of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Field {
    /// Its name, also in event files.
    pub name: &'static str,
    /// Its unit; "1" for a pure number.
    pub unit: &'static str,
    /// The prior used where a user gives none, as event files write it.
    pub prior: &'static str,
    /// Whether it is a list of values, each with that prior.
    pub list: bool,
}

impl Field {
    /// A field with one value.
    pub const fn new(
        name: &'static str,
        unit: &'static str,
        prior: &'static str,
    ) -> Self {
        Self { name, unit, prior, list: false }
    }

    /// A field with a list of values.
    pub const fn list(
        name: &'static str,
        unit: &'static str,
        prior: &'static str,
    ) -> Self {
        Self { name, unit, prior, list: true }
    }
}

/// A named part of a model whose fields are numbers of type `S`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a block",
    label = "this has no `Block`: it cannot stand on the right of `~`",
    note = "a friction law or a noise is a block: give the struct `impl<S> \
            Block<S> for ..` with its name and fields"
)]
pub trait Block<S>: Sized {
    /// Its name in event files, such as "coulomb".
    const NAME: &'static str;
    /// Its fields, in the order of `from_values`.
    const FIELDS: &'static [Field];

    /// The block with the given values, one per field; a list field takes as
    /// many as are left over.
    fn from_values(values: &[S]) -> Self;

    /// The unit of the field `name`; "1" where there is none of that name.
    fn unit(name: &str) -> &'static str {
        Self::FIELDS.iter().find(|f| f.name == name).map_or("1", |f| f.unit)
    }
}

/// Says by which names a part of a model is known, so that a diagnosis does
/// not look for what the model has. Every block does; a sum says the names of
/// its terms.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not say of which blocks it is",
    label = "a model declares blocks, and sums of them",
    note = "give the struct `impl<S> Block<S> for ..` with its name and \
            fields, or declare it by name: `run.declare_as(\"name\", ..)`"
)]
pub trait Named<S> {
    /// Hands each name to `say`.
    fn names(&self, say: &mut dyn FnMut(&str));
}

impl<S, B: Block<S>> Named<S> for B {
    fn names(&self, say: &mut dyn FnMut(&str)) {
        say(B::NAME);
    }
}

/// Two blocks, or sums of blocks, at once: what `+` between blocks stands for,
/// of laws as of noises.
#[derive(Debug, Clone, Copy)]
pub struct Sum<A, B> {
    pub(crate) first: A,
    pub(crate) second: B,
}

impl<A, B> Sum<A, B> {
    /// The sum of two blocks.
    pub fn new(first: A, second: B) -> Self {
        Self { first, second }
    }
}

/// A field that takes the value of one parameter: a number.
#[diagnostic::on_unimplemented(
    message = "one prior cannot fill a field of type `{Self}`",
    label = "a list takes a list of priors: put `[` and `]` about this; what \
             is unknown is a number of the block's own type, `S`, not `f64`"
)]
pub trait OneNumber<S>: Sized {
    /// The field of that value.
    fn of(value: S) -> Self;
}

impl<S> OneNumber<S> for S {
    #[inline(always)]
    fn of(value: S) -> Self {
        value
    }
}

/// A field that takes the values of several parameters: a list.
#[diagnostic::on_unimplemented(
    message = "a list cannot fill a field of type `{Self}`",
    label = "a number takes one prior, or one value: leave out `[` and `]`"
)]
pub trait ManyNumbers<S>: Sized {
    /// The field of those values.
    fn of(values: impl Iterator<Item = S>) -> Self;
}

// The compiler is to name this trait, not what it stands for.
#[diagnostic::do_not_recommend]
impl<S, F: FromIterator<S>> ManyNumbers<S> for F {
    #[inline(always)]
    fn of(values: impl Iterator<Item = S>) -> Self {
        values.collect()
    }
}

/// A known value that fits a field.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot fill a field of type `{F}`",
    label = "a number takes a number, such as `0.3`, and a list takes a list, \
             such as `[0.3]`"
)]
pub trait Fills<F> {
    /// The field of that value.
    fn fill(self) -> F;
}

#[diagnostic::do_not_recommend]
impl<F, V: Into<F>> Fills<F> for V {
    #[inline(always)]
    fn fill(self) -> F {
        self.into()
    }
}
