//! A model with mechanisms, fitted: evidence, draws, and the best place.

use rand::RngExt;

use crate::diagnosis::evidence::apart;
use crate::diagnosis::evidence::edges::on_line;
use crate::draws::Draws;
use crate::error::{Error, Result};
use crate::infer::{
    Frozen, Inference, LaplaceMixture, Peak, Peaks, Precision, Quiet, climb,
};
use crate::mechanism::{Mechanism, Unknown};
use crate::model::{AnyProgram, ByEvent, Point, Posterior, Program};
use crate::prior::AnyPrior;
use crate::seed::Seed;

/// What a fit found.
#[derive(Debug, Clone)]
pub struct Fit {
    /// ln p(recording | model).
    pub log_evidence: f64,
    /// Its standard error.
    pub se: f64,
    /// Posterior draws as named, the mechanisms' parameters first.
    pub draws: Draws,
    /// The peak that the likeliest draw leads to, on the real line.
    pub best: Vec<f64>,
    /// How many parameters the mechanisms have.
    pub added: usize,
    /// What to know before trusting it.
    pub warnings: Vec<String>,
}

impl Fit {
    /// Where the mechanisms' parameters are at the best place.
    pub fn mechanism(&self) -> &[f64] {
        &self.best[..self.added]
    }

    /// Where the model's own parameters are at the best place.
    pub fn own(&self) -> &[f64] {
        &self.best[self.added..]
    }
}

/// What a search found of a program with mechanisms, before it is estimated.
#[derive(Debug, Clone)]
pub(crate) struct Prospect<'a> {
    program: &'a dyn AnyProgram,
    mechanisms: Vec<&'a dyn Mechanism>,
    backend: LaplaceMixture,
    searched: Searched,
    log: f64,
    /// How many parameters the mechanisms have.
    added: usize,
}

/// What a search leaves for an estimate to begin from.
#[derive(Debug, Clone)]
enum Searched {
    /// Of one event, a proposal for all coordinates.
    Proposal(Frozen),
    /// Of several, each of which gets a proposal of its own, the highest peak
    /// on the real line, if there is any.
    Highest(Option<Vec<f64>>),
    /// The same after a rough estimate.
    Estimated(Box<Fit>),
}

impl Searched {
    /// The highest place that is known of several events, on the real line.
    fn highest(&self) -> Option<&[f64]> {
        match self {
            Self::Proposal(_) => None,
            Self::Highest(highest) => highest.as_deref(),
            Self::Estimated(fit) => Some(&fit.best),
        }
    }
}

impl<'a> Prospect<'a> {
    /// About ln of the evidence.
    pub(crate) fn log(&self) -> f64 {
        self.log
    }

