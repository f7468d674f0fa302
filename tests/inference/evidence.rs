//! The evidence three ways on twenty synthetic events, several of which a
//! model can explain in two places.
//!
//! `docs/evidence.md` holds the table that the slow test here prints:
//! `cargo test --release --test inference evidence -- --ignored --nocapture`.

#![allow(clippy::print_stdout, reason = "the table is what it is run for")]

use couloir::context::Context;
use couloir::infer::Evidence;
use couloir::observe::Prediction as _;
use couloir::prelude::*;
use couloir::prior::AnyPrior;
use couloir::scalar::Plain;
use couloir::{Declared, seed::Rng};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// Dry friction that differs between two places, and drag.
#[derive(Debug, Clone)]
struct Patched<S> {
    mu: S,
    /// Drag per squared speed and depth; 0 under Coulomb's law alone.
    drag: S,
    /// By how much, from where, over which length.
    patches: Vec<[S; 3]>,
    /// Whether a patch fades in and out over some metres; otherwise a piece
    /// of the track has it or not.
    smooth: bool,
}

/// Over which length a smooth patch fades \[m\].
const FADE: f64 = 10.0;

impl<K: Kind> Friction<K> for Patched<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::WithPlace
    }

    fn rate(&self, at: &Site, _: Real<K>) -> Rate<K> {
        let mut mu = self.mu;
        for [delta, begin, length] in &self.patches {
            let beyond = -(*begin - at.distance);
            mu += *delta * self.covered(beyond, *length);
        }
        let quadratic = self.drag / at.depth;
        Rate { mu, quadratic, ..Rate::default() }
    }
}

impl<K: Kind> Patched<Real<K>> {
    /// How much of a patch there is so far beyond its begin.
    fn covered(&self, beyond: Real<K>, length: Real<K>) -> Real<K> {
        if self.smooth {
            let step = |x: Real<K>| ((x / (2.0 * FADE)).tanh() + 1.0) * 0.5;
            return step(beyond) - step(beyond - length);
        }
        let inside = beyond.value() >= 0.0 && (beyond - length).value() < 0.0;
        Real::new(if inside { 1.0 } else { 0.0 })
    }
}

/// A model with one patch, whatever the truth has.
#[derive(Debug)]
struct OnePatch {
    event: Event,
    kind: Case,
}

/// What tells the twenty events apart.
#[derive(Debug, Clone, Copy)]
struct Case {
    index: u64,
    drag: bool,
    smooth: bool,
    correlated: bool,
    /// Whether the truth has two patches of which the model can have one.
    twin: bool,
}

const GRAVITY: f64 = 9.81;

/// The standard deviation of an innovation of the errors \[m/s\], and the
/// least and greatest patch of a twin: in some events the errors are small and
/// the modes steep, in the others there is less to tell the modes apart.
fn sizes(case: Case) -> (f64, std::ops::Range<f64>) {
    match case.index {
        0 | 3 | 5 | 6 | 9 | 12 | 15 | 17 => (0.35, 0.07..0.09),
        _ => (0.6, 0.05..0.06),
    }
}

impl Program for OnePatch {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        use AnyPrior::{Gamma, InverseGamma, Normal, Uniform};
        let pure = |name| Label::new(name, "1");
        let metres = |name| Label::new(name, "m");
        let mu = run.scalar(pure("mu"), Gamma(9.0, 0.03))?;
        let mut drag = Real::new(0.0);
        if self.kind.drag {
            let xi =
                run.scalar(Label::new("xi", "m/s2"), Gamma(2.5, 400.0))?;
            drag = GRAVITY / xi;
        }
        let delta = run.scalar(pure("delta_mu"), Normal(0.0, 0.1))?;
        let begin = run.scalar(metres("begin"), Uniform(0.0, 900.0))?;
        let length = run.scalar(metres("length"), Gamma(3.0, 50.0))?;
        let patches = vec![[delta, begin, length]];
        let smooth = self.kind.smooth;
        let law = Patched { mu, drag, patches, smooth };
        let law = run.declare_as("patched", law);
        let flow = self.event.slide(&law)?;
        let series = &self.event.velocity;
        let variance = Label::new("sigma2", "m2/s2");
        if self.kind.correlated {
            let phi = run.scalar(pure("phi"), Uniform(-1.0, 1.0))?;
            let sigma2 = run.scalar(variance, InverseGamma(3.0, 1.0))?;
            let phi = [phi].into_iter().collect();
            let errors = run.declare(Ar { phi, sigma2 });
            return run.observe(series, flow.velocity(), &errors);
        }
        let sigma2 = run.scalar(variance, InverseGamma(3.0, 1.0))?;
        let errors = run.declare(Iid { sigma2 });
        run.observe(series, flow.velocity(), &errors)
    }
}

