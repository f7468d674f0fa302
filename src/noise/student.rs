//! Independent errors with heavy tails.

use rand_distr::{Distribution, StudentT};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use statrs::function::gamma::{digamma, ln_gamma};

use super::{Conditional, Grid, Noise, is_positive, one_per_time};
use crate::block::{Block, Field};
use crate::error::Stop;
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// r_i ~ t_dof(0, w_i), w_i^2 = scale^2 + s_i^2, independent; s_i is the known
/// standard error of the value, 0 where none is given (Lange, Little and
/// Taylor 1989):
///
///   p(r) = G((dof + 1)/2) / (G(dof/2) sqrt(pi dof) w)
///          (1 + r^2 / (dof w^2))^(-(dof + 1)/2), G the gamma function.
///
/// ```
/// use couloir::noise::{Grid, Noise, Student};
/// use couloir::scalar::{Plain, Real};
/// let x = Real::<Plain>::new;
/// let cauchy = Student { dof: x(1.0), scale: x(2.0) };
/// let at = Grid::new(vec![0.0], None);
/// let total = cauchy.log_likelihood(&at, &[x(2.0)]).unwrap();
/// let density = 1.0 / (4.0 * std::f64::consts::PI);
/// assert!((total.value() - density.ln()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Student<S> {
    /// The degrees of freedom, a pure number above 0.
    pub dof: S,
    /// The scale, in the unit of the recording.
    pub scale: S,
}

impl<S: Clone> Block<S> for Student<S> {
    const NAME: &'static str = "student";
    const FIELDS: &'static [Field] = &[
        Field::new("dof", "1", "Gamma(2, 10)"),
        Field::new("scale", "value", "LogNormal(ln 0.01 size, 1)"),
    ];

    fn from_values(values: &[S]) -> Self {
        Self { dof: values[0].clone(), scale: values[1].clone() }
    }
}

impl<K: Kind> Student<Real<K>> {
    fn admit(&self) -> Result<(), Stop> {
        if !is_positive(self.dof) {
            return Err(Stop::Reject(
                "the degrees of freedom are not positive",
            ));
        }
        if !is_positive(self.scale) {
            return Err(Stop::Reject("the scale is not positive"));
        }
        Ok(())
    }

    /// Visits each residual with its law.
    #[inline]
    fn each(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        mut visit: impl FnMut(&Law<K>, Real<K>),
    ) -> Result<(), Stop> {
        self.admit()?;
        one_per_time(at, residuals)?;
        let (square, peak) = (self.scale.squared(), log_peak(self.dof));
        let Some(errors) = at.standard_errors() else {
            let law = Law::new(self.dof, peak, square);
            residuals.iter().for_each(|&r| visit(&law, r));
            return Ok(());
        };
        for (&r, s) in residuals.iter().zip(errors) {
            visit(&Law::new(self.dof, peak, square + s * s), r);
        }
        Ok(())
    }
}

impl<K: Kind> Noise<K> for Student<Real<K>> {
    fn check(&self, _: &Grid) -> crate::Result<()> {
        Ok(())
    }

    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        self.each(at, residuals, |law, r| {
            visit(law.at(r));
        })
    }

    fn log_likelihood(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> Result<Real<K>, Stop> {
        let mut total = Real::new(0.0);
        self.each(at, residuals, |law, r| total += law.log_density(r))?;
        Ok(total)
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        self.admit()?;
        let Ok(law) = StudentT::new(self.dof.value()) else {
            return Err(Stop::Reject(
                "the degrees of freedom are not positive",
            ));
        };
        let (scale, errors) = (self.scale.value(), at.standard_errors());
        Ok((0..at.len())
            .map(|i| scale.hypot(errors.map_or(0.0, |s| s[i])))
            .map(|width| width * law.sample(rng))
            .collect())
    }

    fn standardise(&self, deviate: f64) -> f64 {
        normal_score(deviate, self.dof.value())
    }
}

/// The standard normal deviate as far out as a Student one.
pub(super) fn normal_score(deviate: f64, dof: f64) -> f64 {
    if dof > 1e6 {
        // Abramowitz and Stegun 1972, equation 26.7.8; the distribution
        // function is lost to round-off here.
        let shrunk = deviate * (1.0 - 0.25 / dof);
        return shrunk / (1.0 + 0.5 * deviate * deviate / dof).sqrt();
    }
    let Ok(law) = StudentsT::new(0.0, 1.0, dof) else {
        return f64::NAN;
    };
    // In the lower tail, where a small probability is exact.
    let tail = law.cdf(-deviate.abs()).max(f64::MIN_POSITIVE);
    let z = Normal::standard().inverse_cdf(tail.min(0.5));
    z.abs().copysign(deviate)
}

/// A Student density of mean 0 with its constants worked out once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law<K: Kind> {
    constant: Real<K>,
    power: Real<K>,
    /// 1 / (dof w^2).
    precision: Real<K>,
    inverse_width: Real<K>,
}

impl<K: Kind> Law<K> {
    #[inline]
    pub(super) fn new(
        dof: Real<K>,
        log_peak: Real<K>,
        square: Real<K>,
    ) -> Self {
        Self {
            constant: log_peak - 0.5 * square.ln(),
            power: 0.5 * (dof + 1.0),
            precision: 1.0 / (dof * square),
            inverse_width: 1.0 / square.sqrt(),
        }
    }

    /// One value.
    #[inline]
    pub(super) fn at(&self, r: Real<K>) -> Conditional<K> {
        let deviate = r * self.inverse_width;
        Conditional { log_density: self.log_density(r), deviate }
    }

    #[inline]
    fn log_density(&self, r: Real<K>) -> Real<K> {
        self.constant - self.power * (r * r * self.precision).ln_1p()
    }
}

/// ln G((dof + 1)/2) - ln G(dof/2) - ln(pi dof)/2, the log density of the
/// standard law at 0.
pub(super) fn log_peak<K: Kind>(dof: Real<K>) -> Real<K> {
    let a = 0.5 * dof;
    if a > 100.0 {
        // Difference of two large numbers; by Stirling's series, error
        // below 1e-16 here.
        let u = 1.0 / a;
        let rest =
            (u * u).polynomial(&[-1.0 / 8.0, 1.0 / 192.0, -1.0 / 640.0]);
        return u * rest - crate::prior::LN_SQRT_2PI;
    }
    log_gamma(a + 0.5) - log_gamma(a) - 0.5 * (std::f64::consts::PI * dof).ln()
}

fn log_gamma<K: Kind>(x: Real<K>) -> Real<K> {
    x.chain(ln_gamma(x.value()), digamma(x.value()))
}
