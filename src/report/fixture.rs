//! A calibration to test with: a Voellmy-like flow, AR(1) draws as chains.

use std::f64::consts::TAU;

use super::*;

const CHAINS: usize = 4;
const DRAWS: usize = 1000;

/// A small generator, so that pictures come out the same everywhere.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }

    fn ar1(&mut self, phi: f64, count: usize) -> Vec<f64> {
        let mut x = self.normal();
        let innovation = (1.0 - phi * phi).sqrt();
        (0..count)
            .map(|_| {
                x = phi * x + innovation * self.normal();
                x
            })
            .collect()
    }
}

/// A calibration without trouble: four parameters, 40 values.
pub(super) fn calibration() -> CalibrationReport {
    let mut noise = Noise(7);
    let errors = noise.ar1(0.6, 40);
    let times: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.9).collect();
    let values: Vec<f64> =
        times.iter().zip(&errors).map(|(t, e)| speed(*t) + 2.0 * e).collect();
    let innovations = noise.ar1(0.0, 40);
    CalibrationReport {
        parameters: parameters(&mut noise),
        standard_errors: Some(vec![0.8; 40]),
        bands: bands(&times, 0.06, 4.2),
        prior_bands: Some(bands(&times, 0.5, 9.0)),
        statistics: vec![Statistic {
            name: "largest value",
            unit: "m/s".to_owned(),
            recorded: 21.0,
            replicated: (0..400).map(|i| 18.0 + 0.01 * f64::from(i)).collect(),
        }],
        track: track(),
        autocorrelation: autocorrelation(&innovations),
        innovations,
        innovation_times: times.clone(),
        times,
        values,
        ..run()
    }
}

/// What was run, and how it went.
fn run() -> CalibrationReport {
    CalibrationReport {
        event: "Lautaret-like".to_owned(),
        friction: "voellmy".to_owned(),
        noise: "ar(1)".to_owned(),
        backend: "mh".to_owned(),
        seed: 1,
        quantity: "velocity".to_owned(),
        unit: "m/s".to_owned(),
        evidence: Some(EvidenceReport {
            value: -81.37,
            se: 0.021,
            method: "bridge sampling".to_owned(),
        }),
        checks: Checks {
            ljung_box_p: 0.41,
            shapiro_wilk_p: 0.33,
            kolmogorov_smirnov_p: 0.62,
            coverage90: 0.925,
            rmse: 2.05,
        },
        acceptance: vec![0.31, 0.29, 0.33, 0.30],
        simulations: 84_210,
        seconds: 3.42,
        synthetic: true,
        ..CalibrationReport::default()
    }
}

fn speed(t: f64) -> f64 {
    34.0 * (t / 9.0).tanh() * (1.0 - (t / 38.0).powi(4)).max(0.0)
}

fn bands(times: &[f64], spread: f64, error: f64) -> Bands {
    let end = times.last().copied().unwrap_or(0.0);
    let times: Vec<f64> =
        (0..=120).map(|i| end * f64::from(i) / 120.0).collect();
    let flow = |factor: f64, shift: f64| -> Vec<f64> {
        times.iter().map(|t| factor * speed(*t) + shift).collect()
    };
    Bands {
        median: flow(1.0, 0.0),
        flow_low: flow(1.0 - spread, 0.0),
        flow_high: flow(1.0 + spread, 0.0),
        full_low: flow(1.0 - spread, -error),
        full_high: flow(1.0 + spread, error),
        times,
    }
}

fn track() -> TrackReport {
    let x: Vec<f64> = (0..=30).map(|i| 40.0 * f64::from(i)).collect();
    let height = |x: f64| 2400.0 + 600.0 * (-x / 500.0).exp();
    let z = x.iter().map(|x| height(*x)).collect();
    let mass = |t: f64| (t, 22.0 * t * (t / (t + 6.0)), 0.0);
    let stand = |(t, x, _): (f64, f64, f64)| (t, x, height(x));
    TrackReport {
        x,
        z,
        positions: (0..20).map(|i| stand(mass(2.0 * f64::from(i)))).collect(),
        rest: Some(stand(mass(41.3))),
    }
}

fn autocorrelation(x: &[f64]) -> Vec<f64> {
    let variance: f64 = x.iter().map(|v| v * v).sum();
    let at = |lag: usize| x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum();
    (1..=15)
        .map(|lag| {
            let s: f64 = at(lag);
            s / variance
        })
        .collect()
}

/// Two of the flow and two of its errors, correlated with the first.
fn parameters(noise: &mut Noise) -> Vec<ParameterReport> {
    let chains = |noise: &mut Noise| -> Vec<Vec<f64>> {
        (0..CHAINS).map(|_| noise.ar1(0.7, DRAWS)).collect()
    };
    let standard: Vec<Vec<Vec<f64>>> = (0..4).map(|_| chains(noise)).collect();
    let mixed = |i: usize, with: f64| -> Vec<Vec<f64>> {
        let own = (1.0 - with * with).sqrt();
        let rows = standard[0].iter().zip(&standard[i]);
        rows.map(|(a, b)| {
            a.iter().zip(b).map(|(a, b)| with * a + own * b).collect()
        })
        .collect()
    };
    let (mu, xi) = ((0.34, 0.05, 0.09), (980.0, 260.0, 632.0));
    let (sigma2, phi) = ((4.1, 1.1, 10.0), (0.6, 0.13, 0.58));
    let of_errors =
        |parameter| ParameterReport { of_errors: true, ..parameter };
    vec![
        parameter("mu", "1", "Gamma(9, 0.03)", mu, mixed(0, 0.0)),
        parameter("xi", "m/s2", "Gamma(2.5, 400)", xi, mixed(1, 0.8)),
        of_errors(parameter(
            "sigma2",
            "m2/s2",
            "InverseGamma(3, 20)",
            sigma2,
            mixed(2, 0.1),
        )),
        of_errors(parameter(
            "phi",
            "1",
            "Uniform(-1, 1)",
            phi,
            mixed(3, -0.3),
        )),
    ]
}

/// A parameter with its mean, posterior and prior standard deviation.
pub(super) fn parameter(
    name: &str,
    unit: &str,
    prior: &str,
    (mean, sd, wide): (f64, f64, f64),
    mut chains: Vec<Vec<f64>>,
) -> ParameterReport {
    chains.iter_mut().flatten().for_each(|x| *x = mean + sd * *x);
    let pooled: Vec<f64> =
        chains.iter().flatten().step_by(2).copied().collect();
    ParameterReport {
        name: name.to_owned(),
        unit: unit.to_owned(),
        of_errors: false,
        map: Some(mean - 0.2 * sd),
        mean,
        sd,
        q025: mean - 1.96 * sd,
        q05: mean - 1.645 * sd,
        q50: mean,
        q95: mean + 1.645 * sd,
        q975: mean + 1.96 * sd,
        rhat: 1.003,
        ess_bulk: 1480.0,
        ess_tail: 1912.0,
        mcse_mean: sd / 38.0,
        prior_text: prior.to_owned(),
        prior_density: bell(0.8 * mean, wide),
        posterior_density: bell(mean, sd),
        chains,
        pooled,
    }
}

fn bell(mean: f64, sd: f64) -> Vec<(f64, f64)> {
    let z = (0..=160).map(|i| (f64::from(i) - 80.0) / 22.0);
    z.map(|z| (mean + sd * z, (-0.5 * z * z).exp() / sd)).collect()
}

/// No identifier of a page stands twice.
pub(crate) fn assert_unique_ids(html: &str) {
    let mut ids: Vec<&str> = html
        .split(" id=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
}
