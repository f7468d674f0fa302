//! The number of a model's body: plain, or carrying exact derivatives.
//!
//! Everything between the unknowns and the log density is written once, over
//! [`Real<K>`]. With `K =` [`Plain`] it is an `f64` and costs the same; with
//! `K =` [`Grad<N>`] it carries its partial derivatives in `N` directions
//! (forward-mode dual numbers), so gradients come out exact, to round-off;
//! with `K =` [`Reverse`] it is recorded how it was formed, and derivatives in
//! any number of directions are found from the end backwards.
//!
//! Comparisons look at the value alone, literals combine from both sides:
//!
//! ```
//! use couloir::scalar::{Grad, Real};
//! let x = Real::<Grad<1>>::variable(3.0, 0);
//! let y = 2.0 * x * x + 1.0;
//! assert!(y > 18.0);
//! assert_eq!((y.value(), y.partial(0)), (19.0, 12.0));
//! ```

mod kind;
mod tape;

use std::iter::Sum;
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, Sub, SubAssign,
};

use num_traits::{NumAssignOps, NumOps, One, Zero};

pub(crate) use kind::of_each_kind;
pub use kind::{Forward, Grad, Kind, Plain, fused};
pub(crate) use tape::Recording;
pub use tape::Reverse;

/// The number of a model's body, of kind `K`.
#[derive(Clone, Copy, Debug)]
pub struct Real<K: Kind = Plain>(K::Repr);

impl<K: Kind> Real<K> {
    /// A constant.
    #[inline(always)]
    pub fn new(value: f64) -> Self {
        Self(K::constant(value))
    }

    /// The coordinate along `direction`: its own derivative there is 1.
    #[inline(always)]
    pub fn variable(value: f64, direction: usize) -> Self {
        Self(K::variable(value, direction))
    }

    /// A number whose derivatives were found elsewhere: those along all
    /// directions that the kind carries.
    #[inline]
    pub(crate) fn assembled(value: f64, partials: &[f64]) -> Self {
        Self(K::assemble(value, partials))
    }

    /// The derivative along `direction`, of a kind that carries it.
    #[inline(always)]
    pub(crate) fn direction(self, direction: usize) -> f64 {
        K::partial(&self.0, direction)
    }

    /// The value, without derivatives.
    #[inline(always)]
    pub fn value(self) -> f64 {
        K::value(&self.0)
    }

    /// f(self) for a function with the given value and derivative here.
    #[inline(always)]
    pub fn chain(self, value: f64, slope: f64) -> Self {
        Self(K::chain(&self.0, value, slope))
    }

    /// f(self, other) with the given value and partial derivatives here.
    #[inline(always)]
    pub fn chain2(
        self,
        other: Self,
        value: f64,
        slope: f64,
        other_slope: f64,
    ) -> Self {
        Self(K::chain2(&self.0, &other.0, value, slope, other_slope))
    }

    /// A function of several numbers with the given value here, each number
    /// with the function's partial derivative by it.
    #[inline(always)]
    pub fn combine<const M: usize>(
        value: f64,
        terms: [(&Self, f64); M],
    ) -> Self {
        let terms = terms.map(|(x, slope)| (&x.0, slope));
        Self(K::combine(value, terms))
    }

    /// Adds a function of several numbers, each with the function's partial
    /// derivative by it, to this one, whose value is then the one given.
    #[inline(always)]
    pub fn accumulate<const M: usize>(
        &mut self,
        value: f64,
        terms: [(&Self, f64); M],
    ) {
        let terms = terms.map(|(x, slope)| (&x.0, slope));
        K::accumulate(&mut self.0, value, terms);
    }

    /// Adds a product to it.
    #[inline(always)]
    pub fn add_product(&mut self, x: &Self, y: &Self) {
        let (a, b) = (x.value(), y.value());
        let value = fused(a, b, self.value());
        self.accumulate(value, [(x, b), (y, a)]);
    }

