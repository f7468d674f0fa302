//! What a command makes, made in a thread of its own while the caller's
//! listens to the interpreter.

use std::any::Any;
use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use couloir::cli;
use couloir::physics::friction::Laws;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::failed::exception;
use crate::groups::groups;
use crate::heard::Heard;

/// How long signals and progress may wait.
const PATIENCE: Duration = Duration::from_millis(100);

/// As much as the first thread of a program has, where the command works.
const STACK: usize = 8 << 20;

/// What a command made: the files it would write, and what its draws say.
#[pyclass(frozen, module = "couloir._couloir")]
#[derive(Debug)]
pub(crate) struct Made(cli::Made);

#[pymethods]
impl Made {
    /// The files by their names, with `/` between folders.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for (name, bytes) in &self.0.files {
            let name = name.to_string_lossy().replace('\\', "/");
            files.set_item(name, PyBytes::new(py, bytes))?;
        }
        Ok(files)
    }

    /// Writes the files into a folder, as the command does with `--out`.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        py.detach(move || self.0.write(&folder)).map_err(|e| exception(&e))
    }

    /// The groups of its InferenceData: name, attributes and variables.
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let data = self.0.data.as_ref().map_err(exception)?;
        groups(py, data)
    }
}

/// The end of the work: what it made, or what it was unwound with.
type End = thread::Result<couloir::Result<cli::Made>>;

/// Does what `couloir` does with these words behind its name. `tell` is called
/// with what is being done, its steps or None, and those that are done.
#[pyfunction]
#[pyo3(signature = (words, tell=None))]
pub(crate) fn made(
    py: Python<'_>,
    words: Vec<OsString>,
    tell: Option<&Bound<'_, PyAny>>,
) -> PyResult<Made> {
    let heard = Arc::new(Heard::default());
    let worker = Arc::clone(&heard);
    let (send, mut end) = channel::<End>();
    let work = move || {
        let made = || cli::made(&Laws::default(), &words, &*worker);
        // Where nobody waits any more, nobody is to be told.
        let _ = send.send(catch_unwind(AssertUnwindSafe(made)));
    };
    thread::Builder::new().stack_size(STACK).spawn(work)?;
    let mut told = heard.now();
    loop {
        let (found, back) = py.detach(move || waited(end));
        end = back;
        if let Some(found) = found {
            return finished(found);
        }
        let now = heard.now();
        let news = tell.filter(|_| now != told);
        let listened = py.check_signals().and_then(|()| {
            news.map_or(Ok(()), |f| f.call1(now.clone()).map(drop))
        });
        if let Err(interrupt) = listened {
            heard.stop();
            return Err(interrupt);
        }
        told = now;
    }
}

/// The end of the work, where it comes soon, and where to wait on.
fn waited(end: Receiver<End>) -> (Option<End>, Receiver<End>) {
    let found: Option<End> = match end.recv_timeout(PATIENCE) {
        Ok(found) => Some(found),
        Err(RecvTimeoutError::Timeout) => None,
        Err(RecvTimeoutError::Disconnected) => {
            let why: Box<dyn Any + Send> = Box::new("it said no word");
            Some(Err(why))
        }
    };
    (found, end)
}

fn finished(end: End) -> PyResult<Made> {
    match end {
        Ok(found) => found.map(Made).map_err(|e| exception(&e)),
        Err(why) => Err(PyRuntimeError::new_err(format!(
            "the work ended in an error of couloir itself: {}",
            words(why.as_ref())
        ))),
    }
}

/// What a panic said.
fn words(why: &(dyn Any + Send)) -> &str {
    let owned = why.downcast_ref::<String>().map(String::as_str);
    owned.or(why.downcast_ref::<&str>().copied()).unwrap_or("no reason given")
}
