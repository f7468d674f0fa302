//! A diagnosis to test with, of made-up numbers: a patch of higher friction
//! from 132 to 187 m.

use super::*;
use crate::diagnosis::LawParameters;
use crate::diagnosis::locate::{Band, Process};
use crate::mechanism::catalogue::find;
use crate::mechanism::{Family, Noun};
use crate::observe::{Event, Series};
use crate::physics::Track;
use crate::physics::forces::Axis;
use crate::predict::Bands;

pub(super) fn parameter(
    name: &str,
    unit: &str,
    q50: f64,
    sd: f64,
) -> ParameterSummary {
    ParameterSummary {
        name: name.to_owned(),
        unit: unit.to_owned(),
        mean: q50,
        sd,
        q05: q50 - 1.64 * sd,
        q50,
        q95: q50 + 1.64 * sd,
    }
}

fn judged(
    name: &str,
    kind: Hypothesis,
    probability: f64,
    log10_bayes_factor: f64,
    parameters: Vec<ParameterSummary>,
) -> Judged {
    Judged {
        name: name.to_owned(),
        noun: noun(name, &parameters),
        kind,
        probability,
        log_evidence: -120.3 + 2.303 * log10_bayes_factor,
        se: 0.05,
        log10_bayes_factor,
        says: format!("What {name} says of the motion."),
        coordinate: None,
        form: None,
        parameters,
        variants: vec![],
    }
}

/// As the catalogue calls it.
fn noun(name: &str, parameters: &[ParameterSummary]) -> Noun {
    let times = vec![1.0, 2.0];
    let series = Series::velocity(times, vec![1.0, 2.0]).unwrap();
    let track = Track::incline(30.0, 100.0).unwrap();
    let event = Event::on(track).velocity(series).build().unwrap();
    let amplitude = parameters.first().map_or(f64::NAN, |p| p.q50);
    match find(name, &event.extent(), &[]) {
        Ok(mechanism) => mechanism.noun(amplitude),
        Err(_) => Noun::one("a force that nothing describes"),
    }
}

fn patch() -> Vec<ParameterSummary> {
    vec![
        parameter("delta_mu", "1", 0.142, 0.018),
        parameter("from", "m", 131.8, 1.9),
        parameter("length", "m", 55.3, 4.1),
    ]
}

fn mechanisms() -> Vec<Judged> {
    let mut all = vec![
        judged(
            "friction-patch",
            Hypothesis::Mechanism(Family::Physics),
            0.93,
            21.3,
            patch(),
        ),
        judged(
            "entrainment",
            Hypothesis::Mechanism(Family::Physics),
            0.05,
            20.0,
            vec![parameter("growth", "1/m", 0.0031, 0.0004)],
        ),
        judged(
            "surge",
            Hypothesis::Mechanism(Family::Physics),
            0.017,
            19.6,
            vec![parameter("force", "m/s2", -0.91, 0.1)],
        ),
        judged("unknown", Hypothesis::Unknown, 0.002, 18.6, vec![]),
        judged(
            "clock-offset",
            Hypothesis::Mechanism(Family::Measurement),
            0.0006,
            18.1,
            vec![parameter("ahead", "s", 0.82, 0.08)],
        ),
        judged(
            "velocity-scale",
            Hypothesis::Mechanism(Family::Measurement),
            0.0004,
            17.9,
            vec![parameter("scale", "1", 0.07, 0.01)],
        ),
        judged("none", Hypothesis::Baseline, 1e-20, 0.0, vec![]),
    ];
    all.extend(improbable());
    all
}

