//! Laws under their names: the door for event files.
//!
//! The command reads a law's name and its parameters' values at run time and
//! runs the same blocks as a compiled model. [`law!`](crate::law) turns a
//! block into such an entry.

use std::fmt::Debug;

use super::{Friction, Rate, Site, Varies};
use crate::block::{Field, Named};
use crate::error::{Error, Result};
use crate::scalar::{Grad, Kind, Plain, Real, Reverse, of_each_kind};
use crate::spelling::{nearest, quoted};

/// A law whose parameters are given as a slice.
pub trait RateOf<K: Kind> {
    /// [`Friction::rate`] of the block with these values.
    fn rate(&self, values: &[Real<K>], at: &Site, speed: Real<K>) -> Rate<K>;
}

/// A law by name, for every kind of number that models run with.
///
/// Made by [`law!`](crate::law) from any block that is a [`Friction`].
pub trait Law:
    RateOf<Plain>
    + RateOf<Grad<4>>
    + RateOf<Grad<8>>
    + RateOf<Grad<16>>
    + RateOf<Reverse>
    + Debug
    + Sync
{
    /// The name in event files.
    fn name(&self) -> &'static str;
    /// Its parameters.
    fn fields(&self) -> &'static [Field];
    /// On what its rates depend.
    fn varies(&self) -> Varies;
}

/// Makes a [`Law`] entry from a block: `law!(Coulomb)`.
///
/// The block is a struct generic over its number, `Block<S>` for every
/// number and `Friction<K>` for every kind.
#[macro_export]
macro_rules! law {
    ($block:ident) => {{
        #[derive(Debug)]
        struct Entry;
        impl<K: $crate::scalar::Kind> $crate::physics::friction::RateOf<K>
            for Entry
        {
            fn rate(
                &self,
                values: &[$crate::scalar::Real<K>],
                at: &$crate::physics::Site,
                speed: $crate::scalar::Real<K>,
            ) -> $crate::physics::Rate<K> {
                type Of<K> = $block<$crate::scalar::Real<K>>;
                let block = <Of<K> as $crate::block::Block<_>>::from_values(
                    values,
                );
                $crate::physics::Friction::<K>::rate(&block, at, speed)
            }
        }
        impl $crate::physics::friction::Law for Entry {
            fn name(&self) -> &'static str {
                <$block<f64> as $crate::block::Block<f64>>::NAME
            }
            fn fields(&self) -> &'static [$crate::block::Field] {
                <$block<f64> as $crate::block::Block<f64>>::FIELDS
            }
            fn varies(&self) -> $crate::physics::Varies {
                type Number = $crate::scalar::Real<$crate::scalar::Plain>;
                let values =
                    vec![Number::new(1.0); self.fields().len()];
                let block = <$block<Number> as $crate::block::Block<
                    Number,
                >>::from_values(&values);
                $crate::physics::Friction::<$crate::scalar::Plain>::varies(
                    &block,
                )
            }
        }
        const ENTRY: &dyn $crate::physics::friction::Law = &Entry;
        ENTRY
    }};
}

/// Kinds that a named law can be asked with.
pub trait LawKind: Kind {
    /// The law's rates for this kind of number.
    fn rates(law: &dyn Law) -> &dyn RateOf<Self>;
}

macro_rules! law_kind {
    ($($kind:ty),*) => {
        $(impl LawKind for $kind {
            fn rates(law: &dyn Law) -> &dyn RateOf<Self> {
                law
            }
        })*
    };
}
of_each_kind!(law_kind);