/// The twenty: both laws, both kinds of edge, both noises, eight twins.
fn cases() -> Vec<Case> {
    let case = |index: u64| Case {
        index,
        drag: index.is_multiple_of(2),
        smooth: (index / 2).is_multiple_of(2),
        correlated: index / 4 % 2 == 1,
        twin: index % 5 == 1 || index % 5 == 3,
    };
    (0..20).map(case).collect()
}

/// A slope of 50 pieces: steeper where drag holds the mass back.
fn track(case: Case, rng: &mut Rng) -> Track {
    let mean = if case.drag { 29.0 } else { 20.0 };
    let (mut x, mut z) = (vec![0.0], vec![0.0]);
    for piece in 1..=50 {
        let wave: f64 = rng.random_range(-2.0..2.0);
        let angle: f64 = mean + wave;
        x.push(20.0 * f64::from(piece));
        z.push(z[piece as usize - 1] - 20.0 * angle.to_radians().tan());
    }
    Track::from_points(&x, &z).unwrap()
}

fn truth(case: Case, rng: &mut Rng) -> Patched<f64> {
    let mu = rng.random_range(0.2..0.25);
    let xi = rng.random_range(800.0..1500.0);
    let drag = if case.drag { GRAVITY / xi } else { 0.0 };
    let size = if case.twin { sizes(case).1 } else { 0.05..0.1 };
    let delta: f64 = rng.random_range(size);
    let begin = rng.random_range(100.0..200.0);
    let mut patches = vec![[delta, begin, rng.random_range(80.0..120.0)]];
    if case.twin {
        let begin = rng.random_range(500.0..600.0);
        let sign = if case.drag { 1.0 } else { -1.0 };
        let ratio = rng.random_range(0.9..1.1);
        let length = rng.random_range(80.0..120.0);
        patches.push([sign * ratio * delta, begin, length]);
    }
    Patched { mu, drag, patches, smooth: case.smooth }
}

/// The speeds of an event under a law without errors.
fn speeds(event: &Event, law: &Patched<f64>) -> Vec<f64> {
    let real = Real::<Plain>::new;
    let law = Patched {
        mu: real(law.mu),
        drag: real(law.drag),
        patches: law.patches.iter().map(|p| p.map(real)).collect(),
        smooth: law.smooth,
    };
    let context = Context::new();
    let law = Declared::new(law, &context);
    let flow = event.slide(&law).unwrap();
    let mut speeds = Vec::new();
    let series = &event.velocity;
    flow.velocity().predict(series, |v| speeds.push(v.value())).unwrap();
    speeds
}

/// An event on a track with values of 0 at so many times up to a last.
fn blank(track: &Track, last: f64, count: usize) -> Event {
    let times: Vec<f64> =
        (1..=count).map(|i| last * i as f64 / count as f64).collect();
    Event::on(track.clone())
        .depth(2.0)
        .velocity(Series::velocity(times, vec![0.0; count]).unwrap())
        .build()
        .unwrap()
}

/// When the mass has gone 850 m.
fn duration(track: &Track, law: &Patched<f64>) -> f64 {
    let long = blank(track, 120.0, 1200);
    let mut gone = 0.0;
    for (speed, time) in speeds(&long, law).iter().zip(long.velocity.times()) {
        gone += 0.1 * speed;
        if gone > 850.0 {
            return *time;
        }
    }
    panic!("the mass stops after {gone} m");
}