fn improbable() -> impl Iterator<Item = Judged> {
    let rest = [
        ("initial-velocity", Hypothesis::Mechanism(Family::Start), 3.1),
        ("release-position", Hypothesis::Mechanism(Family::Start), 2.2),
        ("friction-step", Hypothesis::Mechanism(Family::Physics), 1.2),
        ("friction-hardening", Hypothesis::Mechanism(Family::Physics), 0.9),
        ("cohesion", Hypothesis::Mechanism(Family::Physics), -0.4),
        ("viscous-drag", Hypothesis::Mechanism(Family::Physics), -0.7),
        ("velocity-weakening", Hypothesis::Mechanism(Family::Physics), -0.8),
        ("sensor-drift", Hypothesis::Mechanism(Family::Measurement), -0.9),
    ];
    rest.into_iter().map(|(name, kind, bf)| {
        judged(name, kind, 1e-9, bf, vec![parameter("amount", "1", 0.1, 0.1)])
    })
}

fn speed(t: f64) -> f64 {
    21.0 * (t / 5.0).tanh() - 0.35 * t
}

/// What a patch from 8.1 to 10.6 s takes away.
fn slowed(t: f64) -> f64 {
    0.9 * (t.clamp(8.1, 10.6) - 8.1)
}

fn bands(times: &[f64], patch: f64, error: f64) -> Bands {
    let flow = |factor: f64, shift: f64| -> Vec<f64> {
        let of = |t: &f64| factor * (speed(*t) - patch * slowed(*t)) + shift;
        times.iter().map(of).collect()
    };
    Bands {
        times: times.to_vec(),
        median: flow(1.0, 0.0),
        flow_low: flow(0.975, 0.0),
        flow_high: flow(1.025, 0.0),
        full_low: flow(0.975, -error),
        full_high: flow(1.025, error),
    }
}

/// A recording of 90 values.
pub(super) fn pictured() -> Pictured {
    let times: Vec<f64> = (0..90).map(|i| 0.2 * f64::from(i)).collect();
    let wobble = |i: usize| 0.5 * ((i * i % 17) as f64 / 17.0 - 0.5);
    let truth = |t: f64| speed(t) - slowed(t);
    let values = times.iter().enumerate().map(|(i, t)| truth(*t) + wobble(i));
    let places = times.iter().scan(0.0, |s, t| {
        *s += 0.2 * truth(*t).max(0.0);
        Some(*s)
    });
    let height = |x: f64| 600.0 + 190.0 * (-x / 160.0).exp();
    let x: Vec<f64> = (0..=32).map(|i| 10.0 * f64::from(i)).collect();
    let mark = (0..=20).map(|i| 108.0 + 2.1 * f64::from(i));
    Pictured {
        event: "Patch (synthetic)".to_owned(),
        quantity: "velocity".to_owned(),
        unit: "m/s".to_owned(),
        values: values.collect(),
        places: places.collect(),
        before: bands(&times, 0.45, 2.4),
        after: bands(&times, 1.0, 0.5),
        track: (x.clone(), x.iter().map(|x| height(*x)).collect()),
        marked: vec![mark.map(|x| (x, height(x))).collect()],
        times,
    }
}

fn force(axis: Axis, end: f64, middle: f64, log: f64) -> FreeForce {
    let step = end / CELLS as f64;
    let at: Vec<f64> = (0..CELLS).map(|i| step * (i as f64 + 0.5)).collect();
    let hump = |x: f64| -0.95 * (-((x - middle) / (0.09 * end)).powi(4)).exp();
    let band = Band {
        mean: at.iter().map(|x| hump(*x) + 0.1 * (x / step).sin()).collect(),
        sd: at.iter().map(|x| 0.12 + 0.2 * (x / end).powi(4)).collect(),
        width: 2.9,
    };
    let whole = Band {
        mean: band.mean.iter().map(|mean| mean - 0.15).collect(),
        sd: band.sd.iter().map(|sd| sd.hypot(0.3)).collect(),
        width: 2.2,
    };
    FreeForce {
        process: Process(0.0, 0.0),
        axis,
        band,
        whole: Some(whole),
        draws: vec![],
        log_bayes_factor: log,
        se: 0.05,
        own: vec![],
        looks: vec![],
        at,
    }
}

