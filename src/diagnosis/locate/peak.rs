//! The peak of the density of a model's own parameters under one process, the
//! force integrated.

use nalgebra::DVector;

use super::process::Process;
use super::tangent::{Basis, Cells, Tangent, Waves};
use crate::error::Result;
use crate::infer::{self, Climb, Landscape, Slope};

/// How wide what is drawn about a place of the fine grid lies.
pub(super) const SPACING: f64 = 0.6;
/// A climb of the own parameters.
const CLIMB: Climb =
    Climb { steps: 10, longest: 1.0, arrived: 0.02, leaps: 0 };
/// The most tangents at given own parameters, and what a further one has to
/// promise, in ln.
const TANGENTS: usize = 4;
const NEARBY: f64 = 0.5;
/// How many times as much as the last tangent gained those after it may gain:
/// of 6900 places that counted, 24 gained more.
const FURTHER: f64 = 2.0;

/// By how much, in ln, a peak counts for more than where its last tangent was
/// made. Tangents end where the best waves by one gain half a unit; but where a
/// force stops the mass one may promise anything.
const FURTHEST: f64 = 2.0;

/// A peak of the density of a model's own parameters at one process.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Peak {
    pub(super) process: Process,
    /// The own parameters, with ln of the density's height, the process's prior
    /// included.
    pub(super) top: infer::Peak,
    /// ln of about what it integrates to.
    pub(super) log_evidence: f64,
    /// The model there, along the process's waves, and the force that the
    /// tangent was made at.
    pub(super) tangent: Tangent,
    pub(super) force: DVector<f64>,
}

impl Peak {
    /// The one that a tangent along the process's waves leads to; `None` where
    /// the start has no density, or the peak no width.
    pub(super) fn climbed(
        ridge: &Ridge<'_, '_>,
        from: &Tangent,
    ) -> Result<Option<Self>> {
        let own = from.own.clone();
        let Some((slope, tangent)) = ridge.slope(&own, from)? else {
            return Ok(None);
        };
        let found =
            CLIMB.ascend(ridge, (own, slope, tangent), |_, _| false)?;
        let Some((own, slope, tangent)) = found else { return Ok(None) };
        Ok(Self::of(ridge, own, slope, tangent))
    }

    /// The one that a climb came to; `None` where it has no width.
    fn of(
        ridge: &Ridge<'_, '_>,
        own: DVector<f64>,
        slope: Slope,
        tangent: Tangent,
    ) -> Option<Self> {
        let Slope { height: promised, precision, .. } = slope;
        let process = ridge.process;
        let waves = tangent.waves(&own)?;
        let sure = tangent.height_of(&tangent.at, &waves.precision);
        let height = promised.min(sure + FURTHEST) + process.log_prior();
        let top = infer::Peak { line: own, height, precision };
        let log_evidence = top.log_evidence()?;
        let force = &ridge.basis.factor * &tangent.at;
        Some(Self { process, top, log_evidence, tangent, force })
    }

    /// About how unlikely a place is to be under this peak.
    pub(super) fn distance(
        &self,
        process: &Process,
        own: &DVector<f64>,
    ) -> f64 {
        self.process.distance(process) / SPACING.powi(2)
            + self.top.distance(own)
    }
}

/// The density of the own parameters under one process, the force integrated.
pub(super) struct Ridge<'a, 'm> {
    pub(super) cells: Cells<'a, 'm>,
    pub(super) process: Process,
    /// What makes the process's force of its waves.
    pub(super) basis: Basis,
    /// ln of a density below which nothing counts.
    pub(super) least: f64,
}

impl Ridge<'_, '_> {
    /// A tangent at the waves that are about best at some own parameters, from
    /// one nearby, and the best waves by it; `None` where there is no density.
    ///
    /// Climbs make a tangent at each step, and draws about the best are weighed,
    /// so it is made anew only where the force is far off: else draws in the
    /// tails would count for too little. Where a further one cannot lead to
    /// what counts it is not made either.
    pub(super) fn best(
        &self,
        own: &DVector<f64>,
        from: &Tangent,
    ) -> Result<Option<(Tangent, Waves)>> {
        let Some(Waves { mut mean, .. }) = from.waves(own) else {
            return Ok(None);
        };
        let mut found: Option<(Tangent, Waves)> = None;
        for _ in 0..TANGENTS {
            let tangent =
                self.cells.tangent(&self.basis, &mean, own.clone())?;
            let Some(tangent) = tangent else { break };
            let Some(next) = tangent.waves(own) else { break };
            let gain = next.gain_from(&mean);
            let most = || tangent.height(&next) + FURTHER * gain;
            let ends = gain < NEARBY || most() < self.least;
            mean.copy_from(&next.mean);
            found = Some((tangent, next));
            if ends {
                break;
            }
        }
        Ok(found)
    }
}

impl Landscape for Ridge<'_, '_> {
    type Trace = Tangent;

    fn held(&self) -> &[usize] {
        &[]
    }

    fn slope(
        &self,
        at: &DVector<f64>,
        from: &Tangent,
    ) -> Result<Option<(Slope, Tangent)>> {
        Ok(self
            .best(at, from)?
            .map(|(tangent, waves)| (tangent.marginal(&waves), tangent)))
    }
}
