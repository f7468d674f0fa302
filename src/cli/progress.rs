//! Progress: a bar on a terminal, plain lines otherwise, nothing where that
//! was asked for.

use std::io::IsTerminal;
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};

use super::screen::{complain, shown};
use crate::infer::Progress;

/// Tells on the standard error stream how far an inference has come.
#[derive(Debug)]
pub(super) struct Told {
    bar: Mutex<ProgressBar>,
    way: Way,
}

/// How progress is told.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    Bar,
    Lines,
    Quiet,
}

impl Told {
    pub(super) fn new(quiet: bool) -> Self {
        let way = match quiet {
            true => Way::Quiet,
            false if std::io::stderr().is_terminal() => Way::Bar,
            false => Way::Lines,
        };
        Self { bar: Mutex::new(ProgressBar::hidden()), way }
    }

    /// Whether a bar shows it.
    pub(super) fn is_bar(&self) -> bool {
        self.way == Way::Bar
    }

    /// Says a line, unless nothing is to be told.
    pub(super) fn say(&self, line: &str) {
        if self.way != Way::Quiet {
            complain(line);
        }
    }

    /// Clears the bar: the work is done.
    pub(super) fn finish(&self) {
        self.with_bar(|bar| bar.finish_and_clear());
    }

    fn with_bar(&self, work: impl FnOnce(&mut ProgressBar)) {
        if let Ok(mut bar) = self.bar.lock() {
            work(&mut bar);
        }
    }
}

impl Drop for Told {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Progress for Told {
    fn begin(&self, what: &str, steps: Option<u64>) {
        if !self.is_bar() {
            self.say(&format!("{what} ..."));
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
            fresh.set_message(shown(what));
            *bar = fresh;
        });
    }

    fn advance(&self, steps: u64) {
        if self.is_bar() {
            self.with_bar(|bar| bar.inc(steps));
        }
    }
}
