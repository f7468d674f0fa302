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

use super::density::Density;
use super::information::Information;
use super::jacobian::Jacobian;
use super::listener::{Declaration, Listener};
use super::number::Number;
use super::pass::run;
use super::program::Program;
use super::run::Source;
use crate::error::{Error, Outcome, Result};
use crate::noise::{Informing, Noise};
use crate::observe::Series;
use crate::prior::Distribution;
use crate::scalar::{Forward, Grad, Kind, Real};

/// Derivatives of the innovations and of their scales, and how the priors bend.
#[derive(Debug)]
struct Columns {
    jacobian: Jacobian,
    /// The first of the coordinates that are looked at, and the next column.
    first: usize,
    next: usize,
    /// Minus the second derivative of each prior's log density along the line.
    bends: Vec<f64>,
}

impl Columns {
    fn push<K: Forward>(&mut self, x: &Real<K>) {
        self.jacobian.write(self.next, self.first, x);
        self.next += 1;
    }
}

/// One run's part of them, the derivatives that its numbers carry.
struct Part<'c, K: Kind> {
    columns: &'c mut Columns,
    /// Of the series just heard.
    log_likelihood: Option<Real<K>>,
}

impl<K: Forward> Listener<K> for Part<'_, K> {
    fn parameter(&mut self, declaration: &Declaration<'_, K>) {
        if self.columns.first == 0 {
            self.columns.bends.push(bend(declaration));
        }
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
        let mut total = Real::new(0.0);
        let columns = &mut *self.columns;
        noise.walk(series.grid(), residuals, &mut |value| {
            let Informing { place, size, shape } = &value.informing;
            columns.push(place);
            columns.push(size);
            shape.iter().for_each(|shape| columns.push(shape));
            total += value.log_density;
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

/// For how many columns room is made at once.
const RESERVED: usize = 256;

/// The information of a program at a place on the real line.
pub(super) fn information<P: Program>(
    program: &P,
    z: &[f64],
) -> Result<Information> {
    let mut gradient = DVector::zeros(z.len());
    let jacobian = Jacobian::new(z.len(), RESERVED);
    let mut columns =
        Columns { jacobian, first: 0, next: 0, bends: Vec::new() };
    let density = match z.len() {
        0..=2 => fill::<Grad<2>, P>(program, z, &mut gradient, &mut columns),
        3..=4 => fill::<Grad<4>, P>(program, z, &mut gradient, &mut columns),
        5..=16 => fill::<Grad<8>, P>(program, z, &mut gradient, &mut columns),
        _ => fill::<Grad<16>, P>(program, z, &mut gradient, &mut columns),
    }?;
    let Columns { jacobian, bends, .. } = columns;
    let mut precision = jacobian.squared();
    for (i, bend) in bends.iter().take(z.len()).enumerate() {
        precision[(i, i)] += bend;
    }
    Ok(Information { density, gradient, precision, jacobian })
}

fn fill<K: Number + Forward, P: Program>(
    program: &P,
    z: &[f64],
    gradient: &mut DVector<f64>,
    columns: &mut Columns,
) -> Result<Density> {
    let mut last = None;
    for first in (0..z.len()).step_by(K::DIRECTIONS) {
        (columns.first, columns.next) = (first, 0);
        let source = Source::Line { z, first };
        let mut part = Part { columns: &mut *columns, log_likelihood: None };
        let (density, prior, jacobian, likelihood) =
            run::<K, P>(program, source, Some(z.len()), Some(&mut part))?;
        let total = prior + jacobian + likelihood;
        for i in 0..K::DIRECTIONS.min(z.len() - first) {
            gradient[first + i] = total.partial(i);
        }
        let zero = density.rejected.is_some();
        last = Some(density);
        columns.jacobian.resize(columns.next);
        if zero {
            break;
        }
    }
    last.ok_or_else(|| Error::inference("the model has no parameters"))
}
