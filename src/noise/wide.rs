//! A noise whose errors are wider where more is predicted.

use super::{Conditional, Grid, Noise};
use crate::error::{Error, Stop};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// A noise whose i-th error is `widths[i]` times as wide: with w the width,
/// p(r) = p_base(r/w)/w. What [`Noise::width`] asks for.
#[derive(Debug, Clone, Copy)]
pub struct Wide<'a, K: Kind, N: ?Sized> {
    base: &'a N,
    widths: &'a [Real<K>],
}

impl<'a, K: Kind, N: Noise<K> + ?Sized> Wide<'a, K, N> {
    /// A noise with the widths of errors, one for each value.
    ///
    /// # Errors
    /// [`Stop::Reject`] for a width that is not positive, [`Stop::Fail`]
    /// beside known standard errors, which no width should change.
    pub fn new(
        base: &'a N,
        widths: &'a [Real<K>],
        at: &Grid,
    ) -> Result<Self, Stop> {
        if at.standard_errors().is_some() {
            return Err(Stop::Fail(Error::input(
                "the recording has known standard errors, and its noise a \
                 width that depends on the prediction; expected one of \
                 them: leave the standard errors out, or the width",
            )));
        }
        if !widths.iter().all(|w| *w > 0.0 && w.value().is_finite()) {
            return Err(Stop::Reject("the width of an error is not positive"));
        }
        Ok(Self { base, widths })
    }
}

impl<K: Kind, N: Noise<K> + ?Sized> Noise<K> for Wide<'_, K, N> {
    fn check(&self, at: &Grid) -> crate::Result<()> {
        self.base.check(at)
    }

    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        let pairs = residuals.iter().zip(self.widths);
        let narrow: Vec<_> = pairs.map(|(r, w)| *r / *w).collect();
        let mut widths = self.widths.iter();
        self.base.walk(at, &narrow, &mut |mut value| {
            if let Some(width) = widths.next() {
                value.log_density -= width.ln();
            }
            visit(value);
        })
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        let mut drawn = self.base.draw(at, rng)?;
        for (error, width) in drawn.iter_mut().zip(self.widths) {
            *error *= width.value();
        }
        Ok(drawn)
    }

    fn standardise(&self, deviate: f64) -> f64 {
        self.base.standardise(deviate)
    }
}
