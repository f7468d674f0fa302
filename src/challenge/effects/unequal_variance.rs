//! Errors that are larger in one part of the recording: at high speed, or
//! after a time.

use rand::RngExt;

use super::{Class, Effect, Kind, Scene, Void, log_normal_density, normal};
use crate::seed::Rng;

/// Sized by the natural logarithm of the largest over the smallest standard
/// deviation: from 3 to 6 times.
pub(super) const KIND: Kind = Kind {
    name: "unequal-variance",
    class: Class::Errors,
    range: (1.1, 1.8),
    signed: false,
    unit: "1",
    coulomb_only: false,
    void: Void::Never,
    make,
};

#[derive(Debug)]
struct Unequal {
    /// The logarithm of the ratio.
    growth: f64,
    /// From which share of the values on; by speed where there is none.
    after: Option<f64>,
}

fn make(scene: &Scene<'_>, rng: &mut Rng) -> Option<Box<dyn Effect>> {
    let (by_speed, share) = (rng.random_bool(0.5), rng.random_range(0.3..0.7));
    let after = (!by_speed).then_some(share);
    Some(Box::new(Unequal { growth: scene.size, after }))
}

impl Unequal {
    /// The standard deviation of each value, their root mean square `sd`.
    fn deviations(&self, sd: f64, values: &[f64]) -> Vec<f64> {
        let most = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let count = values.len() as f64;
        let part = |(i, value): (usize, &f64)| match self.after {
            Some(share) => f64::from(i as f64 >= share * count),
            None => (value / most).clamp(0.0, 1.0),
        };
        let own: Vec<f64> = values
            .iter()
            .enumerate()
            .map(|place| (self.growth * part(place)).exp())
            .collect();
        let square = own.iter().map(|x| x * x).sum::<f64>() / count;
        own.iter().map(|own| sd * own / square.sqrt()).collect()
    }
}

impl Effect for Unequal {
    fn noise(&self, sd: f64, values: &[f64], rng: &mut Rng) -> Vec<f64> {
        let normal = normal(values.len(), rng).into_iter();
        let own = self.deviations(sd, values);
        normal.zip(&own).map(|(z, own)| own * z).collect()
    }

    fn log_density(&self, sd: f64, errors: &[f64], values: &[f64]) -> f64 {
        let own = self.deviations(sd, values);
        let pairs = errors.iter().zip(&own);
        pairs.map(|(e, own)| log_normal_density(*e, *own)).sum()
    }
}
