//! The Fisher information of a model at a point: how sharply its data tell
//! its parameters.
//!
//! With standardised innovations d_i and their scales s_i, the log likelihood
//! of normal errors is -sum(d_i^2/2 + ln s_i), and the expectation of minus its
//! Hessian is about sum(dd_i dd_i' + dln s_i dln s_i'), from first derivatives
//! alone (Gauss and Newton's matrix, with the part of the scales); other laws
//! say themselves what a value tells. The prior adds its own curvature,
//! parameter by parameter.

use nalgebra::DVector;

use super::along::Along;
use super::any_program::AnyProgram;
use super::density::Density;
use super::information::Information;
use super::jacobian::Jacobian;
use super::listener::{Declaration, Listener};
use super::number::Number;
use super::pass::{passes, run};
use super::run::Source;
use crate::error::{Error, Outcome, Result};
use crate::noise::Noise;
use crate::observe::Series;
use crate::prior::Distribution;
use crate::scalar::{Forward, Grad, Kind, Real};

/// Derivatives of the innovations and of their scales, and how the priors bend.
#[derive(Debug)]
struct Columns<'d> {
    jacobian: Jacobian,
    along: Along<'d>,
    /// How many directions earlier passes looked at, and the next column.
    done: usize,
    next: usize,
    /// Minus the second derivative of each prior's log density along the line;
    /// zero of those that no direction changes.
    bends: Vec<f64>,
}

impl Columns<'_> {
    fn push<K: Forward>(&mut self, x: &Real<K>) {
        self.jacobian.write(self.next, self.done, x);
        self.next += 1;
    }
}

/// One run's part of them, the derivatives that its numbers carry.
struct Part<'c, 'd, K: Kind> {
    columns: &'c mut Columns<'d>,
    /// Of the series just heard.
    log_likelihood: Option<Real<K>>,
}

impl<K: Forward> Listener<K> for Part<'_, '_, K> {
    fn parameter(&mut self, declaration: &Declaration<'_, K>) {
        let Columns { along, done: 0, bends, .. } = &mut *self.columns else {
            return;
        };
        let is_asked = along.change(bends.len());
        bends.push(if is_asked { bend(declaration) } else { 0.0 });
    }

    fn log_likelihood(&mut self) -> Option<Real<K>> {
        self.log_likelihood.take()
    }

    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<K>],
        noise: &dyn Noise<K>,
    ) -> Outcome {
        let columns = &mut *self.columns;
        if columns.done == 0 {
            // Of most noises, a place and a size of each.
            columns.jacobian.reserve(2 * residuals.len() + 1);
        }
        let total = noise.inform(series.grid(), residuals, &mut |number| {
            columns.push(number);
        })?;
        self.log_likelihood = Some(total);
        Ok(())
    }

    fn element(
        &mut self,
        _: f64,
        log_density: Real<K>,
        _: &dyn Distribution<K>,
    ) {
        self.columns.push(&log_density);
    }

    fn increment(&mut self, log_density: Real<K>) {
        self.columns.push(&log_density);
    }
}

/// Minus the second derivative of a prior's log density along the line, where
/// that is positive.
fn bend<K: Kind>(declaration: &Declaration<'_, K>) -> f64 {
    let support = declaration.prior.support();
    let at = |z: f64| {
        let (x, log_jacobian) = support.from_line(Real::new(z));
        (declaration.prior.log_density(x) + log_jacobian).value()
    };
    let z = support.to_line(declaration.value);
    let h = 1e-3;
    let bend = (2.0 * at(z) - at(z - h) - at(z + h)) / (h * h);
    if bend.is_finite() { bend.max(0.0) } else { 0.0 }
}

/// How many directions a pass takes at the most. One of 16 takes three
/// quarters of the time that one of 8 and another of 2 take, at 464 values.
const MOST: usize = 16;

/// The information of a program at a place on the real line, along some
/// directions.
pub(super) fn information(
    program: &dyn AnyProgram,
    z: &[f64],
    along: Along<'_>,
) -> Result<Information> {
    let count = along.count(z.len());
    let mut gradient = DVector::zeros(count);
    let mut columns = Columns {
        jacobian: Jacobian::new(count),
        along,
        done: 0,
        next: 0,
        bends: Vec::new(),
    };
    let mut last = None;
    for (done, wide) in passes(count, MOST) {
        (columns.done, columns.next) = (done, 0);
        let slots = &mut gradient.as_mut_slice()[done..];
        let along = along.from(done);
        let density = match wide {
            4 => pass::<Grad<4>>(program, z, along, slots, &mut columns),
            8 => pass::<Grad<8>>(program, z, along, slots, &mut columns),
            _ => pass::<Grad<16>>(program, z, along, slots, &mut columns),
        }?;
        let is_zero = density.rejected.is_some();
        last = Some(density);
        if is_zero {
            break;
        }
    }
    let density =
        last.ok_or_else(|| Error::inference("no direction to derive along"))?;
    let Columns { jacobian, bends, .. } = columns;
    let mut precision = jacobian.squared();
    along.add_diagonal(&bends, &mut precision);
    Ok(Information { density, gradient, precision, jacobian })
}

