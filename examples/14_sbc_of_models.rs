//! Are the probabilities of models right? A model drawn by its prior odds, a
//! recording from it, and what the diagnosis' engine says of that recording,
//! many times over. Arguments: how many recordings, `iid` or `ar`, a seed.
use std::time::Instant;

use couloir::mechanism::Mechanism;
use couloir::mechanism::catalogue::catalogue;
use couloir::model::{Program, declared_blocks};
use couloir::prelude::*;
use couloir::sbc::{Choices, Held, choices};

/// What the recordings are drawn from beside the model as it is: a force with
/// an edge, in two variants; one without; and a slip of the measurement.
const NAMES: [&str; 3] = ["friction-step", "cohesion", "clock-offset"];

model! {
    struct Independent { event: Event }
    friction ~ Coulomb { mu: Gamma(100.0, 0.003) };
    errors ~ Iid { sigma2: InverseGamma(5.0, 16.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

model! {
    struct Correlated { event: Event }
    friction ~ Coulomb { mu: Gamma(100.0, 0.003) };
    errors ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2: InverseGamma(5.0, 16.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

/// A synthetic track that no draw runs beyond, with 30 values a second apart:
/// those of a mass with a friction of 0.3, which the mechanisms' priors are
/// scaled to.
fn plan() -> Result<Event> {
    let track = Track::from_points(
        &[0.0, 200.0, 500.0, 5000.0],
        &[0.0, -140.0, -260.0, -1160.0],
    )?;
    let times: Vec<f64> = (1..=30).map(f64::from).collect();
    let zero = Series::velocity(times, vec![0.0; 30])?;
    let event = Event::on(track).velocity(zero).build()?;
    let model = Independent::new(event.clone());
    let typical = simulate(&model, &[0.3, 0.01], Seed::new(1))?;
    event.with_recording(typical[0].clone())
}

fn small_catalogue(
    event: &Event,
    program: &impl Program,
) -> Result<Vec<Box<dyn Mechanism>>> {
    let mut all = catalogue(&event.extent(), &declared_blocks(program)?);
    all.retain(|mechanism| NAMES.contains(&mechanism.name()));
    Ok(all)
}

fn study<P: Program>(
    of: impl Fn(Event) -> P + Sync,
    count: usize,
    seed: Seed,
) -> Result<Choices> {
    let event = plan()?;
    let program = of(event.clone());
    let all = small_catalogue(&event, &program)?;
    let remade =
        |seen: &[Series]| Ok(of(event.with_recording(seen[0].clone())?));
    choices(&program, &remade, &all, count, seed, &Quiet)
}

fn row(name: &str, held: &Held) {
    let Held { count, mean, expected, se, .. } = held;
    let z = held.z();
    println!(
        "| {name} | {count} | {mean:.4} | {expected:.4} | {se:.4} | {z:.2} |"
    );
}

fn told(found: &Choices) {
    println!("| figure | of | found | expected | se | z |");
    println!("|---|---|---|---|---|---|");
    for (i, name) in found.names.iter().enumerate() {
        row(&format!("mean probability of {name}"), &found.mean(i));
        row(&format!("share true of {name}"), &found.share(i));
    }
    for (from, to, held) in found.reliability() {
        row(&format!("share true given {from} to {to}"), &held);
    }
    row("log score", &found.log_score());
    println!("\nlargest |z|: {:.2}", found.largest_z());
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: u64| {
        arguments.get(i).and_then(|x| x.parse().ok()).unwrap_or(default)
    };
    let (count, seed) = (number(0, 20) as usize, Seed::new(number(2, 1)));
    let begun = Instant::now();
    let found = match arguments.get(1).map(String::as_str) {
        Some("ar") => study(Correlated::new, count, seed)?,
        _ => study(Independent::new, count, seed)?,
    };
    let wall = begun.elapsed().as_secs_f64();
    told(&found);
    let redrawn: usize = found.cases.iter().map(|case| case.redrawn).sum();
    println!("{count} recordings in {wall:.1} s; {redrawn} draws no flow\n");
    println!("With an evidence too large by e^0.7, of one model each time:\n");
    println!("| model | z of its mean | largest z |\n|---|---|---|");
    for (i, name) in found.names.iter().enumerate() {
        let wrong = found.with_error(i, f64::exp(0.7));
        let (z, largest) = (wrong.mean(i).z(), wrong.largest_z());
        println!("| {name} | {z:.2} | {largest:.2} |");
    }
    Ok(())
}
