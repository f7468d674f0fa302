//! Parameters of many events drawn from one population: in two stages, from
//! the events' own posteriors, beside the joint posterior of all events and
//! the population at once. Synthetic data.
//!
//! ```sh
//! cargo run --release --example 19_population
//! cargo run --release --example 19_population -- ranks 200
//! cargo run --release --example 19_population -- survey FOLDER 1000
//! couloir sweep FOLDER --verb calibrate --out swept -- --quick
//! couloir population swept
//! ```

use std::path::Path;

use couloir::draws::{Draws, summarise};
use couloir::infer::backend;
use couloir::population::{Member, pool};
use couloir::prelude::*;
use couloir::prior::AnyPrior;
use couloir::rand::RngExt;
use couloir::rand_distr::StandardNormal;
use couloir::{Seed, io};

/// The population that is to be found: means and standard deviations of
/// ln mu and of ln xi.
const MEANS: [f64; 2] = [-1.35, 6.9];
const SPREADS: [f64; 2] = [0.2, 0.3];

// An event alone, under priors of its own; its errors are known to have a
// standard deviation of 1 m/s.
model! {
    struct Alone { event: Event }

    friction ~ Voellmy { mu: LogNormal(-1.4, 0.6), xi: LogNormal(7.0, 0.8) };
    errors ~ Iid { sigma2 = 1.0 };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

// All of them, with the priors of mean and spread that `pool` makes of those.
model! {
    struct Joint { events: Vec<Event> }

    mean_mu ~ Normal(-1.4, 0.6);
    spread_mu ~ HalfNormal(0.6);
    mean_xi ~ Normal(7.0, 0.8);
    spread_xi ~ HalfNormal(0.8);
    friction[i in 0..events.len()] ~ Voellmy {
        mu: LogNormal(mean_mu, spread_mu),
        xi: LogNormal(mean_xi, spread_xi),
    };
    errors ~ Iid { sigma2 = 1.0 };

    likelihood {
        for (event, friction) in events.iter().zip(&friction) {
            let flow = event.slide(friction)?;
            event.velocity ~ flow.velocity() + errors;
        }
    }
}

/// A slope that grows less steep, of another steepness for each event, and
/// its recording, synthetic; `None` where the mass leaves the slope.
fn event(number: u64) -> Result<Option<Event>> {
    let mut rng = Seed::new(19).child(number).rng();
    let steep = 0.65 + 0.25 * rng.random::<f64>();
    let place = |k: usize| {
        let z: f64 = rng.sample(StandardNormal);
        (MEANS[k] + SPREADS[k] * z).exp()
    };
    let truth = [0, 1].map(place);
    let (x, z) =
        ([0.0, 400.0, 4000.0], [0.0, -400.0 * steep, -2200.0 * steep]);
    let times: Vec<f64> = (1..=25).map(f64::from).collect();
    let count = times.len();
    let plan = Event::on(Track::from_points(&x, &z)?)
        .named("Synthetic event of a population")
        .depth(1.5)
        .velocity(Series::velocity(times, vec![0.0; count])?)
        .build()?;
    let errors = Seed::new(20).child(number);
    let seen = simulate(&Alone::new(plan.clone()), &truth, errors)?;
    let speeds = seen[0].values().iter().map(|v| v.max(0.0)).collect();
    Ok(plan.with_recording(plan.velocity.with_values(speeds)?).ok())
}

fn events(count: usize) -> Result<Vec<Event>> {
    let made = (0..2 * count as u64).map(event);
    let made = made.collect::<Result<Vec<_>>>()?;
    Ok(made.into_iter().flatten().take(count).collect())
}

/// An event's own posterior.
fn member(number: usize, event: &Event) -> Result<Member> {
    let model = Alone::new(event.clone());
    let posterior = Posterior::new(&model)?;
    let backend = MetropolisHastings::default();
    let seed = Seed::new(1).child(number as u64);
    let found = infer(&backend, &posterior, seed, &Quiet)?;
    let all = found.draws.ok_or(Error::inference("no draws"))?;
    let rows = all.thinned(600).concat();
    let mut draws = Draws::new(all.names().to_vec(), all.units().to_vec())?;
    draws.push_chain(rows, None)?;
    let priors = ["LogNormal(-1.4, 0.6)", "LogNormal(7, 0.8)"];
    let priors = priors.map(AnyPrior::parse).into_iter();
    let priors = priors.collect::<Result<_>>()?;
    Ok(Member { name: format!("event {number}"), draws, priors })
}

/// Both ways on the same twenty events.
fn beside(count: usize) -> Result<()> {
    let events = events(count)?;
    let members = events.iter().enumerate().map(|(i, e)| member(i, e));
    let members = members.collect::<Result<Vec<_>>>()?;
    let pooled = pool(&members, Seed::new(2), &Quiet)?;
    let two = summarise(&pooled.draws);
    let truth = [MEANS[0], SPREADS[0], MEANS[1], SPREADS[1]];
    println!("{count} synthetic events, two stages; true: {truth:?}");
    for figure in &two {
        println!("{:12} {:.3} ± {:.3}", figure.name, figure.mean, figure.sd);
    }
    println!("warnings: {:?}", pooled.warnings);
    // In 44 dimensions, of which the gradient is needed.
    let effort = Effort::new().draws(2_000).warmup(1_000);
    let Ok(nuts) = backend("nuts", &effort) else {
        println!("the joint posterior needs --features nuts");
        return Ok(());
    };
    let joint = Joint::new(events);
    let posterior = Posterior::new(&joint)?;
    let found = infer(nuts.as_ref(), &posterior, Seed::new(3), &Quiet)?;
    let joint = found.draws.ok_or(Error::inference("no draws"))?;
    let one = summarise(&joint);
    println!("\njoint");
    for figure in one.iter().filter(|s| !s.name.contains('[')) {
        println!(
            "{:12} {:.3} ± {:.3} (R-hat {:.3}, ess {:.0})",
            figure.name, figure.mean, figure.sd, figure.rhat, figure.ess_bulk
        );
    }
    for (k, name) in ["mu", "xi"].into_iter().enumerate() {
        let apart = pooled.members.iter().enumerate().map(|(i, member)| {
            let own = one
                .iter()
                .find(|s| s.name.contains(&format!("{name}[{}]", i + 1)));
            own.map_or(f64::NAN, |own| {
                (member.pooled[k][1] - own.q50).abs() / own.sd
            })
        });
        let worst = apart.fold(0.0, f64::max);
        println!("{name}: medians of events at most {worst:.2} sd apart");
    }
    Ok(())
}

/// Simulation-based calibration where everything is known: members are normal
/// about their values, and drawn from exactly.
fn ranks(replications: u64) -> Result<()> {
    let mut counts = [[0; 10]; 2];
    for replication in 0..replications {
        let seed = Seed::new(100).child(replication);
        let mut rng = seed.rng();
        let mut z = || -> f64 { rng.sample(StandardNormal) };
        // The priors that `pool` makes of Normal(1, 2).
        let truth = [1.0 + 2.0 * z(), 2.0 * z().abs()];
        let mut members = Vec::new();
        for number in 0..15 {
            let seen = truth[0] + truth[1] * z() + z();
            let share = 4.0 / (4.0 + 1.0);
            let (mean, sd) = (1.0 + share * (seen - 1.0), share.sqrt());
            let all = (0..400).map(|_| mean + sd * z()).collect();
            let mut draws = Draws::new(vec!["a".into()], vec!["1".into()])?;
            draws.push_chain(all, None)?;
            let priors = vec![AnyPrior::parse("Normal(1, 2)")?];
            members.push(Member { name: format!("{number}"), draws, priors });
        }
        let found = pool(&members, seed, &Quiet)?;
        for (k, truth) in truth.into_iter().enumerate() {
            let own = found.draws.pooled(k);
            let below = own.iter().filter(|x| **x < truth).count();
            counts[k][(10 * below / own.len()).min(9)] += 1;
        }
    }
    println!("tenths of {replications} ranks: mean {:?}", counts[0]);
    println!("                            spread {:?}", counts[1]);
    Ok(())
}

/// Event folders for `couloir sweep`.
fn survey(folder: &Path, count: usize) -> Result<()> {
    for (number, event) in events(count)?.iter().enumerate() {
        let (x, z) = event.track().points();
        let points = x.iter().zip(z).map(|(x, z)| format!("{x},{z}\n"));
        let track = format!("x,z\n{}", points.collect::<String>());
        let series = &event.velocity;
        let values = series.times().iter().zip(series.values());
        let values = values.map(|(t, v)| format!("{t},{v:.3}\n"));
        let recording = format!("t,velocity\n{}", values.collect::<String>());
        let toml = "name = \"Synthetic event of a population\"\n\
                    [track]\nfile = \"track.csv\"\n\
                    [release]\nx = 0.0\nvelocity = 0.0\n\
                    [flow]\ndepth = 1.5\n\
                    [recording]\nfile = \"recording.csv\"\n\
                    quantity = \"velocity\"\n\
                    [model]\nfriction = \"voellmy\"\nnoise = \"iid\"\n\
                    [priors]\nmu = \"LogNormal(-1.4, 0.6)\"\n\
                    xi = \"LogNormal(7, 0.8)\"\n";
        let files = [
            ("event.toml", toml.to_owned()),
            ("track.csv", track),
            ("recording.csv", recording),
        ];
        io::write_all(&folder.join(format!("event-{number:05}")), &files)?;
    }
    println!("{}: {count} synthetic events", folder.display());
    Ok(())
}

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, none: usize| {
        words.get(at).and_then(|word| word.parse().ok()).unwrap_or(none)
    };
    match words.first().map(String::as_str) {
        Some("ranks") => ranks(number(1, 200) as u64),
        Some("survey") => {
            let folder = words.get(1).map_or("survey", String::as_str);
            survey(Path::new(folder), number(2, 1000))
        }
        _ => beside(20),
    }
}
