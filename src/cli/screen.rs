//! What reaches the terminal: answers on the standard output, everything else
//! on the standard error stream.

use std::io::{ErrorKind, Write as _};

use crate::error::{Error, Result};
use crate::spelling::breaks_line;

/// Prints a result. A reader that has gone away (`| head`) is no error.
pub(super) fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    let text = shown(text);
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::system(format!(
                "the answer could not be printed ({error}); expected a \
                 standard output that takes it: send it somewhere else"
            )))
        }
        _ => Ok(()),
    }
}

/// Says a line on the standard error stream.
pub(super) fn complain(message: &str) {
    // Where that is closed or full, nobody is left to be told.
    let _ = writeln!(std::io::stderr(), "couloir: {}", shown(message));
}

/// A text with what would command a terminal, or turn its lines, written out
/// as JSON has it: `\u001b`. Whatever a file, a folder or an option is called,
/// this is where it comes by; and in a JSON document it means the same.
pub(super) fn shown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\t' => out.push(c),
            _ if breaks_line(c) => {
                out.push_str(&format!("\\u{:04x}", u32::from(c)));
            }
            _ => out.push(c),
        }
    }
    out
}

/// The width to print to: that of the terminal, 80 at the most.
pub(super) fn width() -> usize {
    let columns = console_columns().unwrap_or(80);
    columns.clamp(44, 80)
}

fn console_columns() -> Option<usize> {
    std::env::var("COLUMNS").ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_is_never_commanded() {
        assert_eq!(shown("a\tb\né"), "a\tb\né");
        assert_eq!(shown("\u{1b}[2J\r\u{9b}1A"), r"\u001b[2J\u000d\u009b1A");
        let name = "turned \u{202e} and wiped \u{7f}";
        let json = serde_json::json!({ "name": name }).to_string();
        let back: serde_json::Value =
            serde_json::from_str(&shown(&json)).unwrap();
        assert_eq!(back["name"], name);
    }
}
