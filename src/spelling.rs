//! Foreign words in messages: made safe to print, and what a misspelt one
//! may have meant.

/// The longest piece of foreign text in a message, in characters, and the
/// longest word, in bytes, that is taken for a misspelt name.
const LONGEST: usize = 60;

/// Foreign text in quotes, its control characters escaped and its end cut.
pub(crate) fn quoted(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        None => format!("{text:?}"),
        Some((end, _)) => format!("{:?}...", &text[..end]),
    }
}

/// Whether a character would break or turn a line of a message: controls,
/// line separators, and marks without a width or of a writing direction.
pub(crate) fn breaks_line(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

/// The name that a misspelt one is closest to, if any is close: the case
/// aside, at most one letter in three is wrong, and one more, but never more
/// than half of them.
pub(crate) fn nearest<'n>(found: &str, known: &[&'n str]) -> Option<&'n str> {
    if found.len() > LONGEST {
        return None;
    }
    let found = found.to_lowercase();
    let near = known
        .iter()
        .map(|name| (edits(&found, &name.to_lowercase()), *name))
        .min();
    let is_near = |(edits, name): &(usize, &str)| {
        let letters = found.chars().count().max(name.chars().count());
        *edits <= 1 + name.len() / 3 && 2 * *edits <= letters
    };
    near.filter(is_near).map(|n| n.1)
}

/// How many letters to insert, delete or change between two words
/// (Levenshtein's distance).
fn edits(from: &str, to: &str) -> usize {
    let mut row: Vec<usize> = (0..=to.chars().count()).collect();
    for (i, a) in from.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, b) in to.chars().enumerate() {
            let changed = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_text_stays_on_one_line_and_short() {
        assert_eq!(quoted("a\nb\u{1b}[2J"), r#""a\nb\u{1b}[2J""#);
        let long = quoted(&"é".repeat(500));
        assert_eq!(long.chars().count(), LONGEST + 5);
    }

    #[test]
    fn edits_are_counted() {
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("", "iid"), 3);
        assert_eq!(edits("ar", "ar"), 0);
    }

    #[test]
    fn only_a_close_name_is_meant() {
        let known = ["coulomb", "voellmy", "depth", "Speed"];
        assert_eq!(nearest("Voelmy", &known), Some("voellmy"));
        assert_eq!(nearest("depht", &known), Some("depth"));
        assert_eq!(nearest("sped", &known), Some("Speed"));
        assert_eq!(nearest("banana", &known), None);
        assert_eq!(nearest("Truncated", &["Cauchy", "Normal"]), None);
        assert_eq!(nearest("y", &["x", "z"]), None);
        assert_eq!(nearest("ii", &["iid"]), Some("iid"));
        assert_eq!(nearest(&"coulomb".repeat(9), &known), None);
    }
}
