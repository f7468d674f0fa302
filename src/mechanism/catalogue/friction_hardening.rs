//! Dry friction that changes steadily with distance or time.

use super::{FRICTION, Rate, Shape, everywhere, or, variant};
use crate::mechanism::Extent;
use crate::mechanism::{Candidate, Change, Family, Missing, Noun, Unknown};
use crate::physics::forces::{Axis, Range};
use crate::prior::AnyPrior;
use crate::scalar::{Kind, Real};

/// Dry friction that changes steadily with distance or time, in proportion
/// or towards a limit.
#[derive(Debug, Clone, Copy)]
pub struct FrictionHardening {
    /// What its priors are scaled to.
    pub extent: Extent,
    /// Distance or time.
    pub axis: Axis,
    /// Whether it tends to a limit.
    pub saturates: bool,
}

impl FrictionHardening {
    fn range(&self) -> Range {
        let Extent { begin, run, since, duration, .. } = self.extent;
        match self.axis {
            Axis::Time => Range { begin: since, span: duration },
            _ => Range { begin, span: run },
        }
    }
}

impl Candidate for FrictionHardening {
    fn name(&self) -> &'static str {
        "friction-hardening"
    }

    fn label(&self) -> String {
        variant(self)
    }

    fn family(&self) -> Family {
        Family::Physics
    }

    fn noun(&self, amplitude: f64) -> Noun {
        let how = or(amplitude, ["rises", "falls", "changes"]);
        let along = match self.axis {
            Axis::Time => "time",
            _ => "distance",
        };
        Noun::one(format!("friction that {how} steadily with {along}"))
    }

    fn says(&self) -> &'static str {
        "The dry friction rises or falls steadily as the mass goes on."
    }

    fn unknowns(&self) -> Vec<Unknown> {
        let amplitude = AnyPrior::Normal(0.0, FRICTION);
        let mut unknowns =
            vec![Unknown::amplitude("delta_mu", "1", amplitude)];
        if self.saturates {
            let span = self.range().span;
            let scale = AnyPrior::Uniform(0.02 * span, span);
            unknowns.push(Unknown::other("scale", self.axis.unit(), scale));
        }
        unknowns
    }

    fn coordinate(&self) -> Option<Axis> {
        Some(self.axis)
    }

    fn form(&self) -> Option<&'static str> {
        Some(if self.saturates { "saturating" } else { "linear" })
    }

    fn formula(&self) -> String {
        let (x, all) = match self.axis {
            Axis::Time => ("t", "duration"),
            _ => ("(s - s0)", "run"),
        };
        let shape = if self.saturates {
            format!("(1 - exp(-{x}/scale))")
        } else {
            format!("{x}/{all}")
        };
        format!("- delta_mu {shape} g cos(theta)")
    }
}

impl Missing for FrictionHardening {
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K> {
        let rate = Rate { mu: values[0], ..Rate::default() };
        let mut change = everywhere(&self.extent, rate);
        for term in &mut change.forces.terms {
            term.shape = if self.saturates {
                Shape::Saturating(self.axis, self.range(), values[1])
            } else {
                Shape::Linear(self.axis, self.range())
            };
        }
        change
    }
}
