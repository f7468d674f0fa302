//! Malformed events are refused with one line that says what to mend.

#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use std::path::{Path, PathBuf};

use couloir::io::load;
use couloir::physics::friction::Laws;

fn root(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

#[test]
fn the_cases_differ_from_an_event_that_loads() {
    let root = root("good-input");
    let files = [
        ("event.toml", crate::cases::EVENT),
        ("track.csv", crate::cases::TRACK),
        ("recording.csv", crate::cases::RECORDING),
    ]
    .map(|(name, text)| (name, text.as_bytes().to_vec()));
    let good = crate::cases::Case {
        name: "good",
        files: files.to_vec(),
        ask: "",
        expected: &[],
    };
    let file = load(&good.write(&root).unwrap(), &Laws::default()).unwrap();
    assert_eq!(file.event.name(), "spoilt");
    assert_eq!(file.event.track().length(), 500.0);
    assert_eq!(file.event.velocity.len(), 3);
    assert_eq!(file.friction.to_string(), "voellmy");
    assert_eq!(file.priors["mu"].to_string(), "Gamma(9, 0.03)");
}

#[test]
fn every_malformed_input_is_refused_in_one_line() {
    let root = root("bad-input");
    let mut wrong = Vec::new();
    let cases = crate::cases::all();
    for case in &cases {
        let path = case.write(&root).unwrap();
        let text = match load(&path, &Laws::default()) {
            Ok(_) => "was accepted".to_owned(),
            Err(error) if !error.is_input() => format!("no input: {error}"),
            Err(error) => error.to_string(),
        };
        let said = case.expected.iter().all(|part| text.contains(part));
        let fit = !text.contains(char::is_control)
            && text.len() < 600 + 3 * root.as_os_str().len();
        if !said || !fit || case.expected.is_empty() {
            wrong.push(format!(
                "{}: {text:?}\n  expected {:?}",
                case.name, case.expected
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let mut names: Vec<_> = cases.iter().map(|case| case.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), cases.len(), "two cases have the same name");
    let _ = std::fs::remove_dir_all(root);
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_read_is_refused() {
    use std::fs::{Permissions, read, set_permissions};
    use std::os::unix::fs::PermissionsExt as _;
    let case = crate::cases::Case {
        name: "locked",
        files: vec![("event.toml", crate::cases::EVENT.as_bytes().to_vec())],
        ask: "event.toml",
        expected: &[],
    };
    let path = case.write(&root("locked-input")).unwrap();
    set_permissions(&path, Permissions::from_mode(0o000)).unwrap();
    if read(&path).is_ok() {
        eprintln!("skipped: this user may read every file");
        return;
    }
    let error = load(&path, &Laws::default()).unwrap_err().to_string();
    assert!(error.contains("event.toml: may not be read"), "{error}");
}
