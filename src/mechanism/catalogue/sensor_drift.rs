//! A sensor that drifts with time.

use super::{DRIFT, or};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A sensor that drifts with time.
#[derive(Debug, Clone, Copy)]
pub struct SensorDrift {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for SensorDrift {
    fn name(&self) -> &'static str {
        "sensor-drift"
    }

    fn family(&self) -> Family {
        Family::Measurement
    }

    fn noun(&self, amplitude: f64) -> Noun {
        Noun::one(or(
            amplitude,
            [
                "a sensor that drifts up",
                "a sensor that drifts down",
                "a sensor that drifts",
            ],
        ))
    }

    fn says(&self) -> &'static str {
        "The sensor drifts: it shows more and more, or less and less, than there is."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let scale = DRIFT / self.extent.duration;
        vec![Unknown::amplitude(
            "drift",
            self.extent.rate_unit,
            AnyPrior::Normal(0.0, scale),
        )]
    }

    fn formula(&self) -> String {
        "value + drift t".to_owned()
    }
}

impl Missing for SensorDrift {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        Change { drift: values[0], ..Change::default() }
    }
}
