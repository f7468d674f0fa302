//! A survey whose angles are all off by the same amount, distances along the
//! slope being right.

use super::{Class, Effect, Kind, Scene, Void};
use crate::challenge::ground::Ground;
use crate::seed::Rng;

/// Sized by the surveyed less the true angle.
pub(super) const KIND: Kind = Kind {
    name: "slope-bias",
    class: Class::Measurement,
    range: (2.0, 5.0),
    signed: true,
    unit: "degrees",
    coulomb_only: false,
    void: Void::OnInclineUnderCoulomb,
    make,
};

#[derive(Debug)]
struct Survey {
    /// \[radians\].
    excess: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Survey { excess: scene.size.to_radians() }))
}

impl Effect for Survey {
    fn survey(&self, true_ground: &Ground) -> Option<Ground> {
        (self.excess != 0.0).then(|| true_ground.tilted(self.excess))
    }
}
