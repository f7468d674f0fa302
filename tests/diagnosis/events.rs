//! Events that have to load: the shared recordings, the built-in one, a new
//! folder.

#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use couloir::context::Context;
use couloir::io::{EventFile, coastdown, load, new_event};
use couloir::observe::Prediction as _;
use couloir::physics::friction::Laws;
use couloir::scalar::{Plain, Real};
use couloir::{Declared, Event, Stop};

fn load_folder(folder: &Path) -> EventFile {
    load(folder, &Laws::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// All folders below `folder` that hold an event.toml.
fn event_folders(folder: &Path, found: &mut Vec<PathBuf>) {
    if folder.join("event.toml").is_file() {
        found.push(folder.to_owned());
    }
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.path().is_dir() {
            event_folders(&entry.path(), found);
        }
    }
}

fn shared() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    if folder.is_dir() {
        return Some(folder);
    }
    // Printed macros are held back for tests that pass; this is not.
    let said = format!("not run: there is no {}\n", folder.display());
    std::io::stderr().write_all(said.as_bytes()).unwrap();
    None
}

#[test]
fn every_shared_event_loads_if_at_hand() {
    let Some(shared) = shared() else { return };
    let mut folders = Vec::new();
    event_folders(&shared, &mut folders);
    assert!(folders.len() >= 10, "{folders:?}");
    for folder in folders {
        let file = load_folder(&folder);
        assert!(file.event.recordings().count() == 1, "{folder:?}");
        assert!(file.priors.contains_key("sigma2"), "{folder:?}");
        // Nothing that was measured, or simulated well, is taken for a slip.
        assert_eq!(file.warnings, [""; 0], "{folder:?}");
        assert_eq!(file.notes, [""; 0], "{folder:?}");
        let again = load_folder(&folder.join("event.toml"));
        assert_eq!(again.event, file.event);
    }
}

#[test]
fn the_built_in_coast_down_is_the_recorded_one() {
    let built_in = coastdown(&Laws::default()).unwrap();
    assert_eq!(built_in.friction.to_string(), "coulomb + turbulent");
    assert_eq!(built_in.noise.name(), "iid");
    assert_eq!(built_in.priors.len(), 3);
    let Some(shared) = shared() else { return };
    let file = load_folder(&shared.join("recordings/coastdown-north"));
    assert_eq!(file.event, built_in.event);
}

/// The root mean square of recorded minus predicted speeds.
fn misfit(file: &EventFile, values: &[f64]) -> Result<f64, Stop> {
    let values: Vec<Real<Plain>> =
        values.iter().map(|v| Real::new(*v)).collect();
    let context = Context::new();
    let law = Declared::new(file.friction.with(&values), &context);
    let flow = file.event.slide(&law)?;
    let series = &file.event.velocity;
    let mut predicted = Vec::new();
    flow.velocity().predict(series, |v| predicted.push(v.value()))?;
    assert_eq!(predicted.len(), series.len());
    let squares: f64 = predicted
        .iter()
        .zip(series.values())
        .map(|(p, v)| (p - v).powi(2))
        .sum();
    Ok((squares / series.len() as f64).sqrt())
}

#[test]
fn the_events_that_come_along_can_be_fitted() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fit/event");
    let _ = fs::remove_dir_all(&folder);
    new_event(&folder).unwrap();
    // Errors of 0.4 m/s were added to the motion under these values.
    let error = misfit(&load_folder(&folder), &[0.25, 1500.0]).unwrap();
    assert!((0.3..0.5).contains(&error), "{error}");
    // The report's rolling resistance and drag; it has a head wind too.
    let built_in = coastdown(&Laws::default()).unwrap();
    let error = misfit(&built_in, &[0.0079, 47_000.0]).unwrap();
    assert!(error < 2.0, "{error}");
    let without = misfit(&built_in, &[0.0079, 1e9]).unwrap();
    assert!(without > 2.0 * error, "{without}");
}

#[test]
fn a_new_event_loads_and_is_never_overwritten() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new/event");
    let _ = fs::remove_dir_all(&folder);
    let paths = new_event(&folder).unwrap();
    let names: Vec<_> = paths.iter().filter_map(|p| p.file_name()).collect();
    assert_eq!(names, ["event.toml", "track.csv", "recording.csv"]);
    let event: Event = load_folder(&folder).event;
    assert!(event.name().contains("synthetic"));
    assert_eq!((event.velocity.len(), event.depth()), (48, 1.5));

    fs::remove_file(&paths[0]).unwrap();
    let error = new_event(&folder).unwrap_err();
    assert!(error.is_input());
    assert!(error.to_string().contains("track.csv: exists already"));
    assert!(!paths[0].exists());
    assert!(new_event(&paths[1]).unwrap_err().is_input());
}

#[test]
fn what_a_file_leaves_out_has_its_default() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("short");
    fs::create_dir_all(&folder).unwrap();
    let text = "[track]\nfile = \"track.csv\"\n[recording]\n\
                file = \"r.csv\"\nquantity = \"acceleration\"\n[priors]\n\
                voellmy.mu = \"Flat()\"\n\"phi[1]\" = \"Flat()\"";
    fs::write(folder.join("event.toml"), text).unwrap();
    fs::write(folder.join("track.csv"), "x,z\n7,9\n10,5\n").unwrap();
    fs::write(folder.join("r.csv"), "t,acceleration\n1,2").unwrap();
    let file = load_folder(&folder);
    assert_eq!(file.event.start(), 0.0);
    assert_eq!(file.event.depth(), 1.0);
    assert_eq!(file.event.acceleration.window(), 0.0);
    assert_eq!(file.friction.to_string(), "voellmy");
    assert_eq!(file.noise.name(), "iid");
    let names: Vec<_> = file.priors.keys().collect();
    assert_eq!(names, ["phi[1]", "voellmy.mu"]);
}
