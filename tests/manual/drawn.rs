//! The pictures of the reference: made by the library, synthetic.

use std::collections::BTreeMap;

use couloir::mechanism::{Mechanism, Role};
use couloir::model::Assembled;
use couloir::noise::{self, Grid, Noise};
use couloir::physics::Track;
use couloir::physics::friction::{LAWS, Laws};
use couloir::predict::simulate;
use couloir::prior::{AnyPrior, Distribution, NAMES};
use couloir::report::svg::{Curves, curves};
use couloir::scalar::{Plain, Real};
use couloir::{Event, Seed, Series};

use super::mechanisms;

type Curve = Vec<(f64, f64)>;

/// Whether there are pictures of such parts.
pub(crate) fn has(room: &str) -> bool {
    room != "backends"
}

/// What a picture shows.
pub(crate) fn caption(room: &str) -> &'static str {
    match room {
        "laws" => {
            "speed [m/s] over time on a synthetic parabolic slope, the law's \
             parameters at three quantiles of their default priors, beside \
             Coulomb friction of 0.25 where the law has no mu"
        }
        "mechanisms" => {
            "recorded speed [m/s] over time on a synthetic parabolic slope \
             under Voellmy friction, without the mechanism and with it"
        }
        "noises" => {
            "a steady speed of 10 m/s, and the same with synthetic errors \
             of this kind"
        }
        _ => "density of the prior for two choices of its arguments",
    }
}

/// Every picture by its path below `manual/src`.
pub(crate) fn all() -> Vec<(String, String)> {
    let mut all = Vec::new();
    for law in LAWS {
        all.push(picture("laws", law.name(), "time [s]", of_law(law.name())));
    }
    let mechanisms = mechanisms::all();
    for mechanism in mechanisms {
        let name = mechanism.name();
        let path = format!("pictures/mechanisms-{name}.svg");
        if all.iter().all(|(known, _)| *known != path) {
            let drawn = of_mechanism(mechanism);
            all.push(picture("mechanisms", name, "time [s]", drawn));
        }
    }
    for pattern in noise::names() {
        let name = pattern.split('(').next().unwrap();
        all.push(picture("noises", name, "time [s]", of_noise(name)));
    }
    for (name, arguments) in NAMES {
        let file = super::page::file_name(name);
        all.push(picture("priors", &file, "x", of_prior(name, *arguments)));
    }
    all
}

fn picture(
    room: &str,
    name: &str,
    label: &str,
    named: Vec<(String, Curve)>,
) -> (String, String) {
    let (names, lines): (Vec<String>, Vec<Curve>) = named.into_iter().unzip();
    let label = label.to_owned();
    let panel =
        Curves { label, curves: lines.into_iter().enumerate().collect() };
    let drawn = curves("curves", "Curves", caption(room), &names, &[panel]);
    (format!("pictures/{room}-{name}.svg"), drawn.svg)
}

/// A parabola that flattens out, 30 degrees at its top.
fn event(times: &[f64]) -> Event {
    let x: Vec<f64> = (0..=60).map(|i| 20.0 * f64::from(i)).collect();
    let fall = |x: &f64| 350.0 - 0.58 * x + 2.4e-4 * x * x;
    let z: Vec<f64> = x.iter().map(fall).collect();
    let places = vec![1.0; times.len()];
    Event::on(Track::from_points(&x, &z).unwrap())
        .depth(1.5)
        .velocity(Series::velocity(times.to_vec(), places).unwrap())
        .build()
        .unwrap()
}

fn times() -> Vec<f64> {
    (1..=100).map(|i| 0.6 * f64::from(i)).collect()
}

/// A law's speeds with its parameters at three quantiles.
fn of_law(name: &str) -> Vec<(String, Curve)> {
    let has_mu = ["coulomb", "voellmy", "pcm", "velocity-weakening"];
    let sum = match has_mu.contains(&name) {
        true => name.to_owned(),
        false => format!("coulomb + {name}"),
    };
    let law = Laws::default().parse(&sum).unwrap();
    let own = LAWS.iter().find(|l| l.name() == name).unwrap().fields();
    let iid = noise::parse("iid").unwrap();
    let times = times();
    let model =
        Assembled::new(event(&times), law, iid, &BTreeMap::new()).unwrap();
    let at = |p: f64| {
        let mut values: Vec<f64> = own
            .iter()
            .map(|f| AnyPrior::parse(f.prior).unwrap().quantile(p).unwrap())
            .collect();
        if sum != name {
            values.insert(0, 0.25);
        }
        values.push(1.0);
        let states = model.motion(&values, &times).unwrap();
        let speeds = states.iter().map(|s| s.speed.value());
        let line = times.iter().copied().zip(speeds).collect();
        (format!("quantile {p}"), line)
    };
    [0.25, 0.5, 0.75].map(at).to_vec()
}