    /// Square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain(root, 0.5 / root)
    }

    /// Exponential.
    #[inline(always)]
    pub fn exp(self) -> Self {
        let e = self.value().exp();
        self.chain(e, e)
    }

    /// exp(self) - 1, accurate near 0.
    #[inline(always)]
    pub fn exp_m1(self) -> Self {
        let e = self.value().exp_m1();
        self.chain(e, e + 1.0)
    }

    /// Natural logarithm.
    #[inline(always)]
    pub fn ln(self) -> Self {
        self.chain(self.value().ln(), 1.0 / self.value())
    }

    /// ln(1 + self), accurate near 0.
    #[inline(always)]
    pub fn ln_1p(self) -> Self {
        self.chain(self.value().ln_1p(), 1.0 / (1.0 + self.value()))
    }

    /// Integer power.
    #[inline(always)]
    pub fn powi(self, n: i32) -> Self {
        let x = self.value();
        let slope = if n == 0 { 0.0 } else { f64::from(n) * x.powi(n - 1) };
        self.chain(x.powi(n), slope)
    }

    /// Real power with a constant exponent.
    #[inline(always)]
    pub fn powf(self, p: f64) -> Self {
        let x = self.value();
        let slope = if p == 0.0 { 0.0 } else { p * x.powf(p - 1.0) };
        self.chain(x.powf(p), slope)
    }

    /// c\[0\] + x c\[1\] + x^2 c\[2\] + ... at x = self.
    #[inline(always)]
    pub fn polynomial(self, coefficients: &[f64]) -> Self {
        let x = self.value();
        let (mut value, mut slope) = (0.0, 0.0);
        for &c in coefficients.iter().rev() {
            slope = fused(slope, x, value);
            value = fused(value, x, c);
        }
        self.chain(value, slope)
    }

    /// Sine.
    #[inline(always)]
    pub fn sin(self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.chain(s, c)
    }

    /// Cosine.
    #[inline(always)]
    pub fn cos(self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.chain(c, -s)
    }

    /// Tangent.
    #[inline(always)]
    pub fn tan(self) -> Self {
        let t = self.value().tan();
        self.chain(t, 1.0 + t * t)
    }

    /// Inverse tangent.
    #[inline(always)]
    pub fn atan(self) -> Self {
        let x = self.value();
        self.chain(x.atan(), 1.0 / (1.0 + x * x))
    }

    /// Hyperbolic tangent.
    #[inline(always)]
    pub fn tanh(self) -> Self {
        let t = self.value().tanh();
        self.chain(t, 1.0 - t * t)
    }

    /// Inverse hyperbolic tangent.
    #[inline(always)]
    pub fn atanh(self) -> Self {
        let x = self.value();
        self.chain(x.atanh(), 1.0 / (1.0 - x * x))
    }

    /// Absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }

    /// The larger of the two, with its derivatives.
    #[inline(always)]
    pub fn max(self, other: impl Into<Self>) -> Self {
        let other = other.into();
        if other > self { other } else { self }
    }

    /// The smaller of the two, with its derivatives.
    #[inline(always)]
    pub fn min(self, other: impl Into<Self>) -> Self {
        let other = other.into();
        if other < self { other } else { self }
    }

    /// The square.
    #[inline(always)]
    pub fn squared(self) -> Self {
        self * self
    }

    /// Whether this is 0 and stays 0 along every direction.
    #[inline(always)]
    pub fn is_constantly_zero(self) -> bool {
        self.value() == 0.0 && self.is_constant()
    }

    /// Whether this is known to have no derivatives but 0.
    #[inline(always)]
    pub fn is_constant(self) -> bool {
        K::is_constant(&self.0)
    }

    /// Whether another number is this one but for such a share of it, in all
    /// derivatives that both carry with them too.
    #[inline]
    pub(crate) fn is_near(self, other: Self, share: f64) -> bool {
        let size = self.value().abs();
        let off = |i| K::partial(&self.0, i) - K::partial(&other.0, i);
        let slope = |i| size + K::partial(&self.0, i).abs();
        (self.value() - other.value()).abs() <= share * size
            && (0..K::DIRECTIONS).all(|i| off(i).abs() <= share * slope(i))
    }
}

impl<K: Forward> Real<K> {
    /// The derivative along `direction`.
    #[inline(always)]
    pub fn partial(self, direction: usize) -> f64 {
        K::partial(&self.0, direction)
    }

    /// The derivatives along all directions.
    #[inline(always)]
    pub(crate) fn partials(&self) -> &[f64] {
        K::partials(&self.0)
    }

    /// Whether the value and all derivatives are finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.value().is_finite()
            && (0..K::DIRECTIONS).all(|i| self.partial(i).is_finite())
    }
}

impl<K: Kind> From<f64> for Real<K> {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self::new(value)
    }
}

