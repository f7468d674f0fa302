//! Posteriors whose means, spreads, evidence and mode are known.
//!
//! The densities with closed forms are set against a wide prior: the
//! likelihood is the density over the prior, times a constant, so that the
//! posterior is the density and the evidence the constant.

use std::f64::consts::PI;
use std::path::Path;

use couloir::model::Assembled;
use couloir::physics::GRAVITY;
use couloir::physics::friction::Laws;
use couloir::prelude::*;
use couloir::prior::{Cauchy, Distribution, Normal, Prior, Support};
use couloir::seed::Rng;
use couloir::{io, noise};
use serde_json::Value;

/// A posterior and what is known of it.
pub(crate) struct Target {
    pub(crate) name: &'static str,
    pub(crate) model: Box<dyn Model>,
    pub(crate) checks: Vec<Check>,
    pub(crate) log_evidence: Option<f64>,
    /// The height of the mode, ln(prior x likelihood).
    pub(crate) top: Option<f64>,
}

/// A function of a draw.
type Of = dyn Fn(&[f64]) -> f64 + Sync;

/// A function of the parameters whose mean is known.
pub(crate) struct Check {
    pub(crate) what: String,
    pub(crate) of: Box<Of>,
    pub(crate) mean: f64,
    /// The standard error of that, where it is itself from draws.
    pub(crate) se: f64,
    pub(crate) spread: Spread,
}

/// What is known of a standard deviation.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Spread {
    /// Nothing.
    Any,
    /// It is this.
    Sd(f64),
    /// Reference draws have this one.
    About(f64),
}

impl Check {
    fn new(
        what: &str,
        of: impl Fn(&[f64]) -> f64 + Sync + 'static,
        mean: f64,
        spread: Spread,
    ) -> Self {
        let (what, of) = (what.to_owned(), Box::new(of));
        Self { what, of, mean, se: 0.0, spread }
    }

    /// A share of the posterior.
    fn share(
        what: &str,
        of: impl Fn(&[f64]) -> bool + Sync + 'static,
        share: f64,
    ) -> Self {
        let of = move |row: &[f64]| f64::from(u8::from(of(row)));
        Self::new(what, of, share, Spread::Any)
    }
}

/// Every target.
pub(crate) fn all() -> Vec<Target> {
    use super::posteriordb;
    vec![
        correlated(),
        banana(),
        two_modes(),
        funnel(),
        bounds(),
        linear(),
        voellmy(),
        posteriordb::ark(),
        posteriordb::eight_schools(),
        posteriordb::kidscore(),
    ]
}

/// A log likelihood that is given as such.
#[derive(Debug, Clone, Copy)]
struct Factor<K: Kind> {
    log: Real<K>,
}

impl<K: Kind> Factor<K> {
    fn new(log: impl Into<Real<K>>) -> Self {
        Self { log: log.into() }
    }
}

impl<K: Kind> Distribution<K> for Factor<K> {
    fn log_density(&self, _: Real<K>) -> Real<K> {
        self.log
    }

    fn draw(&self, _: &mut Rng) -> Option<f64> {
        None
    }
}

impl<K: Kind> Prior<K> for Factor<K> {
    fn support(&self) -> Support<K> {
        Support::Line
    }

    fn is_proper(&self) -> bool {
        false
    }

    fn quantile(&self, _: f64) -> Option<f64> {
        None
    }
}

/// The evidence of the closed densities: not zero, lest nothing be found.
const LOG_EVIDENCE: f64 = -3.25;

fn normal<K: Kind>(
    x: Real<K>,
    mean: impl Into<Real<K>>,
    sd: impl Into<Real<K>>,
) -> Real<K> {
    Normal::new(mean, sd).log_density(x)
}

const RHO: f64 = 0.95;

/// The log density of standard normals with all correlations `RHO`.
fn equicorrelated<K: Kind>(x: &[Real<K>]) -> Real<K> {
    let n = x.len() as f64;
    let sum: Real<K> = x.iter().copied().sum();
    let squares: Real<K> = x.iter().map(|x| x.squared()).sum();
    let whole = 1.0 + (n - 1.0) * RHO;
    let form = (squares - sum.squared() * (RHO / whole)) / (1.0 - RHO);
    let log_det = (n - 1.0) * (1.0 - RHO).ln() + whole.ln();
    -0.5 * (form + n * (2.0 * PI).ln() + log_det)
}

model! {
    struct Correlated { zero: f64 }

    x[4] ~ Normal(0.0, 5.0);

    likelihood {
        let mut log = equicorrelated(&x) + LOG_EVIDENCE;
        for x in &x {
            log -= normal(*x, 0.0, 5.0);
        }
        zero ~ self::Factor(log);
    }
}

