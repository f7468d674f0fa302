//! What to record next.

use crate::diagnosis::decide::judge::verdict_of;
use crate::diagnosis::findings::{Judged, Verdict};
use crate::physics::forces::Axis;

/// The recording that would tell most beside this one: what tells the members
/// of a group apart or, of one member, whether it is that.
pub(crate) fn next_recording(
    verdict: Verdict,
    group: &[String],
    judged: &[Judged],
) -> Option<String> {
    if group.len() > 1 {
        return Some(separating(group, judged));
    }
    let words = match verdict {
        Verdict::Adequate => return None,
        Verdict::MissingPhysics => {
            "A recording from another start over the same ground would show \
             whether it holds there too."
        }
        Verdict::Unexplained => {
            "A recording from another start over the same ground would show \
             whether that force belongs to a place, a moment or a speed."
        }
        Verdict::Measurement => {
            "A second recording with another sensor, or of a mass released \
             at a known place and moment, would show whether it is that."
        }
        Verdict::Errors => {
            "A second recording by the same sensor would show whether its \
             errors are always such ones."
        }
    };
    Some(words.to_owned())
}

/// The recording that would tell the members of a group apart.
fn separating(group: &[String], judged: &[Judged]) -> String {
    let of = |name: &String| judged.iter().find(|m| m.name == *name);
    let members: Vec<&Judged> = group.iter().filter_map(of).collect();
    let has = |verdict: Verdict| {
        members.iter().any(|m| verdict_of(m.kind) == verdict)
    };
    let along =
        |axis: Axis| members.iter().any(|m| m.coordinate == Some(axis));
    let words = if has(Verdict::Measurement) {
        "A second recording with another sensor, or of a mass released at a \
         known place and moment, would tell them apart."
    } else if along(Axis::Time) && along(Axis::Place) {
        "A recording from another start would tell them apart: what belongs \
         to a place stays there, what belongs to a moment moves along."
    } else {
        "A recording at other speeds over the same ground, from a higher \
         start or on another slope, would tell them apart."
    };
    words.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verdict_but_adequate_says_what_to_record_next() {
        let judged = Judged { name: "surge".into(), ..Judged::default() };
        let next = |verdict, group: &[&str]| {
            let group: Vec<String> =
                group.iter().map(|&name| name.into()).collect();
            next_recording(verdict, &group, std::slice::from_ref(&judged))
        };
        assert_eq!(next(Verdict::Adequate, &["none"]), None);
        for verdict in [
            Verdict::MissingPhysics,
            Verdict::Unexplained,
            Verdict::Measurement,
            Verdict::Errors,
        ] {
            let alone = next(verdict, &["surge"]).unwrap();
            assert!(alone.contains("would show whether"), "{alone}");
            let two = next(verdict, &["surge", "cohesion"]).unwrap();
            assert!(two.contains("tell them apart"), "{two}");
        }
    }
}
