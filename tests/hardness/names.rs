//! Names that are programs elsewhere: of HTML, of LaTeX, of a spreadsheet, of
//! a terminal. Wherever they come out they are text.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::command::{EVENT, RECORDING, couloir, event, fresh, told};

/// Names that may be printed. Each is to be the name of an event.
const NAMES: [&str; 2] = [
    "<script>alert(1)</script>\"><img src=x onerror=alert(1)> \
     \\input{/etc/passwd} $%&_#{}~^\\ '+alert(1)+'",
    "=cmd|' /C calc'!A0,\"@SUM(1+1)*cmd\"",
];

/// What would command a terminal, turn a line or break it.
const COMMANDS: [&str; 5] = [
    "a\nb",
    "\u{1b}[2Jwiped",
    "\u{9b}2Jwiped",
    "\u{202e}turned",
    "\u{7}\u{8}",
];

/// All files below a folder, with their names from there.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => {
                    let name = path.strip_prefix(folder).unwrap();
                    let name = name.to_string_lossy().into_owned();
                    found.push((name, fs::read(&path).unwrap()));
                }
            }
        }
    }
    found
}

/// HTML and SVG: none of the names' marks opens anything.
fn is_text_of_a_page(name: &str, text: &str) {
    for mark in ["<script>alert", "<img src=x", "</script>\""] {
        assert!(!text.contains(mark), "{name} has {mark}");
    }
    assert!(!text.contains(forbidden), "{name} has a control character");
}

/// LaTeX: no command but its own, and every sign with a meaning behind a
/// backslash.
fn is_text_of_latex(name: &str, text: &str) {
    assert!(!text.contains("\\input{"), "{name}: {text}");
    let caption = text.split("\\caption{").nth(1).unwrap();
    let caption = caption.split(": ").next().unwrap();
    for sign in ['%', '&', '#', '_'] {
        for (at, _) in caption.match_indices(sign) {
            assert!(caption[..at].ends_with('\\'), "{name}: {caption}");
        }
    }
}

/// CSV: no cell that a spreadsheet would compute.
fn is_text_of_a_spreadsheet(name: &str, text: &str) {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    for record in reader.records() {
        for cell in &record.unwrap() {
            let is_formula = cell.starts_with(['=', '+', '-', '@', '\t']);
            let is_number = cell.parse::<f64>().is_ok();
            assert!(!is_formula || is_number, "{name}: {cell}");
        }
    }
}

fn forbidden(c: char) -> bool {
    let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}');
    (c.is_control() && c != '\n' && c != '\t') || turns
}

/// Looks at every file of a run.
fn check_files(folder: &Path) -> usize {
    let all = files(folder);
    for (name, bytes) in &all {
        let text = String::from_utf8_lossy(bytes);
        match name.rsplit('.').next().unwrap() {
            "html" | "svg" => is_text_of_a_page(name, &text),
            "tex" => is_text_of_latex(name, &text),
            "csv" => is_text_of_a_spreadsheet(name, &text),
            "json" => drop(serde_json::from_str::<Value>(&text).unwrap()),
            _ => {}
        }
    }
    all.len()
}

/// An event of this name, as TOML has it.
fn toml(name: &str) -> String {
    let name = toml_edit::Value::from(name).to_string();
    EVENT.replace("\"synthetic\"", &name)
}