pub(crate) fn correlated() -> Target {
    let mut checks: Vec<_> = (0..4)
        .map(|i| {
            let x = move |row: &[f64]| row[i];
            Check::new(&format!("x[{}]", i + 1), x, 0.0, Spread::Sd(1.0))
        })
        .collect();
    let product = |row: &[f64]| row[0] * row[3];
    checks.push(Check::new("x[1] x[4]", product, RHO, Spread::Any));
    let origin = [Real::<couloir::scalar::Plain>::new(0.0); 4];
    Target {
        name: "correlated normal",
        model: Box::new(Correlated::new(0.0)),
        checks,
        log_evidence: Some(LOG_EVIDENCE),
        top: Some(equicorrelated(&origin).value() + LOG_EVIDENCE),
    }
}

model! {
    /// A standard normal, and one narrow about its square.
    struct Banana { zero: f64 }

    x ~ Normal(0.0, 10.0);
    y ~ Normal(0.0, 10.0);

    likelihood {
        let log = normal(x, 0.0, 1.0)
            + normal(y, x.squared(), 0.3)
            - normal(x, 0.0, 10.0)
            - normal(y, 0.0, 10.0);
        zero ~ self::Factor(log + LOG_EVIDENCE);
    }
}

pub(crate) fn banana() -> Target {
    // The square of a standard normal has mean 1 and variance 2.
    let sd = (2.0_f64 + 0.3 * 0.3).sqrt();
    let about = |row: &[f64]| row[1] - row[0] * row[0];
    Target {
        name: "banana",
        model: Box::new(Banana::new(0.0)),
        checks: vec![
            Check::new("x", |row| row[0], 0.0, Spread::Sd(1.0)),
            Check::new("y", |row| row[1], 1.0, Spread::Sd(sd)),
            Check::new("y - x^2", about, 0.0, Spread::Sd(0.3)),
        ],
        log_evidence: Some(LOG_EVIDENCE),
        top: Some(-(2.0 * PI * 0.3).ln() + LOG_EVIDENCE),
    }
}

/// Half the distance of the two modes, in their widths.
const APART: f64 = 6.0;

/// Three tenths of the probability about `-APART`, the rest about `APART`.
fn mixture<K: Kind>(x: Real<K>, y: Real<K>) -> Real<K> {
    let left = normal(x, -APART, 1.0) + normal(y, -APART, 1.0);
    let right = normal(x, APART, 1.0) + normal(y, APART, 1.0);
    let (left, right) = (left + 0.3_f64.ln(), right + 0.7_f64.ln());
    let top = left.max(right);
    top + ((left - top).exp() + (right - top).exp()).ln()
}

model! {
    struct TwoModes { zero: f64 }

    x ~ Normal(0.0, 10.0);
    y ~ Normal(0.0, 10.0);

    likelihood {
        let prior = normal(x, 0.0, 10.0) + normal(y, 0.0, 10.0);
        zero ~ self::Factor(mixture(x, y) - prior + LOG_EVIDENCE);
    }
}

pub(crate) fn two_modes() -> Target {
    let mean = (0.7 - 0.3) * APART;
    let sd = (1.0 + APART * APART - mean * mean).sqrt();
    Target {
        name: "two modes",
        model: Box::new(TwoModes::new(0.0)),
        checks: vec![
            Check::new("x", |row| row[0], mean, Spread::Sd(sd)),
            Check::new("y", |row| row[1], mean, Spread::Sd(sd)),
            Check::share("the right mode", |row| row[0] > 0.0, 0.7),
        ],
        log_evidence: Some(LOG_EVIDENCE),
        top: Some(0.7_f64.ln() - (2.0 * PI).ln() + LOG_EVIDENCE),
    }
}

model! {
    /// Neal (2003), "Slice sampling", in four dimensions.
    struct Funnel { zero: f64 }

    v ~ Normal(0.0, 5.0);
    x[3] ~ Cauchy(0.0, 5.0);

    likelihood {
        let mut log = normal(v, 0.0, 3.0) - normal(v, 0.0, 5.0);
        for x in &x {
            log += normal(*x, 0.0, (0.5 * v).exp())
                - Cauchy::new(0.0, 5.0).log_density(*x);
        }
        zero ~ self::Factor(log + LOG_EVIDENCE);
    }
}

pub(crate) fn funnel() -> Target {
    let scaled = |i: usize| move |row: &[f64]| row[i] / (0.5 * row[0]).exp();
    // -v^2/18 - 3v/2 is highest at -27/2, where the neck is narrowest.
    let v = -13.5_f64;
    let top = -v * v / 18.0 - 1.5 * v - 3.0_f64.ln() - 2.0 * (2.0 * PI).ln();
    let below = 0.158_655_253_931_457_05;
    Target {
        name: "funnel",
        model: Box::new(Funnel::new(0.0)),
        checks: vec![
            Check::new("v", |row| row[0], 0.0, Spread::Sd(3.0)),
            Check::share("the neck", |row| row[0] < -3.0, below),
            Check::share("the mouth", |row| row[0] > 3.0, below),
            Check::new("x[1] scaled", scaled(1), 0.0, Spread::Sd(1.0)),
            Check::new("x[3] scaled", scaled(3), 0.0, Spread::Sd(1.0)),
        ],
        log_evidence: Some(LOG_EVIDENCE),
        top: Some(top + LOG_EVIDENCE),
    }
}

