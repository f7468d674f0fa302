//! `couloir sweep` as people run it: stopped, shared, and with bad events.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;

use serde_json::Value;

use crate::cases::{EVENT, RECORDING, TRACK};

fn fresh(name: &str) -> PathBuf {
    let id = std::process::id();
    let folder =
        std::env::temp_dir().join(format!("couloir-sweep-{name}-{id}"));
    let _ = fs::remove_dir_all(&folder);
    folder
}

/// Small synthetic events, of which each has another release.
fn survey(folder: &Path, events: usize) {
    for number in 0..events {
        let event = folder.join(format!("event {number:02}"));
        fs::create_dir_all(&event).unwrap();
        let start = format!("x = {number}.0");
        let text = EVENT.replace("x = 0.0", &start);
        fs::write(event.join("event.toml"), text).unwrap();
        fs::write(event.join("track.csv"), TRACK).unwrap();
        fs::write(event.join("recording.csv"), RECORDING).unwrap();
    }
}

fn command(list: &Path, out: &Path, options: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_couloir"));
    command.args(["sweep", "--quiet", "--verb=calibrate", "--out"]);
    command.arg(out).arg(list).args(options);
    command.args(["--", "--quick", "--draws=200", "--warmup=200"]);
    command
}

fn sweep(list: &Path, out: &Path, options: &[&str]) -> Output {
    command(list, out, options).output().unwrap()
}

fn json(out: &Path) -> String {
    fs::read_to_string(out.join("sweep.json")).unwrap()
}

fn journals(out: &Path) -> usize {
    fs::read_dir(out.join("results")).unwrap().count()
}

