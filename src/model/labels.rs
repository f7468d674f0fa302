//! What the parameters of several events are called by.

use std::collections::{HashMap, HashSet};

/// How many characters a label has at the most, and of how many words.
const LONGEST: usize = 16;
const WORDS: usize = 3;

/// Short and different names: of the words that not all begin with, as few of
/// the first as tell them apart; numbered where none do.
pub(super) fn labels<'n>(names: impl Iterator<Item = &'n str>) -> Vec<String> {
    let names: Vec<Vec<&str>> =
        names.map(|name| name.split_whitespace().collect()).collect();
    let shared = (0..)
        .take_while(|&i| {
            let first = names.first().and_then(|words| words.get(i));
            let alike = |words: &Vec<&str>| words.get(i) == first;
            names.len() > 1 && first.is_some() && names.iter().all(alike)
        })
        .count();
    let of = |count: usize| -> Vec<String> {
        let own = |words: &Vec<&str>| {
            let own = words.iter().skip(shared).take(count);
            short(&own.copied().collect::<Vec<_>>().join("-"))
        };
        names.iter().map(own).collect()
    };
    let differ = |labels: &Vec<String>| {
        let mut seen = HashSet::new();
        labels.iter().all(|label| seen.insert(label))
    };
    (1..=WORDS).map(of).find(differ).unwrap_or_else(|| numbered(of(1)))
}

/// The beginning of a name, of plain characters.
fn short(name: &str) -> String {
    let plain = |c: &char| c.is_ascii_alphanumeric() || "_-".contains(*c);
    let short: String = name.chars().filter(plain).take(LONGEST).collect();
    if short.is_empty() { "event".into() } else { short }
}

/// Each with the first number that no other label has.
fn numbered(names: Vec<String>) -> Vec<String> {
    let mut taken = HashSet::new();
    // Of each name the numbers up to this one are taken.
    let mut last = HashMap::new();
    let free = |short: String| loop {
        let number = last.entry(short.clone()).or_insert(0);
        *number += 1;
        let label = match *number {
            1 => short.clone(),
            number => format!("{short}-{number}"),
        };
        if taken.insert(label.clone()) {
            break label;
        }
    };
    names.into_iter().map(free).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_short_and_tell_events_apart() {
        let of = |names: &[&str]| labels(names.iter().copied());
        assert_eq!(of(&["upper 1", "lower 1"]), ["upper", "lower"]);
        let runs = ["Ava 220222 C07, North", "Ava 220222 C10, North"];
        assert_eq!(of(&runs), ["C07", "C10"]);
        let runs = [runs[0], runs[1], "Ava 230204 C07, North"];
        assert_eq!(of(&runs), ["220222-C07", "220222-C10", "230204-C07"]);
        assert_eq!(
            of(&["Ava", "Ava", "Ava"]),
            ["event", "event-2", "event-3"]
        );
        assert_eq!(of(&["<b>", ""]), ["b", "event"]);
        assert_eq!(of(&["one run"]), ["one"]);
    }
}
