//! Which blocks a model has, told by the model itself.

use super::face::{Model, Point};
use super::listener::Listener;
use crate::error::Result;
use crate::scalar::Plain;

/// The names of the laws, noises and mechanisms that a model declares, each
/// once, in the order declared: "coulomb", "ar".
///
/// A diagnosis does not look for what the model has.
///
/// ```
/// use couloir::model::declared_blocks;
/// use couloir::prelude::*;
/// model! {
///     struct Dry { event: Event }
///     friction ~ Coulomb { mu: Gamma(9.0, 0.03) }
///         + Turbulent { xi = 900.0 };
///     errors ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2 = 1.0 };
///     likelihood {
///         let flow = event.slide(&friction)?;
///         event.velocity ~ flow.velocity() + errors;
///     }
/// }
/// let event = Event::on(Track::incline(35.0, 500.0)?)
///     .velocity(Series::velocity(vec![1.0, 2.0], vec![2.9, 5.6])?)
///     .build()?;
/// let blocks = declared_blocks(&Dry::new(event))?;
/// assert_eq!(blocks, ["coulomb", "turbulent", "ar"]);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// Whatever the model fails with.
pub fn declared_blocks(model: &dyn Model) -> Result<Vec<String>> {
    let mut blocks = Blocks::default();
    model.evaluate(Point::Middle, Some(&mut blocks))?;
    Ok(blocks.0)
}

#[derive(Default)]
struct Blocks(Vec<String>);

impl Listener<Plain> for Blocks {
    fn block(&mut self, name: &str) {
        if !self.0.iter().any(|known| known == name) {
            self.0.push(name.to_owned());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::mechanism::Mechanism;
    use crate::mechanism::catalogue::find;
    use crate::model::{Assembled, With};
    use crate::noise;
    use crate::observe::{Event, Series};
    use crate::physics::Track;
    use crate::physics::friction::Laws;

    #[test]
    fn a_model_by_names_tells_what_it_was_put_together_of() {
        let track = Track::incline(35.0, 500.0).unwrap();
        let seen = Series::velocity(vec![1.0, 2.0, 3.0], vec![2.0, 5.0, 8.0]);
        let event = Event::on(track).velocity(seen.unwrap()).build().unwrap();
        let extent = event.extent();
        let law = Laws::default().parse("coulomb + turbulent").unwrap();
        let noise = noise::parse("ar(2)").unwrap();
        let of = |label: &str| find(label, &extent, &[]).unwrap();
        let model = Assembled::new(event, law, noise, &BTreeMap::new())
            .and_then(|m| {
                m.with_mechanisms(vec![of("surge")], &BTreeMap::new())
            })
            .unwrap();
        let own = ["coulomb", "turbulent", "ar", "surge"];
        assert_eq!(model.blocks(), own);
        let mut found = declared_blocks(&model).unwrap();
        let mut sorted = own.map(str::to_owned);
        found.sort();
        sorted.sort();
        assert_eq!(found, sorted);
        let added: Box<dyn Mechanism> = of("cohesion");
        let more = With::new(&model, &[added.as_ref()]);
        let more = declared_blocks(&more).unwrap();
        assert_eq!(more.len(), 5);
        assert!(more.contains(&"cohesion".to_owned()));
    }
}
