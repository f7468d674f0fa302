//! Whether the members' draws are enough to tell the population by.

use super::hyper::{Hyper, Law};
use super::pooled::{Pooled, Shared};
use crate::draws::Draws;
use crate::parallel;

/// How many draws of the population the halves are compared at.
const LAWS: usize = 400;

/// The largest error of a figure, as a share of its standard deviation, that
/// leaves the figure as it is for most purposes.
const MOST: f64 = 0.3;

/// How many draws a member's weights have to be worth: fewer leave no 90 %
/// interval of it.
const FEWEST: f64 = 20.0;

/// Adds the errors that the members' draws leave: the population is weighed
/// again by each half of the draws of every member; half the difference is the
/// standard error of both together.
pub(super) fn with_errors(
    hyper: &Hyper,
    draws: &Draws,
    mut parameters: Vec<Shared>,
) -> Vec<Shared> {
    let rows = draws.thinned(LAWS);
    let laws: Vec<Law> = rows.iter().map(|row| hyper.law(row)).collect();
    let logs: Vec<[f64; 2]> =
        parallel::map(&laws, |law| against_whole(hyper, law));
    let mean = |half: usize, column: usize| {
        let logs = logs.iter().map(|log| log[half]);
        let most = logs.clone().fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = logs.map(|log| (log - most).exp()).collect();
        let sum = weights.iter().zip(&rows).map(|(w, row)| w * row[column]);
        sum.sum::<f64>() / weights.iter().sum::<f64>()
    };
    let covariance = draws.covariance();
    for (k, parameter) in parameters.iter_mut().enumerate() {
        parameter.errors = [2 * k, 2 * k + 1].map(|column| {
            let apart = mean(0, column) - mean(1, column);
            0.5 * apart.abs() / covariance[(column, column)].sqrt()
        });
    }
    parameters
}

/// ln of the likelihood by each half of the draws, less that by all.
fn against_whole(hyper: &Hyper, law: &Law) -> [f64; 2] {
    let mut apart = [0.0; 2];
    for member in &hyper.members {
        let count = member.base.len();
        let (whole, _) = hyper.log_likelihood(member, 0..count, law);
        for (half, apart) in apart.iter_mut().enumerate() {
            let own = (half..count).step_by(2);
            *apart += hyper.log_likelihood(member, own, law).0 - whole;
        }
    }
    apart
}

/// Why the result should not be used as it is.
pub(super) fn warnings(
    parameters: &[Shared],
    members: &[Pooled],
) -> Vec<String> {
    let mut warnings = Vec::new();
    for parameter in parameters {
        let worst = parameter.errors.iter().fold(0.0_f64, |a, b| a.max(*b));
        if worst.is_nan() || worst > MOST {
            warnings.push(format!(
                "halves of the events' draws disagree on the population's {} \
                 by {worst:.2} of its standard deviation, above {MOST}: \
                 calibrate the events with more draws kept",
                parameter.name
            ));
        }
    }
    let few: Vec<&Pooled> =
        members.iter().filter(|m| m.effective < FEWEST).collect();
    if let Some(worst) =
        few.iter().min_by(|a, b| a.effective.total_cmp(&b.effective))
    {
        warnings.push(format!(
            "{} of {} events, {} first with {:.1}, are left with fewer than \
             {FEWEST} of their draws: the population lies beside what each of \
             them says alone, or is much narrower; their pooled intervals are \
             rough",
            few.len(),
            members.len(),
            worst.name,
            worst.effective
        ));
    }
    warnings
}
