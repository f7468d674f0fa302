//! What users of a command line expect of every command.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn couloir(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_couloir"))
        .args(arguments)
        .env("COLUMNS", "80")
        .output()
        .unwrap()
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn fresh(name: &str) -> PathBuf {
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join("habits").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

#[test]
fn quiet_tells_no_progress_and_still_complains() {
    let loud = couloir(&["calibrate", "--quick"]);
    assert!(!loud.stderr.is_empty());
    let quiet = couloir(&["calibrate", "--quick", "--quiet"]);
    assert!(quiet.status.success() && quiet.stderr.is_empty());
    let refused = couloir(&["-q", "calibrate", "nowhere"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(said.starts_with("couloir: nowhere"), "{said}");
}

#[test]
fn a_quick_look_is_marked_and_repeats() {
    let json = |arguments: &[&str]| -> Value {
        let text = printed(&couloir(arguments));
        serde_json::from_str(&text).unwrap()
    };
    let quick = ["diagnose", "--quick", "--json", "-q"];
    let (first, mut second) = (json(&quick), json(&quick));
    assert_eq!(first["quick"], true);
    let said = first["words"][1].as_str().unwrap();
    assert!(said.starts_with("This is a quick look"), "{said}");
    // Only the time differs.
    second["seconds"] = first["seconds"].clone();
    assert_eq!(first["command"], "couloir diagnose --quick --json -q");
    assert_eq!(first["seed"], 1);
    assert_eq!(first, second);
    let calibrated = json(&["calibrate", "--quick", "--json", "-q"]);
    assert_eq!(calibrated["quick"], true);
    let notes = calibrated["notes"].to_string();
    assert!(notes.contains("This is a quick look"), "{notes}");
    let rate = couloir(&["diagnose", "--quick", "--check-rate"]);
    assert_eq!(rate.status.code(), Some(2));
}

#[test]
fn a_quick_look_finds_what_a_long_one_finds() {
    // The car is braked by the air besides the road's friction.
    let verdict = |arguments: &[&str]| -> Value {
        let text = printed(&couloir(arguments));
        let found: Value = serde_json::from_str(&text).unwrap();
        found["verdict"].clone()
    };
    let quick = verdict(&["diagnose", "--quick", "--json", "-q"]);
    assert_eq!(quick, verdict(&["diagnose", "--json", "-q"]));
}

#[test]
fn the_version_is_that_of_the_package() {
    let text = printed(&couloir(&["--version"]));
    let package = concat!("couloir ", env!("CARGO_PKG_VERSION"));
    assert!(text.starts_with(package), "{text}");
}

#[test]
fn shells_complete_every_command() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = printed(&couloir(&["completions", shell]));
        for command in ["calibrate", "diagnose", "simulate", "--one-law"] {
            let bare = command.trim_start_matches('-');
            assert!(script.contains(bare), "{shell}: {command}");
        }
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = fresh("man");
    let told = printed(&couloir(&["man", "--out", &folder.to_string_lossy()]));
    let help = printed(&couloir(&["--help"]));
    let (_, commands) = help.split_once("Commands:").unwrap();
    let (commands, _) = commands.split_once("Options:").unwrap();
    let names: Vec<&str> = commands
        .lines()
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|name| !name.is_empty() && *name != "help")
        .collect();
    assert!(names.len() > 8, "{names:?}");
    for name in names {
        let page = format!("couloir-{name}.1");
        let text = std::fs::read_to_string(folder.join(&page)).unwrap();
        assert!(text.contains(".TH"), "{page}");
        assert!(told.contains(&page), "{told}");
    }
    assert!(printed(&couloir(&["man"])).contains(".TH couloir 1"));
}
