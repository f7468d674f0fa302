//! A part of a sweep that a process takes for itself.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::spelling::quoted;

/// Part `number` of `of`, counted from 1: every `of`-th event of the list.
///
/// ```
/// use couloir::sweep::Shard;
/// let shard: Shard = "2/3".parse()?;
/// let taken: Vec<usize> = (0..7).filter(|at| shard.takes(*at)).collect();
/// assert_eq!(taken, [1, 4]);
/// # Ok::<(), couloir::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// The whole.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// Whether it holds the event at this place of the list, from 0.
    pub fn takes(&self, at: usize) -> bool {
        at % self.of == self.number - 1
    }

    /// How many shards there are.
    pub fn of(&self) -> usize {
        self.of
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::input(format!(
                "{}: expected I/N with I from 1 to N, such as 3/100",
                quoted(text)
            ))
        };
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let [number, of] = [number, of].map(|n| n.parse::<usize>().ok());
        match (number, of) {
            (Some(number), Some(of)) if (1..=of).contains(&number) => {
                Ok(Self { number, of })
            }
            _ => Err(wrong()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_event_is_in_one_shard() {
        for of in 1..6 {
            for at in 0..20 {
                let takes =
                    |number: &usize| Shard { number: *number, of }.takes(at);
                assert_eq!((1..=of).filter(takes).count(), 1);
            }
        }
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "a/b", "1/2/3"] {
            assert!(text.parse::<Shard>().unwrap_err().is_input(), "{text}");
        }
        assert_eq!("3/7".parse::<Shard>().unwrap().to_string(), "3/7");
    }
}
