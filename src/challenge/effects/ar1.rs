//! Errors of which each takes over a part of the one before.

use super::{Class, Effect, Kind, Scene, Void, log_normal_density, normal};
use crate::seed::Rng;

/// Sized by phi, the part taken over from value to value.
pub(super) const KIND: Kind = Kind {
    name: "ar1",
    class: Class::Errors,
    range: (0.5, 0.9),
    signed: false,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Correlated {
    phi: f64,
}

fn make(scene: &Scene<'_>, _: &mut Rng) -> Option<Box<dyn Effect>> {
    Some(Box::new(Correlated { phi: scene.size }))
}

impl Effect for Correlated {
    /// `sd` is the stationary one.
    fn noise(&self, sd: f64, values: &[f64], rng: &mut Rng) -> Vec<f64> {
        let fresh = sd * (1.0 - self.phi * self.phi).sqrt();
        let mut last = None;
        normal(values.len(), rng)
            .into_iter()
            .map(|z| {
                let error = match last {
                    Some(last) => self.phi * last + fresh * z,
                    None => sd * z,
                };
                last = Some(error);
                error
            })
            .collect()
    }

    fn log_density(&self, sd: f64, errors: &[f64], _: &[f64]) -> f64 {
        let fresh = sd * (1.0 - self.phi * self.phi).sqrt();
        let first = errors.first().map(|e| log_normal_density(*e, sd));
        let step = |pair: &[f64]| {
            log_normal_density(pair[1] - self.phi * pair[0], fresh)
        };
        first.unwrap_or(0.0) + errors.windows(2).map(step).sum::<f64>()
    }
}
