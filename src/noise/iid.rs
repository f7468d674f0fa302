//! Independent normal errors, the paper's M0.

use rand_distr::{Distribution, StandardNormal};

use super::gaussian::Gaussian;
use super::{Conditional, Grid, Noise, is_positive, one_per_time};
use crate::block::{Block, Field};
use crate::error::Stop;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// r_i ~ N(0, sigma2 + s_i^2), independent; s_i is the known standard error
/// of the value, 0 where none is given (Heredia et al. 2020, equation 6).
///
/// ```
/// use couloir::noise::{Grid, Iid, Noise};
/// use couloir::scalar::{Plain, Real};
/// let noise = Iid::<Real<Plain>> { sigma2: Real::new(4.0) };
/// let at = Grid::new(vec![0.0, 1.0], None);
/// let total = noise.log_likelihood(&at, &[2.0.into(), 0.0.into()]);
/// let density = 1.0 / (8.0 * std::f64::consts::PI);
/// assert!((total.unwrap().value() - (density.ln() - 0.5)).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Iid<S> {
    /// The variance, in the squared unit of the recording.
    pub sigma2: S,
}

impl<S: Clone> Block<S> for Iid<S> {
    const NAME: &'static str = "iid";
    const FIELDS: &'static [Field] =
        &[Field::new("sigma2", "value2", "LogNormal(ln 1e-4 size2, 2)")];

    fn from_values(values: &[S]) -> Self {
        Self { sigma2: values[0].clone() }
    }
}

impl<K: Kind> Iid<Real<K>> {
    fn admit(&self) -> Result<(), Stop> {
        if is_positive(self.sigma2) {
            Ok(())
        } else {
            Err(Stop::Reject("the variance sigma2 is not positive"))
        }
    }

    /// Visits each residual with its law.
    #[inline(always)]
    fn each(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        mut visit: impl FnMut(&Gaussian<K>, Real<K>),
    ) -> Result<(), Stop> {
        self.admit()?;
        one_per_time(at, residuals)?;
        let Some(errors) = at.standard_errors() else {
            let law = Gaussian::new(self.sigma2);
            residuals.iter().for_each(|&r| visit(&law, r));
            return Ok(());
        };
        for (&r, s) in residuals.iter().zip(errors) {
            visit(&Gaussian::new(self.sigma2 + s * s), r);
        }
        Ok(())
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
        self.each(at, residuals, |law, r| visit(law.at(r)))
    }

    fn inform(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        hear: &mut dyn FnMut(&Real<K>),
    ) -> Result<Real<K>, Stop> {
        let mut total = Real::new(0.0);
        self.each(at, residuals, |law, r| total += law.inform(r, hear))?;
        Ok(total)
    }

    fn log_likelihood(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> Result<Real<K>, Stop> {
        self.admit()?;
        one_per_time(at, residuals)?;
        let terms = residuals.iter();
        Ok(match at.standard_errors() {
            None => Gaussian::new(self.sigma2)
                .of_squares(terms.len(), terms.map(|&r| r * r).sum()),
            Some(errors) => terms
                .zip(errors)
                .map(|(&r, s)| {
                    Gaussian::new(self.sigma2 + s * s).at(r).log_density
                })
                .sum(),
        })
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        self.admit()?;
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
