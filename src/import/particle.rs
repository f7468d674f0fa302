//! Which particles of a simulation are taken.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::io::quoted;

/// What is taken of a simulation's particles.
///
/// ```
/// use couloir::import::Particle;
/// assert_eq!("17".parse::<Particle>()?, Particle::Number(17));
/// assert_eq!(Particle::Mean.to_string(), "mean");
/// assert!("first".parse::<Particle>().is_err());
/// # Ok::<(), couloir::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Particle {
    /// All of them, their places and speeds averaged by mass.
    Mean,
    /// The one that is furthest along the path at each time.
    Front,
    /// The one with this `ID`.
    Number(u64),
}

impl FromStr for Particle {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text.trim() {
            "mean" => Ok(Self::Mean),
            "front" => Ok(Self::Front),
            number => number.parse().map(Self::Number).map_err(|_| {
                Error::input(format!(
                    "found {}; expected \"mean\", \"front\", or the number \
                     of a particle such as 17",
                    quoted(text)
                ))
            }),
        }
    }
}

impl fmt::Display for Particle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mean => f.write_str("mean"),
            Self::Front => f.write_str("front"),
            Self::Number(number) => write!(f, "particle-{number}"),
        }
    }
}