/// How steeply the density rises to the bounds.
const STEEP: f64 = 20.0;

model! {
    /// Densities that are highest at a bound and fall off exponentially.
    struct Bounds { zero: f64 }

    low ~ Uniform(0.0, 1.0);
    high ~ Uniform(0.0, 1.0);

    likelihood {
        zero ~ self::Factor(STEEP * (high - 1.0 - low));
    }
}

pub(crate) fn bounds() -> Target {
    // An exponential distribution, cut at 1.
    let mean = 1.0 / STEEP - 1.0 / STEEP.exp_m1();
    let cut = STEEP.exp() / STEEP.exp_m1().powi(2);
    let sd = Spread::Sd((1.0 / (STEEP * STEEP) - cut).sqrt());
    let one = -(-STEEP).exp_m1() / STEEP;
    Target {
        name: "bounds",
        model: Box::new(Bounds::new(0.0)),
        checks: vec![
            Check::new("low", |row| row[0], mean, sd),
            Check::new("high", |row| row[1], 1.0 - mean, sd),
        ],
        log_evidence: Some(2.0 * one.ln()),
        top: Some(0.0),
    }
}

/// Times \[s\] and speeds \[m/s\] down 35 degrees under mu = 0.31, with
/// made-up errors.
fn speeds() -> (Vec<f64>, Vec<f64>) {
    let errors = [0.4, -1.1, 0.9, 0.2, -0.6, 1.5, -0.3, -0.9, 0.7, 0.1];
    let (sin, cos) = 35_f64.to_radians().sin_cos();
    let times: Vec<f64> = (1..=10).map(f64::from).collect();
    let a = GRAVITY * (sin - 0.31 * cos);
    let speeds = times.iter().zip(errors).map(|(t, e)| a * t + e).collect();
    (times, speeds)
}

model! {
    /// The speed on a slope is linear in mu.
    struct Linear { event: Event }

    friction ~ Coulomb { mu: Normal(0.3, 0.1) };
    errors ~ Iid { sigma2 = 1.0 };

    likelihood {
        event.velocity ~ event.slide(&friction)?.velocity() + errors;
    }
}

pub(crate) fn linear() -> Target {
    let (times, speeds) = speeds();
    // Normal prior, normal errors of variance 1: y = a t - b t mu + e.
    let (sin, cos) = 35_f64.to_radians().sin_cos();
    let (a, b) = (GRAVITY * sin, GRAVITY * cos);
    let data = times.iter().zip(&speeds);
    let prior = (0.3, 100.0);
    let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        data.clone().map(|(t, y)| of(*t, *y)).sum()
    };
    let squares = sum(&|t, _| (b * t).powi(2));
    let precision = prior.1 + squares;
    let pull = sum(&|t, y| b * t * ((a - b * prior.0) * t - y));
    let shift = pull / precision;
    let rest = sum(&|t, y| (y - (a - b * prior.0) * t).powi(2));
    // Gaussian integral over mu, centred on the prior's mean.
    let n = times.len() as f64;
    let log_evidence = -0.5
        * (n * (2.0 * PI).ln() + (precision / prior.1).ln() + rest
            - pull * shift);
    let event = Event::on(Track::incline(35.0, 1000.0).unwrap())
        .velocity(Series::velocity(times, speeds).unwrap())
        .build()
        .unwrap();
    let mean = prior.0 + shift;
    let sd = Spread::Sd(precision.powf(-0.5));
    Target {
        name: "linear",
        model: Box::new(Linear::new(event)),
        checks: vec![Check::new("mu", |row| row[0], mean, sd)],
        log_evidence: Some(log_evidence),
        // Evidence times the height of the normal posterior.
        top: Some(log_evidence + 0.5 * (precision / (2.0 * PI)).ln()),
    }
}

/// The synthetic event whose posterior is known by quadrature.
pub(crate) fn voellmy() -> Target {
    let folder = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/voellmy-21"
    ));
    let file = io::load(folder, &Laws::default()).unwrap();
    let noise = noise::parse("iid").unwrap();
    let model = Assembled::new(file.event, file.friction, noise, &file.priors);
    let text = std::fs::read_to_string(folder.join("reference.json"));
    let reference: Value = serde_json::from_str(&text.unwrap()).unwrap();
    let track = &reference["piecewise_linear_track"];
    let best = &reference["map"]["M0"]["log_posterior_unnormalised"];
    let mut checks = Vec::new();
    for (i, name) in ["mu", "xi", "sigma2"].into_iter().enumerate() {
        for (p, q) in track["M0"][name]["q"].as_object().unwrap() {
            let q = q.as_f64().unwrap();
            let what = format!("{name} below its {p} quantile");
            let below = move |row: &[f64]| row[i] < q;
            checks.push(Check::share(&what, below, p.parse().unwrap()));
        }
    }
    Target {
        name: "voellmy-21",
        model: Box::new(model.unwrap()),
        checks,
        log_evidence: track["lnZ0"].as_f64(),
        top: best.as_f64(),
    }
}
