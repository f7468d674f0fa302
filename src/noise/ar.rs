//! Autoregressive errors of any order, the paper's M1 for order 1.

mod companion;
mod first;
mod levinson;
mod root;

use rand_distr::{Distribution, StandardNormal};

use self::first::First;
use self::levinson::{Predictor, one_minus_square};
use self::root::Filter;
use super::gaussian::Gaussian;
use super::part::check_increasing;
use super::{
    Conditional, Grid, Noise, Spacing, Stationary, is_positive, one_per_time,
};
use crate::block::{Block, Field, List};
use crate::error::{Error, Stop};
use crate::scalar::{Arithmetic, Kind, Real};
use crate::seed::Rng;

/// r_t = c_1 r_(t-1) + .. + c_k r_(t-k) + eta_t, eta_t ~ N(0, sigma2), in its
/// stationary state; k = 1 is Heredia et al. 2020, equation 7.
///
/// The coefficients c follow from the partial autocorrelations phi, each in
/// (-1, 1), by the Durbin-Levinson recursion: these are exactly the
/// stationary processes (Barndorff-Nielsen and Schou 1973). For k = 1,
/// c_1 = phi. The variance of r is sigma2 / prod (1 - phi_j^2).
///
/// A known standard error s_i adds an independent N(0, s_i^2) to the value i.
/// Missing values are passed over exactly. On uneven times only k = 1 exists,
/// as an Ornstein-Uhlenbeck process with the correlation phi^(d / step) over
/// a time d, phi >= 0; phi and sigma2 then belong to one median step.
///
/// ```
/// use couloir::noise::{Ar, Grid, Noise};
/// use couloir::scalar::{Plain, Real};
/// let x = Real::<Plain>::new;
/// let noise = Ar { phi: [x(0.6)].into_iter().collect(), sigma2: x(1.0) };
/// assert!((noise.stationary_sd().value() - 1.25).abs() < 1e-12);
/// let at = Grid::new(vec![0.0, 1.0], None);
/// let total = noise.log_likelihood(&at, &[x(1.25), x(0.75)]);
/// // N(1.25; 0, 1.25^2) N(0.75; 0.6 * 1.25, 1).
/// let density = (-0.5_f64).exp() / (2.5 * std::f64::consts::PI);
/// assert!((total.unwrap().value() - density.ln()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone)]
pub struct Ar<S> {
    /// The partial autocorrelations phi_11 .. phi_kk, pure numbers in
    /// (-1, 1); for k = 1 the coefficient itself.
    pub phi: List<S>,
    /// The variance of an innovation, in the squared unit of the recording.
    pub sigma2: S,
}

impl<S: Clone> Block<S> for Ar<S> {
    const NAME: &'static str = "ar";
    const FIELDS: &'static [Field] = &[
        Field::list("phi", "1", "Uniform(-1, 1)"),
        Field::new("sigma2", "value2", "LogNormal(ln 1e-4 size2, 2)"),
    ];

    fn from_values(values: &[S]) -> Self {
        let order = values.len().saturating_sub(1);
        Self {
            phi: values[..order].iter().cloned().collect(),
            sigma2: values[order].clone(),
        }
    }
}

impl<S: Arithmetic> Ar<S> {
    /// The coefficients c_1 .. c_k of the recursion.
    pub fn coefficients(&self) -> List<S> {
        let mut predictor = Predictor::new(S::one());
        self.phi.iter().for_each(|&partial| predictor.raise(partial));
        predictor.coefficients
    }

    /// The stationary variance sigma2 / prod (1 - phi_j^2) of r, in the
    /// squared unit of the recording.
    pub fn variance(&self) -> S {
        self.phi.iter().fold(self.sigma2, |v, &p| v / one_minus_square(p))
    }

    /// The autocovariances at the lags 0 .. `count` - 1, in the squared unit
    /// of the recording; without errors of measurement.
    pub fn autocovariances(&self, count: usize) -> Vec<S> {
        let mut predictor = Predictor::new(self.variance());
        let mut gamma = vec![predictor.variance];
        for lag in 1..count {
            // gamma_j = sum_(i<j) c_(j-1,i) gamma_(j-i) + phi_jj v_(j-1).
            let mut next = predictor.predict(&gamma[1..]);
            match self.phi.get(lag - 1) {
                Some(&partial) => {
                    next += partial * predictor.variance;
                    predictor.raise(partial);
                }
                None => next = predictor.predict(&gamma),
            }
            gamma.push(next);
        }
        gamma.truncate(count);
        gamma
    }
}

impl<K: Kind> Ar<Real<K>> {
    /// The stationary standard deviation of r, in the unit of the recording.
    pub fn stationary_sd(&self) -> Real<K> {
        self.variance().sqrt()
    }

    /// Rejects what is no stationary process.
    fn admit(&self, at: &Grid) -> Result<(), Stop> {
        if !is_positive(self.sigma2) {
            return Err(Stop::Reject("the variance sigma2 is not positive"));
        }
        let inside = |p: &Real<K>| p.value().abs() < 1.0;
        if !self.phi.iter().all(inside) || !is_positive(self.variance()) {
            return Err(Stop::Reject("a phi is not between -1 and 1"));
        }
        match (self.phi.len(), at.spacing()) {
            (1, _) => First::new(self.phi[0], self.sigma2).admit(at),
            (0, _) | (_, Spacing::Uneven) => Ok(self.exists(at)?),
            _ => Ok(()),
        }
    }

