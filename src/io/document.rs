//! An event file as a tree of sections and keys that know their lines.

use std::fmt::Display;
use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::source::line_of;
use super::words::{admissible, breaks_line, either, place, quoted};
use crate::error::{Error, Result};
use crate::spelling::nearest;

/// The longest text that a key may have, in characters.
const LONGEST: usize = 200;

/// A parsed event file.
#[derive(Debug)]
pub(super) struct Document<'d> {
    text: &'d str,
    path: &'d Path,
    table: DeTable<'d>,
}

/// A section of an event file, perhaps absent; the top level is one too.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section<'d> {
    document: &'d Document<'d>,
    name: &'d str,
    table: Option<&'d DeTable<'d>>,
    offset: usize,
}

/// The value of a key.
#[derive(Debug, Clone, Copy)]
struct Entry<'d> {
    value: &'d DeValue<'d>,
    offset: usize,
}

impl<'d> Document<'d> {
    /// Parses TOML; an error names the line.
    pub(super) fn parse(text: &'d str, path: &'d Path) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        match DeTable::parse(text) {
            Ok(table) => Ok(Self { text, path, table: table.into_inner() }),
            Err(error) => Err(syntax(text, path, &error)),
        }
    }

    /// The top level.
    pub(super) fn top(&'d self) -> Section<'d> {
        Section {
            document: self,
            name: "",
            table: Some(&self.table),
            offset: 0,
        }
    }
}

impl<'d> Section<'d> {
    /// A section below this one, empty if it is absent.
    pub(super) fn section(&self, name: &'d str) -> Result<Section<'d>> {
        let absent = Section { name, table: None, ..*self };
        let Some(entry) = self.entry(name) else { return Ok(absent) };
        match entry.value {
            DeValue::Table(table) => Ok(Section {
                table: Some(table),
                offset: entry.offset,
                ..absent
            }),
            other => Err(self.wrong(
                name,
                other,
                &format!("a section: write [{name}] on a line of its own"),
            )),
        }
    }

    /// Whether the key is there and is a section itself.
    pub(super) fn is_section(&self, key: &str) -> bool {
        self.entry(key).is_some_and(|entry| entry.value.is_table())
    }

    /// Whether the key is there.
    pub(super) fn has(&self, key: &str) -> bool {
        self.entry(key).is_some()
    }

    /// Whether the key is there and is a text.
    pub(super) fn is_text(&self, key: &str) -> bool {
        self.entry(key).is_some_and(|entry| entry.value.is_str())
    }

    /// The keys of the section, in alphabetical order.
    pub(super) fn keys(&self) -> Vec<&'d str> {
        let Some(table) = self.table else { return Vec::new() };
        table.keys().map(|key| key.get_ref().as_ref()).collect()
    }

    /// Refuses keys that are not among the known ones.
    pub(super) fn only(&self, known: &[&str]) -> Result<()> {
        let found = self.keys();
        match found.iter().find(|key| !known.contains(key)) {
            None => Ok(()),
            Some(key) => {
                let mend = match nearest(key, known) {
                    Some(name) => format!("; did you mean {name:?}?"),
                    None => ": mend or drop it".to_owned(),
                };
                Err(self.at(
                    key,
                    format!("is not known; expected {}{mend}", either(known)),
                ))
            }
        }
    }