#[test]
fn what_is_done_is_never_done_again() {
    let folder = fresh("again");
    let (list, out) = (folder.join("survey"), folder.join("out"));
    survey(&list, 3);
    let bad = list.join("event 01/recording.csv");
    fs::write(&bad, "t,velocity\n1,fast\n").unwrap();
    let first = sweep(&list, &out, &[]);
    assert_eq!(first.status.code(), Some(3), "{first:?}");
    let said = String::from_utf8_lossy(&first.stdout);
    assert!(said.contains("3 events: 2 done, 1 failed"), "{said}");
    assert!(said.contains("recording.csv:2"), "{said}");
    let before = json(&out);
    let second = sweep(&list, &out, &[]);
    assert_eq!((second.status.code(), journals(&out)), (Some(3), 1));
    assert_eq!(json(&out), before);
    // A retry finds the same fault; the mended event is another task.
    sweep(&list, &out, &["--retry"]);
    assert_eq!((journals(&out), json(&out)), (2, before));
    fs::write(&bad, RECORDING).unwrap();
    let mended = sweep(&list, &out, &[]);
    assert_eq!(mended.status.code(), Some(0), "{mended:?}");
    let document: Value = serde_json::from_str(&json(&out)).unwrap();
    assert_eq!(
        (&document["done"], &document["failed"]),
        (&3.into(), &0.into())
    );
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_killed_sweep_goes_on_to_the_same_bytes() {
    let folder = fresh("killed");
    let list = folder.join("survey");
    survey(&list, 12);
    let whole = folder.join("whole");
    assert_eq!(sweep(&list, &whole, &[]).status.code(), Some(0));
    let out = folder.join("out");
    for moment in [20, 90, 150, 60, 240] {
        let mut child = command(&list, &out, &["--jobs=2"]).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(moment));
        // It may have ended by itself.
        let _ = child.kill();
        child.wait().unwrap();
    }
    assert_eq!(sweep(&list, &out, &[]).status.code(), Some(0));
    assert_eq!(json(&out), json(&whole));
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn shards_and_runs_at_once_give_what_one_run_gives() {
    let folder = fresh("shards");
    let list = folder.join("survey");
    survey(&list, 6);
    let (whole, shared) = (folder.join("whole"), folder.join("shared"));
    assert_eq!(sweep(&list, &whole, &[]).status.code(), Some(0));
    let parts = ["--shard=1/3", "--shard=2/3", "--shard=3/3", "--shard=2/3"];
    let mut running: Vec<_> = parts
        .iter()
        .map(|part| command(&list, &shared, &[part]).spawn().unwrap())
        .collect();
    running.push(command(&list, &shared, &[]).spawn().unwrap());
    for child in &mut running {
        assert!(child.wait().unwrap().success());
    }
    assert_eq!(sweep(&list, &shared, &[]).status.code(), Some(0));
    assert_eq!(json(&shared), json(&whole));
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_table_of_events_overrides_options() {
    let folder = fresh("table");
    survey(&folder, 1);
    let list = folder.join("list.csv");
    let rows = "event,friction,draws\nevent 00,coulomb,\nevent 00,,100\n\
                event 00,voelmy,\nmissing,,\n";
    fs::write(&list, rows).unwrap();
    let out = folder.join("out");
    let found = sweep(&list, &out, &[]);
    assert_eq!(found.status.code(), Some(3), "{found:?}");
    let document: Value = serde_json::from_str(&json(&out)).unwrap();
    let rows = document["rows"].as_array().unwrap();
    let friction = |row: &Value| row["result"]["model"]["friction"].clone();
    assert_eq!(friction(&rows[0]), "coulomb");
    assert_eq!(friction(&rows[1]), "voellmy");
    let why = |row: &Value| row["message"].as_str().unwrap().to_owned();
    assert!(why(&rows[2]).contains("voellmy"), "{}", why(&rows[2]));
    assert!(why(&rows[3]).contains("does not exist"), "{}", why(&rows[3]));
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn hostile_names_are_text() {
    let folder = fresh("hostile");
    let list = folder.join("survey");
    survey(&list, 1);
    for name in ["--out=x", "=1+1,\"b", "<script>", "-- --json"] {
        fs::rename(list.join("event 00"), list.join(name)).unwrap();
        let out = folder.join("out");
        let mut from_within = command(Path::new("*"), &out, &[]);
        let found = from_within.current_dir(&list).output().unwrap();
        assert_eq!(found.status.code(), Some(0), "{name}: {found:?}");
        let document: Value = serde_json::from_str(&json(&out)).unwrap();
        assert_eq!(document["rows"][0]["event"], *name);
        let csv = fs::read_to_string(out.join("sweep.csv")).unwrap();
        let row = csv.lines().nth(1).unwrap();
        assert!(!row.starts_with(['=', '-']), "{row}");
        fs::rename(list.join(name), list.join("event 00")).unwrap();
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn options_that_a_sweep_says_itself_are_refused() {
    let folder = fresh("refused");
    survey(&folder, 1);
    for option in ["--out=x", "--json", "--strict", "--format=csv", "stray"] {
        let mut command = command(&folder, &folder.join("out"), &[]);
        let refused = command.arg(option).output().unwrap();
        assert_eq!(refused.status.code(), Some(2), "{option}");
    }
    assert!(!folder.join("out").exists());
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_would_fail_for_every_event_is_refused_once() {
    let folder = fresh("once");
    survey(&folder, 2);
    let out = folder.join("out");
    let refused = |list: &Path, words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_couloir"));
        command.args(["sweep", "--quiet", "--out"]).arg(&out).arg(list);
        let found = command.args(words).output().unwrap();
        assert_eq!(found.status.code(), Some(2), "{words:?}: {found:?}");
        let said = String::from_utf8(found.stderr).unwrap();
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(!said.contains("tip: to pass"), "{said}");
        said
    };
    let unknown = refused(&folder, &["--", "--nonsense"]);
    assert!(unknown.contains("'--nonsense'"), "{unknown}");
    let missing = refused(&folder, &["--verb=compare"]);
    assert!(missing.contains("--model"), "{missing}");
    let other = refused(&folder, &["--", "--draws=100"]);
    assert!(other.contains("'--draws'"), "{other}");
    let list = folder.join("list.csv");
    for (head, said) in [("colour", "'--colour'"), ("out", "--out")] {
        let rows = format!("event,{head}\nevent 00,\nevent 01,x\n");
        fs::write(&list, rows).unwrap();
        let column = refused(&list, &[]);
        assert!(column.contains("list.csv:"), "{column}");
        assert!(column.contains(said), "{column}");
    }
    assert!(!out.exists());
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_failure_says_the_same_wherever_the_survey_is() {
    let folder = fresh("moved");
    let (list, moved) = (folder.join("survey"), folder.join("moved"));
    survey(&list, 3);
    for of in 0..3 {
        let bad = list.join(format!("event {of:02}/recording.csv"));
        fs::write(bad, "t,velocity\n1,fast\n").unwrap();
    }
    // The same files, in folders of the same names.
    let command = |within: &Path, list: &str, out: &Path| {
        let mut command = command(Path::new(list), out, &[]);
        command.current_dir(within).output().unwrap()
    };
    let here = command(&folder, "survey", &folder.join("here"));
    let said = String::from_utf8(here.stdout).unwrap();
    assert!(said.contains("3 failed, survey/event 00 first: rec"), "{said}");
    assert!(said.contains("--retry"), "{said}");
    fs::create_dir_all(&moved).unwrap();
    fs::rename(&list, moved.join("survey")).unwrap();
    command(&moved, "survey", &folder.join("there"));
    assert_eq!(json(&folder.join("here")), json(&folder.join("there")));
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn comparisons_are_summed_up() {
    let folder = fresh("compared");
    let (list, out) = (folder.join("survey"), folder.join("out"));
    survey(&list, 2);
    let mut command = Command::new(env!("CARGO_BIN_EXE_couloir"));
    command.args(["sweep", "--quiet", "--verb=compare", "--out"]);
    command.arg(&out).arg(&list).args(["--", "--draws=100"]);
    command.args(["--model=coulomb, iid", "--model=voellmy, iid"]);
    let found = command.output().unwrap();
    assert_eq!(found.status.code(), Some(0), "{found:?}");
    let document: Value = serde_json::from_str(&json(&out)).unwrap();
    let models = document["models"].as_array().unwrap();
    let of = |key: &str| -> f64 {
        models.iter().map(|model| model[key].as_f64().unwrap()).sum()
    };
    assert_eq!((models.len(), of("selected")), (2, 2.0));
    assert!((of("mean_probability") - 1.0).abs() < 1e-9);
    let csv = fs::read_to_string(out.join("sweep.csv")).unwrap();
    assert!(csv.contains("\"p(coulomb, iid)\""), "{csv}");
    let said = String::from_utf8(found.stdout).unwrap();
    assert!(said.contains("\nvoellmy, iid "), "{said}");
    fs::remove_dir_all(&folder).unwrap();
}
