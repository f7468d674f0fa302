//! Numbers in ascending order.

use super::{Distribution, Joint, Prior, Support, impossible};
use crate::block::List;
use crate::error::Result;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Ordered(D) of n numbers: n independent draws of D, in ascending order,
/// p(x) = n! p_D(x_1) .. p_D(x_n) for x_1 < .. < x_n.
///
/// Each is above the one before it: x_i = x_(i-1) + exp(z_i) on the line, as
/// in the Stan Reference Manual's ordered vector.
///
/// ```
/// use couloir::prior::{Distribution, Joint, Normal, Ordered};
/// use couloir::scalar::{Plain, Real};
/// let two = Ordered::<Plain, _>::new(Normal::new(0.0, 1.0));
/// let first = [Real::new(1.0)];
/// let second = two.next(2, &first);
/// assert_eq!(second.log_density(Real::new(0.5)).value(), f64::NEG_INFINITY);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Ordered<K: Kind, D> {
    of: D,
    kind: std::marker::PhantomData<K>,
}

impl<K: Kind, D: Prior<K>> Ordered<K, D> {
    /// From the distribution of each before they are put in order.
    #[inline]
    pub fn new(of: D) -> Self {
        Self { of, kind: std::marker::PhantomData }
    }
}

impl<K: Kind, D: Prior<K>> Joint<K> for Ordered<K, D> {
    fn check(&self, _: usize) -> Result<()> {
        Ok(())
    }

    fn next(&self, _: usize, before: &[Real<K>]) -> impl Prior<K> {
        // The factors i make n!.
        let log_place = ((before.len() + 1) as f64).ln();
        Next { of: &self.of, above: before.last().copied(), log_place }
    }

    fn determines_last(&self) -> bool {
        false
    }

    fn last(&self, before: &[Real<K>]) -> Real<K> {
        before.last().copied().unwrap_or_default()
    }

    fn draw(&self, count: usize, rng: &mut Rng) -> Option<List<f64>> {
        let all = (0..count).map(|_| self.of.draw(rng));
        let mut all = all.collect::<Option<List<f64>>>()?;
        all.sort_by(f64::total_cmp);
        Some(all)
    }
}

/// The next number, above the one before it. It has no draws of its own: the
/// numbers before it would have to leave room.
struct Next<'d, K: Kind, D> {
    of: &'d D,
    above: Option<Real<K>>,
    log_place: f64,
}

impl<K: Kind, D: Prior<K>> Distribution<K> for Next<'_, K, D> {
    fn log_density(&self, x: Real<K>) -> Real<K> {
        match self.above {
            Some(above) if x <= above => impossible(),
            _ => self.of.log_density(x) + self.log_place,
        }
    }

    fn draw(&self, _: &mut Rng) -> Option<f64> {
        None
    }
}

impl<K: Kind, D: Prior<K>> Prior<K> for Next<'_, K, D> {
    fn support(&self) -> Support<K> {
        self.of.support().cut(self.above, None)
    }

    fn is_proper(&self) -> bool {
        self.of.is_proper()
    }

    fn quantile(&self, _: f64) -> Option<f64> {
        None
    }
}
