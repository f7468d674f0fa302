//! Independent errors with heavy tails.

use rand_distr::{Distribution, StudentT};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use statrs::function::gamma::{digamma, ln_gamma};

use super::{Conditional, Grid, Noise, is_positive, one_per_time};
use crate::block::{Block, Field};
use crate::error::Stop;
use crate::scalar::{Kind, Real, polynomial};
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
        self.each(at, residuals, |law, r| visit(law.at(r, None)))
    }

    fn inform(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        hear: &mut dyn FnMut(&Real<K>),
    ) -> Result<Real<K>, Stop> {
        let known = Known::of(self.dof);
        let mut total = Real::new(0.0);
        self.each(at, residuals, |law, r| {
            hear(&known.place(&r, law.inverse_width.value()));
            hear(&known.size(law.log_width));
            total += law.log_density(r);
        })?;
        hear(&known.shape(residuals.len()));
        Ok(total)
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
    // What is no number has no distribution function, and half of the
    // smallest numbers is 0.
    let is_number = !deviate.is_nan() && dof.is_normal();
    let law = StudentsT::new(0.0, 1.0, dof).ok().filter(|_| is_number);
    let Some(law) = law else { return f64::NAN };
    // In the lower tail, where a small probability is exact.
    let tail = law.cdf(-deviate.abs()).max(f64::MIN_POSITIVE);
    let z = Normal::standard().inverse_cdf(tail.min(0.5));
    z.abs().copysign(deviate)
}

/// A Student density of mean 0 with its constants worked out once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law<K: Kind> {
    constant: Real<K>,
    /// ln w.
    log_width: Real<K>,
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
        let log_width = 0.5 * square.ln();
        Self {
            constant: log_peak - log_width,
            log_width,
            power: 0.5 * (dof + 1.0),
            precision: 1.0 / (dof * square),
            inverse_width: 1.0 / square.sqrt(),
        }
    }

    /// One value, its size on top of its width where that changes.
    #[inline(always)]
    pub(super) fn at(
        &self,
        r: Real<K>,
        log_size: Option<Real<K>>,
    ) -> Conditional<K> {
        let log_density = self.log_density(r) - log_size.unwrap_or_default();
        Conditional::new(log_density, r * self.inverse_width)
    }

    #[inline(always)]
    fn log_density(&self, r: Real<K>) -> Real<K> {
        self.constant - self.power * (r * r * self.precision).ln_1p()
    }
}

/// The Fisher information of values of the Student law (Lange, Little and
/// Taylor 1989, appendix): of the place in widths (dof + 1)/(dof + 3), of the
/// log width 2 dof/(dof + 3), of both log width and dof
/// -2/((dof + 1)(dof + 3)), and of dof; the last three as the factor L of
/// L L'.
pub(super) struct Known<K: Kind> {
    dof: Real<K>,
    place: f64,
    pub(super) size: f64,
    both: f64,
    shape: f64,
}

impl<K: Kind> Known<K> {
    pub(super) fn of(nu: Real<K>) -> Self {
        let dof = nu.value();
        let size = (2.0 * dof / (dof + 3.0)).sqrt();
        let both = -2.0 / ((dof + 1.0) * (dof + 3.0)) / size;
        let own = of_dof(dof) - both * both;
        let place = (dof + 1.0) / (dof + 3.0);
        Self { dof: nu, place, size, both, shape: own.max(0.0).sqrt() }
    }

    /// What a value tells of its place, as derivatives alone. One far out
    /// tells the less the farther out it is: in proportion to
    /// (dof + 1)/(dof + d^2), which is 1 on average.
    #[inline(always)]
    pub(super) fn place(&self, r: &Real<K>, inverse_width: f64) -> Real<K> {
        let (d, dof) = (r.value() * inverse_width, self.dof.value());
        let near = self.place * (dof + 1.0) / (dof + d * d);
        Real::combine(0.0, [(r, inverse_width * near.sqrt())])
    }

    /// What it tells of its log width.
    #[inline(always)]
    pub(super) fn size(&self, log_width: Real<K>) -> Real<K> {
        log_width * self.size + self.dof * self.both
    }

    /// What so many values tell of the degrees of freedom beyond that.
    pub(super) fn shape(&self, count: usize) -> Real<K> {
        self.dof * (self.shape * (count as f64).sqrt())
    }
}

