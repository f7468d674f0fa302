//! Profiles along coordinates: where a posterior is not as its peak looks.
//!
//! A normal approximation knows a peak's curvature and no more. A tail may be
//! bent, one-sided, or flat beyond some place: a patch's friction can vanish,
//! but not fall below zero. Such a tail can hold as much as the peak, and no
//! draw of the approximation gets there; importance weights do not tell of
//! places without draws. Profiles do: strides along each coordinate, with all
//! others at their best, show where the posterior lies above the
//! approximation, and each such place becomes a component (profiles as a check
//! of normality: Bates and Watts 1988, chapter 6).

use nalgebra::DVector;

use super::climb::{Held, Peak, climb_holding};
use super::proposal::Component;
use crate::error::Result;
use crate::model::Posterior;
use crate::parallel;

/// A stride, in widths of the peak.
const STRIDE: f64 = 1.3;
/// How far down a profile goes, in ln.
const DOWN: f64 = 6.5;
/// The most strides, and the most steps of a climb after each.
const STRIDES: usize = 9;
const FEW: usize = 2;
/// How far above the normal approximation, in ln, a place becomes a
/// component.
const ABOVE: f64 = 0.4;
/// How far above the highest peak, in ln, a place belongs to another peak.
const HIGHER: f64 = 0.3;

/// What profiles meet.
#[derive(Default)]
pub(super) struct Met {
    /// Where the posterior lies above the normal approximation.
    pub(super) components: Vec<Component>,
    /// The highest place, where it is above the peak.
    pub(super) higher: Option<Peak>,
}

/// What profiles from some peaks meet, both ways along some coordinates;
/// `best` is the height of the highest peak.
///
/// # Errors
/// What no other parameter values would mend.
pub(super) fn profiles<'p>(
    posterior: &Posterior<'_>,
    peaks: impl Iterator<Item = &'p Peak>,
    best: f64,
    along: impl Fn(usize) -> bool,
) -> Result<Met> {
    let all = peaks.flat_map(Profile::all);
    let all = all.filter(|profile| along(profile.along));
    let met = parallel::try_map(all, |profile| profile.walked(posterior))?;
    let mut all = Met::default();
    for one in met {
        all.components.extend(one.components);
        let other = one.higher.filter(|peak| peak.height > best + HIGHER);
        let highest = all.higher.as_ref().map_or(best, |peak| peak.height);
        all.higher = other.filter(|p| p.height > highest).or(all.higher);
    }
    Ok(all)
}

/// One side of a profile.
struct Profile<'a> {
    peak: &'a Peak,
    along: usize,
    /// The peak's width along it.
    width: f64,
    /// The first stride: other coordinates go along as in the approximation.
    stride: DVector<f64>,
}

impl<'a> Profile<'a> {
    /// The profiles along every coordinate, up and down.
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

    /// Strides along the profile for as long as it stays high, each begun in
    /// the direction of the last.
    fn walked(self, posterior: &Posterior<'_>) -> Result<Met> {
        let held = [self.along];
        let spacing = [STRIDE * self.width];
        let (mut at, mut stride) = (self.peak.line.clone(), self.stride);
        let mut met = Met::default();
        for count in 1..=STRIDES {
            let start = &at + &stride;
            let landscape = Held::new(posterior, &held);
            let found = climb_holding(&landscape, start.as_slice(), FEW)?;
            let high = |f: &Peak| f.height > self.peak.height - DOWN;
            let Some(found) = found.filter(high) else { break };
            let widths = count as f64 * STRIDE;
            let normal = self.peak.height - 0.5 * widths * widths;
            if found.height > normal + ABOVE {
                let component = Component::of_place(&found, &held, &spacing);
                met.components.extend(component);
            }
            stride = &found.line - &at;
            at.copy_from(&found.line);
            let highest = met.higher.as_ref().map_or(f64::MIN, |p| p.height);
            if found.height > highest {
                met.higher = Some(found);
            }
        }
        Ok(met)
    }
}
