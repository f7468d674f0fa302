//! Whether what was left out belongs to a place or to a moment.

use std::f64::consts::LN_10;

use crate::diagnosis::tell::phrases::{called, judged, log10};
use crate::diagnosis::{Diagnosis, Judged, Pictured};
use crate::physics::forces::Axis;
use crate::report::digits::short;

/// In log10: by how much the evidence must differ to tell two variants apart.
const APART: f64 = 1.0;

/// A sentence on it, where a mechanism that was selected has variants of both
/// kinds. One mass is at each place at one moment, so that one recording tells
/// only by the shape of what happens; several sensors tell by when each comes
/// to the place.
pub(super) fn place_or_moment(d: &Diagnosis) -> Option<String> {
    let selected = d.selected.iter().filter_map(|name| judged(d, name));
    let mut both = selected.filter_map(|m| Some((m, lead(m)?)));
    let (m, lead) = both.next()?;
    let (what, by) = (called(m), log10(lead.abs()));
    if lead.abs() >= APART {
        let [more, less] = match lead > 0.0 {
            true => ["the place", "the moment"],
            false => ["the moment", "the place"],
        };
        return Some(format!(
            "Of {what}, it is {more} that stays the same rather than {less} \
             ({by} in log10)."
        ));
    }
    let why = why(d)?;
    Some(format!(
        "Whether {what} belongs to a place or to a moment is not told \
         ({by} in log10): {why}."
    ))
}

/// By how much, in log10, a mechanism's best variant over distance has more
/// evidence than that over time.
fn lead(m: &Judged) -> Option<f64> {
    let best = |axis: Axis| {
        let own = m.variants.iter().filter(|v| v.coordinate == Some(axis));
        own.map(|v| v.log_evidence).max_by(f64::total_cmp)
    };
    Some((best(Axis::Place)? - best(Axis::Time)?) / LN_10)
}

/// Why nothing is told.
fn why(d: &Diagnosis) -> Option<String> {
    if d.pictured.len() < 2 {
        return Some("one mass is at each place at one moment".to_owned());
    }
    let place = d.mismatch.first()?.place_from;
    let mut times: Vec<f64> =
        d.pictured.iter().filter_map(|p| passing(p, place)).collect();
    times.sort_by(f64::total_cmp);
    match times[..] {
        [first, .., last] => Some(format!(
            "the masses come to the place where it begins within {} s of each \
             other",
            short(last - first, 2)
        )),
        _ => Some("no two masses come to the place where it begins".into()),
    }
}

/// When a mass passes a place \[s\], where it comes to it.
fn passing(p: &Pictured, place: f64) -> Option<f64> {
    let i = p.places.iter().position(|s| *s >= place)?;
    let Some(before) = i.checked_sub(1) else { return Some(p.times[0]) };
    let step = p.places[i] - p.places[before];
    let share = (place - p.places[before]) / step.max(f64::MIN_POSITIVE);
    Some(p.times[before] + share * (p.times[i] - p.times[before]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Variant;
    use crate::diagnosis::fixture::diagnosis;

    fn of(place: f64, time: f64) -> Diagnosis {
        let variant = |axis, log_evidence| Variant {
            coordinate: Some(axis),
            log_evidence,
            ..Variant::default()
        };
        let mut d = diagnosis();
        let selected = d.selected[0].clone();
        let m = d.mechanisms.iter_mut().find(|m| m.name == selected);
        m.unwrap().variants =
            vec![variant(Axis::Place, place), variant(Axis::Time, time)];
        d
    }

    fn along(times: [f64; 3], places: [f64; 3]) -> Pictured {
        let (times, places) = (times.to_vec(), places.to_vec());
        Pictured { times, places, ..Pictured::default() }
    }

    #[test]
    fn a_place_and_a_moment_are_told_apart_or_it_is_said_why_not() {
        let said = place_or_moment(&of(-90.0, -95.0)).unwrap();
        assert!(said.contains("the place that stays"), "{said}");
        let said = place_or_moment(&of(-95.0, -90.0)).unwrap();
        assert!(said.contains("the moment that stays"), "{said}");
        let said = place_or_moment(&of(-90.0, -90.5)).unwrap();
        assert!(said.contains("one mass is at each place"), "{said}");
        let mut two = of(-90.0, -90.5);
        two.pictured = vec![
            along([1.0, 2.0, 3.0], [10.0, 20.0, 30.0]),
            along([4.0, 5.0, 6.0], [10.0, 20.0, 30.0]),
        ];
        two.mismatch[0].place_from = 25.0;
        let said = place_or_moment(&two).unwrap();
        // At 2.5 s and at 5.5 s.
        assert!(said.contains("within 3 s of each other"), "{said}");
        assert!(place_or_moment(&diagnosis()).is_none());
    }
}
