//! Mechanisms: named changes with unknown amounts.
//!
//! A mechanism says its name, one plain sentence, what is unknown about it,
//! and which [`Change`] given values make. It is written as a [`Candidate`]
//! and one generic method, [`Missing::change`]; [`Mechanism`], object-safe,
//! follows from those for every kind of number.

use std::fmt::{self, Debug};
use std::ops::Range;

use super::Change;
use crate::physics::forces::Axis;
use crate::prior::AnyPrior;
use crate::scalar::{Grad, Kind, Plain, Real, Reverse, of_each_kind};

/// What sort of thing a mechanism changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// The forces on the mass.
    Physics,
    /// How the mass starts.
    Start,
    /// How the motion is measured.
    Measurement,
}

impl Family {
    /// Its name in `diagnosis.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Start => "start",
            Self::Measurement => "measurement",
        }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What an unknown is to its mechanism: what a search for its value needs to
/// know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    /// How much of the mechanism there is; at zero there is none.
    Amplitude,
    /// Where, or when, it begins: a place \[m\] or a moment \[s\].
    Edge(Axis),
    /// How long the stretch is that begins at the edge just before it.
    ///
    /// Its prior is uniform and reaches to what is left of the run, or to
    /// twice the shortest length where less is left: what differs up to the
    /// last value is a step.
    Length {
        /// Where the stretch ends at the latest \[m or s\].
        until: f64,
    },
    /// Anything else, such as a scale.
    Other,
}

/// Something unknown about a mechanism.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Unknown {
    /// Its name.
    pub name: String,
    /// Its unit; "1" for a pure number.
    pub unit: &'static str,
    /// Its prior, scaled to the event.
    pub prior: AnyPrior,
    /// What it is to the mechanism.
    pub role: Role,
}

impl Unknown {
    /// How much of a mechanism there is.
    pub fn amplitude(
        name: impl Into<String>,
        unit: &'static str,
        prior: AnyPrior,
    ) -> Self {
        Self { role: Role::Amplitude, ..Self::other(name, unit, prior) }
    }

    /// Where a mechanism begins, uniform between two places \[m\] or two
    /// moments \[s\].
    pub fn edge(
        name: impl Into<String>,
        axis: Axis,
        [begin, end]: [f64; 2],
    ) -> Self {
        let prior = AnyPrior::Uniform(begin, end);
        Self {
            role: Role::Edge(axis),
            ..Self::other(name, axis.unit(), prior)
        }
    }

    /// How long the stretch is that begins at the edge before it: uniform from
    /// the shortest length to what is left until the run's end.
    pub fn length(
        name: impl Into<String>,
        axis: Axis,
        [shortest, longest]: [f64; 2],
        until: f64,
    ) -> Self {
        let prior = AnyPrior::Uniform(shortest, longest);
        Self {
            role: Role::Length { until },
            ..Self::other(name, axis.unit(), prior)
        }
    }

    /// Something else that is unknown.
    pub fn other(
        name: impl Into<String>,
        unit: &'static str,
        prior: AnyPrior,
    ) -> Self {
        Self { name: name.into(), unit, prior, role: Role::Other }
    }

    /// Whether its prior reaches to both sides of zero.
    pub fn is_signed(&self) -> bool {
        let beyond = |p: f64, sign: f64| {
            self.prior.quantile(p).is_none_or(|x| x * sign > 0.0)
        };
        beyond(0.0, -1.0) && beyond(1.0, 1.0)
    }
}

/// What something is called in a sentence: "a clock that is off".
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Noun {
    /// The words.
    pub words: String,
    /// Whether a verb with it stands in the plural.
    pub plural: bool,
}

impl Noun {
    /// A noun in the singular.
    pub fn one(words: impl Into<String>) -> Self {
        Self { words: words.into(), plural: false }
    }

    /// A noun in the plural.
    pub fn many(words: impl Into<String>) -> Self {
        Self { words: words.into(), plural: true }
    }
}

/// Where a mechanism acts, where it is confined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Along place or time.
    pub axis: Axis,
    /// From here \[m or s\].
    pub from: f64,
    /// To here; infinite where it goes on.
    pub to: f64,
}

/// What there is to know of a mechanism before its amounts are known.
pub trait Candidate: Debug + Send + Sync {
    /// Its name, such as "friction-patch".
    fn name(&self) -> &'static str;

    /// Its name in an event file: where a name has several variants, with
    /// what tells it from the others, such as "friction-step(time)".
    fn label(&self) -> String {
        self.name().to_owned()
    }