/// The laws that an event file may name: the built-in ones and a user's own.
#[derive(Debug, Clone)]
pub struct Laws(Vec<&'static dyn Law>);

impl Default for Laws {
    fn default() -> Self {
        Self(super::LAWS.to_vec())
    }
}

impl Laws {
    /// Adds a law of one's own.
    #[must_use]
    pub fn with(mut self, law: &'static dyn Law) -> Self {
        self.0.push(law);
        self
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &'static dyn Law> {
        self.0.iter().copied()
    }

    /// Reads a sum of laws, such as `coulomb + turbulent`, or `none`.
    ///
    /// # Errors
    /// A name that is not among the laws, the message lists them; one that
    /// stands twice.
    pub fn parse(&self, text: &str) -> Result<LawSum> {
        if text.trim() == "none" {
            return Ok(LawSum(Vec::new()));
        }
        let terms = text.split('+').map(|name| self.find(name.trim()));
        once_each(terms.collect::<Result<_>>()?)
    }

    fn find(&self, name: &str) -> Result<&'static dyn Law> {
        self.iter().find(|law| law.name() == name).ok_or_else(|| {
            let known: Vec<_> = self.iter().map(|law| law.name()).collect();
            let mend = nearest(name, &known)
                .map(|known| format!("; did you mean {known:?}?"));
            Error::input(format!(
                "friction {} is not known; expected none, or one or a sum \
                 (\"a + b\") of {}{}",
                quoted(name),
                known.join(", "),
                mend.unwrap_or_default()
            ))
            .on_page("reference/laws")
        })
    }
}

/// Refuses a sum in which a law stands twice: its parameters would have the
/// same names.
fn once_each(friction: LawSum) -> Result<LawSum> {
    let names: Vec<_> = friction.terms().iter().map(|t| t.name()).collect();
    let twice =
        names.iter().enumerate().find(|(i, name)| names[..*i].contains(name));
    match twice {
        None => Ok(friction),
        Some((_, name)) => Err(Error::input(format!(
            "the sum has {name:?} twice; expected each law once: drop one of \
             them"
        ))),
    }
}

/// A sum of named laws.
#[derive(Debug, Clone)]
pub struct LawSum(Vec<&'static dyn Law>);

impl FromIterator<&'static dyn Law> for LawSum {
    fn from_iter<I: IntoIterator<Item = &'static dyn Law>>(laws: I) -> Self {
        Self(laws.into_iter().collect())
    }
}

impl LawSum {
    /// Its terms, in the order written.
    pub fn terms(&self) -> &[&'static dyn Law] {
        &self.0
    }

    /// Whether what it resists hangs on the flow depth.
    pub fn has_depth(&self) -> bool {
        let values = vec![Real::<Plain>::new(1.0); self.dimension()];
        let law = self.with(&values);
        let at = |depth| {
            let (distance, curvature) = (1.0, 0.0);
            let site =
                Site { distance, pull: 5.0, load: 8.0, curvature, depth };
            let r = law.rate(&site, Real::new(10.0));
            [r.mu, r.pressed, r.constant, r.linear, r.quadratic, r.growth]
                .map(|rate| rate.value())
        };
        at(1.0) != at(2.0)
    }

    /// How many values it takes.
    pub fn dimension(&self) -> usize {
        self.0.iter().map(|law| law.fields().len()).sum()
    }

    /// The law with the given values, one per field of its terms.
    pub fn with<'a, K: LawKind>(
        &'a self,
        values: &'a [Real<K>],
    ) -> Valued<'a, K> {
        Valued { laws: self, values }
    }
}

impl std::fmt::Display for LawSum {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_empty() {
            return f.write_str("none");
        }
        let names: Vec<_> = self.0.iter().map(|law| law.name()).collect();
        f.write_str(&names.join(" + "))
    }
}

/// A sum of named laws with values for their parameters.
#[derive(Debug, Clone, Copy)]
pub struct Valued<'a, K: Kind> {
    laws: &'a LawSum,
    values: &'a [Real<K>],
}

impl<K: LawKind> Friction<K> for Valued<'_, K> {
    fn varies(&self) -> Varies {
        let terms = self.laws.0.iter();
        terms.map(|law| law.varies()).max().unwrap_or(Varies::Nowhere)
    }

    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        let mut total = Rate::default();
        let mut values = self.values;
        for law in &self.laws.0 {
            let (own, rest) = values.split_at(law.fields().len());
            total = total + K::rates(*law).rate(own, at, speed);
            values = rest;
        }
        total
    }
}

impl<K: LawKind> Named<Real<K>> for Valued<'_, K> {
    fn names(&self, say: &mut dyn FnMut(&str)) {
        self.laws.0.iter().for_each(|law| say(law.name()));
    }
}
