//! An event with its own posterior.

use crate::draws::Draws;
use crate::error::{Error, Result};
use crate::prior::{AnyPrior, Distribution};
use crate::scalar::{Plain, Real};

/// An event as it was calibrated alone.
#[derive(Debug, Clone)]
pub struct Member {
    /// What it is called.
    pub name: String,
    /// Draws of the parameters that the population is of, as named.
    pub draws: Draws,
    /// The prior that each of them was calibrated under.
    pub priors: Vec<AnyPrior>,
}

/// The fewest draws of a member.
const FEWEST: usize = 20;

/// A member as the population's likelihood reads it.
#[derive(Debug, Clone)]
pub(super) struct Weighed {
    /// Places by draw and parameter, one draw after the other.
    pub(super) places: Vec<f64>,
    /// - ln of the prior density at each draw, on the scale of the places.
    pub(super) base: Vec<f64>,
}

impl Member {
    /// # Errors
    /// Too few draws, or an improper prior.
    pub(super) fn check(&self) -> Result<()> {
        let wrong = |what: String| Error::input(what).within(&self.name);
        if self.draws.total() < FEWEST {
            return Err(wrong(format!(
                "{} draws; expected {FEWEST} or more",
                self.draws.total()
            )));
        }
        match self.priors.iter().position(|prior| !prior.is_proper()) {
            Some(flat) => Err(wrong(format!(
                "the prior of {} is improper; expected one that integrates \
                 to 1",
                self.draws.names()[flat]
            ))),
            None => Ok(()),
        }
    }

    /// Puts a member's draws on the scale of the population: logarithms where
    /// `in_log`.
    ///
    /// # Errors
    /// A draw outside its prior.
    pub(super) fn weighed(&self, in_log: &[bool]) -> Result<Weighed> {
        let (mut places, mut base) = (Vec::new(), Vec::new());
        for row in self.draws.rows() {
            let mut density = 0.0;
            for ((x, prior), in_log) in
                row.iter().zip(&self.priors).zip(in_log)
            {
                let own: Real<Plain> = prior.log_density(Real::new(*x));
                let place = if *in_log { x.ln() } else { *x };
                // ln p(ln x) = ln p(x) + ln x.
                density += own.value() + if *in_log { place } else { 0.0 };
                places.push(place);
            }
            if !density.is_finite() {
                return Err(Error::input(format!(
                    "the draw {row:?} has no density under the prior; \
                     expected draws of a calibration under this prior"
                ))
                .within(&self.name));
            }
            base.push(-density);
        }
        Ok(Weighed { places, base })
    }
}
