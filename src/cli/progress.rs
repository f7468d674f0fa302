//! Progress: a bar on a terminal, plain lines otherwise.

use std::io::IsTerminal;
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};

use crate::infer::Progress;

/// Tells on the standard error stream how far an inference has come.
#[derive(Debug)]
pub(super) struct Told {
    bar: Mutex<ProgressBar>,
    terminal: bool,
}

impl Told {
    pub(super) fn new() -> Self {
        Self {
            bar: Mutex::new(ProgressBar::hidden()),
            terminal: std::io::stderr().is_terminal(),
        }
    }

    /// Whether a bar shows it.
    pub(super) fn is_bar(&self) -> bool {
        self.terminal
    }

    fn with_bar(&self, work: impl FnOnce(&mut ProgressBar)) {
        if let Ok(mut bar) = self.bar.lock() {
            work(&mut bar);
        }
    }
}

impl Drop for Told {
    fn drop(&mut self) {
        self.with_bar(|bar| bar.finish_and_clear());
    }
}

impl Progress for Told {
    fn begin(&self, what: &str, steps: Option<u64>) {
        if !self.terminal {
            super::complain(&format!("{what} ..."));
            return;
        }
        self.with_bar(|bar| {
            bar.finish_and_clear();
            let (fresh, form) = match steps {
                Some(steps) => (
                    ProgressBar::new(steps),
                    "{msg:32} [{bar:30}] {percent:>3} % {eta:>4}",
                ),
                None => (
                    ProgressBar::new_spinner(),
                    "{msg:32} {spinner} {elapsed}",
                ),
            };
            if let Ok(style) = ProgressStyle::with_template(form) {
                fresh.set_style(style.progress_chars("=> "));
            }
            fresh.set_message(what.to_owned());
            *bar = fresh;
        });
    }

    fn advance(&self, steps: u64) {
        if self.terminal {
            self.with_bar(|bar| bar.inc(steps));
        }
    }
}
