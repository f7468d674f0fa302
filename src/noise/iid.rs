//! Independent normal errors, the paper's M0.

use rand_distr::{Distribution, StandardNormal};

use super::{Conditional, Grid, Noise};
use crate::block::{Block, Field};
use crate::error::Stop;
use crate::prior::LN_SQRT_2PI;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// r_i ~ N(0, sigma2 + s_i^2), independent; s_i is the known standard error
/// of the value, 0 where none is given (Heredia et al. 2020, equation 6).
#[derive(Debug, Clone, Copy)]
pub struct Iid<S> {
    /// The variance, in the squared unit of the recording.
    pub sigma2: S,
}

impl<S: Clone> Block<S> for Iid<S> {
    const NAME: &'static str = "iid";
    const FIELDS: &'static [Field] =
        &[Field::new("sigma2", "unit2", "InverseGamma(2, 1)")];

    fn from_values(values: &[S]) -> Self {
        Self { sigma2: values[0].clone() }
    }
}

impl<K: Kind> Noise<K> for Iid<Real<K>> {
    fn check(&self, _: &Grid) -> crate::Result<()> {
        Ok(())
    }

    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        if !(self.sigma2 > 0.0) {
            return Err(Stop::Reject("the variance sigma2 is not positive"));
        }
        match at.standard_errors() {
            None => {
                let law = Gaussian::new(self.sigma2);
                residuals.iter().for_each(|&r| visit(law.at(r)));
            }
            Some(errors) => {
                for (&r, s) in residuals.iter().zip(errors) {
                    visit(Gaussian::new(self.sigma2 + s * s).at(r));
                }
            }
        }
        Ok(())
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        let errors = at.standard_errors();
        Ok((0..at.len())
            .map(|i| {
                let known = errors.map_or(0.0, |s| s[i] * s[i]);
                let z: f64 = StandardNormal.sample(rng);
                z * (self.sigma2.value() + known).sqrt()
            })
            .collect())
    }
}

/// A normal density of mean 0 with its constants worked out once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gaussian<K: Kind> {
    constant: Real<K>,
    half_precision: Real<K>,
    sd: f64,
}

impl<K: Kind> Gaussian<K> {
    #[inline]
    pub(crate) fn new(variance: Real<K>) -> Self {
        Self {
            constant: -0.5 * variance.ln() - LN_SQRT_2PI,
            half_precision: 0.5 / variance,
            sd: variance.value().sqrt(),
        }
    }

    #[inline]
    pub(crate) fn at(&self, r: Real<K>) -> Conditional<K> {
        Conditional {
            log_density: self.constant - r * r * self.half_precision,
            innovation: r.value() / self.sd,
        }
    }
}
