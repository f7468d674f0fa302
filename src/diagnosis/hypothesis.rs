//! What may explain a recording: the model as it was, a mechanism, or a force
//! that no mechanism describes.

use crate::mechanism::Family;

/// What sort of explanation of a recording something is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Hypothesis {
    /// The model as it was: nothing is missing.
    #[default]
    Baseline,
    /// A mechanism of this family is missing.
    Mechanism(Family),
    /// A force is missing that no mechanism describes.
    Unknown,
}

impl Hypothesis {
    /// Its kind in `diagnosis.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => NONE,
            Self::Mechanism(family) => family.name(),
            Self::Unknown => UNKNOWN,
        }
    }
}

/// The name of the model as it was among the mechanisms.
pub(crate) const NONE: &str = "none";
/// The name of the free-form force among the mechanisms.
pub(crate) const UNKNOWN: &str = "unknown";
