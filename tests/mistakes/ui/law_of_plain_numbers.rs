//! rustc: a law of plain numbers, which is not generic.
use couloir::block::{Block, Field};
use couloir::noise::Iid;
use couloir::physics::friction::{Friction, Rate, Site, Varies};
use couloir::scalar::Plain;
use couloir::{Event, Real, model};

struct Own {
    mu: f64,
}

impl Block<f64> for Own {
    const NAME: &'static str = "own";
    const FIELDS: &'static [Field] = &[Field::new("mu", "1", "Flat()")];

    fn from_values(values: &[f64]) -> Self {
        Self { mu: values[0] }
    }
}

impl Friction<Plain> for Own {
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
