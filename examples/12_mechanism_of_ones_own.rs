//! A mechanism of one's own, weighed with the others: two gullies, known from
//! the map, in which dry friction differs. Synthetic.
use couloir::diagnosis::{Options, diagnose, summary};
use couloir::mechanism::catalogue::Catalogue;
use couloir::mechanism::{
    Candidate, Change, Extent, Family, Missing, Noun, Unknown,
};
use couloir::physics::forces::{Axis, Term};
use couloir::{model::With, prelude::*, prior::AnyPrior};

/// Dry friction that differs in two gullies, by the same amount.
#[derive(Debug)]
struct Gullies {
    extent: Extent,
}

impl Candidate for Gullies {
    fn name(&self) -> &'static str {
        "gullies"
    }
    fn family(&self) -> Family {
        Family::Physics
    }
    fn noun(&self, _amplitude: f64) -> Noun {
        Noun::one("other friction in the gullies")
    }
    fn says(&self) -> &'static str {
        "In both gullies the dry friction is higher or lower than elsewhere."
    }
    fn unknowns(&self) -> Vec<Unknown> {
        let prior = AnyPrior::Normal(0.0, 0.15);
        vec![Unknown::amplitude("delta_mu", "1", prior)]
    }
    fn formula(&self) -> String {
        "- delta_mu g cos(theta) in the gullies".to_owned()
    }
}

impl Missing for Gullies {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { mu: values[0], ..Rate::default() };
        let gully = |from: f64, to: f64| {
            let edges = [from, to].map(Real::new);
            let term = Term::between(Axis::Place, edges, rate);
            Change::force(&self.extent, term)
        };
        gully(40.0, 60.0).and(&gully(120.0, 150.0))
    }
}

model! {
    struct Dry { event: Event }
    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 0.1) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() -> Result<()> {
    // 1. The data: speeds with errors of 0.2 m/s, and 0.2 more friction in
    // the gullies.
    let times = (1..30).map(|i| 0.5 * f64::from(i)).collect();
    let plan = Event::on(Track::incline(30.0, 900.0)?)
        .named("Two gullies (synthetic)")
        .velocity(Series::velocity(times, vec![10.0; 29])?);
    let mut model = Dry::new(plan.build()?);
    let gullies = Gullies { extent: model.event.extent() };
    let truth = With::new(&model, &[&gullies]);
    let seen = simulate(&truth, &[0.2, 0.3, 0.04], Seed::new(1))?;
    model.event = model.event.with_recording(seen[0].clone())?;
    // 2. What is looked for: the catalogue, and the gullies.
    let catalogue = Catalogue::default()
        .with(|extent| Box::new(Gullies { extent: *extent }));
    let options = Options::default().with_catalogue(catalogue);
    // 3. The inference. The model itself says which law and noise it has.
    let found = diagnose(&model, &model.event, &options, &Quiet)?;
    println!("{}", summary(&found, 80)); // 4. The result
    Ok(())
}