    /// The highest peak that climbs from the heaviest components reach, on the
    /// real line: the mechanisms' parameters, and the model's own; `None` of
    /// several events.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn peak(&self) -> Result<Option<(Vec<f64>, Vec<f64>)>> {
        let Searched::Proposal(frozen) = &self.searched else {
            return Ok(None);
        };
        let with = self.by_event()?;
        let posterior = Posterior::new(&with)?;
        let mut highest: Option<Peak> = None;
        for start in frozen.mixture.middles().into_iter().take(MIDDLES) {
            let Some(peak) = climb(&posterior, start)? else { continue };
            if highest.as_ref().is_none_or(|h| peak.height > h.height) {
                highest = Some(peak);
            }
        }
        Ok(highest.map(|peak| {
            let (added, own) = peak.line.as_slice().split_at(self.added);
            (added.to_vec(), own.to_vec())
        }))
    }

    /// Whether what it holds may be above a threshold, in ln.
    pub(crate) fn may_reach(&self, threshold: f64) -> bool {
        self.most() > threshold
    }

    /// The most, in ln, that it may hold.
    pub(crate) fn most(&self) -> f64 {
        let unseen = match &self.searched {
            Searched::Proposal(frozen) if frozen.good => SETTLED,
            Searched::Proposal(frozen) if frozen.round > FEW_ROUNDS => OPEN,
            Searched::Proposal(_) => UNSEEN,
            Searched::Highest(_) => SEVERAL,
            Searched::Estimated(fit) if fit.warnings.is_empty() => SETTLED,
            Searched::Estimated(_) => OPEN,
        };
        self.log + unseen
    }

    /// The same with a search of another kind in its estimate; `None` where the
    /// estimate does not search by itself, as that of several events does.
    pub(crate) fn searching(&self, backend: &LaplaceMixture) -> Option<Self> {
        let backend = backend.clone();
        match self.searched {
            Searched::Proposal(_) => None,
            Searched::Highest(_) | Searched::Estimated(_) => {
                Some(Self { backend, ..self.clone() })
            }
        }
    }

    /// After learning more, as long as it may reach a threshold: of several
    /// events after a rough estimate, since their peaks tell little.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn pursued(self, threshold: f64, seed: Seed) -> Result<Self> {
        match &self.searched {
            Searched::Proposal(_) => self.learned(threshold, seed),
            Searched::Highest(_) if self.may_reach(threshold) => {
                let fit = self.fit(Precision::Rough, seed)?;
                let log = fit.log_evidence;
                let searched = Searched::Estimated(Box::new(fit));
                Ok(Self { searched, log, ..self })
            }
            Searched::Highest(_) | Searched::Estimated(_) => Ok(self),
        }
    }

    /// Of one event, after its proposal learned more, as long as it may reach
    /// a threshold.
    fn learned(mut self, threshold: f64, seed: Seed) -> Result<Self> {
        let mechanisms = self.mechanisms.clone();
        let with = ByEvent::new(self.program, &mechanisms)?;
        let posterior = Posterior::new(&with)?;
        let most = self.backend.schedule.rounds;
        for rounds in [FEW_ROUNDS + 2, most] {
            let Searched::Proposal(frozen) = &self.searched else { break };
            if frozen.good || !self.may_reach(threshold) {
                break;
            }
            let (schedule, seed) =
                (&self.backend.schedule, seed.child(rounds));
            let frozen = frozen.clone();
            let next = frozen.learned(&posterior, schedule, rounds, seed)?;
            self.log = next.log;
            self.searched = Searched::Proposal(next);
        }
        Ok(self)
    }

    /// Together with what another search of the same posterior found, where
    /// that is more.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn joined(mut self, other: Self, seed: Seed) -> Result<Self> {
        let both = (&self.searched, other.searched);
        let (Searched::Proposal(first), Searched::Proposal(second)) = both
        else {
            return Ok(self);
        };
        if other.log > self.log {
            let with = self.by_event()?;
            let posterior = Posterior::new(&with)?;
            let schedule = &self.backend.schedule;
            let both = second.beside(first);
            let both = both.learned(&posterior, schedule, FEW_ROUNDS, seed)?;
            self.log = both.log;
            self.searched = Searched::Proposal(both);
        }
        Ok(self)
    }

    /// The fit, as sharp as asked.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn fit(&self, precision: Precision, seed: Seed) -> Result<Fit> {
        if let Searched::Estimated(fit) = &self.searched
            && precision == Precision::Rough
        {
            return Ok(fit.as_ref().clone());
        }
        let with = self.by_event()?;
        let posterior = Posterior::new(&with)?;
        let backend = &self.backend;
        let found = match &self.searched {
            Searched::Proposal(frozen) => {
                backend.estimate(&posterior, frozen, precision, seed, &Quiet)
            }
            Searched::Highest(_) | Searched::Estimated(_) => {
                apart::estimate(&with, &posterior, backend, precision, seed)
            }
        };
        let mut fit = fit_of(&posterior, found?, with.added())?;
        if let Some(highest) = self.searched.highest() {
            fit.best = higher(&posterior, fit.best, highest)?;
        }
        Ok(fit)
    }

    /// About where it is best, on the real line.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn best(&self, seed: Seed) -> Result<Vec<f64>> {
        match self.searched.highest() {
            Some(highest) => Ok(highest.to_vec()),
            None => Ok(self.fit(Precision::Rough, seed)?.best),
        }
    }

    fn by_event(&self) -> Result<ByEvent<'_>> {
        ByEvent::new(self.program, &self.mechanisms)
    }
}

/// How much more, in ln, a proposal may come to hold: one that has learned
/// little, one that has poor weights yet, and a good one. A rough estimate of
/// several events counts as one of the latter two.
const UNSEEN: f64 = 4.0;
const OPEN: f64 = 3.0;
const SETTLED: f64 = 1.0;
/// How much more the peaks of several events may: of 58 fits of five avalanches
/// together 53 held up to 8 more than their peaks said, two 18 and 19 more.
const SEVERAL: f64 = 10.0;

