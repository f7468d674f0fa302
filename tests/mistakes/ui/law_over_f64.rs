//! rustc: a law that computes with plain numbers.
use couloir::block::{Block, Field};
use couloir::noise::Iid;
use couloir::physics::friction::{Friction, Rate, Site, Varies};
use couloir::scalar::Plain;
use couloir::{Event, Real, model};

struct Own<S> {
    mu: S,
}

impl<S: Copy> Block<S> for Own<S> {
    const NAME: &'static str = "own";
    const FIELDS: &'static [Field] = &[Field::new("mu", "1", "Flat()")];

    fn from_values(values: &[S]) -> Self {
        Self { mu: values[0] }
    }
}

impl Friction<Plain> for Own<f64> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }

    fn rate(&self, _: &Site, _: Real<Plain>) -> Rate<Plain> {
        Rate { mu: self.mu.into(), ..Rate::default() }
    }
}

model! {
    pub struct Calibration { event: Event }

    friction ~ Own { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