/// A synthetic event: the motion under two patches or one, with errors.
fn model(case: Case) -> OnePatch {
    let mut rng = Seed::new(7000 + case.index).rng();
    let track = track(case, &mut rng);
    let law = truth(case, &mut rng);
    let count = 20 + 2 * case.index as usize;
    let event = blank(&track, duration(&track, &law), count);
    let mut error = 0.0;
    let phi = if case.correlated { 0.5 } else { 0.0 };
    let values = speeds(&event, &law)
        .into_iter()
        .map(|speed| {
            let normal: f64 = StandardNormal.sample(&mut rng);
            error = phi * error + sizes(case).0 * normal;
            f64::max(speed + error, 0.0)
        })
        .collect();
    let series = event.velocity.with_values(values).unwrap();
    OnePatch { event: event.with_recording(series).unwrap(), kind: case }
}

/// What the three say of an event.
struct Findings {
    case: Case,
    values: usize,
    /// The share of the posterior whose patch begins in the first half.
    early: f64,
    /// The share whose patch begins between the two places of a twin.
    between: f64,
    smc: Vec<Evidence>,
    /// How many of these runs warned.
    warned: usize,
    importance: Vec<Evidence>,
    bridge: Vec<Evidence>,
    /// Bridge sampling on chains, and whether it warned.
    chains: (Evidence, bool),
    seconds: [f64; 3],
}

/// Runs of sequential Monte Carlo on each event.
const SEEDS: u64 = 10;

/// Independent runs of each of the three that are compared.
const COMPARED: usize = 4;

fn explore(case: Case) -> Findings {
    let model = model(case);
    let posterior = Posterior::new(&model).unwrap();
    // Of its own for each event: runs from one seed err alike.
    let seed = |seed: u64| Seed::new(seed).child(case.index);
    let run = |backend: &dyn Backend, number: u64| {
        infer(backend, &posterior, seed(number), &Quiet).unwrap()
    };
    let runs: Vec<Inference> =
        (0..SEEDS).map(|seed| run(&Smc::default(), seed)).collect();
    let sampler = ImportanceSampling::default();
    let importance: Vec<Inference> =
        (100..).take(COMPARED).map(|seed| run(&sampler, seed)).collect();
    // Bridge sampling has the draws of runs that are not compared with it.
    let on_chains = Bridge::default();
    let begun = std::time::Instant::now();
    let bridge = (200..)
        .zip(&runs[COMPARED..2 * COMPARED])
        .map(|(number, run)| {
            let draws = run.draws.as_ref().unwrap();
            on_chains.from_draws(&posterior, draws, seed(number)).unwrap().0
        })
        .collect();
    let bridged = begun.elapsed().as_secs_f64() / COMPARED as f64;
    let chains = run(&on_chains, 300);
    let begins = begins(&runs[1]);
    Findings {
        case,
        values: model.event.velocity.len(),
        early: share(&begins, |begin| begin < MIDDLE),
        between: share(&begins, |begin| (begin - MIDDLE).abs() < APART),
        warned: runs.iter().filter(|r| !r.warnings.is_empty()).count(),
        seconds: [runs[0].cost.seconds, importance[0].cost.seconds, bridged],
        smc: evidences(runs),
        importance: evidences(importance),
        bridge,
        chains: (chains.evidence.unwrap(), !chains.warnings.is_empty()),
    }
}

/// Where the patch begins, draw by draw.
fn begins(run: &Inference) -> Vec<f64> {
    let draws = run.draws.as_ref().unwrap();
    let begin = draws.names().iter().position(|name| name == "begin");
    draws.pooled(begin.unwrap())
}

fn share(begins: &[f64], within: impl Fn(f64) -> bool) -> f64 {
    let count = begins.iter().filter(|b| within(**b)).count();
    count as f64 / begins.len() as f64
}

fn evidences(runs: Vec<Inference>) -> Vec<Evidence> {
    runs.into_iter().map(|run| run.evidence.unwrap()).collect()
}

/// Between the two places where a twin has its patches \[m\].
const MIDDLE: f64 = 380.0;

/// How far about it is in between \[m\]: the places begin before 200 m and
/// after 500 m.
const APART: f64 = 60.0;

impl Findings {
    /// Whether either place has a share that a posterior must not miss.
    fn two_modes(&self) -> bool {
        self.case.twin && (0.02..0.98).contains(&self.early)
    }

