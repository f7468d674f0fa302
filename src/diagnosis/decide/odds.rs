//! What is held likely before a recording is seen.

use std::collections::BTreeMap;

use crate::diagnosis::findings::Judged;
use crate::diagnosis::hypothesis::{NONE, UNKNOWN};
use crate::draws::shares;
use crate::error::{Error, Result};
use crate::mechanism::Mechanism;

/// What the user holds likely beforehand: odds by name, against 1 for every
/// name not in it; `none` against all the others together.
pub type Odds = BTreeMap<String, f64>;

/// The names of a catalogue, each once.
pub(super) fn names(catalogue: &[Box<dyn Mechanism>]) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for mechanism in catalogue {
        if !names.contains(&mechanism.name()) {
            names.push(mechanism.name());
        }
    }
    names
}

/// Refuses odds of what is not weighed.
pub(crate) fn check_odds(
    odds: &Odds,
    catalogue: &[Box<dyn Mechanism>],
) -> Result<()> {
    let known = [&[NONE, UNKNOWN], &names(catalogue)[..]].concat();
    match odds.keys().find(|name| !known.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => Err(Error::input(format!(
            "the odds of {name:?}: nothing of that name is weighed here; \
             expected one of {}: take one of them, or drop it",
            known.join(", ")
        ))),
    }
}

/// What is held likely before the recording is seen: half of it for `none`,
/// half shared by the other names, times the user's odds.
pub(crate) struct Beforehand<'a> {
    odds: &'a Odds,
    /// The odds of all names but `none`.
    others: f64,
}

impl<'a> Beforehand<'a> {
    pub(crate) fn of(all: &[Judged], odds: &'a Odds) -> Self {
        Self::among(all.iter().map(|m| m.name.as_str()), odds)
    }

    pub(super) fn among<'n>(
        names: impl Iterator<Item = &'n str>,
        odds: &'a Odds,
    ) -> Self {
        let mut beforehand = Self { odds, others: 0.0 };
        let others = names.filter(|name| *name != NONE);
        beforehand.others = others.map(|name| beforehand.odds_of(name)).sum();
        beforehand
    }

    fn odds_of(&self, name: &str) -> f64 {
        self.odds.get(name).copied().unwrap_or(1.0)
    }

    /// ln of the prior probability of a name, up to a constant.
    pub(super) fn log(&self, name: &str) -> f64 {
        match name {
            NONE => self.odds_of(NONE).ln(),
            name => (self.odds_of(name) / self.others).ln(),
        }
    }

    /// In ln, by how much less likely a term is than its absence.
    pub(crate) fn price(&self, name: &str) -> f64 {
        self.log(NONE) - self.log(name)
    }
}

/// The probability of each name before the recording is seen: that of the
/// model as it was, then those of a catalogue's names, each once.
pub fn prior_probabilities(
    catalogue: &[Box<dyn Mechanism>],
    odds: &Odds,
) -> Vec<(String, f64)> {
    let all = [&[NONE], &names(catalogue)[..]].concat();
    let beforehand = Beforehand::among(all.iter().copied(), odds);
    let shares = shares(all.iter().map(|name| beforehand.log(name)));
    let names = all.into_iter().map(str::to_owned);
    names.zip(shares).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_further_term_costs_what_the_odds_say() {
        let names = ["none", "surge", "cohesion", "clock-offset", "unknown"];
        let named =
            |name: &str| Judged { name: name.into(), ..Judged::default() };
        let all = names.map(named);
        let even = Odds::new();
        let price = Beforehand::of(&all, &even).price("surge");
        assert!((price - 4.0_f64.ln()).abs() < 1e-12, "{price}");
        // Three times as likely as each of three others, which are half as
        // likely together as nothing.
        let odds = Odds::from([("surge".into(), 3.0), ("none".into(), 2.0)]);
        let price = Beforehand::of(&all, &odds).price("surge");
        assert!((price - (2.0 * 6.0 / 3.0_f64).ln()).abs() < 1e-12, "{price}");
    }
}