/// The Fisher information of the degrees of freedom.
fn of_dof(dof: f64) -> f64 {
    if dof <= 0.0 {
        // There is no such law, and a noise of it is rejected.
        return f64::NAN;
    }
    if dof > 200.0 {
        // The difference of two large numbers; its first terms are within
        // 1e-3 of it.
        return (3.5 - 13.0 / dof) / dof.powi(4);
    }
    let bends = trigamma(0.5 * dof) - trigamma(0.5 * (dof + 1.0));
    let rest = (dof + 5.0) / (2.0 * dof * (dof + 1.0) * (dof + 3.0));
    0.25 * bends - rest
}

/// The derivative of the digamma function: by psi'(x) = psi'(x + 1) + 1/x^2 to
/// where its asymptotic series holds (Abramowitz and Stegun 1972, 6.4.12).
fn trigamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 20.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let u = 1.0 / (x * x);
    let series =
        polynomial(u, &[1.0 / 6.0, -1.0 / 30.0, 1.0 / 42.0, -1.0 / 30.0]);
    sum + 1.0 / x + 0.5 * u + series * u / x
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Grad;

    type D = Real<Grad<4>>;

    /// What the log density and the numbers that inform have for derivatives
    /// by place, log width, and degrees of freedom, at an angle whose tangent
    /// is the deviate; and the probability there.
    fn at(angle: f64, dof: f64) -> (f64, [f64; 3], [[f64; 3]; 3]) {
        let log_width = D::variable(0.3, 1);
        let nu = D::variable(dof, 2);
        let square = (2.0 * log_width).exp();
        let law = Law::new(nu, log_peak(nu), square);
        let r = angle.tan() * 0.3_f64.exp() - D::variable(0.0, 0);
        let log_density = law.log_density(r);
        let known = Known::of(nu);
        let told = [
            known.place(&r, law.inverse_width.value()),
            known.size(law.log_width),
            known.shape(1),
        ];
        let of = |x: D| [x.partial(0), x.partial(1), x.partial(2)];
        let stretch = 0.3_f64.exp() / angle.cos().powi(2);
        let p = log_density.value().exp() * stretch;
        (p, of(log_density), told.map(of))
    }

    #[test]
    fn values_tell_of_the_tails_as_often_as_there_are_some() {
        let known = Known::of(D::variable(3.0, 2));
        let [one, four] = [1, 4].map(|n| known.shape(n).partial(2).powi(2));
        assert!((four / one - 4.0).abs() < 1e-14);
    }

    #[test]
    fn trigamma_is_pi_squared_over_six_at_one() {
        let square = std::f64::consts::PI.powi(2);
        let [half, one] = [square / 2.0, square / 6.0];
        // Sums of 20 terms: their round-off.
        assert!((trigamma(0.5) - half).abs() < 1e-14);
        assert!((trigamma(1.0) - one).abs() < 1e-14);
        let fifth = one - 1.0 - 1.0 / 4.0 - 1.0 / 9.0 - 1.0 / 16.0;
        assert!((trigamma(5.0) - fifth).abs() < 1e-14);
        // 1/x + 1/(2 x^2) + 1/(6 x^3) - 1/(30 x^5), all of it here.
        let x = 100.0_f64;
        let far = 1.0 / x + 0.5 / x.powi(2) + 1.0 / (6.0 * x.powi(3))
            - 1.0 / (30.0 * x.powi(5));
        assert!((trigamma(x) / far - 1.0).abs() < 1e-13);
    }

    #[test]
    fn what_a_value_tells_is_the_mean_square_of_its_score() {
        const STEPS: usize = 20_000;
        for dof in [2.0, 4.0, 30.0, 250.0] {
            let (mut known, mut told) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
            for k in 0..STEPS {
                let step = std::f64::consts::PI / STEPS as f64;
                let angle =
                    (k as f64 + 0.5) * step - 0.5 * STEPS as f64 * step;
                let (p, score, numbers) = at(angle, dof);
                for i in 0..3 {
                    for j in 0..3 {
                        let all = numbers.iter().map(|n| n[i] * n[j]);
                        known[i][j] += p * step * score[i] * score[j];
                        told[i][j] += p * step * all.sum::<f64>();
                    }
                }
            }
            for i in 0..3 {
                for j in 0..3 {
                    // The midpoint rule, and above 200 the first terms.
                    let size = (known[i][i] * known[j][j]).sqrt();
                    let off = (told[i][j] - known[i][j]).abs() / size;
                    assert!(off < 1e-3, "{dof} {i} {j}: {off}");
                }
            }
        }
    }
}