/// What is recorded without a mechanism, and with a fair amount of it.
fn of_mechanism(mechanism: Box<dyn Mechanism>) -> Vec<(String, Curve)> {
    let unknowns = mechanism.unknowns();
    let value = |unknown: &couloir::mechanism::Unknown| {
        let p = if unknown.role == Role::Amplitude { 0.9 } else { 0.2 };
        unknown.prior.quantile(p).unwrap()
    };
    let with: Vec<f64> = unknowns.iter().map(value).collect();
    let amount = format!(
        "with {} = {} {}",
        unknowns[0].name,
        super::table::short(with[0]),
        if unknowns[0].unit == "1" { "" } else { unknowns[0].unit }
    );
    let mut without = with.clone();
    // Zero is the end of a prior on one side, and not within it.
    without[0] = 1e-9;
    let law = Laws::default().parse("voellmy").unwrap();
    let iid = noise::parse("iid").unwrap();
    let (times, none) = (times(), BTreeMap::new());
    let model = Assembled::new(event(&times), law, iid, &none)
        .unwrap()
        .with_mechanisms(vec![mechanism], &none)
        .unwrap();
    let recorded = |values: &[f64]| -> Curve {
        let values = [values, &[0.25, 1500.0, 1e-12]].concat();
        let made = simulate(&model, &values, Seed::new(1)).unwrap();
        times.iter().copied().zip(made.series[0].values().to_vec()).collect()
    };
    vec![
        ("without".to_owned(), recorded(&without)),
        (amount.trim().to_owned(), recorded(&with)),
    ]
}

/// A steady speed with errors of a kind.
fn of_noise(name: &str) -> Vec<(String, Curve)> {
    let (written, values): (&str, &[f64]) = match name {
        "iid" => ("iid", &[1.0]),
        "student" => ("student", &[2.0, 0.6]),
        "ar" => ("ar(1)", &[0.9, 0.2]),
        "ou" => ("ou", &[1.0, 5.0]),
        "matern32" => ("matern32", &[1.0, 5.0]),
        "white" => ("white", &[1.0]),
        "tails" => ("white + tails", &[0.4, 2.0]),
        "growth" => ("white + growth", &[0.5, 2.0]),
        other => panic!("no picture of the noise {other:?}: add its values"),
    };
    let times = times();
    let grid = Grid::new(times.clone(), None);
    let values: Vec<Real<Plain>> = values.iter().map(|&v| v.into()).collect();
    let mut errors = Vec::new();
    let mut draw = |noise: &dyn Noise<Plain>| {
        errors = noise.draw(&grid, &mut Seed::new(1).rng()).unwrap();
    };
    let entry = noise::parse(written).unwrap();
    couloir::noise::NoiseFor::<Plain>::with(&*entry, &values, &mut draw)
        .unwrap();
    let steady = times.iter().map(|t| (*t, 10.0)).collect();
    let wrong = times.iter().zip(&errors).map(|(t, e)| (*t, 10.0 + e));
    let names: Vec<String> =
        entry.parameters().into_iter().map(|(name, _)| name).collect();
    let shown = values.iter().zip(names);
    let shown: Vec<String> =
        shown.map(|(v, n)| format!("{n} = {}", v.value())).collect();
    vec![
        ("speed".to_owned(), steady),
        (format!("{written}: {}", shown.join(", ")), wrong.collect()),
    ]
}

/// Two densities.
fn of_prior(name: &str, arguments: usize) -> Vec<(String, Curve)> {
    let some: [&str; 2] = match name {
        "Normal" | "Cauchy" => ["0, 1", "1, 2"],
        "LogNormal" => ["0, 0.5", "0.5, 1"],
        "Gamma" => ["2, 1", "9, 0.3"],
        "InverseGamma" => ["2, 1", "3, 4"],
        "Uniform" => ["0, 1", "-1, 2"],
        "Beta" => ["2, 2", "2, 6"],
        "StudentT" => ["2, 0, 1", "8, 1, 2"],
        _ if arguments == 1 => ["1", "2"],
        _ => ["", ""],
    };
    let one = |text: &str| {
        let written = format!("{name}({text})");
        let prior = AnyPrior::parse(&written).unwrap();
        let density = |x: f64| {
            let at = Real::<Plain>::new(x);
            (x, prior.log_density(at).value().exp())
        };
        let places = (-400..=600).map(|i| 0.01 * f64::from(i) + 0.005);
        (written, places.map(density).collect())
    };
    let mut all: Vec<_> = some.map(one).to_vec();
    all.dedup_by(|a, b| a.0 == b.0);
    all
}
