//! Forces that no recording tells from the model's own parameters: one that is
//! the same along the whole run from a friction, one that grows with the
//! square of the speed from a drag.
//!
//! To first order a force f adds J f to the innovations, and a change v of the
//! parameters S v. With A = J'J, G = J'S and D = S'S (and what the priors say
//! of v), the smooth force W w that does most nearly what v does has
//! w = (W'AW)^-1 W'G v. The share of it that it does,
//! v'G'W (W'AW)^-1 W'G v / v'Dv, is the square of a canonical correlation
//! (Hotelling 1936): near 1 along changes of the friction law, near 0 along
//! those of the errors.

use nalgebra::{DMatrix, SymmetricEigen};

use super::process::Process;
use super::tangent::Tangent;
use crate::mechanism::Extent;

/// Into how many lengths of these waves the run is parted: what a law does
/// changes with the ground and the speed.
const LENGTHS: f64 = 8.0;
/// The share of what a change of the parameters does that a force does, above
/// which they count as one. In five simulated flows, each under two noises and
/// along three axes, it was 0.95 or more along the law's parameters (0.46 once,
/// of a drag and a force over speed) and at most 0.25 along the errors'.
const LEAST: f64 = 0.5;
/// What keeps a force finite where nothing was recorded, as a share of what is
/// known of it on average.
const RIDGE: f64 = 1e-8;

/// The forces in each cell that do what changes of the model's own parameters
/// do, as independent columns of mean square 1; `None` where `tangent` tells of
/// no such change.
pub(super) fn confounded(
    tangent: &Tangent,
    extent: &Extent,
) -> Option<DMatrix<f64>> {
    let cells = tangent.of_waves.nrows() as f64;
    Some(imitations(tangent, extent)?.qr().q() * cells.sqrt())
}

/// A force for each direction of the parameters that one imitates; `None`
/// where there is no such direction.
fn imitations(tangent: &Tangent, extent: &Extent) -> Option<DMatrix<f64>> {
    let Tangent { of_waves: of_force, across, of_own, .. } = tangent;
    let smooth = Process::of_length(extent.run / LENGTHS);
    let waves = smooth.factor(extent, of_force.nrows());
    let waves = waves.insert_column(0, 1.0);
    let mut told = waves.tr_mul(&(of_force * &waves));
    let ridge = RIDGE * told.trace() / told.nrows() as f64;
    for i in 0..told.nrows() {
        told[(i, i)] += ridge;
    }
    let together = waves.tr_mul(across);
    let alike = told.cholesky()?.solve(&together);
    let does = together.tr_mul(&alike);
    // In coordinates of the parameters of which as much is known along each.
    let unit = of_own.clone().cholesky()?.l().try_inverse()?.transpose();
    let shares = SymmetricEigen::new(unit.tr_mul(&(does * &unit)));
    let of =
        |i: usize| &waves * (&alike * (&unit * shares.eigenvectors.column(i)));
    let shares_of = shares.eigenvalues.iter().enumerate();
    let near = shares_of.filter(|(_, share)| **share > LEAST);
    let columns: Vec<_> = near.map(|(i, _)| of(i)).collect();
    let is_finite = columns.iter().flatten().all(|f| f.is_finite());
    (is_finite && !columns.is_empty()).then(|| DMatrix::from_columns(&columns))
}
