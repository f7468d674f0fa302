//! An InferenceData as plain Python: groups of named arrays, real and whole
//! numbers as bytes, words as a list.

use couloir::export::{InferenceData, Values, Variable};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};

/// The attributes of all groups under "", and each group's variables under its
/// name.
pub(crate) fn groups<'py>(
    py: Python<'py>,
    data: &InferenceData,
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("", attributes(py, &data.attributes)?)?;
    for group in &data.groups {
        let variables = PyDict::new(py);
        for variable in &group.variables {
            variables.set_item(&variable.name, array(py, variable)?)?;
        }
        let own = attributes(py, &group.attributes)?;
        all.set_item(group.name, (own, variables))?;
    }
    Ok(all)
}

fn attributes<'py>(
    py: Python<'py>,
    all: &[(String, String)],
) -> PyResult<Bound<'py, PyDict>> {
    let known = PyDict::new(py);
    for (key, value) in all {
        known.set_item(key, value)?;
    }
    Ok(known)
}

/// Dimensions, shape, type and values, last dimension fastest, with its unit
/// and what it is.
fn array<'py>(
    py: Python<'py>,
    variable: &Variable,
) -> PyResult<Bound<'py, PyDict>> {
    let known = PyDict::new(py);
    known.set_item("dimensions", &variable.dimensions)?;
    known.set_item("shape", &variable.shape)?;
    known.set_item("units", &variable.unit)?;
    known.set_item("long_name", &variable.about)?;
    match &variable.values {
        Values::Real(x) => {
            let bytes: Vec<u8> =
                x.iter().flat_map(|x| x.to_le_bytes()).collect();
            known.set_item("type", "<f8")?;
            known.set_item("values", PyBytes::new(py, &bytes))?;
        }
        Values::Whole(x) => {
            let bytes: Vec<u8> =
                x.iter().flat_map(|x| x.to_le_bytes()).collect();
            known.set_item("type", "<i8")?;
            known.set_item("values", PyBytes::new(py, &bytes))?;
        }
        Values::Words(x) => {
            known.set_item("type", "str")?;
            known.set_item("values", PyList::new(py, x)?)?;
        }
        _ => {}
    }
    Ok(known)
}