impl<K: Kind> From<&Self> for Real<K> {
    #[inline(always)]
    fn from(value: &Self) -> Self {
        *value
    }
}

impl<K: Kind> Default for Real<K> {
    fn default() -> Self {
        Self::new(0.0)
    }
}

impl<K: Kind> PartialEq for Real<K> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.value() == other.value()
    }
}

impl<K: Kind> PartialOrd for Real<K> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.value().partial_cmp(&other.value())
    }
}

impl<K: Kind> PartialEq<f64> for Real<K> {
    #[inline(always)]
    fn eq(&self, other: &f64) -> bool {
        self.value() == *other
    }
}

impl<K: Kind> PartialOrd<f64> for Real<K> {
    #[inline(always)]
    fn partial_cmp(&self, other: &f64) -> Option<std::cmp::Ordering> {
        self.value().partial_cmp(other)
    }
}

impl<K: Kind> PartialEq<Real<K>> for f64 {
    #[inline(always)]
    fn eq(&self, other: &Real<K>) -> bool {
        *self == other.value()
    }
}

impl<K: Kind> PartialOrd<Real<K>> for f64 {
    #[inline(always)]
    fn partial_cmp(&self, other: &Real<K>) -> Option<std::cmp::Ordering> {
        self.partial_cmp(&other.value())
    }
}

/// One binary operator from the value and the two slopes, for every mix of
/// numbers and literals.
macro_rules! operator {
    ($trait:ident, $name:ident, $assign:ident, $assign_name:ident,
     |$x:ident, $y:ident| $value:expr, $slope_x:expr, $slope_y:expr) => {
        impl<K: Kind> $trait for Real<K> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let ($x, $y) = (self.value(), other.value());
                self.chain2(other, $value, $slope_x, $slope_y)
            }
        }
        impl<K: Kind> $trait<f64> for Real<K> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, $y: f64) -> Self {
                let $x = self.value();
                self.chain($value, $slope_x)
            }
        }
        impl<K: Kind> $trait<Real<K>> for f64 {
            type Output = Real<K>;
            #[inline(always)]
            fn $name(self, other: Real<K>) -> Real<K> {
                let ($x, $y) = (self, other.value());
                other.chain($value, $slope_y)
            }
        }
        impl<K: Kind> $assign for Real<K> {
            #[inline(always)]
            fn $assign_name(&mut self, other: Self) {
                *self = $trait::$name(*self, other);
            }
        }
        impl<K: Kind> $assign<f64> for Real<K> {
            #[inline(always)]
            fn $assign_name(&mut self, other: f64) {
                *self = $trait::$name(*self, other);
            }
        }
    };
}

operator!(Add, add, AddAssign, add_assign, |x, y| x + y, 1.0, 1.0);
operator!(Sub, sub, SubAssign, sub_assign, |x, y| x - y, 1.0, -1.0);
operator!(Mul, mul, MulAssign, mul_assign, |x, y| x * y, y, x);
operator!(
    Div,
    div,
    DivAssign,
    div_assign,
    |x, y| x / y,
    1.0 / y,
    -(x / y) * (1.0 / y)
);
operator!(
    Rem,
    rem,
    RemAssign,
    rem_assign,
    |x, y| x % y,
    1.0,
    -(x / y).trunc()
);

use std::ops::RemAssign;

/// The same of references, as iterators over data hand them out.
macro_rules! of_references {
    ($($trait:ident $name:ident $assign:ident $assign_name:ident),*) => {$(
        of_references!(@one $trait $name, Real<K>, &f64);
        of_references!(@one $trait $name, &f64, Real<K>);
        of_references!(@one $trait $name, Real<K>, &Real<K>);
        of_references!(@one $trait $name, &Real<K>, Real<K>);
        of_references!(@one $trait $name, &Real<K>, &Real<K>);
        of_references!(@one $trait $name, &Real<K>, f64);
        of_references!(@one $trait $name, f64, &Real<K>);
        of_references!(@one $trait $name, &Real<K>, &f64);
        of_references!(@one $trait $name, &f64, &Real<K>);
        of_references!(@assign $assign $assign_name, &f64);
        of_references!(@assign $assign $assign_name, &Real<K>);
    )*};
    (@one $trait:ident $name:ident, $left:ty, $right:ty) => {
        impl<K: Kind> $trait<$right> for $left {
            type Output = Real<K>;
            #[inline(always)]
            fn $name(self, other: $right) -> Real<K> {
                $trait::$name(self.number(), other.number())
            }
        }
    };
    (@assign $assign:ident $assign_name:ident, $right:ty) => {
        impl<K: Kind> $assign<$right> for Real<K> {
            #[inline(always)]
            fn $assign_name(&mut self, other: $right) {
                $assign::$assign_name(self, other.number());
            }
        }
    };
}