    /// Whether there is such a process at those times.
    fn exists(&self, at: &Grid) -> crate::Result<()> {
        match (self.phi.len(), at.spacing()) {
            (0, _) => Err(Error::input(
                "ar needs at least one phi, and has none; use ar(1), or iid",
            )),
            (1, _) | (_, Spacing::Regular | Spacing::Gaps(_)) => Ok(()),
            (k, Spacing::Uneven) => Err(Error::input(format!(
                "ar({k}) needs times on a regular grid, on which values may \
                 be missing, and these are spaced unevenly; use ar(1), or iid"
            ))),
        }
    }

    /// Visits each residual's error of prediction with its law.
    fn each(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        mut visit: impl FnMut(&Gaussian<K>, Real<K>),
    ) -> Result<(), Stop> {
        if let [phi] = *self.phi {
            return First::new(phi, self.sigma2).filter(at, residuals, visit);
        }
        let errors = at.standard_errors();
        let mut filter = Filter::new(&self.phi, self.sigma2, self.variance());
        for (i, &r) in residuals.iter().enumerate() {
            filter.advance(steps(at, i));
            let (law, error) = filter.measure(r, errors.map_or(0.0, |s| s[i]));
            visit(&law, error);
        }
        Ok(())
    }

    /// Visits each innovation with its law, whatever the grid.
    #[inline(always)]
    fn innovated(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        mut visit: impl FnMut(&Gaussian<K>, Real<K>),
    ) -> Result<(), Stop> {
        self.admit(at)?;
        one_per_time(at, residuals)?;
        if !is_full(at) {
            return self.each(at, residuals, visit);
        }
        let c = self.start(residuals, &mut visit);
        let law = Gaussian::new(self.sigma2);
        errors(&c, residuals, |e| visit(&law, e));
        Ok(())
    }

    /// The first k residuals on a full grid, with the predictors of lower
    /// order; returns the coefficients of the full one.
    fn start(
        &self,
        residuals: &[Real<K>],
        mut visit: impl FnMut(&Gaussian<K>, Real<K>),
    ) -> List<Real<K>> {
        let mut predictor = Predictor::new(self.variance());
        for (i, &partial) in self.phi.iter().enumerate() {
            if let Some(&r) = residuals.get(i) {
                let error = r - predictor.predict(&residuals[..i]);
                visit(&Gaussian::new(predictor.variance), error);
            }
            predictor.raise(partial);
        }
        predictor.coefficients
    }
}

/// The errors of prediction after the first k residuals on a full grid, in
/// loops of fixed length for the orders in use.
#[inline]
fn errors<K: Kind>(
    coefficients: &[Real<K>],
    residuals: &[Real<K>],
    mut visit: impl FnMut(Real<K>),
) {
    match *coefficients {
        [a] => residuals.windows(2).for_each(|w| visit(w[1] - a * w[0])),
        [a, b] => residuals
            .windows(3)
            .for_each(|w| visit(w[2] - a * w[1] - b * w[0])),
        [a, b, c] => residuals
            .windows(4)
            .for_each(|w| visit(w[3] - a * w[2] - b * w[1] - c * w[0])),
        _ => {
            let k = coefficients.len();
            for w in residuals.windows(k + 1) {
                let terms = coefficients.iter().zip(w[..k].iter().rev());
                visit(terms.fold(w[k], |e, (&c, &r)| e - c * r));
            }
        }
    }
}

/// The whole steps before the value `i` of a grid.
fn steps(at: &Grid, i: usize) -> usize {
    match at.spacing() {
        Spacing::Gaps(steps) => steps[i],
        _ => usize::from(i > 0),
    }
}

/// Whether every step has a value, measured without error.
fn is_full(at: &Grid) -> bool {
    *at.spacing() == Spacing::Regular && at.standard_errors().is_none()
}

impl<K: Kind> Noise<K> for Ar<Real<K>> {
    fn stationary(&self) -> Option<Stationary> {
        Some(Stationary {
            error_sd: self.stationary_sd().value(),
            innovation_sd: self.sigma2.value().sqrt(),
        })
    }

    fn check(&self, at: &Grid) -> crate::Result<()> {
        check_increasing("ar", at)?;
        self.exists(at)
    }

    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        self.innovated(at, residuals, |law, e| visit(law.at(e)))
    }

    fn inform(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        hear: &mut dyn FnMut(&Real<K>),
    ) -> Result<Real<K>, Stop> {
        let mut total = Real::new(0.0);
        let add = |law: &Gaussian<K>, e| total += law.inform(e, hear);
        self.innovated(at, residuals, add)?;
        Ok(total)
    }

    fn log_likelihood(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> Result<Real<K>, Stop> {
        self.admit(at)?;
        one_per_time(at, residuals)?;
        let mut total = Real::new(0.0);
        let mut add = |law: &Gaussian<K>, e| total += law.at(e).log_density;
        if !is_full(at) {
            self.each(at, residuals, add)?;
            return Ok(total);
        }
        let c = self.start(residuals, &mut add);
        let mut squares = Real::new(0.0);
        errors(&c, residuals, |e| squares += e * e);
        let count = residuals.len().saturating_sub(c.len());
        Ok(total + Gaussian::new(self.sigma2).of_squares(count, squares))
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        self.admit(at)?;
        let mut values = if let [phi] = *self.phi {
            First::new(phi, self.sigma2).draw(at, rng)
        } else {
            let mut filter =
                Filter::new(&self.phi, self.sigma2, self.variance());
            let next = |i| {
                filter.advance(steps(at, i));
                filter.settle(rng)
            };
            (0..at.len()).map(next).collect()
        };
        for (value, s) in
            values.iter_mut().zip(at.standard_errors().unwrap_or_default())
        {
            let z: f64 = StandardNormal.sample(rng);
            *value += s * z;
        }
        Ok(values)
    }
}
