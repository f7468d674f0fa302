//! Long runs that are killed and begun again: the same result, and not from
//! the beginning. `benches/kills.py` kills them at fifty random moments.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

const KEPT: &str = ".couloir-checkpoint";

fn fresh(name: &str) -> PathBuf {
    let id = std::process::id();
    let folder =
        std::env::temp_dir().join(format!("couloir-resume-{name}-{id}"));
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn command(words: &[&str], out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_couloir"));
    command.args(words).arg("--out").arg(out);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// A document without the times that it took.
fn document(path: &Path) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(members) => {
                members.retain(|key, _| key != "seconds" && key != "command");
                members.values_mut().for_each(strip);
            }
            Value::Array(values) => values.iter_mut().for_each(strip),
            _ => {}
        }
    }
    let text = fs::read_to_string(path).unwrap();
    let mut value = serde_json::from_str(&text).unwrap();
    strip(&mut value);
    value
}

/// Kills a run as soon as parts of it are on the disk, and begins it again.
fn goes_on(name: &str, words: &[&str], file: &str) {
    let folder = fresh(name);
    let (whole, out) = (folder.join("whole"), folder.join("out"));
    assert!(command(words, &whole).status().unwrap().success());
    let mut stopped = 0;
    for _ in 0..2 {
        let mut child = command(words, &out).spawn().unwrap();
        let before = length(&out);
        while child.try_wait().unwrap().is_none() && length(&out) <= before {
            sleep(Duration::from_millis(5));
        }
        stopped += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap_or_default();
        child.wait().unwrap();
        if out.join(file).exists() {
            break;
        }
    }
    assert!(stopped > 0, "it ended before anything was kept");
    let last = command(words, &out).output().unwrap();
    assert!(last.status.success(), "{last:?}");
    assert_eq!(document(&out.join(file)), document(&whole.join(file)));
    assert!(!out.join(KEPT).exists());
    fs::remove_dir_all(&folder).unwrap();
}

fn length(out: &Path) -> u64 {
    fs::metadata(out.join(KEPT)).map_or(0, |file| file.len())
}

#[test]
fn a_calibration_goes_on_where_it_was_killed() {
    let words = ["calibrate", "--draws=400000", "--warmup=20000"];
    goes_on("calibrate", &words, "calibration.json");
}

#[test]
fn a_challenge_goes_on_where_it_was_killed() {
    let words = ["challenge", "--cases=2", "--quick"];
    goes_on("challenge", &words, "challenge.json");
}

#[test]
fn another_run_does_not_take_what_was_kept() {
    let folder = fresh("another");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(KEPT), "nobody's\n").unwrap();
    let words = ["calibrate", "--quick"];
    let ran = command(&words, &folder).output().unwrap();
    assert!(ran.status.success());
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(!said.contains("Going on"), "{said}");
    fs::remove_dir_all(&folder).unwrap();
}
