//! What is missing from a law of one's own: friction that is lower where the
//! flow is deep, on a synthetic slope with a stretch that is rougher.
use couloir::diagnosis::{Options, diagnose, summary};
use couloir::mechanism::catalogue::find;
use couloir::{model::With, prelude::*};

/// Dry friction under a flow of depth h: r = mu/(1 + h/2 m) g cos(theta).
struct Lubricated<S> {
    mu: S,
}

impl<S: Copy> Block<S> for Lubricated<S> {
    const NAME: &'static str = "lubricated";
    const FIELDS: &'static [Field] =
        &[Field::new("mu", "1", "Gamma(9, 0.05)")];
    fn from_values(values: &[S]) -> Self {
        Self { mu: values[0] }
    }
}

impl<K: Kind> Friction<K> for Lubricated<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }
    fn rate(&self, site: &Site, _: Real<K>) -> Rate<K> {
        Rate { mu: self.mu / (1.0 + site.depth / 2.0), ..Rate::default() }
    }
}

// 2. The model.
model! {
    struct Own { event: Event }
    friction ~ Lubricated { mu: Gamma(9.0, 0.05) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 0.1) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() -> Result<()> {
    // 1. The data: speeds with errors of 0.2 m/s, and 0.2 more friction along
    // 40 m from 40 m on.
    let times = (1..25).map(|i| 0.5 * f64::from(i)).collect();
    let plan = Event::on(Track::incline(30.0, 900.0)?)
        .named("A rougher stretch (synthetic)")
        .velocity(Series::velocity(times, vec![10.0; 24])?);
    let mut own = Own::new(plan.build()?);
    let patch = find("friction-patch", &own.event.extent(), &[])?;
    let truth = With::new(&own, &[patch.as_ref()]);
    let seen = simulate(&truth, &[0.2, 40.0, 40.0, 0.4, 0.04], Seed::new(1))?;
    own.event = own.event.with_recording(seen[0].clone())?;
    // 3. The inference: of the model without the rougher stretch.
    let found = diagnose(&own, &own.event, &Options::default(), &Quiet)?;
    println!("{}", summary(&found, 80)); // 4. The result
    Ok(())
}