fn improvement() -> Improvement {
    let pair = |before, after| BeforeAfter { before, after };
    Improvement {
        log10_bayes_factor: 21.3,
        rmse: pair(1.9, 0.31),
        elpd: pair(-130.1, -70.4),
        heldout_rmse: pair(2.2, 0.35),
        coverage90: pair(0.5, 0.9),
        ljung_box_p: pair(1e-9, 0.4),
        least_squares: pair(1.85, 0.30),
        stationary_sd: pair(f64::NAN, f64::NAN),
    }
}

fn corrected() -> Corrected {
    Corrected {
        equation: vec![
            "du/dt = g sin(theta) - mu g cos(theta) - g/xi u^2".to_owned(),
            "        - delta_mu g cos(theta) from 132 m over 55 m".to_owned(),
        ],
        model: "model! {\n    fn corrected(event: &Event) {\n        mu ~ \
                Gamma(9, 0.03);\n        let law = Voellmy { mu, xi };\n    \
                }\n}"
            .to_owned(),
        labels: vec!["friction-patch".to_owned()],
        noise: None,
    }
}

fn mismatch() -> Mismatch {
    Mismatch {
        axis: Axis::Place,
        from: 131.8,
        to: 187.1,
        time_from: 8.1,
        time_to: 10.6,
        place_from: 131.8,
        place_to: 187.1,
        specific_force: -0.9,
        specific_force_q05: -1.2,
        specific_force_q95: -0.6,
        delta_mu: 0.14,
        probability: 0.99,
        parts: vec![],
    }
}

fn law() -> LawParameters {
    let of = |mu: (f64, f64), xi: (f64, f64)| {
        let mu = parameter("mu", "1", mu.0, mu.1);
        vec![mu, parameter("xi", "m/s2", xi.0, xi.1)]
    };
    LawParameters {
        as_it_was: of((0.26, 0.01), (1050.0, 130.0)),
        corrected: of((0.213, 0.012), (1410.0, 220.0)),
        with_free_form_force: of((0.22, 0.03), (1380.0, 310.0)),
    }
}

/// A patch of higher friction, found.
pub(super) fn diagnosis() -> Diagnosis {
    Diagnosis {
        event: "Patch (synthetic)".to_owned(),
        baseline: Baseline {
            priors: vec![("mu".into(), "Gamma(9, 0.03)".into())],
            friction: "voellmy".to_owned(),
            noise: "iid".to_owned(),
            log_evidence: -120.3,
            rmse: 1.9,
            ljung_box_p: 1e-9,
            shapiro_wilk_p: 0.2,
            predictive_p: 0.03,
            ..Baseline::default()
        },
        verdict: Verdict::MissingPhysics,
        seed: 1,
        mismatch: vec![mismatch()],
        mechanisms: mechanisms(),
        noise: noises(),
        selected: vec!["friction-patch".to_owned()],
        selected_noise: "iid".to_owned(),
        group: vec!["friction-patch".to_owned()],
        improvement: improvement(),
        parameters: parameters(),
        law: law(),
        rest: Some(Rest { specific_force_sd: 0.05, specific_force_q95: 0.12 }),
        corrected: corrected(),
        forces: vec![
            force(Axis::Place, 260.0, 160.0, 44.0),
            force(Axis::Time, 18.0, 9.4, 41.5),
            force(Axis::Speed, 26.0, 16.0, 12.1),
        ],
        pictured: vec![pictured()],
        seconds: 6.2,
        ..Diagnosis::default()
    }
}

fn parameters() -> Vec<ParameterSummary> {
    vec![
        parameter("friction-patch.delta_mu", "1", 0.139, 0.017),
        parameter("friction-patch.from", "m", 131.9, 1.8),
        parameter("friction-patch.length", "m", 55.1, 4.0),
        parameter("mu", "1", 0.213, 0.012),
        parameter("xi", "m/s2", 1410.0, 220.0),
        parameter("sigma2", "m2/s2", 0.096, 0.015),
    ]
}

