//! The page of formats names what files have.

use std::fs;

use couloir::report::{CalibrationReport, calibration_json};

use super::{book, root};

fn page() -> String {
    fs::read_to_string(book().join("formats.md")).unwrap()
}

#[test]
fn every_key_of_a_calibration_is_told() {
    let (page, json) =
        (page(), calibration_json(&CalibrationReport::default()));
    for key in json.as_object().unwrap().keys() {
        assert!(page.contains(&format!("`{key}`")), "{key}");
    }
}

#[test]
fn every_key_of_an_event_file_is_told() {
    let template = root().join("src/io/template/event.toml");
    let text = fs::read_to_string(template).unwrap();
    let mut section = "";
    let mut told = 0;
    for line in text.lines() {
        let line = line.trim_start_matches("# ");
        if let Some(name) = line.strip_prefix('[') {
            // A unit in a comment, such as [m], is no section.
            let name = name.split(']').next().unwrap();
            section = if name.len() > 3 { name } else { section };
        }
        let Some((key, _)) = line.split_once(" = ") else { continue };
        let is_key = key.chars().all(|c| c.is_ascii_lowercase());
        if !is_key || section.is_empty() || section == "priors" {
            continue;
        }
        let name = format!("`{section}.{key}`");
        assert!(page().contains(&name), "{name}");
        told += 1;
    }
    assert!(told >= 10, "{told}");
}