/// How much more, in ln, than its peaks say a program may hold.
pub(super) fn unseen(program: &dyn AnyProgram) -> f64 {
    if program.events() > 1 { SEVERAL } else { UNSEEN }
}

/// From the middles of how many components a peak is sought: a climb from one
/// may end where the density bends.
const MIDDLES: usize = 5;

/// For how many rounds one learns that is only looked at.
const FEW_ROUNDS: u64 = 2;

/// Searches a program with mechanisms, and looks at what is there.
///
/// # Errors
/// An improper prior, or a model that fails.
pub(crate) fn prospect<'a>(
    program: &'a dyn AnyProgram,
    mechanisms: &[&'a dyn Mechanism],
    backend: LaplaceMixture,
    seed: Seed,
) -> Result<Prospect<'a>> {
    let of = |log, searched, added, backend| {
        let mechanisms = mechanisms.to_vec();
        Prospect { program, mechanisms, backend, searched, log, added }
    };
    let with = ByEvent::new(program, mechanisms)?;
    let posterior = Posterior::new(&with)?;
    let added = with.added();
    if program.events() > 1 {
        let Peaks { log, highest } = backend.outlook(&posterior, seed)?;
        let highest = highest.map(|peak| peak.line.as_slice().to_vec());
        let searched = Searched::Highest(highest);
        return Ok(of(log, searched, added, backend));
    }
    let frozen = backend.searched(&posterior, seed.child(0))?;
    let (schedule, seed) = (&backend.schedule, seed.child(1));
    let frozen = frozen.learned(&posterior, schedule, FEW_ROUNDS, seed)?;
    let log = frozen.log;
    Ok(of(log, Searched::Proposal(frozen), added, backend))
}

/// Fits a program with mechanisms, looking for modes as told.
///
/// # Errors
/// An improper prior, or a model that fails.
pub fn fit(
    program: &dyn AnyProgram,
    mechanisms: &[&dyn Mechanism],
    backend: &LaplaceMixture,
    seed: Seed,
) -> Result<Fit> {
    let with = ByEvent::new(program, mechanisms)?;
    let posterior = Posterior::new(&with)?;
    let found =
        apart::estimate(&with, &posterior, backend, Precision::Sharp, seed)?;
    fit_of(&posterior, found, with.added())
}

/// A fit from what an inference found.
fn fit_of(
    posterior: &Posterior<'_>,
    found: Inference,
    added: usize,
) -> Result<Fit> {
    let (Some(draws), Some(evidence)) = (found.draws, found.evidence) else {
        return Err(Error::inference("a fit without draws or evidence"));
    };
    Ok(Fit {
        log_evidence: evidence.log,
        se: evidence.se,
        best: peak(posterior, &draws)?,
        draws,
        added,
        warnings: found.warnings,
    })
}

/// Where a climb from the likeliest draw leads, on the real line: searches that
/// begin there must not hang on which draws were made.
fn peak(posterior: &Posterior<'_>, draws: &Draws) -> Result<Vec<f64>> {
    let likeliest = likeliest(posterior, draws)?;
    let peak = climb(posterior, &likeliest)?;
    Ok(peak.map_or(likeliest, |peak| peak.line.as_slice().to_vec()))
}

/// The higher of two places on the real line.
fn higher(
    posterior: &Posterior<'_>,
    first: Vec<f64>,
    second: &[f64],
) -> Result<Vec<f64>> {
    let height = |z: &[f64]| {
        let density = posterior.density(Point::Line(z))?;
        Ok::<_, Error>(density.on_line())
    };
    let is_second = height(second)? > height(&first)?;
    Ok(if is_second { second.to_vec() } else { first })
}

/// The draw with the highest density, on the real line.
pub(crate) fn likeliest(
    posterior: &Posterior<'_>,
    draws: &Draws,
) -> Result<Vec<f64>> {
    let mut best = (f64::NEG_INFINITY, Vec::new());
    for row in draws.thinned(400) {
        let density = posterior.density(Point::Natural(row))?.natural();
        if best.1.is_empty() || density > best.0 {
            best = (density, row.to_vec());
        }
    }
    posterior.line(&best.1)
}

