//! Binding of `playback`: the poses that a trial shows.

use gmr_core::matching::ground::Placement;
use gmr_core::matching::playback::{Playback, PlaybackError, shown_positions};
use numpy::ndarray::Array3;
use numpy::{IntoPyArray, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::matching::PyDatabase;

#[pyfunction]
#[pyo3(signature = (database, rows, placements, half_life, joints=None))]
fn trial_positions<'py>(
    py: Python<'py>,
    database: &PyDatabase,
    rows: PyReadonlyArray1<'py, i64>,
    placements: PyReadonlyArray2<'py, f64>,
    half_life: f64,
    joints: Option<Vec<i32>>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    if placements.as_array().ncols() != 3 {
        return Err(PyValueError::new_err("placements must be (T, 3): x, z and heading of each step"));
    }
    // A row below 0 becomes one that no database has, and is refused as such.
    let rows: Vec<u32> = rows.as_array().iter().map(|&row| u32::try_from(row).unwrap_or(u32::MAX)).collect();
    let placements = placements.as_array();
    let placements: Vec<_> = placements.outer_iter().map(|p| Placement::new(p[0], p[1], p[2])).collect();
    let database = &*database.0;
    let playback =
        Playback { database, rows: &rows, placements: &placements, half_life, joints: joints.as_deref() };
    let shape = (rows.len(), joints.as_ref().map_or(database.joint_count(), Vec::len), 3);
    let positions = py.detach(|| -> Result<_, PlaybackError> {
        let mut positions = vec![0.0; shape.0 * shape.1 * shape.2];
        shown_positions(&playback, &mut positions).map(|()| positions)
    });
    let array = Array3::from_shape_vec(shape, positions.map_err(value_error)?).map_err(value_error)?;
    Ok(array.into_pyarray(py))
}

fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(trial_positions, module)?)
}
