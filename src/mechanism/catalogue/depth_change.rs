//! A flow whose depth changes along the run.

use super::{FORCE, Rate, everywhere, or};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::physics::forces::{Axis, Range, Shape};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// A depth that grows or falls along the run, in a law whose drag is
/// g u^2/(xi h) (Voellmy 1955): the drag's coefficient g/(xi h) changes
/// steadily, by so much until the run's end.
#[derive(Debug, Clone, Copy)]
pub struct DepthChange {
    /// What its prior is scaled to.
    pub extent: Extent,
}

impl Candidate for DepthChange {
    fn name(&self) -> &'static str {
        "depth-change"
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, amplitude: f64) -> Noun {
        Noun::one(or(
            amplitude,
            [
                "a flow that gets shallower (more drag)",
                "a flow that gets deeper (less drag)",
                "a flow whose depth changes",
            ],
        ))
    }

    fn says(&self) -> &'static str {
        "The flow gets deeper or shallower along the run, and its drag \
         changes with it."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let scale = FORCE / self.extent.speed.powi(2);
        let amplitude = AnyPrior::Normal(0.0, scale);
        vec![Unknown::amplitude("delta_drag", "1/m", amplitude)]
    }

    fn coordinate(&self) -> Option<Axis> {
        Some(Axis::Place)
    }

    fn needs(&self) -> &'static [&'static str] {
        &["voellmy", "turbulent"]
    }

    fn formula(&self) -> String {
        "- delta_drag (s - s0)/run u^2".to_owned()
    }
}

impl Missing for DepthChange {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let Extent { begin, run, .. } = self.extent;
        let rate = Rate { quadratic: values[0], ..Rate::default() };
        let mut change = everywhere(&self.extent, rate);
        let range = Range { begin, span: run };
        for term in &mut change.forces.terms {
            term.shape = Shape::Linear(Axis::Place, range);
        }
        change
    }
}