#[test]
fn a_name_is_text_in_every_format() {
    let folder = fresh("names");
    for name in NAMES {
        let source = folder.join("event");
        event(&source, &toml(name));
        let source = source.to_str().unwrap();
        for words in [
            &["calibrate", "--quick", "--format=latex", "--figures"][..],
            &["diagnose", "--quick", "--format=latex"],
            &["simulate", "--set=mu=0.2"],
        ] {
            let out = folder.join("out").join(words[0]);
            let place = out.to_str().unwrap();
            let behind = ["--out", place, source];
            let output = couloir(&[words, &behind].concat());
            let text = told(&output);
            assert_eq!(output.status.code(), Some(0), "{text}");
            assert!(!text.contains(forbidden), "{text:?}");
            assert!(check_files(&out) > 1);
        }
        let json = folder.join("out/calibrate/calibration.json");
        let json: Value =
            serde_json::from_slice(&fs::read(json).unwrap()).unwrap();
        assert_eq!(json["event"], name);
        fs::remove_dir_all(folder.join("out")).unwrap();
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn models_of_such_names_are_compared_and_swept() {
    let folder = fresh("names-swept");
    for (i, name) in NAMES.into_iter().enumerate() {
        event(&folder.join("survey").join(i.to_string()), &toml(name));
    }
    let one = folder.join("survey/0");
    let models = ["--model", "voellmy, iid", "--model", "coulomb, iid"];
    let quick = ["compare", "--draws=200", one.to_str().unwrap()];
    let output = couloir(&[&quick[..], &models].concat());
    let text = told(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(!text.contains(forbidden), "{text:?}");
    let (list, out) = (folder.join("survey"), folder.join("swept"));
    let words = ["sweep", "--verb=calibrate", list.to_str().unwrap(), "--out"];
    let behind = [out.to_str().unwrap(), "--", "--quick"];
    let output = couloir(&[&words[..], &behind].concat());
    assert_eq!(output.status.code(), Some(0), "{}", told(&output));
    assert!(check_files(&out) > 2);
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn an_event_toml_never_commands_a_terminal() {
    let folder = fresh("names-toml");
    for command in COMMANDS {
        let text = toml_edit::Value::from(command).to_string();
        for (from, to) in [
            ("name = \"synthetic\"", format!("name = {text}")),
            ("file = \"track.csv\"", format!("file = {text}")),
            ("\"velocity\"", text.clone()),
            ("\"voellmy\"", text.clone()),
            ("\"iid\"", text.clone()),
            ("\"Gamma(9, 0.03)\"", text.clone()),
            ("window", text.clone()),
            ("[priors]\nmu", format!("[priors]\n{text}")),
            ("[release]", format!("[{text}]")),
        ] {
            let toml = EVENT.replacen(from, &to, 1);
            assert_ne!(toml, EVENT, "{from}");
            event(&folder, &toml);
            refused(&["simulate", folder.to_str().unwrap()], command);
        }
        let header = format!("t,velocity,{command}\n1,2\n");
        event(&folder, EVENT);
        fs::write(folder.join("recording.csv"), header).unwrap();
        refused(&["simulate", folder.to_str().unwrap()], command);
    }
    fs::remove_dir_all(&folder).unwrap();
}

/// One line on the standard error, of which none of the text is raw.
fn refused(words: &[&str], command: &str) {
    let output = couloir(words);
    let text = told(&output);
    assert_eq!(output.status.code(), Some(2), "{command:?}: {text}");
    assert!(!text.contains(forbidden), "{text:?}");
    assert_eq!(text.lines().count(), 1, "{text}");
}

#[cfg(unix)]
#[test]
fn folders_are_called_as_they_like() {
    let folder = fresh("names-folders");
    for name in COMMANDS.into_iter().chain(["--out=x", "; rm -rf ~", "a'b"]) {
        let (source, out) = (folder.join(name), folder.join("out"));
        event(&source, EVENT);
        let words = ["calibrate", "--quick", "--out", out.to_str().unwrap()];
        let paths = ["--", source.to_str().unwrap()];
        let output = couloir(&[&words[..], &paths].concat());
        let text = told(&output);
        assert_eq!(output.status.code(), Some(0), "{name:?}: {text}");
        assert!(!text.contains(forbidden), "{text:?}");
        check_files(&out);
        let into = folder.join("to").join(name);
        let again = ["simulate", "--out", into.to_str().unwrap()];
        let text = told(&couloir(&[&again[..], &paths].concat()));
        assert!(!text.contains(forbidden), "{text:?}");
        assert!(into.is_dir(), "{text}");
        let nothing = folder.join("no").join(name);
        refused(&["simulate", nothing.to_str().unwrap()], name);
        fs::remove_dir_all(&folder).unwrap();
    }
}

#[test]
fn an_import_is_called_as_its_log() {
    let folder = fresh("names-import");
    fs::create_dir_all(&folder).unwrap();
    let log = include_str!("corpus/log/metres.csv");
    for name in
        ["<img src=x onerror=alert(1)>", "=1+1", "$%&_#{}~^\\", "\u{202e}x"]
    {
        let file: PathBuf = folder.join(format!("{name}.csv"));
        fs::write(&file, log).unwrap();
        let out = folder.join("out");
        let words = ["import", "--out", out.to_str().unwrap(), "--"];
        let output =
            couloir(&[&words[..], &[file.to_str().unwrap()]].concat());
        let text = told(&output);
        assert!(!text.contains(forbidden), "{text:?}");
        let is_plain = !name.contains(forbidden);
        assert_eq!(output.status.success(), is_plain, "{text}");
        if is_plain {
            check_files(&out);
            let again = couloir(&["simulate", out.to_str().unwrap()]);
            assert!(again.status.success(), "{}", told(&again));
            let text = fs::read_to_string(out.join("event.toml")).unwrap();
            let event: toml_edit::DocumentMut = text.parse().unwrap();
            assert_eq!(event["name"].as_str(), Some(name));
            fs::remove_dir_all(&out).unwrap();
        }
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_very_long_name_is_refused_or_cut() {
    let folder = fresh("names-long");
    event(&folder, &toml(&"é".repeat(100_000)));
    refused(&["simulate", folder.to_str().unwrap()], "a long name");
    let wide = format!("t,velocity,{}\n{RECORDING}", "w".repeat(900));
    event(&folder, EVENT);
    fs::write(folder.join("recording.csv"), wide).unwrap();
    refused(&["simulate", folder.to_str().unwrap()], "a wide header");
    fs::remove_dir_all(&folder).unwrap();
}
