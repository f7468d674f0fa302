//! Errors of Student's t distribution: outliers among good values.

use std::f64::consts::PI;

use rand_distr::{ChiSquared, Distribution};

use super::{Class, Effect, Kind, Scene, Void, normal};
use crate::seed::Rng;

/// Sized by 1/nu: from 4 to 2 degrees of freedom.
pub(super) const KIND: Kind = Kind {
    name: "heavy-tails",
    class: Class::Errors,
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

    fn log_density(&self, sd: f64, errors: &[f64], _: &[f64]) -> f64 {
        let nu = 1.0 / self.weight;
        let log_area = area(nu).ln();
        let one = |e: &f64| {
            let z2 = (e / sd).powi(2);
            -0.5 * (nu + 1.0) * (z2 / nu).ln_1p() - log_area - sd.ln()
        };
        errors.iter().map(one).sum()
    }
}

/// The integral of (1 + x2/nu)^(-(nu + 1)/2): with x = sqrt(nu) tan(a) that
/// of sqrt(nu) cos(a)^(nu - 1), by the midpoint rule.
fn area(nu: f64) -> f64 {
    const PARTS: u32 = 2000;
    let width = PI / f64::from(PARTS);
    let at = |i: u32| -0.5 * PI + (f64::from(i) + 0.5) * width;
    let all: f64 = (0..PARTS).map(|i| at(i).cos().powf(nu - 1.0)).sum();
    nu.sqrt() * width * all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_is_known_for_two_degrees_of_freedom() {
        // The density at 0 is 1/(2 sqrt 2).
        assert!((area(2.0) - 8.0_f64.sqrt()).abs() < 1e-5);
    }
}
