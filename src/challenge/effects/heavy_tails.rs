//! Errors of Student's t distribution: outliers among good values.

use rand_distr::{ChiSquared, Distribution};

use super::{Class, Effect, Kind, Scene, Void, normal};
use crate::seed::Rng;

/// Sized by 1/nu: from 4 to 2 degrees of freedom.
pub(super) const KIND: Kind = Kind {
    name: "heavy-tails",
    class: Class::Noise,
    range: (0.25, 0.5),
    signed: false,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Tails {
    /// 1/nu; 0 for normal errors.
    weight: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Tails { weight: scene.size }))
}

impl Effect for Tails {
    /// `sd` is the scale of the good values.
    fn noise(&self, sd: f64, values: &[f64], rng: &mut Rng) -> Vec<f64> {
        let normal = normal(values.len(), rng);
        let nu = 1.0 / self.weight;
        let chi = ChiSquared::new(nu).ok().filter(|_| nu.is_finite());
        let Some(chi) = chi else {
            return normal.into_iter().map(|z| sd * z).collect();
        };
        let t = |z: f64| z / (chi.sample(rng) * self.weight).sqrt();
        normal.into_iter().map(t).map(|t| sd * t).collect()
    }
}
