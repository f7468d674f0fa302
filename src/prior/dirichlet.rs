//! Shares of a whole.

use super::gamma::ln_draw;
use super::{Beta, Distribution, Joint, Prior, Support, positive};
use crate::block::List;
use crate::error::{Error, Result};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// Dirichlet(\[a, b, ..\]) of n shares above 0 that sum to 1:
/// p(x) = Γ(a + b + ..) / (Γ(a) Γ(b) ..) x_1^(a - 1) x_2^(b - 1) ...
/// `Dirichlet([a; n])` is the same for each; a = 1 is uniform.
///
/// By breaking a stick: of what is left, each takes a share that is Beta(a,
/// sum of those after it), and the last is the rest (Connor and Mosimann
/// 1969).
///
/// ```
/// use couloir::prior::{Dirichlet, Distribution, Joint};
/// use couloir::scalar::{Plain, Real};
/// let shares = Dirichlet::<Plain>::new([1.0, 1.0, 1.0]);
/// let (first, rest) = (Real::new(0.2), Real::new(0.5));
/// let density = shares.next(3, &[]).log_density(first)
///     + shares.next(3, &[first]).log_density(rest);
/// // The triangle of shares has a density of 2! everywhere.
/// assert!((density.value() - 2.0_f64.ln()).abs() < 1e-14);
/// assert!((shares.last(&[first, rest]).value() - 0.3).abs() < 1e-15);
/// ```
#[derive(Debug, Clone)]
pub struct Dirichlet<K: Kind> {
    weights: List<Real<K>>,
}

impl<K: Kind> Dirichlet<K> {
    /// From a weight for each share.
    #[inline]
    pub fn new<W: Into<Real<K>>>(
        weights: impl IntoIterator<Item = W>,
    ) -> Self {
        Self { weights: weights.into_iter().map(Into::into).collect() }
    }
}

impl<K: Kind> Joint<K> for Dirichlet<K> {
    fn check(&self, count: usize) -> Result<()> {
        match (self.weights.len(), count) {
            (_, 0 | 1) => Err(Error::input(format!(
                "Dirichlet has {count} shares; expected two or more"
            ))),
            (found, count) if found != count => Err(Error::input(format!(
                "Dirichlet has {found} weights for {count} shares; expected \
                 one for each, such as Dirichlet([1.0; {count}])"
            ))),
            _ => Ok(()),
        }
    }

    fn next(&self, _: usize, before: &[Real<K>]) -> impl Prior<K> {
        let i = before.len();
        let after = self.weights[i + 1..].iter().copied().sum::<Real<K>>();
        Share { of: Beta::new(self.weights[i], after), left: left(before) }
    }

    fn determines_last(&self) -> bool {
        true
    }

    fn last(&self, before: &[Real<K>]) -> Real<K> {
        left(before)
    }

    fn draw(&self, count: usize, rng: &mut Rng) -> Option<List<f64>> {
        let weights = self.weights.iter().take(count);
        let logs = weights.map(|w| {
            positive(w.value()).then_some(())?;
            ln_draw(w.value(), rng)
        });
        let logs = logs.collect::<Option<List<f64>>>()?;
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let sizes = logs.iter().map(|log| (log - largest).exp());
        let sizes = sizes.collect::<List<f64>>();
        let total: f64 = sizes.iter().sum();
        // A share that rounds to nothing, or to all that is left, is none.
        let mut left = 1.0_f64;
        let mut inside = |size: &f64| {
            let most = left.next_down().max(f64::MIN_POSITIVE);
            let share = (size / total).clamp(f64::MIN_POSITIVE, most);
            left -= share;
            share
        };
        let (_, first) = sizes.split_last()?;
        let mut shares: List<f64> = first.iter().map(&mut inside).collect();
        shares.push(left);
        Some(shares)
    }
}

/// What is left of 1.
fn left<K: Kind>(before: &[Real<K>]) -> Real<K> {
    1.0 - before.iter().copied().sum::<Real<K>>()
}

/// A share of what is left.
struct Share<K: Kind> {
    of: Beta<K>,
    left: Real<K>,
}

impl<K: Kind> Distribution<K> for Share<K> {
    fn log_density(&self, x: Real<K>) -> Real<K> {
        self.of.log_density(x / self.left) - self.left.ln()
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        Some(self.of.draw(rng)? * self.left.value())
    }
}

impl<K: Kind> Prior<K> for Share<K> {
    fn support(&self) -> Support<K> {
        Support::Between(Real::new(0.0), self.left)
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        Some(self.of.quantile(p)? * self.left.value())
    }
}
