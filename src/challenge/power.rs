//! What each effect needs to be seen: detection against size and noise.

use std::fmt::Write;

use super::case::{Case, Mix};
use super::cases::branch;
use super::effects::{CATALOGUE, Kind, OUTSIDE};
use super::scenery::{Order, draw};
use super::score::{Outcome, Share};
use crate::error::{Error, Result};

/// The names of the effects that the catalogue has, in its order.
///
/// ```
/// assert!(couloir::challenge::mechanisms().contains(&"friction-patch"));
/// ```
pub fn mechanisms() -> Vec<&'static str> {
    CATALOGUE.iter().map(|kind| kind.name).collect()
}

/// Cases that hide one effect, `count` of them for each share of its greatest
/// size and each standard deviation of the noise \[m/s\]. Ground and motion
/// are drawn anew for each size, but are the same at every noise.
///
/// # Errors
/// An effect that is not known, a share that is not above 0 and at most 1, a
/// noise that is not positive, or no ground found for an effect.
pub fn power_cases(
    mechanism: &str,
    fractions: &[f64],
    noises: &[f64],
    count: usize,
    seed: u64,
) -> Result<Vec<Case>> {
    let kind = find(mechanism)?;
    check(fractions, noises)?;
    let mut cases = Vec::new();
    for (row, fraction) in fractions.iter().enumerate() {
        for sd in noises {
            for k in 0..count {
                let sign = if kind.signed && k % 2 == 1 { -1.0 } else { 1.0 };
                let size = Some(sign * fraction * kind.range.1);
                let order = Order {
                    kind,
                    size,
                    sd: Some(*sd),
                    mix: Mix::One,
                    scatter: None,
                };
                let name = format!("power-{:04}", cases.len() + 1);
                let seed = branch(seed, kind)
                    .child(0x9_0e5)
                    .child(row as u64)
                    .child(k as u64);
                cases.push(draw(&order, &name, seed)?);
            }
        }
    }
    Ok(cases)
}

fn find(mechanism: &str) -> Result<&'static Kind> {
    let mut all = CATALOGUE.into_iter().chain(OUTSIDE);
    all.find(|kind| kind.name == mechanism).ok_or_else(|| {
        Error::input(format!(
            "the effect is {mechanism:?}; expected one of {}",
            mechanisms().join(", ")
        ))
    })
}

fn check(fractions: &[f64], noises: &[f64]) -> Result<()> {
    if let Some(f) = fractions.iter().find(|f| !(**f > 0.0 && **f <= 1.0)) {
        return Err(Error::input(format!(
            "a share of the greatest size is {f}; expected more than 0 and \
             at most 1"
        )));
    }
    let fine = |sd: f64| sd > 0.0 && sd.is_finite();
    if let Some(sd) = noises.iter().find(|sd| !fine(**sd)) {
        return Err(Error::input(format!(
            "a noise is {sd}; expected m/s, more than 0"
        )));
    }
    Ok(())
}

/// Detection of one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerTable {
    /// The effect.
    pub mechanism: &'static str,
    /// The unit of the sizes; `1` for a number without one.
    pub unit: &'static str,
    /// Absolute sizes, a row each.
    pub sizes: Vec<f64>,
    /// Standard deviations of the noise \[m/s\], a column each.
    pub noises: Vec<f64>,
    /// How often anything was found, by size, then noise.
    pub detected: Vec<Vec<Share>>,
    /// How often the effect was in the group, the same way.
    pub in_group: Vec<Vec<Share>>,
}

impl PowerTable {
    /// The tables of all effects among the outcomes, in their order.
    pub fn of(outcomes: &[Outcome]) -> Vec<Self> {
        let names = unique(outcomes.iter().map(|o| o.truth.effect));
        names.into_iter().map(|name| Self::one(outcomes, name)).collect()
    }

