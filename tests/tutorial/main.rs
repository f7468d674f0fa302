//! The README and the manual's chapters, command by command: every command
//! that they show is run as it is written, one after another in one folder,
//! and prints what the next block shows.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]
#![allow(clippy::print_stdout, reason = "what takes long is seen")]

mod blocks;
mod printed;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use blocks::{Step, steps, words};
use printed::difference;

/// The chapters in the order in which a reader takes them.
const CHAPTERS: [&str; 12] = [
    "README.md",
    "manual/src/install.md",
    "manual/src/event.md",
    "manual/src/calibrate.md",
    "manual/src/diagnose.md",
    "manual/src/report.md",
    "manual/src/silence.md",
    "manual/src/noise.md",
    "manual/src/together.md",
    "manual/src/many.md",
    "manual/src/messages.md",
    "manual/src/python.md",
];

/// What would take hours: `docs/challenge.md` records what came out.
const NOT_RUN: &str = "couloir challenge";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A fresh folder with what the reader is said to have: a second event, and a
/// log, where a recorded one is at hand; whether it is.
fn begin(folder: &Path) -> bool {
    let _ = fs::remove_dir_all(folder);
    fs::create_dir_all(folder).unwrap();
    run("couloir new other", folder).unwrap();
    let raw = root().join("../shared/recordings/avanodes/raw");
    let files = [
        ("ava220123_C01.txt", "gnss.txt"),
        ("dem_crop_5m_epsg31254.asc", "terrain.asc"),
    ];
    files.iter().all(|(recorded, name)| {
        fs::copy(raw.join(recorded), folder.join(name)).is_ok()
    })
}

/// What a command prints, or how it failed.
fn run(command: &str, folder: &Path) -> Result<String, String> {
    let begun = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_couloir"))
        .args(&words(command)[1..])
        .current_dir(folder)
        .env("COLUMNS", "80")
        .output()
        .unwrap();
    println!("{:5.1} s: {command}", begun.elapsed().as_secs_f64());
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let all = text(&output.stdout) + &text(&output.stderr);
    match output.status.code() {
        Some(0) => Ok(all),
        code => Err(format!("ended with {code:?}\n{all}")),
    }
}

/// What is wrong with what a step printed, if anything is.
fn fault(step: &Step, printed: &Result<String, String>) -> Option<String> {
    match printed {
        Ok(all) => difference(step.shown.as_deref()?, all),
        Err(wrong) => Some(wrong.clone()),
    }
}

/// Whether a command needs the log, or the event made of it.
fn is_of_log(command: &str) -> bool {
    let files = ["gnss.txt", "event", "slide"];
    words(command).iter().any(|word| files.contains(&word.as_str()))
}

#[test]
fn every_command_prints_what_is_shown() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tutorial");
    let has_log = begin(&folder);
    let mut faults = Vec::new();
    // A command that several chapters show is run once.
    let mut ran = BTreeMap::new();
    for chapter in CHAPTERS {
        let text = fs::read_to_string(root().join(chapter)).unwrap();
        for step in steps(&text) {
            if step.command.starts_with(NOT_RUN)
                || (!has_log && is_of_log(&step.command))
            {
                continue;
            }
            let printed = ran
                .entry(step.command.clone())
                .or_insert_with(|| run(&step.command, &folder));
            if let Some(wrong) = fault(&step, printed) {
                faults.push(format!("{chapter}: {}\n{wrong}", step.command));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(ran.len() >= 15, "{ran:?}");
}