    /// A number, if the key is there.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>> {
        let Some(entry) = self.entry(key) else { return Ok(None) };
        let value = match entry.value {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(whole) if whole.radix() == 10 => {
                whole.as_str().parse().ok()
            }
            DeValue::Integer(_) => None,
            other => return Err(self.wrong(key, other, "a number")),
        };
        match value {
            Some(value) => admissible(value)
                .map(Some)
                .map_err(|message| self.at(key, message)),
            None => Err(self.at(key, "is no decimal number; expected one")),
        }
    }

    /// A text of one line, if the key is there.
    pub(super) fn text(&self, key: &str) -> Result<Option<&'d str>> {
        self.text_as(key, "a text in quotes")
    }

    /// The same, with words of its own for what is expected.
    pub(super) fn text_as(
        &self,
        key: &str,
        expected: &str,
    ) -> Result<Option<&'d str>> {
        let Some(entry) = self.entry(key) else { return Ok(None) };
        self.line(key, entry.value, expected).map(Some)
    }

    /// A list of texts, empty if the key is not there.
    pub(super) fn texts(&self, key: &str) -> Result<Vec<&'d str>> {
        let Some(entry) = self.entry(key) else { return Ok(Vec::new()) };
        let expected = "a list of texts, such as [\"a\", \"b\"]";
        match entry.value {
            DeValue::Array(list) => list
                .iter()
                .map(|item| self.line(key, item.get_ref(), expected))
                .collect(),
            other => Err(self.wrong(key, other, expected)),
        }
    }

    /// The error for a key of this section, with its line where it has one.
    pub(super) fn at(&self, key: &str, message: impl Display) -> Error {
        Error::input(format!("{} {message}", self.spot(key)))
    }

    /// Puts a key before an error that speaks of its value.
    pub(super) fn about(&self, key: &str, error: Error) -> Error {
        error.within(self.spot(key))
    }

    /// The error for a key that has to be there and is not.
    pub(super) fn missing(&self, key: &str, mend: &str) -> Error {
        let write = match (self.table, self.name) {
            (Some(_), "") => format!("write {mend} at the top"),
            (Some(_), name) => format!("write {mend} below [{name}]"),
            (None, name) => {
                format!("write a line [{name}] and below it {mend}")
            }
        };
        self.at(key, format!("is missing: {write}"))
    }

    /// "event.toml:7".
    pub(super) fn line_of(&self, key: &str) -> String {
        let document = self.document;
        let offset = self.entry(key).map_or(self.offset, |e| e.offset);
        let mut spot = place(document.path);
        if offset > 0 || self.entry(key).is_some() {
            let line = line_of(document.text.as_bytes(), offset);
            spot.push_str(&format!(":{line}"));
        }
        spot
    }

    /// "event.toml:7: flow.depth".
    pub(super) fn spot(&self, key: &str) -> String {
        let spot = self.line_of(key);
        let plain = |c: char| c.is_ascii_alphanumeric() || "_-[].".contains(c);
        let key = match key.chars().all(plain) && key.len() <= 60 {
            true => key.to_owned(),
            false => quoted(key),
        };
        let dot = if self.name.is_empty() { "" } else { "." };
        format!("{spot}: {}{dot}{key}", self.name)
    }

    fn entry(&self, key: &str) -> Option<Entry<'d>> {
        let table = self.table?;
        let (name, value) =
            table.iter().find(|(name, _)| name.get_ref() == key)?;
        Some(Entry { value: value.get_ref(), offset: name.span().start })
    }

    /// A text that may be printed and parsed further.
    fn line(
        &self,
        key: &str,
        value: &'d DeValue<'d>,
        expected: &str,
    ) -> Result<&'d str> {
        let DeValue::String(text) = value else {
            return Err(self.wrong(key, value, expected));
        };
        if text.chars().any(breaks_line) || text.chars().count() > LONGEST {
            return Err(self.at(
                key,
                format!(
                    "is {}; expected one line of at most {LONGEST} \
                     characters, none of them a control character",
                    quoted(text)
                ),
            ));
        }
        Ok(text)
    }

    fn wrong(&self, key: &str, found: &DeValue, expected: &str) -> Error {
        let found = match found {
            DeValue::String(text) => {
                format!("the text {}", quoted(text))
            }
            DeValue::Integer(number) => {
                format!("the number {}", cut(&number.to_string()))
            }
            DeValue::Float(number) => {
                format!("the number {}", cut(number.as_str()))
            }
            DeValue::Boolean(value) => value.to_string(),
            DeValue::Datetime(date) => format!("the date {date}"),
            DeValue::Array(_) => "a list".to_owned(),
            DeValue::Table(_) => "a section".to_owned(),
        };
        self.at(key, format!("is {found}; expected {expected}"))
    }
}

fn cut(number: &str) -> String {
    match number.get(..30) {
        Some(start) if number.len() > 30 => format!("{start}..."),
        _ => number.to_owned(),
    }
}

/// The error of the TOML parser as one line.
fn syntax(text: &str, path: &Path, error: &toml::de::Error) -> Error {
    let start = error.span().map_or(0, |span| span.start);
    let line = line_of(text.as_bytes(), start);
    let what: String = error
        .message()
        .chars()
        .map(|c| if breaks_line(c) { ' ' } else { c })
        .take(200)
        .collect();
    let found = text.lines().nth(line - 1).unwrap_or("").trim();
    // A link may lead to any file of the machine.
    let found = match path.is_symlink() {
        true => "another line".to_owned(),
        false => quoted(found),
    };
    Error::input(format!(
        "{}:{line}: is not TOML: {what}; found {found}; expected lines such \
         as depth = 1.5, name = \"text\" or [track]",
        place(path)
    ))
}