/// A number, of itself or of a reference to it.
trait Copied {
    type Number;
    fn number(&self) -> Self::Number;
}

impl Copied for f64 {
    type Number = Self;
    #[inline(always)]
    fn number(&self) -> Self {
        *self
    }
}

impl<K: Kind> Copied for Real<K> {
    type Number = Self;
    #[inline(always)]
    fn number(&self) -> Self {
        *self
    }
}

of_references!(
    Add add AddAssign add_assign,
    Sub sub SubAssign sub_assign,
    Mul mul MulAssign mul_assign,
    Div div DivAssign div_assign
);

impl<K: Kind> Neg for Real<K> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value(), -1.0)
    }
}

impl<K: Kind> Sum for Real<K> {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::zero(), |total, term| total + term)
    }
}

impl<K: Kind> Zero for Real<K> {
    fn zero() -> Self {
        Self::new(0.0)
    }
    fn is_zero(&self) -> bool {
        self.value() == 0.0
    }
}

impl<K: Kind> One for Real<K> {
    fn one() -> Self {
        Self::new(1.0)
    }
}

/// Arithmetic that works on `f64` and on every [`Real`] alike: what the exact
/// solution's series are written over.
pub trait Arithmetic:
    Copy
    + Zero
    + One
    + NumOps
    + NumOps<f64>
    + NumAssignOps
    + Neg<Output = Self>
    + PartialOrd
{
}

impl<T> Arithmetic for T where
    T: Copy
        + Zero
        + One
        + NumOps
        + NumOps<f64>
        + NumAssignOps
        + Neg<Output = Self>
        + PartialOrd
{
}

/// Horner's scheme: c\[0\] + x (c\[1\] + x (c\[2\] + ...)).
#[inline(always)]
pub fn polynomial(x: f64, coefficients: &[f64]) -> f64 {
    let mut terms = coefficients.iter().rev();
    let Some(&last) = terms.next() else { return 0.0 };
    terms.fold(last, |sum, &c| fused(sum, x, c))
}

#[cfg(test)]
mod tests {
    use super::*;

    type D = Real<Grad<4>>;

    /// Central difference of fourth order, error about 1e-11 at h = 1e-3.
    fn difference(f: impl Fn(f64) -> f64, x: f64) -> f64 {
        let h = 1e-3;
        (8.0 * (f(x + h) - f(x - h)) - (f(x + 2.0 * h) - f(x - 2.0 * h)))
            / (12.0 * h)
    }

    #[test]
    fn functions_carry_their_derivatives() {
        type Pair = (fn(D) -> D, fn(f64) -> f64);
        let functions: [Pair; 14] = [
            (D::sqrt, f64::sqrt),
            (D::exp, f64::exp),
            (D::exp_m1, f64::exp_m1),
            (D::ln, f64::ln),
            (D::ln_1p, f64::ln_1p),
            (D::sin, f64::sin),
            (D::cos, f64::cos),
            (D::tan, f64::tan),
            (D::atan, f64::atan),
            (D::tanh, f64::tanh),
            (D::atanh, f64::atanh),
            (|x| x.powi(3), |x| x.powi(3)),
            (|x| x.powf(1.7), |x| x.powf(1.7)),
            (|x| 2.0 / x - x / 3.0, |x| 2.0 / x - x / 3.0),
        ];
        for (dual, plain) in functions {
            let y = dual(D::variable(0.6, 1));
            assert_eq!(y.value(), plain(0.6));
            assert!((y.partial(1) - difference(plain, 0.6)).abs() < 1e-9);
            assert_eq!(y.partial(0), 0.0);
        }
    }

    #[test]
    fn the_quotient_rule_holds_in_both_directions() {
        let (x, y) = (D::variable(3.0, 0), D::variable(4.0, 1));
        let q = x / y;
        assert_eq!((q.partial(0), q.partial(1)), (0.25, -3.0 / 16.0));
    }
}
