//! Three models of posteriordb, with the means and standard deviations of
//! its reference draws; `tests/data/posteriordb/SOURCE.md` says whence.

use std::path::Path;

use couloir::model;
use serde_json::Value;

use super::targets::{Check, Spread, Target};

fn read(file: &str) -> Value {
    let folder =
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/posteriordb");
    let text = std::fs::read_to_string(Path::new(folder).join(file));
    serde_json::from_str(&text.unwrap()).unwrap()
}

fn numbers(data: &Value, name: &str) -> Vec<f64> {
    let list = data[name].as_array().unwrap();
    list.iter().map(|x| x.as_f64().unwrap()).collect()
}

/// The mean of so many reference draws has an error of its own.
const REFERENCE_DRAWS: f64 = 10_000.0;

/// A check of the quantity that the reference calls `name`.
fn check(
    posterior: &str,
    name: &str,
    of: impl Fn(&[f64]) -> f64 + Sync + 'static,
) -> Check {
    let known = &read("reference.json")[posterior][name];
    let [mean, sd] = ["mean", "sd"].map(|key| known[key].as_f64().unwrap());
    Check {
        what: name.to_owned(),
        of: Box::new(of),
        mean,
        se: sd / REFERENCE_DRAWS.sqrt(),
        spread: Spread::About(sd),
    }
}

model! {
    /// An autoregression of order five.
    struct Autoregression { y: Vec<f64> }

    alpha ~ Normal(0.0, 10.0);
    beta[5] ~ Normal(0.0, 10.0);
    sigma ~ HalfCauchy(2.5);

    likelihood {
        for t in 5..y.len() {
            let mut mean = alpha;
            for k in 0..5 {
                mean += beta[k] * y[t - 1 - k];
            }
            y[t] ~ Normal(mean, sigma);
        }
    }
}

pub(crate) fn ark() -> Target {
    let names = ["alpha", "beta[1]", "beta[2]", "beta[3]", "beta[4]"];
    let names = names.into_iter().chain(["beta[5]", "sigma"]);
    let checks = names.enumerate();
    Target {
        name: "arK",
        model: Box::new(Autoregression::new(numbers(&read("arK.json"), "y"))),
        checks: checks
            .map(|(i, name)| check("arK-arK", name, move |row| row[i]))
            .collect(),
        log_evidence: None,
        top: None,
    }
}

model! {
    /// Eight schools, non-centred.
    struct Schools { y: Vec<f64>, sigma: Vec<f64> }

    mu ~ Normal(0.0, 5.0);
    tau ~ HalfCauchy(5.0);
    z[y.len()] ~ Normal(0.0, 1.0);

    likelihood {
        for (j, y) in y.iter().enumerate() {
            y ~ Normal(mu + tau * z[j], sigma[j]);
        }
    }
}

pub(crate) fn eight_schools() -> Target {
    let data = read("eight_schools.json");
    let posterior = "eight_schools-eight_schools_noncentered";
    let mut checks = vec![
        check(posterior, "mu", |row| row[0]),
        check(posterior, "tau", |row| row[1]),
    ];
    for j in 0..8 {
        let name = format!("theta[{}]", j + 1);
        let theta = move |row: &[f64]| row[0] + row[1] * row[2 + j];
        checks.push(check(posterior, &name, theta));
    }
    let (y, sigma) = (numbers(&data, "y"), numbers(&data, "sigma"));
    Target {
        name: "eight_schools",
        model: Box::new(Schools::new(y, sigma)),
        checks,
        log_evidence: None,
        top: None,
    }
}

model! {
    /// A line through children's scores over their mothers'.
    struct Scores { kid_score: Vec<f64>, mom_iq: Vec<f64> }

    beta[2] ~ Flat();
    sigma ~ HalfCauchy(2.5);

    likelihood {
        for (kid_score, iq) in kid_score.iter().zip(mom_iq) {
            kid_score ~ Normal(beta[0] + beta[1] * *iq, sigma);
        }
    }
}

pub(crate) fn kidscore() -> Target {
    let data = read("kidiq.json");
    let posterior = "kidiq-kidscore_momiq";
    let [kid_score, mom_iq] =
        ["kid_score", "mom_iq"].map(|name| numbers(&data, name));
    Target {
        name: "kidscore_momiq",
        model: Box::new(Scores::new(kid_score, mom_iq)),
        checks: vec![
            check(posterior, "beta[1]", |row| row[0]),
            check(posterior, "beta[2]", |row| row[1]),
            check(posterior, "sigma", |row| row[2]),
        ],
        log_evidence: None,
        top: None,
    }
}
