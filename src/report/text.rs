//! Text from outside, made safe for a terminal, for SVG and for HTML.

use crate::spelling::breaks_line;

/// The text with control characters (terminal escapes, characters that XML
/// forbids, marks that turn a line) replaced by a visible mark.
pub(crate) fn plain(text: &str) -> String {
    let forbidden =
        |c: char| breaks_line(c) || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars().map(|c| if forbidden(c) { '\u{fffd}' } else { c }).collect()
}

/// With a capital letter.
pub(crate) fn capital(words: &str) -> String {
    let mut chars = words.chars();
    let first = chars.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + chars.as_str()
}

/// A friction law in a sentence: those called by names have their capitals.
pub(crate) fn law(name: &str) -> String {
    let written = |word: &str| match word {
        "coulomb" | "voellmy" => capital(word),
        "pcm" => word.to_uppercase(),
        other => plain(other),
    };
    name.split(' ').map(written).collect::<Vec<_>>().join(" ")
}

/// Whether the recordings of events were computed: a name says so.
pub(crate) fn is_synthetic(name: &str) -> bool {
    name.to_lowercase().contains("synthetic")
}

/// A unit to print: empty for a number without one, exponents raised.
pub(crate) fn unit(unit: &str) -> String {
    if unit == "1" {
        return String::new();
    }
    let mut before = ' ';
    let raised = |c: char| {
        let exponent = before.is_ascii_alphabetic();
        before = c;
        match c {
            '2' if exponent => '²',
            '3' if exponent => '³',
            other => other,
        }
    };
    plain(unit).chars().map(raised).collect()
}

/// The text with everything escaped that has a meaning in XML.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in plain(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            other => out.push(other),
        }
    }
    out
}

/// At most `most` characters, the middle left out where there are more.
pub(crate) fn shorten(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    let kept = most.saturating_sub(1);
    let tail = kept / 2;
    let head = text.chars().take(kept - tail);
    head.chain(['…']).chain(text.chars().skip(count - tail)).collect()
}

/// The text broken into lines of at most `width` characters, at blanks where
/// there are any.
pub(crate) fn wrap(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let chars: Vec<char> = word.chars().collect();
        for chunk in chars.chunks(width) {
            let length = line.chars().count();
            if length > 0 && length + 1 + chunk.len() > width {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.extend(chunk);
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

/// At most `most` of the indices `0..count`, evenly spread, the last one
/// among them.
pub(crate) fn thinned(count: usize, most: usize) -> Vec<usize> {
    if count <= most.max(2) {
        return (0..count).collect();
    }
    let last = most.max(2) - 1;
    (0..=last)
        .map(|i| ((count - 1) as u128 * i as u128 / last as u128) as usize)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_and_control_characters_become_text() {
        assert_eq!(escape("<a>&\"'"), "&lt;a&gt;&amp;&quot;&#39;");
        assert_eq!(plain("a\u{1b}[31mb"), "a\u{fffd}[31mb");
    }

    #[test]
    fn laws_called_by_names_have_capitals() {
        assert_eq!(law("coulomb + viscous"), "Coulomb + viscous");
        assert_eq!(law("pcm"), "PCM");
        assert_eq!(law("velocity-weakening"), "velocity-weakening");
        assert_eq!(capital("one \u{1f9ca}"), "One \u{1f9ca}");
    }

    #[test]
    fn units_are_raised() {
        assert_eq!(unit("m2/s2"), "m²/s²");
        assert_eq!(unit("1"), "");
    }

    #[test]
    fn long_text_keeps_both_ends() {
        assert_eq!(shorten("friction[12].mu", 9), "fric…].mu");
        assert_eq!(shorten("mu", 9), "mu");
        assert_eq!(shorten("mu", 0), "…");
    }

    #[test]
    fn wrapped_lines_fit() {
        let lines = wrap("a bb ccccccccc dd", 4);
        assert_eq!(lines, ["a bb", "cccc", "cccc", "c dd"]);
    }

    #[test]
    fn thinning_keeps_both_ends() {
        assert_eq!(thinned(3, 10), [0, 1, 2]);
        assert_eq!(thinned(101, 3), [0, 50, 100]);
        assert!(thinned(0, 5).is_empty());
    }
}
