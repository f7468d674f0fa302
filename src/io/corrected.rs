//! An event folder written again, with another model: what a diagnosis found
//! goes into the user's own event.toml, whose comments and order stay.

use std::path::Path;

use toml_edit::{Array, DocumentMut, Item, TableLike, Value, table};

use super::document::Document;
use super::embedded;
use super::event_file::{MOST_BYTES, find};
use super::source::{read_data, read_text};
use super::words::place;
use crate::error::{Error, Result};
use crate::observe::Series;

/// What is changed of an event's model.
#[derive(Debug, Clone, Default)]
pub struct Correction {
    /// The friction law, where it is another than the file's.
    pub friction: Option<String>,
    /// The noise, where it is another than the file's.
    pub noise: Option<String>,
    /// The labels of all mechanisms.
    pub mechanisms: Vec<String>,
    /// The priors that the changed model has no parameters for.
    pub unused: Vec<String>,
    /// The recording, where it is another than the file's.
    pub recording: Option<Series>,
}

/// The files of an event with a corrected model, by their names in a folder:
/// event.toml, recording.csv and, where track or flow depth have a file,
/// track.csv and depth.csv. The event is the built-in one where no path is given.
///
/// # Errors
/// Files that can no longer be read.
pub fn corrected(
    event: Option<&Path>,
    correction: &Correction,
) -> Result<Vec<(&'static str, String)>> {
    let Some(path) = event else {
        let text = edited(embedded::EVENT, Path::new(embedded::PLACE), |d| {
            correct(d, correction)
        })?;
        return Ok(vec![
            ("event.toml", text),
            (
                RECORDING,
                correction
                    .recording
                    .as_ref()
                    .map_or_else(embedded::recording, csv),
            ),
        ]);
    };
    let file = find(path)?;
    let text = read_text(&file, MOST_BYTES)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut data = Vec::new();
    let text = edited(&text, &file, |document| {
        correct(document, correction);
        data = moved(document);
    })?;
    let mut files = vec![("event.toml", text)];
    if let Some(series) = &correction.recording {
        files.push((RECORDING, csv(series)));
        data.retain(|(name, _)| *name != RECORDING);
    }
    for (name, from) in data {
        files.push((name, read_data(&folder.join(from))?));
    }
    Ok(files)
}

/// What the recording is called in the new folder.
const RECORDING: &str = "recording.csv";

/// The sections and keys of an event.toml that may name a file, and what the
/// file is called in the new folder.
pub(super) const FILES: [(&str, &str, &str); 3] = [
    ("track", "file", "track.csv"),
    ("recording", "file", RECORDING),
    ("flow", "depth", "depth.csv"),
];

/// A recording as its file has it, to the last digit.
fn csv(series: &Series) -> String {
    let errors = series.grid().standard_errors();
    let sigma = if errors.is_some() { ",sigma" } else { "" };
    let mut text = format!("t,{}{sigma}\n", series.quantity());
    let rows = series.times().iter().zip(series.values()).enumerate();
    for (i, (t, value)) in rows {
        let sigma = errors.map_or(String::new(), |all| format!(",{}", all[i]));
        text.push_str(&format!("{t},{value}{sigma}\n"));
    }
    text
}

/// The text of an event.toml after a change, all else as it was.
fn edited(
    text: &str,
    path: &Path,
    change: impl FnOnce(&mut DocumentMut),
) -> Result<String> {
    let mut document = editable(text, path)?;
    change(&mut document);
    Ok(document.to_string())
}

/// An event.toml that was read before, with its comments.
pub(super) fn editable(text: &str, path: &Path) -> Result<DocumentMut> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.parse().map_err(|_| match Document::parse(text, path) {
        Err(error) => error,
        Ok(_) => Error::input(format!("{}: is not TOML", place(path))),
    })
}

fn correct(document: &mut DocumentMut, correction: &Correction) {
    let Correction { friction, noise, mechanisms, unused, recording } =
        correction;
    let model = document.entry("model").or_insert_with(table);
    if let Some(model) = model.as_table_like_mut() {
        for (key, name) in [("friction", friction), ("noise", noise)] {
            if let Some(name) = name {
                put(model, key, name.as_str());
            }
        }
        put(model, "mechanisms", mechanisms.iter().collect::<Array>());
    }
    let section = document.get_mut("recording");
    if let (Some(series), Some(section)) =
        (recording, section.and_then(Item::as_table_like_mut))
    {
        put(section, "window", series.window());
    }
    for name in unused {
        remove(document.get_mut("priors"), name);
    }
}

