//! Four published posteriors, each by a model in the language: means within
//! a tenth of a standard deviation. `tests/data/posteriordb/SOURCE.md` says
//! whence the figures are.

#[allow(dead_code)]
#[path = "../examples/16_counts.rs"]
mod counts;
#[allow(dead_code)]
#[path = "../examples/15_hare_and_lynx.rs"]
mod hare_and_lynx;

use couloir::draws::summarise;
use couloir::prelude::*;
use serde_json::Value;

fn read(file: &str) -> Value {
    let folder =
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/posteriordb/");
    let text = std::fs::read_to_string(format!("{folder}{file}"));
    serde_json::from_str(&text.expect("a file")).expect("JSON")
}

fn numbers(data: &Value) -> Vec<f64> {
    let list = data.as_array().expect("a list");
    list.iter().map(|x| x.as_f64().expect("a number")).collect()
}

/// By how much a mean may be off, in standard deviations.
const OFF: f64 = 0.1;
/// The fewest effective draws: the Monte Carlo error of a mean is then a
/// quarter of what it may be off, or less.
const EFFECTIVE: f64 = 1600.0;

/// Compares means with those of the reference, by its names and ours.
#[track_caller]
fn check(
    model: &dyn Model,
    backend: &dyn Backend,
    known: &Value,
    names: &[[&str; 2]],
) {
    let posterior = Posterior::new(model).expect("a posterior");
    let found = infer(backend, &posterior, Seed::new(1), &Quiet);
    let found = found.expect("draws");
    let draws = [found.draws, found.kept].into_iter().flatten();
    let all: Vec<_> = draws.flat_map(|draws| summarise(&draws)).collect();
    for [theirs, ours] in names {
        let one = all.iter().find(|s| s.name == *ours).expect("a name");
        let [mean, sd] = ["mean", "sd"]
            .map(|key| known[*theirs][key].as_f64().expect("a number"));
        let off = (one.mean - mean) / sd;
        println!("{ours}: {off:.3} sd off, {:.0} draws", one.ess_bulk);
        assert!(one.ess_bulk > EFFECTIVE, "{ours}: {}", one.ess_bulk);
        assert!(off.abs() < OFF, "{ours}: {} for {mean}", one.mean);
    }
}

#[test]
fn hare_and_lynx() {
    let names = [
        ["theta[1]", "alpha"],
        ["theta[2]", "beta"],
        ["theta[3]", "gamma"],
        ["theta[4]", "delta"],
        ["z_init[1]", "start[1]"],
        ["z_init[2]", "start[2]"],
        ["sigma[1]", "sigma[1]"],
        ["sigma[2]", "sigma[2]"],
    ];
    let known = &read("reference.json")["hudson_lynx_hare-lotka_volterra"];
    check(&hare_and_lynx::pelts(), &Smc::default(), known, &names);
}

model! {
    /// An autoregression of order one with a moving average of order one.
    struct Arma { y: Vec<f64> }

    mu ~ Normal(0.0, 10.0);
    phi ~ Normal(0.0, 2.0);
    theta ~ Normal(0.0, 2.0);
    sigma ~ HalfCauchy(2.5);

    likelihood {
        let mut mean = mu + phi * mu;
        for y in y {
            y ~ Normal(mean, sigma);
            mean = mu + phi * *y + theta * (*y - mean);
        }
    }
}

#[test]
fn arma() {
    let model = Arma::new(numbers(&read("arma.json")["y"]));
    let names = ["mu", "phi", "theta", "sigma"].map(|name| [name, name]);
    let known = &read("reference.json")["arma-arma11"];
    check(&model, &MetropolisHastings::default(), known, &names);
}

model! {
    /// Two normal distributions, their centres in order.
    struct Groups { y: Vec<f64> }

    mu[2] ~ Ordered(Normal(0.0, 2.0));
    sigma[2] ~ HalfNormal(2.0);
    theta ~ Beta(5.0, 5.0);

    likelihood {
        y ~ Mixture([theta, 1.0 - theta], [
            Normal(mu[0], sigma[0]),
            Normal(mu[1], sigma[1]),
        ]);
    }
}

#[test]
fn two_components() {
    let model = Groups::new(numbers(&read("low_dim_gauss_mix.json")["y"]));
    let names = ["mu[1]", "mu[2]", "sigma[1]", "sigma[2]", "theta"];
    let known = &read("reference.json")["low_dim_gauss_mix-low_dim_gauss_mix"];
    let names = names.map(|name| [name, name]);
    check(&model, &MetropolisHastings::default(), known, &names);
}

#[cfg(feature = "nuts")]
model! {
    /// Counts whose log mean is a Gaussian process of x.
    struct Process { x: Vec<f64>, k: Vec<f64> }

    rho ~ Gamma(25.0, 0.25);
    alpha ~ HalfNormal(2.0);
    z[x.len()] ~ Normal(0.0, 1.0);

    likelihood {
        // Cholesky's factor of the covariance, row by row.
        let mut rows: Vec<Vec<_>> = Vec::new();
        for i in 0..x.len() {
            let mut row = Vec::new();
            for j in 0..=i {
                let far = (x[i] - x[j]) / rho;
                let mut left = alpha * alpha * (-0.5 * far * far).exp();
                let above = if j < i { &rows[j] } else { &row };
                for (a, b) in row.iter().zip(above).take(j) {
                    left -= *a * *b;
                }
                row.push(match j < i {
                    true => left / above[j],
                    false => (left + 1e-10).sqrt(),
                });
            }
            let mut f = 0.0 * rho;
            for (factor, z) in row.iter().zip(&z) {
                f += *factor * *z;
            }
            keep f[i] = f;
            k[i] ~ Poisson(f.exp());
            rows.push(row);
        }
    }
}

// In 13 dimensions that depend on each other only the gradient leads on.
#[cfg(feature = "nuts")]
#[test]
fn a_poisson_regression_on_a_process() {
    let data = read("gp_pois_regr.json");
    let model = Process::new(numbers(&data["x"]), numbers(&data["k"]));
    let f: Vec<String> = (1..=11).map(|i| format!("f[{i}]")).collect();
    let all = ["rho", "alpha"].into_iter().chain(f.iter().map(|f| &f[..]));
    let names: Vec<_> = all.map(|name| [name, name]).collect();
    let known = &read("reference.json")["gp_pois_regr-gp_pois_regr"];
    let backend = Nuts { draws: 8000, ..Nuts::default() };
    check(&model, &backend, known, &names);
}

/// Not published: importance sampling in Python, 400 000 draws of Student's t
/// about the mode, of which 375 000 count.
#[test]
fn a_poisson_regression_on_a_cubic() {
    let known = serde_json::json!({
        "alpha": { "mean": 4.28455, "sd": 0.02935 },
        "beta[1]": { "mean": 1.24616, "sd": 0.04476 },
        "beta[2]": { "mean": 0.06940, "sd": 0.02351 },
        "beta[3]": { "mean": -0.22962, "sd": 0.02338 },
    });
    let names = ["alpha", "beta[1]", "beta[2]", "beta[3]"];
    let names = names.map(|name| [name, name]);
    let backend = MetropolisHastings::default();
    check(&counts::falcons(), &backend, &known, &names);
}
