//! couloir's errors as exceptions.

use couloir::Error;
use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};

create_exception!(
    couloir,
    InputError,
    PyValueError,
    "An input that has to be mended: a file, a name, a value."
);

/// The exception that stands for an error.
pub(crate) fn exception(error: &Error) -> PyErr {
    let text = error.to_string();
    if error.is_input() {
        InputError::new_err(text)
    } else if error.is_inference() {
        PyRuntimeError::new_err(text)
    } else {
        PyOSError::new_err(text)
    }
}
