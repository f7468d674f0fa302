//! Several avalanches: one law for all, one each, or each from a common
//! distribution; by evidence, and by prediction. Arguments are event folders,
//! `FOLDER=METRES` where the distance travelled is known too.
use couloir::{elpd, io, prelude::*};

// 2. The models: speeds of one kind of sensor, distances with an sd of 10 m.
model! {
    struct Apart { events: Vec<Event>, laws: usize }
    law[i in 0..laws] ~ Voellmy { mu: LogNormal(-0.65, 0.36), xi: LogNormal(8.3, 0.72) };
    errors ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2: InverseGamma(2.0, 0.1) };
    tape ~ Iid { sigma2 = 100.0 };
    likelihood { for (i, event) in events.iter().enumerate() {
        let flow = event.slide(&law[i % laws])?;
        event.velocity ~ flow.velocity() + errors;
        if !event.position.is_empty() { event.position ~ flow.position() + tape; }
    } }
}
model! {
    struct Related { events: Vec<Event> }
    mu_centre ~ Normal(-0.65, 0.3); mu_spread ~ HalfNormal(0.2);
    xi_centre ~ Normal(8.3, 0.6); xi_spread ~ HalfNormal(0.4);
    law[i in 0..events.len()] ~ Voellmy { mu: LogNormal(mu_centre, mu_spread), xi: LogNormal(xi_centre, xi_spread) };
    errors ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2: InverseGamma(2.0, 0.1) };
    tape ~ Iid { sigma2 = 100.0 };
    likelihood { for (event, law) in events.iter().zip(&law) {
        let flow = event.slide(law)?;
        event.velocity ~ flow.velocity() + errors;
        if !event.position.is_empty() { event.position ~ flow.position() + tape; }
    } }
}

fn read(text: &String) -> Result<Event> {
    let (folder, far) = text.split_once('=').unwrap_or((text, "NaN"));
    let event = io::load(folder.as_ref(), &Laws::default())?.event;
    let bad = |_| Error::input(format!("{text}: expected FOLDER=METRES"));
    let (far, end) = (far.parse::<f64>().map_err(bad)?, event.velocity.len());
    if far.is_nan() {
        return Ok(event);
    }
    let end = vec![event.velocity.times()[end - 1]];
    event.with_recording(Series::position(end, vec![far])?)
}

/// Three slopes of a common distribution, recorded for 30 s.
fn synthetic() -> Result<Vec<Event>> {
    let silent =
        Series::velocity((1..31).map(f64::from).collect(), vec![0.0; 30])?;
    let plan = |angle| {
        Event::on(Track::incline(angle, 3e3)?).velocity(silent.clone()).build()
    };
    let plans = vec![plan(36.0)?, plan(38.0)?, plan(40.0)?];
    let truth = [0.5, 4000.0, 0.55, 3000.0, 0.6, 5000.0, 0.5, 0.3];
    let seen = simulate(&Apart::new(plans.clone(), 3), &truth, Seed::new(1))?;
    plans.iter().zip(seen).map(|(p, s)| p.with_recording(s)).collect()
}

fn main() -> Result<()> {
    // 1. The data.
    let given: Vec<String> = std::env::args().skip(1).collect();
    let events: Result<Vec<_>> = given.iter().map(read).collect();
    let events = if given.is_empty() { synthetic()? } else { events? };
    if given.is_empty() {
        println!("No event folders given: synthetic events.");
    }
    let (one, each) = (
        Apart::new(events.clone(), 1),
        Apart::new(events.clone(), events.len()),
    );
    let related = Related::new(events);
    // 3. The inference, and 4. the result.
    let models: [(&str, &dyn Model); 3] = [
        ("one law for all", &one),
        ("one law each", &each),
        ("related laws", &related),
    ];
    for (name, model) in models {
        let posterior = Posterior::new(model)?;
        let found = infer(&Smc::default(), &posterior, Seed::new(1), &Quiet)?;
        let Some(draws) = &found.draws else { continue };
        let loo = elpd::leave_one_out(&posterior, draws)?;
        println!("{name}: elpd {:.1} +- {:.1}\n{found}", loo.elpd, loo.se);
    }
    Ok(())
}
