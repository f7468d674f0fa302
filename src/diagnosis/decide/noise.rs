//! Which noise made the errors, and under which the model goes on.

use std::f64::consts::LN_10;

use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::evidence::table::{Row, Table};
use crate::diagnosis::findings::{JudgedNoise, ParameterSummary};
use crate::draws::{log_sum_exp, summarise};
use crate::error::Result;
use crate::noise::{self, Form};

/// In log10: by how much another noise must be more probable than the named
/// one to take its place.
const RISE: f64 = 1.0;

/// The noise that the model goes on with: the named one, if any, or the most
/// probable where that is more probable by far. `logs` are ln of their
/// probabilities, up to a constant.
pub(crate) fn taken(named: Option<usize>, logs: &[f64]) -> usize {
    let more = |a: &usize, b: &usize| logs[*a].total_cmp(&logs[*b]);
    let best = (0..logs.len()).max_by(more).unwrap_or(0);
    let near = |i: &usize| logs[best] - logs[*i] < RISE * LN_10;
    named.filter(near).unwrap_or(best)
}

/// The noises that are kept, most probable first.
///
/// # Errors
/// A name that no noise has.
pub(crate) fn judged_noises(
    table: &Table<'_>,
    logs: &[f64],
) -> Result<Vec<JudgedNoise>> {
    let total = log_sum_exp(logs.iter().copied());
    let named = table.as_it_was()?;
    let evidence =
        |place: usize| logs[place] - table.rows[place].noisy.beforehand();
    let of_named = match table.named() {
        Some(place) => evidence(place),
        // It was dropped: about as far below the best as it was then.
        None => {
            let best = taken(None, logs);
            let above = table.rows[best].noisy.either_way();
            evidence(best) - (above - named.either_way())
        }
    };
    let mut all = Vec::new();
    for (place, row) in table.rows.iter().enumerate() {
        let form = Form::of(&row.noisy.name);
        let gain = evidence(place) - of_named;
        all.push(JudgedNoise {
            name: row.noisy.name.clone(),
            has_tails: form.has_tails,
            grows: form.grows,
            probability: (logs[place] - total).exp(),
            log10_bayes_factor: gain / LN_10,
            parameters: parameters(row),
        });
    }
    all.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    Ok(all)
}

/// The noise's parameters, with what has the most evidence under it.
fn parameters(row: &Row<'_>) -> Vec<ParameterSummary> {
    let found = row.found.iter().flat_map(|found| &found.candidates);
    let all = [&row.noisy.none].into_iter().chain(found);
    let more = |a: &&Fit, b: &&Fit| a.log_evidence.total_cmp(&b.log_evidence);
    let Some(fit) = all.max_by(more) else { return Vec::new() };
    let Ok(noise) = noise::parse(&row.noisy.name) else { return Vec::new() };
    let own: Vec<String> =
        noise.parameters().into_iter().map(|(name, _)| name).collect();
    // "sigma2", and an event's "C10.sigma2".
    let is_own = |name: &str| {
        let of = |own: &String| {
            let label = name.strip_suffix(own.as_str());
            label.is_some_and(|l| l.is_empty() || l.ends_with('.'))
        };
        own.iter().any(of)
    };
    let columns = summarise(&fit.draws);
    let columns = columns.iter().skip(fit.added);
    let columns = columns.filter(|column| is_own(&column.name));
    columns.map(ParameterSummary::of).collect()
}