/// One run, for as many coordinates as its numbers carry derivatives of.
fn pass<K: Number + Forward>(
    program: &dyn AnyProgram,
    z: &[f64],
    along: Along<'_>,
    gradient: &mut [f64],
    columns: &mut Columns<'_>,
) -> Result<Density> {
    let source = Source::Line { z, along };
    let mut part = Part { columns: &mut *columns, log_likelihood: None };
    let (density, prior, jacobian, likelihood) =
        run::<K>(program, source, Some(z.len()), Some(&mut part))?;
    let total = prior + jacobian + likelihood;
    for (i, slot) in gradient.iter_mut().take(K::DIRECTIONS).enumerate() {
        *slot = total.partial(i);
    }
    columns.jacobian.resize(columns.next);
    Ok(density)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::model::{Label, Posterior, Program, Run, unit_directions};
    use crate::prior::{AnyPrior, Normal};

    /// 0.5 ~ N(a'x, 1) was seen, with x ~ N(0, 1) and a known.
    struct Linear(Vec<f64>);

    impl Program for Linear {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let standard = AnyPrior::Normal(0.0, 1.0);
            let x =
                run.vector(Label::new("x", "1"), self.0.len(), standard)?;
            let mut mean = Real::new(0.0);
            for (a, x) in self.0.iter().zip(&x) {
                mean += *x * *a;
            }
            run.observe_each(&0.5, Normal::new(mean, Real::new(1.0)))
        }
    }

    #[test]
    fn along_mixed_directions_it_is_the_quadratic_form() {
        let count = 7;
        let program = Linear((0..count).map(|i| 0.2 * i as f64).collect());
        let posterior = Posterior::new(&program).unwrap();
        let z: Vec<f64> = (0..count).map(|i| (0.3 * i as f64).sin()).collect();
        let whole = posterior.information(&z).unwrap();
        // More than a pass takes.
        let directions = DMatrix::from_fn(19, count, |i, j| {
            (1.3 * (i + 5 * j) as f64).cos()
        });
        let along = posterior.information_along(&z, &directions).unwrap();
        let gradient = &directions * &whole.gradient;
        assert!((along.gradient - gradient).amax() < 1e-12);
        let precision =
            &directions * &whole.precision * directions.transpose();
        assert!((along.precision - precision).amax() < 1e-12);
        let narrow = DMatrix::zeros(2, count - 1);
        let error = posterior.information_along(&z, &narrow).unwrap_err();
        assert!(error.is_input());
    }

    #[test]
    fn passes_of_any_widths_add_up() {
        for count in [1, 2, 3, 5, 9, 11, 16, 17, 19, 33] {
            let weights = |i: usize| (0.7 * i as f64).cos();
            let program = Linear((0..count).map(weights).collect());
            let posterior = Posterior::new(&program).unwrap();
            let z: Vec<f64> =
                (0..count).map(|i| (0.3 * i as f64).sin()).collect();
            let a = DVector::from_vec(program.0.clone());
            let x = DVector::from_column_slice(&z);
            let found = posterior.information(&z).unwrap();
            // An element counts by the square of its score.
            let score = &a * (0.5 - a.dot(&x));
            let gradient = &score - &x;
            assert!((&found.gradient - gradient).amax() < 1e-12, "{count}");
            let one = DMatrix::identity(count, count);
            let precision = one + &score * score.transpose();
            // Second differences of the prior's density over steps of 1e-3.
            assert!((&found.precision - precision).amax() < 1e-8, "{count}");
            for i in 0..count {
                let one = unit_directions(&[i], count);
                let along = posterior.information_along(&z, &one).unwrap();
                assert_eq!(along.density, found.density);
                assert_eq!(along.gradient[0], found.gradient[i]);
                assert_eq!(along.precision[0], found.precision[(i, i)]);
                assert_eq!(along.jacobian.row(0), found.jacobian.row(i));
            }
        }
    }
}
