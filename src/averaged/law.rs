//! The law's parameters with a force of free form in the model: what can be
//! said of them when the rest of the physics is left open.

use std::f64::consts::LN_10;

use super::mix::mixed;
use super::noises::Under;
use crate::calibrate::of_summary;
use crate::diagnosis::{FreeForce, left_open, locate_all, no_density};
use crate::draws::{Draws, log_sum_exp, summarise};
use crate::error::{Error, Result};
use crate::infer::Progress;
use crate::model::Assembled;
use crate::physics::forces::Axis;
use crate::report::{CalibrationReport, LawReport, ParameterReport};
use crate::seed::Seed;

/// What a force of free form says.
pub(super) struct Forced {
    parameters: Vec<ParameterReport>,
    /// ln of its Bayes factor.
    gain: f64,
    differs: bool,
}

impl Forced {
    /// The same beside what a calibration without it says.
    pub(super) fn beside(
        self,
        model: &Assembled,
        report: &CalibrationReport,
    ) -> LawReport {
        let names = model.law_names();
        let was = report.parameters.iter();
        let was = was.filter(|p| names.contains(&p.name));
        LawReport {
            as_it_was: was.cloned().collect(),
            with_free_form_force: self.parameters,
            log10_bayes_factor: self.gain / LN_10,
            differs: self.differs,
        }
    }
}

/// A force of free form under one noise.
struct Located {
    draws: Draws,
    /// ln of the evidence with it, and without, times the noise's probability
    /// beforehand.
    logs: [f64; 2],
    differs: bool,
}

/// Leaves the rest of the physics open, under each noise; with the force in
/// the model the noises have probabilities of their own.
///
/// # Errors
/// A model that fails.
pub(super) fn forced(
    model: &Assembled,
    under: &[Under<'_>],
    seed: Seed,
    progress: &dyn Progress,
) -> Result<Forced> {
    progress.begin("leaving the rest of the physics open", None);
    let found: Vec<Located> = under
        .iter()
        .enumerate()
        .map(|(i, one)| located(one, seed.child(1 + i as u64)))
        .collect::<Result<_>>()?;
    let total =
        |way: usize| log_sum_exp(found.iter().map(|one| one.logs[way]));
    let with = total(0);
    let share = |one: &Located| (one.logs[0] - with).exp();
    // Far from the likeliest there are not enough draws to be a share of.
    let near: Vec<&Located> =
        found.iter().filter(|one| share(one) > 0.01).collect();
    let whole: f64 = near.iter().map(|one| share(one)).sum();
    let parts: Vec<(f64, &Draws)> =
        near.iter().map(|one| (share(one) / whole, &one.draws)).collect();
    let names = model.law_names();
    let parameters = match names.is_empty() {
        true => Vec::new(),
        false => summarise(&mixed(&parts, &names)?),
    };
    let most = |a: &&&Located, b: &&&Located| a.logs[0].total_cmp(&b.logs[0]);
    let likeliest = near.iter().max_by(most);
    Ok(Forced {
        parameters: parameters.iter().map(of_summary).collect(),
        gain: with - total(1),
        differs: likeliest.is_some_and(|one| one.differs),
    })
}

fn located(one: &Under<'_>, seed: Seed) -> Result<Located> {
    let none = one.none.as_ref();
    let none =
        none.ok_or_else(|| Error::inference("a force beside no fit"))?;
    let extent = one.program().event().extent();
    let forces =
        locate_all(one.program(), &extent, &Axis::ALL, none, seed.child(0))?;
    let gains = forces.iter().map(|force| force.log_bayes_factor);
    let gain = log_sum_exp(gains) - (forces.len() as f64).ln();
    let likeliest = FreeForce::likeliest(&forces);
    let open = left_open(one.program(), &extent, &forces, seed.child(1))?;
    let open = open.ok_or_else(no_density)?;
    Ok(Located {
        draws: open.own,
        logs: [gain, 0.0]
            .map(|gain| one.beforehand + none.log_evidence + gain),
        differs: likeliest.is_some_and(|force| !force.runs().is_empty()),
    })
}
