//! A calibration averaged over noises.

use std::f64::consts::LN_10;

use super::mix::mixed;
use crate::calibrate::{
    Calibration, calibrate, calibrate_from, curve, of_summary,
};
use crate::diagnosis::{Fit, Noises, Noisy};
use crate::draws::{log_sum_exp, summarise};
use crate::error::{Error, Result};
use crate::infer::{Backend, Progress};
use crate::model::{Assembled, Program};
use crate::report::{
    CalibrationReport, EvidenceReport, NoiseReport, ParameterReport,
};
use crate::seed::Seed;

/// The probability below which a noise is not worth a calibration.
const LEAST: f64 = 1e-3;

/// A model calibrated under one noise.
pub(super) struct Under<'a> {
    named: &'a Assembled,
    /// The model with another noise than the one that it names.
    other: Option<Assembled>,
    /// Its fit as a diagnosis makes it, where that is known.
    pub(super) none: Option<Fit>,
    /// ln of its probability beforehand, among all noises that were kept.
    pub(super) beforehand: f64,
    /// Its probability among those that were calibrated.
    pub(super) probability: f64,
    found: Calibration,
    /// What the evidence says of all noises that were kept.
    all: Vec<NoiseReport>,
}

impl Under<'_> {
    pub(super) fn program(&self) -> &Assembled {
        self.other.as_ref().unwrap_or(self.named)
    }
}

/// Under the noise that the model names.
pub(super) fn under_one<'a>(
    named: &'a Assembled,
    backend: &dyn Backend,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Under<'a>> {
    let found = calibrate(named, backend, seed, progress)?;
    let (other, none, all) = (None, None, Vec::new());
    let (beforehand, probability) = (0.0, 1.0);
    Ok(Under { named, other, none, beforehand, probability, found, all })
}

/// A noise that was kept, with what a calibration under it found.
struct Kept<'n> {
    noisy: &'n Noisy<'n>,
    other: Option<Assembled>,
    found: Option<Calibration>,
}

impl<'n> Kept<'n> {
    fn of(noisy: &'n Noisy<'n>, named: &Assembled) -> Result<Self> {
        let other = match noisy.is_named() {
            true => None,
            false => named.with_noise(&noisy.name)?,
        };
        Ok(Self { noisy, other, found: None })
    }

    /// ln of the evidence: that of the calibration, which has more draws, where
    /// there is one.
    fn log(&self) -> f64 {
        let evidence = self.found.as_ref().map(|found| &found.report.evidence);
        match evidence {
            Some(Some(evidence)) => evidence.value,
            _ => self.noisy.none.log_evidence,
        }
    }

    /// ln of its probability, up to a constant.
    fn worth(&self) -> f64 {
        self.log() + self.noisy.beforehand()
    }
}

/// Under each noise that is kept and may matter, most probable first.
///
/// # Errors
/// As [`calibrate`].
pub(super) fn under_each<'a>(
    named: &'a Assembled,
    noises: &Noises<'_>,
    backend: &dyn Backend,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Vec<Under<'a>>> {
    let kept = noises.kept.iter().map(|noisy| Kept::of(noisy, named));
    let mut kept = kept.collect::<Result<Vec<_>>>()?;
    let most = kept.iter().map(Kept::worth).fold(f64::NEG_INFINITY, f64::max);
    for one in &mut kept {
        if one.worth() > most + LEAST.ln() {
            let program = one.other.as_ref().unwrap_or(named);
            // One of its own for each: errors from one seed are alike.
            let own = Seed::new(seed).called(&one.noisy.name);
            let found = calibrate_from(program, backend, own, progress)?;
            one.found = Some(found.with_seed(seed));
        }
    }
    kept.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
    let all = judged(&kept, noises.dropped.as_ref());
    let calibrated = kept.iter().filter(|one| one.found.is_some());
    let total = log_sum_exp(calibrated.map(Kept::worth));
    let known = kept.iter().map(|one| one.noisy.beforehand());
    let known = log_sum_exp(known);
    let under = kept.into_iter().filter_map(|one| {
        let probability = (one.worth() - total).exp();
        Some(Under {
            named,
            other: one.other,
            none: Some(one.noisy.none.clone()),
            beforehand: one.noisy.beforehand() - known,
            probability,
            found: one.found?,
            all: all.clone(),
        })
    });
    Ok(under.collect())
}

/// What the evidence says of the noises that are kept.
fn judged(kept: &[Kept<'_>], dropped: Option<&Noisy<'_>>) -> Vec<NoiseReport> {
    let total = log_sum_exp(kept.iter().map(Kept::worth));
    let named = kept.iter().find(|one| one.noisy.is_named()).map(Kept::log);
    let named = named.or(dropped.map(|noisy| noisy.none.log_evidence));
    let judged = |one: &Kept<'_>| {
        let (name, log) = (&one.noisy.name, one.log());
        NoiseReport {
            name: name.clone(),
            probability: (one.worth() - total).exp(),
            log10_bayes_factor: (log - named.unwrap_or(f64::NAN)) / LN_10,
            parameters: Vec::new(),
        }
    };
    kept.iter().map(judged).collect()
}