    /// The mean of ln Z over the seeds.
    fn mean(&self) -> f64 {
        let sum: f64 = self.smc.iter().map(|e| e.log).sum();
        sum / self.smc.len() as f64
    }

    /// The standard deviation of ln Z over the seeds.
    fn spread(&self) -> f64 {
        let logs = self.smc.iter().map(|e| e.log);
        let n = self.smc.len() as f64;
        let mean = self.mean();
        (logs.map(|l| (l - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt()
    }

    /// The standardised differences of each pair of the three, run by run.
    fn differences(&self) -> [Vec<f64>; 3] {
        let three = [&self.smc, &self.importance, &self.bridge];
        [(0, 1), (0, 2), (1, 2)].map(|(i, j)| {
            let pairs = three[i].iter().zip(three[j]).take(COMPARED);
            pairs.map(|(a, b)| (a.log - b.log) / a.se.hypot(b.se)).collect()
        })
    }

    fn row(&self) -> String {
        let Case { index, drag, smooth, correlated, twin } = self.case;
        let word = |is: bool, yes: &'static str, no: &'static str| {
            if is { yes } else { no }
        };
        let told = |e: &Evidence| format!("{:.3} ± {:.3}", e.log, e.se);
        format!(
            "| {index} | {}, {}, {} | {} | {} | {:.2} | {:.2} | {} | {} | \
             {} | {:.3} | {:.3} | {}{} | {:.1}, {:.1}, {:.1} |",
            word(drag, "Voellmy", "Coulomb"),
            word(smooth, "smooth", "pieces"),
            word(correlated, "AR(1)", "iid"),
            self.values,
            word(self.two_modes(), "two", word(twin, "one of two", "one")),
            self.early,
            self.between,
            told(&self.smc[0]),
            told(&self.importance[0]),
            told(&self.bridge[0]),
            self.mean(),
            self.spread(),
            told(&self.chains.0),
            word(self.chains.1, ", warns", ""),
            self.seconds[0],
            self.seconds[1],
            self.seconds[2],
        )
    }
}

const HEAD: &str = "\
| event | law, edges, noise | values | modes | early | between | smc | \
importance | bridge | mean of smc | spread of smc | bridge on chains | \
seconds |
|---|---|---|---|---|---|---|---|---|---|---|---|---|";

/// The root mean square, which a standardised difference has at 1.
fn size(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
    f64::sqrt(sum / n)
}

#[test]
#[ignore = "minutes of repeated runs: cargo slow"]
fn three_estimators_of_the_evidence_agree() {
    println!("{HEAD}");
    let mut all = Vec::new();
    // Twins first: they are what the test is for.
    let mut cases = cases();
    cases.sort_by_key(|case| !case.twin);
    for case in cases {
        let findings = explore(case);
        println!("{}", findings.row());
        all.push(findings);
    }
    let pairs = ["smc - importance", "smc - bridge", "importance - bridge"];
    for (pair, name) in pairs.iter().enumerate() {
        let sd = size(all.iter().flat_map(|f| f.differences()[pair].clone()));
        println!("standardised {name}: {sd:.2}");
    }
    let stated = |f: &Findings| size(f.smc.iter().map(|e| e.se));
    let sd = size(all.iter().map(|f| f.spread() / stated(f)));
    println!("spread of smc over its stated error: {sd:.2}");
    let two = all.iter().filter(|f| f.two_modes()).count();
    println!("two modes: {two}");
    let warned: usize = all.iter().map(|f| f.warned).sum();
    println!("runs of smc that warned: {warned}");
    for f in &all {
        let far = f.differences().concat().iter().any(|d| d.abs() > 4.0);
        assert!(!far, "event {}: {:?}", f.case.index, f.differences());
        assert!(f.spread() <= 0.3, "{}: {}", f.case.index, f.spread());
    }
    for (pair, name) in pairs.iter().enumerate() {
        // Under the chi-squared law with 80 degrees 0.8 to 1.2 but for one
        // time in 100.
        let sd = size(all.iter().flat_map(|f| f.differences()[pair].clone()));
        assert!((0.8..=1.2).contains(&sd), "{name}: {sd}");
    }
    assert!(two >= 5, "{two}");
}