fn noises() -> Vec<JudgedNoise> {
    let of = |name: &str, probability, log10_bayes_factor| JudgedNoise {
        name: name.to_owned(),
        probability,
        log10_bayes_factor,
        parameters: vec![parameter("sigma2", "m2/s2", 0.096, 0.015)],
        ..JudgedNoise::default()
    };
    vec![of("iid", 0.7, 0.0), of("ou", 0.3, -0.4)]
}

/// Nothing is missing.
pub(super) fn adequate() -> Diagnosis {
    let mut d = diagnosis();
    d.verdict = Verdict::Adequate;
    d.mismatch.clear();
    d.selected.clear();
    d.group.clear();
    d.mechanisms.rotate_left(6);
    let rest = [0.0016; 12].into_iter();
    let shares = [0.97, 0.006, 0.004].into_iter().chain(rest);
    for (m, p) in d.mechanisms.iter_mut().zip(shares) {
        m.probability = p;
        m.log10_bayes_factor = if m.name == "none" { 0.0 } else { -0.7 };
    }
    d.improvement = Improvement {
        log10_bayes_factor: f64::NAN,
        rmse: BeforeAfter { before: f64::NAN, after: f64::NAN },
        ..improvement()
    };
    d.baseline.rmse = 0.3;
    d.baseline.ljung_box_p = 0.4;
    d.baseline.predictive_p = 0.5;
    d.parameters.drain(..3);
    d.corrected.labels.clear();
    d.pictured[0].marked.clear();
    d.pictured[0].after = Bands::default();
    d
}

/// The same, with another verdict and another mechanism at its head.
pub(super) fn of(verdict: Verdict, head: &str) -> Diagnosis {
    let mut d = diagnosis();
    d.verdict = verdict;
    d.mechanisms.sort_by_key(|m| m.name != head);
    d.mechanisms[0].probability = 0.8;
    d.mechanisms[1].probability = 0.1;
    d.selected = match verdict {
        Verdict::Unexplained => vec![],
        _ => vec![head.to_owned()],
    };
    d.parameters.drain(..3);
    d
}

/// Nothing is missing, but the errors are not those named.
fn other_errors() -> Diagnosis {
    let mut d = adequate();
    d.verdict = Verdict::Errors;
    d.noise.reverse();
    d.noise[0].log10_bayes_factor = 4.2;
    d.selected_noise = d.noise[0].name.clone();
    d.improvement = improvement();
    d.corrected.noise = Some(d.selected_noise.clone());
    d
}

/// One of each verdict, and a pair, several recordings and an AR(1) that
/// swallowed the physics.
pub(super) fn all() -> Vec<Diagnosis> {
    let mut rich = diagnosis();
    rich.event = "C10 + C01 + C07".to_owned();
    rich.baseline.noise = "ar(1)".to_owned();
    rich.baseline.stationary_sd = Some(7.2);
    rich.baseline.innovation_sd = Some(0.4);
    rich.baseline.instrument = Some(0.1);
    rich.selected.push("clock-offset".to_owned());
    rich.parameters.push(parameter("clock-offset.ahead", "s", 0.8, 0.1));
    rich.group =
        ["friction-patch", "entrainment", "surge"].map(str::to_owned).to_vec();
    rich.separating =
        Some("A release from higher up would tell them apart.".to_owned());
    rich.mismatch[0].parts = vec![(131.8, 160.0, -1.1), (160.0, 187.1, 0.3)];
    rich.mismatch.push(rich.mismatch[0].clone());
    rich.pictured.push(Pictured { event: "C01".to_owned(), ..pictured() });
    rich.warnings = vec!["one climb failed".to_owned(), "x".to_owned()];
    let empty =
        Diagnosis { verdict: Verdict::MissingPhysics, ..Diagnosis::default() };
    vec![
        diagnosis(),
        adequate(),
        of(Verdict::Measurement, "clock-offset"),
        of(Verdict::Measurement, "initial-velocity"),
        other_errors(),
        of(Verdict::Unexplained, "unknown"),
        rich,
        Diagnosis::default(),
        empty,
    ]
}
