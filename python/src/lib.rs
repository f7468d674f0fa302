//! couloir's compiled part for Python: what a command makes, and the command
//! itself. Everything that a user sees is in `python/couloir/`.

mod failed;
mod groups;
mod heard;
mod made;

/// The module `couloir._couloir`.
#[pyo3::pymodule]
mod _couloir {
    use std::ffi::OsString;
    use std::path::PathBuf;

    use couloir::physics::friction::Laws;
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::failed::InputError;
    use crate::failed::exception;
    #[pymodule_export]
    use crate::made::{Made, made};

    /// Runs the command with these words behind its name; its exit code.
    #[pyfunction]
    fn command(py: Python<'_>, words: Vec<OsString>) -> u8 {
        py.detach(move || couloir::cli::run(&Laws::default(), &words))
    }

    /// How many events a sweep's list holds.
    #[pyfunction]
    fn events_of(py: Python<'_>, list: PathBuf) -> PyResult<usize> {
        let listed = py.detach(move || couloir::sweep::listed(&list));
        listed.map(|all| all.len()).map_err(|e| exception(&e))
    }
}
