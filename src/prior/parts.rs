//! What a mixture is made of: a list of distributions, or a tuple of some.

use super::{Distribution, Prior, Support};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Several distributions: an array, a vector, or a tuple of up to six.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a list of distributions",
    label = "a mixture takes weights and as many distributions: \
             `Mixture([0.9, 0.1], [Normal(0.0, 1.0), Normal(0.0, 9.0)])`"
)]
pub trait Parts<K: Kind> {
    /// How many they are.
    fn count(&self) -> usize;
    /// [`Distribution::log_density`] of one of them.
    fn log_density(&self, part: usize, x: Real<K>) -> Real<K>;
    /// [`Distribution::draw`] of one of them.
    fn draw(&self, part: usize, rng: &mut Rng) -> Option<f64>;
}

/// Several priors, so that their mixture is one.
pub trait PriorParts<K: Kind>: Parts<K> {
    /// [`Prior::support`] of one of them.
    fn support(&self, part: usize) -> Support<K>;
    /// [`Prior::is_proper`] of one of them.
    fn is_proper(&self, part: usize) -> bool;
}

macro_rules! list {
    ($list:ty $(, $n:ident)?) => {
        impl<K: Kind, D: Distribution<K> $(, const $n: usize)?> Parts<K>
            for $list
        {
            fn count(&self) -> usize {
                self.len()
            }
            fn log_density(&self, part: usize, x: Real<K>) -> Real<K> {
                self[part].log_density(x)
            }
            fn draw(&self, part: usize, rng: &mut Rng) -> Option<f64> {
                self.get(part)?.draw(rng)
            }
        }
        impl<K: Kind, D: Prior<K> $(, const $n: usize)?> PriorParts<K>
            for $list
        {
            fn support(&self, part: usize) -> Support<K> {
                self[part].support()
            }
            fn is_proper(&self, part: usize) -> bool {
                self[part].is_proper()
            }
        }
    };
}
list!([D; N], N);
list!(Vec<D>);

macro_rules! tuple {
    ($count:literal: $($index:tt $part:ident),*) => {
        impl<K: Kind, $($part: Distribution<K>),*> Parts<K> for ($($part,)*) {
            fn count(&self) -> usize {
                $count
            }
            fn log_density(&self, part: usize, x: Real<K>) -> Real<K> {
                match part {
                    $($index => self.$index.log_density(x),)*
                    _ => super::impossible(),
                }
            }
            fn draw(&self, part: usize, rng: &mut Rng) -> Option<f64> {
                match part {
                    $($index => self.$index.draw(rng),)*
                    _ => None,
                }
            }
        }
        impl<K: Kind, $($part: Prior<K>),*> PriorParts<K> for ($($part,)*) {
            fn support(&self, part: usize) -> Support<K> {
                match part {
                    $($index => self.$index.support(),)*
                    _ => Support::Line,
                }
            }
            fn is_proper(&self, part: usize) -> bool {
                match part {
                    $($index => self.$index.is_proper(),)*
                    _ => true,
                }
            }
        }
    };
}
tuple!(1: 0 A);
tuple!(2: 0 A, 1 B);
tuple!(3: 0 A, 1 B, 2 C);
tuple!(4: 0 A, 1 B, 2 C, 3 D);
tuple!(5: 0 A, 1 B, 2 C, 3 D, 4 E);
tuple!(6: 0 A, 1 B, 2 C, 3 D, 4 E, 5 F);
