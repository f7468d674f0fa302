//! What reaches the terminal: answers on the standard output, everything else
//! on the standard error stream.

use std::io::{ErrorKind, Write as _};

use crate::error::{Error, Result};

/// Prints a result. A reader that has gone away (`| head`) is no error.
pub(super) fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
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
    let _ = writeln!(std::io::stderr(), "couloir: {message}");
}

/// The width to print to: that of the terminal, 80 at the most.
pub(super) fn width() -> usize {
    let columns = console_columns().unwrap_or(80);
    columns.clamp(44, 80)
}

fn console_columns() -> Option<usize> {
    std::env::var("COLUMNS").ok()?.parse().ok()
}
