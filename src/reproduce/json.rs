//! `reproduction.json`, the document for programs.

use serde_json::{Map, Value, json};

use super::{ModelStudy, PriorStudy, Reading, Reproduction, error_of};
use crate::sbc::Ranks;

/// `reproduction.json`, schema 1: coverage in percent.
pub fn reproduction_json(found: &Reproduction) -> Value {
    let priors: Map<String, Value> = found
        .priors
        .iter()
        .map(|p| (p.name.to_owned(), prior(p, found.samples)))
        .collect();
    let case = &found.case;
    let mut document = json!({
        "schema": 1,
        "samples": found.samples,
        "left_out": found.left_out,
        "seed": found.seed,
        "priors": priors,
        "readings": found.readings.iter().map(reading).collect::<Vec<_>>(),
        "windows": found.windows.iter().map(reading).collect::<Vec<_>>(),
        "delta1": case.delta1,
        "delta2": case.delta2,
        "sbc": found.ranks.iter().map(ranks).collect::<Vec<_>>(),
    });
    found.origin.write_to(&mut document);
    document
}

/// The p-value and the histogram of each quantity's ranks.
fn ranks(ranks: &Ranks) -> Value {
    let named = ranks.names.iter().enumerate().map(|(i, name)| {
        let said = json!({ "p": ranks.p(i), "tenths": ranks.histogram(i) });
        (name.clone(), said)
    });
    named.collect()
}

fn prior(study: &PriorStudy, samples: usize) -> Value {
    let by_model = |of: &dyn Fn(&ModelStudy) -> Value| -> Value {
        let pairs = study.models.iter().map(|m| (m.which.name(), of(m)));
        pairs.map(|(name, value)| (name.to_owned(), value)).collect()
    };
    let shares = |m: &ModelStudy, counts: &[usize]| {
        named(m, counts, |n| 100.0 * *n as f64 / samples as f64)
    };
    json!({
        "xi": study.priors.xi,
        "coverage": by_model(&|m| shares(m, &m.covered)),
        "coverage_se": by_model(&|m| {
            named(m, &m.covered, |n| error_of(*n, samples))
        }),
        "coverage_exact": by_model(&|m| shares(m, &m.covered_exactly)),
        "log10_bf": study.log10_bf(),
        "log10_bf_exact": study.log10_bf_exact(),
        "map": by_model(&|m| {
            let pairs = m.names.iter().zip(&m.modes);
            pairs.map(|(n, v)| (n.clone(), json!(v))).collect()
        }),
    })
}

fn named<T>(m: &ModelStudy, of: &[T], value: impl Fn(&T) -> f64) -> Value {
    let pairs = m.names.iter().zip(of);
    pairs.map(|(name, x)| (name.clone(), json!(value(x)))).collect()
}

fn reading(reading: &Reading) -> Value {
    let share = |n: &usize| 100.0 * *n as f64 / reading.samples as f64;
    let shares = |counts: &[usize]| -> Value {
        counts.iter().map(|n| json!(share(n))).collect()
    };
    json!({
        "what": reading.what,
        "samples": reading.samples,
        "left_out": reading.left_out,
        "coverage": {
            "M0": shares(&reading.covered[0]),
            "M1": shares(&reading.covered[1]),
        },
        "log10_bf": reading.log10_bf,
    })
}
