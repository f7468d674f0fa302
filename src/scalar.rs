//! The number of a model's body: plain, or carrying exact derivatives.
//!
//! Everything between the unknowns and the log density is written once, over
//! [`Real<K>`]. With `K =` [`Plain`] it is an `f64` and costs the same; with
//! `K =` [`Grad<N>`] it carries its partial derivatives in `N` directions
//! (forward-mode dual numbers), so gradients come out exact, to round-off.
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

use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, Sub, SubAssign,
};

use num_traits::{NumAssignOps, NumOps, One, Zero};

/// What a [`Real`] carries besides its value.
///
/// A kind is an arithmetic: it says how sums, products and functions of
/// numbers are formed. [`Plain`] forms values, [`Grad`] values with
/// derivatives. Vector lanes would be one more kind.
pub trait Kind: Copy + Debug + Default + Send + Sync + 'static {
    /// How a number is stored.
    type Repr: Copy + Debug + Send + Sync;
    /// How many partial derivatives a number carries.
    const DIRECTIONS: usize;

    /// A number with no dependence on the directions.
    fn constant(value: f64) -> Self::Repr;
    /// A number that is the coordinate along `direction`.
    fn variable(value: f64, direction: usize) -> Self::Repr;
    /// A number of given value and partial derivatives.
    fn assemble(value: f64, partial: impl Fn(usize) -> f64) -> Self::Repr;
    /// The value of a number.
    fn value(x: &Self::Repr) -> f64;
    /// Its derivative along `direction`; 0 outside the kind's directions.
    fn partial(x: &Self::Repr, direction: usize) -> f64;
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

    #[inline(always)]
    fn constant(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn variable(value: f64, _: usize) -> f64 {
        value
    }
    #[inline(always)]
    fn assemble(value: f64, _: impl Fn(usize) -> f64) -> f64 {
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
    fn chain(_: &f64, value: f64, _: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn chain2(_: &f64, _: &f64, value: f64, _: f64, _: f64) -> f64 {
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
    fn assemble(value: f64, partial: impl Fn(usize) -> f64) -> Dual<N> {
        Dual { value, partials: std::array::from_fn(partial) }
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
}

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

    /// A number of given value and partial derivatives.
    pub fn assemble(value: f64, partial: impl Fn(usize) -> f64) -> Self {
        Self(K::assemble(value, partial))
    }

    /// The value, without derivatives.
    #[inline(always)]
    pub fn value(self) -> f64 {
        K::value(&self.0)
    }

    /// The derivative along `direction`.
    #[inline(always)]
    pub fn partial(self, direction: usize) -> f64 {
        K::partial(&self.0, direction)
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
        self.chain(x.powi(n), f64::from(n) * x.powi(n - 1))
    }

    /// Real power with a constant exponent.
    #[inline(always)]
    pub fn powf(self, p: f64) -> Self {
        let x = self.value();
        self.chain(x.powf(p), p * x.powf(p - 1.0))
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
        self.value() == 0.0
            && (0..K::DIRECTIONS).all(|i| self.partial(i) == 0.0)
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

/// a b + c, in one rounding where the machine does that in one step.
#[inline(always)]
pub fn fused(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") { a.mul_add(b, c) } else { a * b + c }
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

    type D = Real<Grad<2>>;

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