    fn one(outcomes: &[Outcome], mechanism: &'static str) -> Self {
        let own: Vec<_> =
            outcomes.iter().filter(|o| o.truth.effect == mechanism).collect();
        let size = |o: &Outcome| o.truth.size.abs();
        let sizes = unique(own.iter().map(|o| size(o)));
        let noises = unique(own.iter().map(|o| o.truth.noise_sd));
        let counted = |of: &dyn Fn(&Outcome) -> bool| -> Vec<Vec<Share>> {
            let cell = |s: f64, sd: f64| {
                let here = own
                    .iter()
                    .filter(|o| size(o) == s && o.truth.noise_sd == sd);
                Share::count(here.map(|o| of(o)))
            };
            let row =
                |s: &f64| noises.iter().map(|sd| cell(*s, *sd)).collect();
            sizes.iter().map(row).collect()
        };
        let detected = counted(&Outcome::detected);
        let in_group = counted(&Outcome::in_group);
        let unit = own.first().map_or("1", |o| o.truth.unit);
        Self { mechanism, unit, sizes, noises, detected, in_group }
    }

    /// The table for a page of documentation; it reads as well on a terminal.
    /// Per cent detected, in brackets per cent in the group.
    pub fn markdown(&self) -> String {
        let unit = match self.unit {
            "1" => String::new(),
            unit => format!(" [{unit}]"),
        };
        let mut head = format!("| {}{unit} |", self.mechanism);
        let mut rule = "|---|".to_owned();
        for sd in &self.noises {
            // Writing to a text cannot fail.
            let _ = write!(head, " {sd:.2} m/s |");
            rule.push_str("---|");
        }
        let mut text = format!("{head}\n{rule}\n");
        for (i, size) in self.sizes.iter().enumerate() {
            let _ = write!(text, "| {size:.3} |");
            for (all, named) in self.detected[i].iter().zip(&self.in_group[i])
            {
                let (all, named) = (percent(all), percent(named));
                let _ = write!(text, " {all} ({named}) |");
            }
            text.push('\n');
        }
        text
    }
}

/// A share in per cent; a dash of none.
pub(super) fn percent(share: &Share) -> String {
    if share.of == 0 {
        return "–".to_owned();
    }
    format!("{:.0}", 100.0 * share.value())
}

/// What occurs, once each, in the order of its first occurrence.
fn unique<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut out = Vec::new();
    for x in all {
        if !out.contains(&x) {
            out.push(x);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::challenge::score::Answer;

    #[test]
    fn a_table_counts_by_size_and_noise() {
        let sizes = [0.4, 1.0];
        let cases =
            power_cases("friction-patch", &sizes, &[0.2, 0.4], 2, 3).unwrap();
        assert_eq!(cases.len(), 8);
        assert!((cases[0].truth.size - 0.1).abs() < 1e-12);
        assert!((cases[1].truth.size + 0.1).abs() < 1e-12);
        let at = |i: usize| cases[i].truth.interval;
        assert_eq!(at(0), at(2), "the same ground at another noise");
        // A diagnosis that sees large sizes only.
        let outcomes: Vec<Outcome> = cases
            .iter()
            .map(|case| {
                let seen = case.truth.size.abs() > 0.2;
                let verdict = if seen { "noise" } else { "adequate" };
                let verdict = verdict.to_owned();
                Outcome {
                    case: case.name.clone(),
                    truth: case.truth.clone(),
                    answer: Answer { verdict, ..Answer::default() },
                }
            })
            .collect();
        let [table] = &PowerTable::of(&outcomes)[..] else {
            panic!("one effect")
        };
        assert_eq!(table.detected[0][1], Share { hits: 0, of: 2 });
        assert_eq!(table.detected[1][0], Share { hits: 2, of: 2 });
        let text = table.markdown();
        assert!(text.contains("| 0.250 | 100 (0) | 100 (0) |"), "{text}");
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let bad = |name, fraction, sd| {
            power_cases(name, &[fraction], &[sd], 1, 1).unwrap_err()
        };
        assert!(bad("gravity", 1.0, 0.2).is_input());
        assert!(bad("surge", 1.5, 0.2).is_input());
        assert!(bad("surge", 1.0, 0.0).is_input());
    }
}
