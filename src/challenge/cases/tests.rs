//! Cases are legal events, and the same whoever draws them.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use super::*;
use crate::challenge::case::Recording;
use crate::challenge::scenery::VALUES;
use crate::io::{EventFile, parse_event};
use crate::physics::friction::Laws;

fn read(recording: &Recording) -> EventFile {
    let text = |name: &str| {
        let file = recording.files.iter().find(|f| f.0 == name);
        file.map(|f| f.1.clone()).unwrap()
    };
    let open = |name: &str| Ok((Cursor::new(text(name)), PathBuf::from(name)));
    let event = Path::new("event.toml");
    parse_event(&text("event.toml"), event, open, &Laws::default()).unwrap()
}

fn check(case: &Case) {
    for recording in &case.recordings {
        let file = read(recording);
        let series = &file.event.velocity;
        assert!((VALUES.0..=VALUES.1).contains(&series.len()));
        let step = series.times()[1] - series.times()[0];
        assert!((0.0999..0.2501).contains(&step), "{step}");
        let names: Vec<_> = file.friction.terms().to_vec();
        assert_eq!(names.len(), 1);
        assert_eq!(file.noise.name(), "iid");
        let all: Vec<_> =
            recording.files.iter().map(|f| f.1.as_str()).collect();
        let told = all.concat();
        assert!(!told.contains(case.truth.effect));
    }
    if let Some(at) = case.truth.interval {
        assert!(at.from < at.to && at.time_from < at.time_to, "{case:?}");
        assert!(at.from >= 0.0 && at.to.is_finite());
    }
    let ratio = case.truth.noise_rms / case.truth.noise_sd;
    assert!((0.3..20.0).contains(&ratio), "{ratio}");
}

#[test]
fn every_case_is_a_legal_event() {
    for mix in [Mix::One, Mix::Two] {
        let all = cases(20, 77, mix).unwrap();
        let mut counts: BTreeMap<_, usize> = BTreeMap::new();
        for case in &all {
            *counts.entry(case.truth.effect).or_default() += 1;
            assert_eq!(case.recordings.len(), mix.recordings());
            check(case);
        }
        assert_eq!(counts.remove("none"), Some(10));
        assert_eq!(counts.len(), 24);
        assert!(counts.values().all(|n| *n == 1));
    }
}

#[test]
fn the_seed_decides() {
    let some = cases(6, 5, Mix::One).unwrap();
    assert_eq!(some, cases(6, 5, Mix::One).unwrap());
    let other = cases(6, 6, Mix::One).unwrap();
    assert!(some.iter().zip(&other).all(|(a, b)| a != b));
    let more = cases(8, 5, Mix::One).unwrap();
    assert_eq!(some[..6], more[..6]);
}

#[test]
fn sizes_are_spread_over_their_range() {
    let size = |kind: &Kind, k: u64| kind.size(&mut Seed::new(k).rng());
    for kind in CATALOGUE {
        let all: Vec<f64> = (0..400).map(|k| size(kind, k)).collect();
        let (low, high) = kind.range;
        let mean = all.iter().map(|x| x.abs()).sum::<f64>() / 400.0;
        assert!((mean - 0.5 * (low + high)).abs() < 0.06 * (high - low));
        let back = all.iter().filter(|x| **x < 0.0).count();
        assert_eq!(back > 150, kind.signed, "{}", kind.name);
    }
}

#[test]
fn two_recordings_share_the_track_and_not_the_start() {
    let x = |r: &Recording| {
        let line = r.files[0].1.lines().find(|l| l.starts_with("x = "));
        line.map(str::to_owned).unwrap()
    };
    for case in cases(6, 9, Mix::Two).unwrap() {
        let [a, b] = &case.recordings[..] else { panic!("two") };
        assert_eq!(a.files[1], b.files[1]);
        assert_ne!(x(a), x(b));
        assert_ne!(a.files[2], b.files[2]);
        assert_ne!(a.folder, b.folder);
    }
}
