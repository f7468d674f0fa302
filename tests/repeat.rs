//! The evidence of every candidate is the same whatever the seed, on events
//! that can be explained in several places.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::io::Cursor;
use std::path::{Path, PathBuf};

use couloir::Error;
use couloir::challenge::{Case, Mix, cases};
use couloir::discrepancy::attribute;
use couloir::discrepancy::mechanisms::catalogue;
use couloir::infer::Quiet;
use couloir::io::parse_event;
use couloir::model::Assembled;
use couloir::physics::friction::Laws;
use couloir::seed::Seed;

fn model_of(case: &Case) -> Assembled {
    let files = &case.recordings[0].files;
    let text = |name: &str| {
        let found = files.iter().find(|(file, _)| *file == name);
        found
            .map(|(_, text)| text.clone())
            .ok_or_else(|| Error::input(format!("{name} is missing")))
    };
    let open = |name: &str| {
        text(name).map(|text| (Cursor::new(text), PathBuf::from(name)))
    };
    let (path, laws) = (Path::new("event.toml"), Laws::default());
    let toml = text("event.toml").unwrap();
    let file = parse_event(&toml, path, open, &laws).unwrap();
    Assembled::new(file.event, file.friction, file.noise, &file.priors)
        .unwrap()
}

/// How far below the best, in ln, a candidate no longer matters: it has a
/// millionth of a millionth of the probability. A mode that is only found by
/// chance was seen in 2 of 331 candidates, 60 below the best and further.
const FAR: f64 = 30.0;

/// Asked for and not met yet: of six seeds, the evidence of a friction patch
/// in the first event was 0.7 too low with three. The weights of importance
/// sampling are even enough to pass, and a tail of short, strong patches is
/// missed that holds half of the posterior.
#[test]
#[ignore = "not met yet: a patch's ln Z is up to 0.7 too low"]
fn evidences_repeat_within_three_tenths() {
    for effect in ["friction-patch", "surge", "clock-offset"] {
        let all = cases(20, 8, Mix::One).unwrap();
        let case = all.iter().find(|c| c.truth.effect == effect).unwrap();
        let model = model_of(case);
        let candidates = catalogue(&model.event().extent(), &model.blocks());
        let fits: Vec<_> = (1..=3)
            .map(|s| attribute(&model, &candidates, Seed::new(s), &Quiet))
            .map(|found| found.unwrap().candidates)
            .collect();
        let first = fits[0].iter().map(|fit| fit.log_evidence);
        let best = first.fold(f64::NEG_INFINITY, f64::max);
        for (i, mechanism) in candidates.iter().enumerate() {
            let logs = [0, 1, 2].map(|s| fits[s][i].log_evidence);
            let mean = logs.iter().sum::<f64>() / 3.0;
            if mean < best - FAR {
                continue;
            }
            for log in logs {
                let off = (log - mean).abs();
                let label = mechanism.label();
                assert!(off < 0.3, "{effect}: {label} {logs:?}");
            }
        }
    }
}
