//! Several avalanches: one law for all, one each, or each from a common
//! distribution. Arguments: event folders, `FOLDER=METRES` with a distance.
use couloir::{elpd, io, prelude::*};

// 2. The model: laws in turn, with a common distribution unknown or given.
model! {
    struct Together { events: Vec<Event>, laws: usize, unknown: usize }
    mu_centre[unknown] ~ Normal(-0.65, 0.3); mu_spread[unknown] ~ HalfNormal(0.2);
    xi_centre[unknown] ~ Normal(8.3, 0.6); xi_spread[unknown] ~ HalfNormal(0.4);
    law[i in 0..laws] ~ Voellmy {
        mu: LogNormal(or(&mu_centre, -0.65), or(&mu_spread, 0.36)),
        xi: LogNormal(or(&xi_centre, 8.3), or(&xi_spread, 0.72)),
    };
    errors ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2: InverseGamma(2.0, 0.1) };
    tape ~ Iid { sigma2 = 100.0 };
    likelihood { for (i, event) in events.iter().enumerate() {
        let flow = event.slide(&law[i % laws])?;
        event.velocity ~ flow.velocity() + errors;
        if !event.position.is_empty() { event.position ~ flow.position() + tape; }
    } }
}

fn or<K: Kind>(unknown: &[Real<K>], given: f64) -> Real<K> {
    unknown.first().copied().unwrap_or(given.into())
}
fn read(text: &str) -> Result<Event> {
    let (folder, far) = text.split_once('=').unzip();
    let event = io::load(folder.unwrap_or(text).as_ref(), &Laws::default())?;
    let Some(far) = far else { return Ok(event.event) };
    let far = far.parse().map_err(|_| Error::input("not FOLDER=METRES"))?;
    let end = event.event.velocity.times().last().copied();
    let far = Series::position(end.into_iter().collect(), vec![far])?;
    event.event.with_recording(far)
}
fn synthetic() -> Result<Vec<Event>> {
    println!("No event folders given: three synthetic events.\n");
    let times = (1..31).map(f64::from).collect();
    let plan = Event::on(Track::incline(38.0, 3000.0)?)
        .velocity(Series::velocity(times, vec![0.0; 30])?);
    let plan = Together::new(vec![plan.build()?; 3], 3, 0);
    let truth = [0.5, 4000.0, 0.55, 3000.0, 0.6, 5000.0, 0.5, 0.3];
    let seen = simulate(&plan, &truth, Seed::new(1))?.into_iter();
    seen.map(|one| plan.events[0].with_recording(one)).collect()
}
fn main() -> Result<()> {
    let given: Vec<String> = std::env::args().skip(1).collect(); // 1. The data
    let events = given.iter().map(|g| read(g)).collect::<Result<Vec<_>>>()?;
    let events = if given.is_empty() { synthetic()? } else { events };
    for (laws, unknown) in [(1, 0), (events.len(), 0), (events.len(), 1)] {
        let model = Together::new(events.clone(), laws, unknown);
        let posterior = Posterior::new(&model)?; // 3. The inference
        let found = infer(&Smc::default(), &posterior, Seed::new(1), &Quiet)?;
        let Some(draws) = &found.draws else { continue };
        let loo = elpd::leave_one_out(&posterior, draws)?; // 4. The result
        let (elpd, se) = (loo.elpd, loo.se);
        println!("laws: {laws}\n{found}elpd {elpd:.1} +- {se:.1}\n");
    }
    Ok(())
}
