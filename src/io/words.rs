//! Words of messages: foreign text made safe to print.

use std::path::Path;

pub(crate) use crate::spelling::{breaks_line, quoted};

/// The largest number, either way, that a file may give: further from
/// anything that slides than any slip of units, and safe to square.
pub(super) const LARGEST: f64 = 1e9;

/// A path as the user gave it, unless that would break the line.
pub(crate) fn place(path: &Path) -> String {
    let text = path.display().to_string();
    if text.chars().any(breaks_line) { format!("{text:?}") } else { text }
}

/// The names in quotes: "a", "b" or "c".
pub(crate) fn either(names: &[&str]) -> String {
    let quoted: Vec<_> = names.iter().map(|n| format!("{n:?}")).collect();
    match quoted.split_last() {
        None => "nothing".to_owned(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
    }
}

/// A number, if it is one that couloir can take; otherwise what is wrong
/// with it.
pub(super) fn admissible(value: f64) -> Result<f64, String> {
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    Err(format!(
        "is {value:?}; expected a finite number in SI units, from -{LARGEST:e} \
         to {LARGEST:e}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_stays_on_one_line() {
        assert_eq!(place(Path::new("a/b c")), "a/b c");
        assert_eq!(place(Path::new("a\nb")), r#""a\nb""#);
    }

    #[test]
    fn names_are_listed_with_or_before_the_last() {
        assert_eq!(either(&["a", "b", "c"]), r#""a", "b" or "c""#);
    }
}