/// The calibration under the likeliest noise, with the parameters of the
/// motion averaged over all; as it is where no noise was to be inferred.
pub(super) fn averaged(
    model: &Assembled,
    mut under: Vec<Under<'_>>,
    infers_noise: bool,
) -> Result<Calibration> {
    if !infers_noise {
        let one = under.pop().ok_or_else(no_noise)?;
        return Ok(one.found);
    }
    let names = motion(model);
    let parts: Vec<_> =
        under.iter().map(|one| (one.probability, &one.found.draws)).collect();
    let likeliest = &under.first().ok_or_else(no_noise)?.found;
    let draws = match names.is_empty() {
        true => likeliest.draws.clone(),
        false => mixed(&parts, &names)?,
    };
    let mut report = likeliest.report.clone();
    for (i, summary) in summarise(&draws).iter().enumerate().take(names.len())
    {
        let all = &mut report.parameters;
        let own = all.iter_mut().find(|p| p.name == summary.name);
        if let (Some(own), Some((_, prior))) = (own, model.priors().nth(i)) {
            let density = curve(prior, &draws, i);
            replace(own, worth(of_summary(summary), &under), density);
        }
    }
    tell(&mut report, &under);
    Ok(Calibration { report, draws })
}

/// The names of the parameters of the motion, which all noises have.
fn motion(model: &Assembled) -> Vec<String> {
    let all = model.priors().enumerate();
    let motion = all.filter(|(i, _)| model.is_of_motion(*i));
    motion.map(|(_, (name, _))| name.to_owned()).collect()
}

/// Puts other figures in a parameter's place; its mode, its prior and the
/// draws to be shown stay.
fn replace(
    own: &mut ParameterReport,
    figures: ParameterReport,
    posterior_density: Vec<(f64, f64)>,
) {
    *own = ParameterReport {
        of_errors: own.of_errors,
        map: own.map,
        prior_text: std::mem::take(&mut own.prior_text),
        prior_density: std::mem::take(&mut own.prior_density),
        chains: std::mem::take(&mut own.chains),
        pooled: std::mem::take(&mut own.pooled),
        posterior_density,
        ..figures
    };
}

fn no_noise() -> Error {
    Error::inference("the model was calibrated under no noise")
}

/// How good the draws of a parameter are, from those under each noise: the
/// variance of a mean of means adds up by the squares of their shares.
fn worth(mut p: ParameterReport, under: &[Under<'_>]) -> ParameterReport {
    let each = || {
        under.iter().filter_map(|one| {
            let all = &one.found.report.parameters;
            let own = all.iter().find(|own| own.name == p.name)?;
            Some((one.probability, own))
        })
    };
    let summed = |of: fn(&ParameterReport) -> f64| -> f64 {
        each().map(|(share, own)| share.powi(2) * of(own)).sum()
    };
    let bulk = summed(|own| 1.0 / own.ess_bulk);
    let tail = summed(|own| 1.0 / own.ess_tail);
    let error = summed(|own| own.mcse_mean.powi(2));
    let rhat = each().map(|(_, own)| own.rhat).fold(f64::NAN, f64::max);
    (p.ess_bulk, p.ess_tail) = (1.0 / bulk, 1.0 / tail);
    (p.mcse_mean, p.rhat) = (error.sqrt(), rhat);
    p
}

/// What was found under all noises, beside what is of the likeliest.
fn tell(report: &mut CalibrationReport, under: &[Under<'_>]) {
    let reports = || under.iter().map(|one| &one.found.report);
    report.simulations = reports().map(|r| r.simulations).sum();
    report.seconds = reports().map(|r| r.seconds).sum();
    let told = |of: fn(&CalibrationReport) -> &Vec<String>| -> Vec<String> {
        let each = reports().flat_map(|r| {
            of(r).iter().map(|w| format!("under {} errors, {w}", r.noise))
        });
        each.collect()
    };
    report.warnings = told(|r| &r.warnings);
    report.doubts = told(|r| &r.doubts);
    report.evidence = evidence(under);
    report.noises =
        under.first().map(|one| one.all.clone()).unwrap_or_default();
    for one in reports() {
        let of_errors = one.parameters.iter().filter(|p| p.of_errors);
        let own = report.noises.iter_mut().find(|n| n.name == one.noise);
        if let Some(own) = own {
            own.parameters = of_errors.map(bare).collect();
        }
    }
}

/// A parameter's figures alone.
fn bare(p: &ParameterReport) -> ParameterReport {
    ParameterReport {
        prior_density: Vec::new(),
        posterior_density: Vec::new(),
        chains: Vec::new(),
        pooled: Vec::new(),
        ..p.clone()
    }
}

/// The evidence averaged over all noises that were kept, as each is probable
/// beforehand; what was not calibrated adds less than its error.
fn evidence(under: &[Under<'_>]) -> Option<EvidenceReport> {
    let each: Vec<(&Under<'_>, &EvidenceReport)> = under
        .iter()
        .map(|one| Some((one, one.found.report.evidence.as_ref()?)))
        .collect::<Option<_>>()?;
    let logs = each.iter().map(|(one, e)| one.beforehand + e.value);
    let square = each.iter().map(|(one, e)| (one.probability * e.se).powi(2));
    Some(EvidenceReport {
        value: log_sum_exp(logs),
        se: square.sum::<f64>().sqrt(),
        method: format!("{}, averaged over noises", each.first()?.1.method),
    })
}
