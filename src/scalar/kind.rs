//! The kinds of number that carry what they know with them: a value, and its
//! derivatives along some directions.

use std::fmt::Debug;

/// What a [`Real`](super::Real) carries besides its value.
///
/// A kind is an arithmetic: it says how sums, products and functions of
/// numbers are formed. [`Plain`] forms values, [`Grad`] values with
/// derivatives, [`Reverse`](super::Reverse) values and a record of how they
/// were formed. Vector lanes would be one more kind.
pub trait Kind: Copy + Debug + Default + Send + Sync + 'static {
    /// How a number is stored.
    type Repr: Copy + Debug + Send + Sync;
    /// How many partial derivatives a number carries with it.
    const DIRECTIONS: usize;
    /// Whether numbers have derivatives, carried with them or found later.
    const DIFFERENTIATES: bool;

    /// A number with no dependence on the directions.
    fn constant(value: f64) -> Self::Repr;
    /// A number that is the coordinate along `direction`.
    fn variable(value: f64, direction: usize) -> Self::Repr;
    /// A number of given derivatives, as many as the kind carries.
    fn assemble(value: f64, partials: &[f64]) -> Self::Repr;
    /// The value of a number.
    fn value(x: &Self::Repr) -> f64;
    /// Its derivative along `direction`; 0 outside the kind's directions.
    fn partial(x: &Self::Repr, direction: usize) -> f64;
    /// Whether it is known to have no derivatives but 0.
    fn is_constant(x: &Self::Repr) -> bool;
    /// A number of given value whose derivatives are `slope` times `x`'s:
    /// the chain rule for a function of one variable.
    fn chain(x: &Self::Repr, value: f64, slope: f64) -> Self::Repr;
    /// The chain rule for a function of two variables.
    fn chain2(
        x: &Self::Repr,
        y: &Self::Repr,
        value: f64,
        slope_x: f64,
        slope_y: f64,
    ) -> Self::Repr;
    /// The chain rule for a function of several: each with its slope.
    fn combine<const M: usize>(
        value: f64,
        terms: [(&Self::Repr, f64); M],
    ) -> Self::Repr;
    /// Adds such a function to a number, whose value it then is.
    #[inline(always)]
    fn accumulate<const M: usize>(
        sum: &mut Self::Repr,
        value: f64,
        terms: [(&Self::Repr, f64); M],
    ) {
        let more = Self::combine(value, terms);
        *sum = Self::chain2(sum, &more, value, 1.0, 1.0);
    }
}

/// Writes something, by a macro that takes kinds, for each that models are
/// evaluated with: plain numbers, three widths of gradient, and the tape.
macro_rules! of_each_kind {
    ($implement:ident) => {
        $implement!(
            $crate::scalar::Plain,
            $crate::scalar::Grad<4>,
            $crate::scalar::Grad<8>,
            $crate::scalar::Grad<16>,
            $crate::scalar::Reverse
        );
    };
}
pub(crate) use of_each_kind;

/// Kinds whose numbers carry their derivatives with them, so that these can
/// be looked at on the way.
pub trait Forward: Kind {
    /// The derivatives along all directions.
    fn partials(x: &Self::Repr) -> &[f64];
}

/// The kind of ordinary numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plain;

/// The kind of numbers with `N` partial derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub struct Grad<const N: usize>;

impl Kind for Plain {
    type Repr = f64;
    const DIRECTIONS: usize = 0;
    const DIFFERENTIATES: bool = false;

    #[inline(always)]
    fn constant(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn variable(value: f64, _: usize) -> f64 {
        value
    }
    #[inline(always)]
    fn assemble(value: f64, _: &[f64]) -> f64 {
        value
    }
    #[inline(always)]
    fn value(x: &f64) -> f64 {
        *x
    }
    #[inline(always)]
    fn partial(_: &f64, _: usize) -> f64 {
        0.0
    }
    #[inline(always)]
    fn is_constant(_: &f64) -> bool {
        true
    }
    #[inline(always)]
    fn chain(_: &f64, value: f64, _: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn chain2(_: &f64, _: &f64, value: f64, _: f64, _: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn combine<const M: usize>(value: f64, _: [(&f64, f64); M]) -> f64 {
        value
    }
}

/// A value with its derivatives, the store of [`Grad`].
#[derive(Clone, Copy, Debug)]
pub struct Dual<const N: usize> {
    value: f64,
    partials: [f64; N],
}

impl<const N: usize> Kind for Grad<N> {
    type Repr = Dual<N>;
    const DIRECTIONS: usize = N;
    const DIFFERENTIATES: bool = N > 0;

    #[inline(always)]
    fn constant(value: f64) -> Dual<N> {
        Dual { value, partials: [0.0; N] }
    }
    #[inline(always)]
    fn variable(value: f64, direction: usize) -> Dual<N> {
        let mut partials = [0.0; N];
        if let Some(slot) = partials.get_mut(direction) {
            *slot = 1.0;
        }
        Dual { value, partials }
    }
    #[inline(always)]
    fn assemble(value: f64, given: &[f64]) -> Dual<N> {
        let mut partials = [0.0; N];
        for (slot, partial) in partials.iter_mut().zip(given) {
            *slot = *partial;
        }
        Dual { value, partials }
    }
    #[inline(always)]
    fn value(x: &Dual<N>) -> f64 {
        x.value
    }
    #[inline(always)]
    fn partial(x: &Dual<N>, direction: usize) -> f64 {
        x.partials.get(direction).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    fn is_constant(x: &Dual<N>) -> bool {
        x.partials.iter().all(|p| *p == 0.0)
    }
    #[inline(always)]
    fn chain(x: &Dual<N>, value: f64, slope: f64) -> Dual<N> {
        let mut partials = x.partials;
        for p in &mut partials {
            *p *= slope;
        }
        Dual { value, partials }
    }
    #[inline(always)]
    fn chain2(
        x: &Dual<N>,
        y: &Dual<N>,
        value: f64,
        slope_x: f64,
        slope_y: f64,
    ) -> Dual<N> {
        let mut partials = [0.0; N];
        for (i, p) in partials.iter_mut().enumerate() {
            *p = fused(slope_x, x.partials[i], slope_y * y.partials[i]);
        }
        Dual { value, partials }
    }
    #[inline(always)]
    fn combine<const M: usize>(
        value: f64,
        terms: [(&Dual<N>, f64); M],
    ) -> Dual<N> {
        let mut sum = Self::constant(0.0);
        Self::accumulate(&mut sum, value, terms);
        sum
    }
    #[inline(always)]
    fn accumulate<const M: usize>(
        sum: &mut Dual<N>,
        value: f64,
        terms: [(&Dual<N>, f64); M],
    ) {
        sum.value = value;
        for (i, p) in sum.partials.iter_mut().enumerate() {
            for (x, slope) in &terms {
                *p = fused(*slope, x.partials[i], *p);
            }
        }
    }
}

impl<const N: usize> Forward for Grad<N> {
    #[inline(always)]
    fn partials(x: &Dual<N>) -> &[f64] {
        &x.partials
    }
}

/// a b + c, in one rounding where the machine does that in one step.
#[inline(always)]
pub fn fused(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") { a.mul_add(b, c) } else { a * b + c }
}
