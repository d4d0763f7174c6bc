//! Binding of `file`: motion databases in files.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use gmr_core::matching::file::{Fault, FileError, Labels, check, open, save};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::matching::PyDatabase;

type Opened = (PyDatabase, Vec<String>, Vec<String>, BTreeMap<String, String>);

#[pyfunction]
fn save_database(
    py: Python<'_>,
    database: &PyDatabase,
    path: PathBuf,
    joints: Vec<String>,
    clips: Vec<String>,
    notes: BTreeMap<String, String>,
) -> PyResult<()> {
    let labels = Labels { joints, clips, notes };
    py.detach(|| save(&database.0, &labels, &path)).map_err(refused)
}

/// A `ValueError` where the index is not that of the rows.
#[pyfunction]
fn check_database(py: Python<'_>, database: &PyDatabase) -> PyResult<()> {
    py.detach(|| check(&database.0)).map_err(|error| PyValueError::new_err(error.to_string()))
}

#[pyfunction]
fn open_database(py: Python<'_>, path: PathBuf) -> PyResult<Opened> {
    let (database, Labels { joints, clips, notes }) = py.detach(|| open(&path)).map_err(refused)?;
    Ok((PyDatabase(Arc::new(database)), joints, clips, notes))
}

/// The system's own error as such; a file that is none of ours as a `ValueError`, without its name.
fn refused(error: FileError) -> PyErr {
    match error.fault {
        Fault::Io(error) => error.into(),
        fault => PyValueError::new_err(fault.to_string()),
    }
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(save_database, module)?)?;
    module.add_function(wrap_pyfunction!(check_database, module)?)?;
    module.add_function(wrap_pyfunction!(open_database, module)?)
}