    /// What sort of thing it changes.
    fn family(&self) -> Family;

    /// As a snow scientist would call it. The sign of the amplitude may go into
    /// the words, which are those of either sign where it is NaN.
    fn noun(&self, amplitude: f64) -> Noun;

    /// What it says of the recording, in one plain sentence.
    fn says(&self) -> &'static str;

    /// What is unknown; the first is the amplitude, whose zero gives the
    /// model back as it was.
    fn unknowns(&self) -> Vec<Unknown>;

    /// Whether each of several events has it in an amount of its own, as
    /// starts are.
    fn is_each_events_own(&self) -> bool {
        self.family() == Family::Start
    }

    /// Which of the unknowns are an amplitude and its places, one range for
    /// each amplitude; the others follow from them and the data.
    fn amplitudes(&self) -> Vec<Range<usize>> {
        std::iter::once(0..self.unknowns().len()).collect()
    }

    /// Along which axis, where there are variants over several.
    fn coordinate(&self) -> Option<Axis> {
        None
    }

    /// In which form, where there are several.
    fn form(&self) -> Option<&'static str> {
        None
    }

    /// The stretch that given values confine it to.
    fn reach(&self, _values: &[f64]) -> Option<Reach> {
        None
    }

    /// The laws and noises that already are what it would add.
    fn contained_in(&self) -> &'static [&'static str] {
        &[]
    }

    /// The laws of which the model must have one, where it changes what only
    /// these have; empty where any will do.
    fn needs(&self) -> &'static [&'static str] {
        &[]
    }

    /// The term it adds to du/dt, or the change it makes, as a formula.
    fn formula(&self) -> String;
}

/// A candidate that can say which change its values make.
pub trait Missing: Candidate {
    /// The change with given values, in the order of
    /// [`Candidate::unknowns`].
    fn change<K: Kind>(&self, values: &[Real<K>]) -> Change<K>;
}

/// [`Missing::change`] for one kind of number.
pub trait ChangeOf<K: Kind> {
    /// The change with given values.
    fn change_of(&self, values: &[Real<K>]) -> Change<K>;
}

impl<K: Kind, M: Missing> ChangeOf<K> for M {
    fn change_of(&self, values: &[Real<K>]) -> Change<K> {
        self.change(values)
    }
}

/// A mechanism for every kind of number that models run with; every
/// [`Missing`] is one.
pub trait Mechanism:
    Candidate
    + ChangeOf<Plain>
    + ChangeOf<Grad<4>>
    + ChangeOf<Grad<8>>
    + ChangeOf<Grad<16>>
    + ChangeOf<Reverse>
{
    /// What of it concerns one of several events.
    fn of_event(&self, _event: usize) -> Concern {
        Concern::All
    }
}

/// What of a mechanism concerns one of several events.
#[derive(Debug)]
pub enum Concern {
    /// All of it, which is the same for every event.
    All,
    /// Its first unknowns, so many of them, which all events have in common,
    /// and that event's own, which follow event by event.
    Own {
        /// How many are in common.
        common: usize,
        /// The mechanism with just those and the event's own; `None` where
        /// the event has nothing of it.
        mechanism: Option<Box<dyn Mechanism>>,
    },
}

impl<M: Missing> Mechanism for M {}

/// Kinds of number that a mechanism can be asked with.
pub trait ChangeKind: Kind {
    /// The change of a mechanism with given values.
    fn change(
        mechanism: &dyn Mechanism,
        values: &[Real<Self>],
    ) -> Change<Self>;
}

macro_rules! change_kind {
    ($($kind:ty),*) => {
        $(impl ChangeKind for $kind {
            fn change(
                mechanism: &dyn Mechanism,
                values: &[Real<Self>],
            ) -> Change<Self> {
                mechanism.change_of(values)
            }
        })*
    };
}
of_each_kind!(change_kind);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prior_on_both_sides_of_zero_is_signed() {
        let signed = |prior| Unknown::amplitude("a", "1", prior).is_signed();
        assert!(signed(AnyPrior::Normal(0.0, 1.5)));
        assert!(signed(AnyPrior::Uniform(-1.0, 2.0)));
        assert!(!signed(AnyPrior::HalfNormal(1.0)));
        assert!(!signed(AnyPrior::Uniform(0.0, 0.5)));
        assert!(!signed(AnyPrior::LogNormal(0.0, 0.3)));
    }
}