/// Names the data files anew, as they are called in the new folder; returns
/// both names of each.
fn moved(document: &mut DocumentMut) -> Vec<(&'static str, String)> {
    FILES
        .into_iter()
        .filter_map(|(section, key, name)| {
            let section = document.get_mut(section)?.as_table_like_mut()?;
            let from = section.get(key)?.as_str()?.to_owned();
            put(section, key, name);
            Some((name, from))
        })
        .collect()
}

/// Sets a key; what stands beside its value stays.
fn put(section: &mut dyn TableLike, key: &str, value: impl Into<Value>) {
    let mut value = value.into();
    if let Some(old) = section.get(key).and_then(Item::as_value) {
        *value.decor_mut() = old.decor().clone();
    }
    section.insert(key, Item::Value(value));
}

/// Removes a key, or one of two parts: `coulomb.mu`.
fn remove(section: Option<&mut Item>, name: &str) {
    let Some(section) = section.and_then(Item::as_table_like_mut) else {
        return;
    };
    if section.remove(name).is_none()
        && let Some((block, field)) = name.split_once('.')
    {
        remove(section.get_mut(block), field);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(text: &str) -> String {
        let correction = Correction {
            friction: Some("coulomb".into()),
            mechanisms: vec!["surge".into(), "friction-step(time)".into()],
            unused: vec!["xi".into(), "voellmy.mu".into()],
            ..Correction::default()
        };
        edited(text, Path::new("event.toml"), |document| {
            correct(document, &correction);
            moved(document);
        })
        .unwrap()
    }

    const LIST: &str = "mechanisms = [\"surge\", \"friction-step(time)\"]\n";

    #[test]
    fn all_else_stays_as_the_user_wrote_it() {
        let before = "# mine\nname = 'a'\n[track]\nslope = 1.0 # measured\n\
                      [recording]\nfile = \"../x/r.csv\" # by radar\n\
                      [flow]\ndepth = \"../y/h.csv\"\n\
                      [model] # first guess\nfriction = \"voellmy\" # why\n\
                      mechanisms = []\n[priors]\nmu = \"Gamma(9, 0.03)\"\n\
                      xi = \"Gamma(2, 400)\"\nvoellmy.mu = \"Flat()\"\n";
        let expected = before
            .replace("../x/r.csv", "recording.csv")
            .replace("../y/h.csv", "depth.csv")
            .replace("\"voellmy\"", "\"coulomb\"")
            .replace("mechanisms = []\n", LIST)
            .replace("xi = \"Gamma(2, 400)\"\nvoellmy.mu = \"Flat()\"\n", "");
        assert_eq!(after(before), expected);
    }

    #[test]
    fn a_thinned_recording_is_written_with_its_window() {
        let series = Series::velocity(vec![0.5, 1.0], vec![2.5, 0.1 + 0.2])
            .and_then(|s| s.with_standard_errors(vec![0.25, 0.5]))
            .and_then(|s| s.with_window(0.5))
            .unwrap();
        assert_eq!(
            csv(&series),
            "t,velocity,sigma\n0.5,2.5,0.25\n1,0.30000000000000004,0.5\n"
        );
        let recording = Some(series);
        let correction = Correction { recording, ..Correction::default() };
        let before = "[recording]\nfile = \"r.csv\"\nwindow = 0.1 # why\n";
        let text = edited(before, Path::new("event.toml"), |document| {
            correct(document, &correction);
        });
        assert!(text.unwrap().contains("window = 0.5 # why\n"));
    }

    #[test]
    fn a_model_in_another_form_is_found_too() {
        for model in
            ["model = { noise = \"iid\" }\n", "model.noise = \"iid\"\n", ""]
        {
            let text = after(&format!("{model}[track]\nslope = 30.0\n"));
            let document: DocumentMut = text.parse().unwrap();
            let list = document["model"]["mechanisms"].as_array().unwrap();
            assert_eq!(list.len(), 2, "{text}");
            assert_eq!(
                document["model"]["friction"].as_str(),
                Some("coulomb")
            );
            let kept = document["model"].get("noise").is_some();
            assert_eq!(kept, !model.is_empty(), "{text}");
        }
    }
}
