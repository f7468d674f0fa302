//! Walks away from a peak: where a posterior is not as its peak looks.
//!
//! A normal approximation knows a peak's curvature and no more. A tail that is
//! bent, one-sided, or flat beyond some place, as that of a patch whose
//! friction can vanish but not fall below zero, holds as much as the peak and
//! none of its draws go there; importance weights cannot tell of places that
//! they have never seen. The profile along every coordinate does: strides
//! along it, with all other coordinates at their best, show where the
//! posterior lies above the approximation, and each such place becomes a part
//! (profiles as a check of normality: Bates, Watts 1988, chapter 6).

use nalgebra::DVector;
use rayon::prelude::*;

use super::climb::{Peak, climb_holding};
use super::proposal::Part;
use crate::error::Result;
use crate::model::Posterior;

/// How many of the highest peaks are walked away from.
const WALKED: usize = 3;
/// A stride, in widths of the peak.
const STRIDE: f64 = 1.2;
/// How far down a walk goes, in ln.
const DOWN: f64 = 7.0;
/// The most strides of a walk.
const STRIDES: usize = 12;
/// How much above the normal approximation, in ln, a place becomes a part.
const ABOVE: f64 = 0.4;

/// The parts met on walks from the highest of some peaks, along all
/// coordinates both ways.
///
/// # Errors
/// What no other parameter values would mend.
pub(super) fn walks(
    posterior: &Posterior<'_>,
    peaks: &[Peak],
) -> Result<Vec<Part>> {
    let walked = peaks.iter().take(WALKED);
    let walks: Vec<Walk<'_>> = walked.flat_map(Walk::all).collect();
    let met = walks
        .into_par_iter()
        .map(|walk| walk.go(posterior))
        .collect::<Result<Vec<_>>>()?;
    Ok(met.concat())
}

/// A way from a peak, along one coordinate.
struct Walk<'a> {
    peak: &'a Peak,
    along: usize,
    /// The peak's width along it.
    width: f64,
    /// The first stride: the others follow as they do in the approximation.
    stride: DVector<f64>,
}

impl<'a> Walk<'a> {
    /// Those along every coordinate, up and down.
    fn all(peak: &'a Peak) -> Vec<Self> {
        let Some(factor) = peak.precision.clone().cholesky() else {
            return Vec::new();
        };
        let covariance = factor.inverse();
        let ways = (0..peak.line.len()).flat_map(|i| [(i, 1.0), (i, -1.0)]);
        ways.map(|(along, sign)| {
            let width = covariance[(along, along)].sqrt();
            let stride = covariance.column(along) * (sign * STRIDE / width);
            Self { peak, along, width, stride }
        })
        .collect()
    }

    /// Walks as far as the profile stays high, each stride begun in the
    /// direction of the last.
    fn go(self, posterior: &Posterior<'_>) -> Result<Vec<Part>> {
        let held = [self.along];
        let apart = [STRIDE * self.width];
        let (mut at, mut stride) = (self.peak.line.clone(), self.stride);
        let mut parts = Vec::new();
        for count in 1..=STRIDES {
            let start = &at + &stride;
            let found = climb_holding(posterior, start.as_slice(), &held)?;
            let Some(found) =
                found.filter(|f| f.height > self.peak.height - DOWN)
            else {
                break;
            };
            let widths = count as f64 * STRIDE;
            let normal = self.peak.height - 0.5 * widths * widths;
            if found.height > normal + ABOVE {
                parts.extend(Part::of_place(&found, &held, &apart));
            }
            stride = &found.line - &at;
            at = found.line;
        }
        Ok(parts)
    }
}
