//! A noise as the answers to three questions: what an error remembers, what
//! tails it has, and whether its size changes.

use std::fmt;

/// The answers of a noise that an event file names.
///
/// ```
/// use couloir::noise::Form;
/// let form = Form::of("tails + matern32 + white");
/// assert_eq!(form.memory, "matern32 + white");
/// assert!(form.has_tails && !form.grows);
/// assert_eq!(form.to_string(), "matern32 + white + tails");
/// assert_eq!(Form::of("iid"), Form::of("white"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Form {
    /// The blocks that say what is remembered, such as "ou + white".
    pub memory: String,
    /// Whether large errors are more common than a normal law has them.
    pub has_tails: bool,
    /// Whether its size changes along the recording.
    pub grows: bool,
}

impl Form {
    /// That of a noise's name.
    pub fn of(name: &str) -> Self {
        let (mut has_tails, mut grows) = (false, false);
        let mut memory = Vec::new();
        for block in name.split('+').map(str::trim) {
            match block {
                "tails" => has_tails = true,
                "growth" => grows = true,
                "iid" => memory.push("white"),
                "student" => {
                    has_tails = true;
                    memory.push("white");
                }
                other => memory.push(other),
            }
        }
        Self { memory: memory.join(" + "), has_tails, grows }
    }

    /// The same memory with normal errors of one size.
    #[must_use]
    pub fn plain(&self) -> Self {
        Self { has_tails: false, grows: false, ..self.clone() }
    }

    /// Whether it is the same noise as another, or one that makes no other
    /// errors: AR(1) is the Ornstein-Uhlenbeck process seen at even times.
    pub fn is_like(&self, other: &Self) -> bool {
        self.blocks() == other.blocks()
            && self.has_tails == other.has_tails
            && self.grows == other.grows
    }

    /// What its memory is a sum of.
    fn blocks(&self) -> Vec<&str> {
        let all = self.memory.split(" + ");
        let name = |block| if block == "ar(1)" { "ou" } else { block };
        let mut all: Vec<&str> = all.map(name).collect();
        all.sort_unstable();
        all
    }

    /// The blocks that remember.
    fn processes(&self) -> Vec<&str> {
        let mut all = self.blocks();
        all.retain(|block| *block != "white");
        all
    }

    fn has_white(&self) -> bool {
        self.blocks().contains(&"white")
    }

    /// Whether it has nothing that another one lacks, and less. A process that
    /// forgets within a step makes white errors.
    #[must_use]
    pub fn is_simpler_than(&self, other: &Self) -> bool {
        let (own, its) = (self.processes(), other.processes());
        let leaves_one = its.len() > own.len();
        own.iter().all(|process| its.contains(process))
            && (!self.has_white() || other.has_white() || leaves_one)
            && !self.is_like(other)
            && self.has_tails <= other.has_tails
            && self.grows <= other.grows
    }
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.memory)?;
        if self.has_tails {
            f.write_str(" + tails")?;
        }
        if self.grows {
            f.write_str(" + growth")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_process_by_two_names_is_one() {
        let like = |a: &str, b: &str| Form::of(a).is_like(&Form::of(b));
        assert!(like("ar(1)", "ou"));
        assert!(like("student", "white + tails"));
        assert!(like("ar(1) + tails", "ou + tails"));
        assert!(!like("ar(1)", "ou + white"));
        assert!(!like("ar(2)", "ou"));
        assert!(like("white + ou", "ou + white"));
        assert!(like("ar(1) + white", "ou + white"));
        let simpler =
            |a: &str, b: &str| Form::of(a).is_simpler_than(&Form::of(b));
        assert!(simpler("iid", "white + tails"));
        assert!(simpler("ar(1) + tails", "matern32 + ou + tails"));
        assert!(simpler("iid", "ar(1)"));
        assert!(simpler("matern32 + white", "matern32 + ou"));
        assert!(simpler("ou + white + tails", "matern32 + ou + tails"));
        assert!(!simpler("ou + white", "matern32 + white"));
        assert!(!simpler("ou + white", "ou"));
        assert!(!simpler("ou", "matern32"));
        assert!(!simpler("white + tails + growth", "white + growth"));
        assert!(!simpler("white + tails", "white + growth"));
        assert!(!like("iid", "white + growth"));
        assert_eq!(Form::of("student").plain().to_string(), "white");
    }
}