/// Even places in the prior of some unknowns, on the real line, with how far
/// the next ones lie: Halton's points, shifted at random.
pub(crate) fn spread(
    unknowns: &[Unknown],
    count: usize,
    seed: Seed,
) -> Vec<(Vec<f64>, Vec<f64>)> {
    let mut rng = seed.rng();
    let shifts: Vec<f64> = unknowns.iter().map(|_| rng.random()).collect();
    let step = (count as f64).powf(-1.0 / unknowns.len() as f64);
    (1..=count as u64)
        .map(|i| {
            unknowns
                .iter()
                .zip(PRIMES.into_iter().cycle())
                .zip(&shifts)
                .map(|((unknown, base), shift)| {
                    let p = (radical_inverse(i, base) + shift).fract();
                    place(&unknown.prior, p, step)
                })
                .unzip()
        })
        .collect()
}

/// The place on the line of a prior's quantile, and how far it is to those
/// half a step away.
///
/// Steps are even in the angle whose sin^2 is the probability: places lie
/// denser at the ends of a prior, where a short stretch, or one at the very
/// start of the run, has a mode of its own.
fn place(prior: &AnyPrior, p: f64, step: f64) -> (f64, f64) {
    let at = |p: f64| {
        on_line(prior, (p * std::f64::consts::FRAC_PI_2).sin().powi(2))
    };
    let edge = 0.25 * step;
    let middle = p.clamp(edge, 1.0 - edge);
    let below = at((middle - 0.5 * step).max(0.5 * edge));
    let above = at((middle + 0.5 * step).min(1.0 - 0.5 * edge));
    (at(middle), 0.6 * (above - below))
}

const PRIMES: [u64; 20] = [
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71,
];

/// The digits of `i` in a base, mirrored at the point (Halton 1960).
fn radical_inverse(mut i: u64, base: u64) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0 / base as f64);
    while i > 0 {
        value += (i % base) as f64 * digit;
        i /= base;
        digit /= base as f64;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::fixture::{Hills, proposal_for_hill};

    /// ln of the evidence of the hills between two places, by the midpoint
    /// rule.
    fn between(low: f64, high: f64) -> f64 {
        let normal = |x: f64, mean: f64, sd: f64| {
            let z = (x - mean) / sd;
            (-0.5 * z * z).exp() / (sd * std::f64::consts::TAU.sqrt())
        };
        let step = (high - low) / 4000.0;
        let places = (0..4000).map(|i| low + (f64::from(i) + 0.5) * step);
        let density = |x| normal(x, 1.0, 0.8) * normal(1.0, x * x, 0.45);
        (places.map(density).sum::<f64>() * step).ln()
    }

    #[test]
    fn two_searches_together_hold_what_either_found() {
        let near = |x: f64, log: f64| {
            let searched = Searched::Proposal(proposal_for_hill(x));
            let (backend, mechanisms) = (LaplaceMixture::default(), vec![]);
            let program = &Hills;
            Prospect { program, mechanisms, backend, searched, log, added: 0 }
        };
        let low = near(-1.0, between(-3.0, 0.0));
        let high = near(1.0, between(0.0, 4.0));
        fn joined<'a>(a: &Prospect<'a>, b: &Prospect<'a>) -> Prospect<'a> {
            a.clone().joined(b.clone(), Seed::new(3)).unwrap()
        }
        let at = |one: &Prospect<'_>, x: f64| {
            let Searched::Proposal(frozen) = &one.searched else {
                unreachable!()
            };
            frozen.mixture.log_density(&[x, 0.0])
        };
        let both = joined(&low, &high);
        // 600 draws with an effective share above a third.
        let error = 4.0 / 200.0_f64.sqrt();
        let exact = between(-3.0, 4.0);
        assert!((both.log() - exact).abs() < error, "{}", both.log());
        // Half of the weight at first, of which a round leaves half at least.
        for (one, x) in [(&low, -1.0), (&high, 1.0)] {
            assert!(at(&both, x) > at(one, x) + 0.125_f64.ln(), "{x}");
        }
        assert!(at(&high, -1.0) < at(&low, -1.0) + 0.125_f64.ln());
        // What found less adds nothing.
        let less = joined(&high, &low);
        assert_eq!(
            (less.log(), at(&less, -1.0)),
            (high.log(), at(&high, -1.0))
        );
    }
}
