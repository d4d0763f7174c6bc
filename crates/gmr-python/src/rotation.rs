//! Euler angles, quaternions and resampling over NumPy arrays.

use gmr_core::lanes::Real;
use gmr_core::rotation::{self, EulerColumns};
use numpy::{
    Element, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::arrays::unwritten;
use crate::kinematics::{input, output, to_vec, triples, value_error};

/// Local rotations of all slots, from rows (F, C) of degrees into `out` (F, S, 4), float32 or float64.
#[pyfunction]
fn euler_to_quaternions(
    py: Python<'_>,
    rows: PyReadonlyArray2<'_, f64>,
    columns: PyReadonlyArray2<'_, i32>,
    axes: PyReadonlyArray2<'_, u8>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let (columns, axes) = (triples(&columns, "columns")?, triples(&axes, "axes")?);
    let angles = EulerColumns { columns: &columns, axes: &axes };
    if out.cast::<numpy::PyArrayDyn<f32>>().is_ok() {
        return fill::<f32>(py, &rows, angles, out);
    }
    fill::<f64>(py, &rows, angles, out)
}

fn fill<T: Real + Element>(
    py: Python<'_>,
    rows: &PyReadonlyArray2<'_, f64>,
    angles: EulerColumns<'_>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let mut out = output::<T>(out, "out", 4)?;
    let (column_count, rows, out) = (rows.shape()[1], rows.as_slice()?, out.as_slice_mut()?);
    py.detach(|| rotation::euler_to_quaternions(rows, column_count, angles, out)).map_err(value_error)
}

/// `euler_to_quaternions` about axes of each slot's own, turned by `frames` (S, 4) float64: C A C^-1; float64.
#[pyfunction]
fn turned_euler_to_quaternions(
    py: Python<'_>,
    rows: PyReadonlyArray2<'_, f64>,
    columns: PyReadonlyArray2<'_, i32>,
    axes: PyReadonlyArray2<'_, u8>,
    frames: PyReadonlyArray2<'_, f64>,
    out: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let (columns, axes) = (triples(&columns, "columns")?, triples(&axes, "axes")?);
    let angles = EulerColumns { columns: &columns, axes: &axes };
    let mut out = output::<f64>(out, "out", 4)?;
    let (column_count, rows, out) = (rows.shape()[1], rows.as_slice()?, out.as_slice_mut()?);
    let frames = frames.as_slice()?.as_chunks::<4>().0;
    py.detach(|| rotation::turned_euler_to_quaternions(rows, column_count, angles, frames, out))
        .map_err(value_error)
}

/// Turns slots of `rotations` (F, S, 4) by other slots, in place and one after the other.
#[pyfunction]
#[pyo3(signature = (rotations, slots, by, inverse, threads=1))]
fn turn_slots(
    py: Python<'_>,
    rotations: &Bound<'_, PyAny>,
    slots: PyReadonlyArray1<'_, i32>,
    by: PyReadonlyArray1<'_, i32>,
    inverse: bool,
    threads: usize,
) -> PyResult<()> {
    let mut rotations = output::<f64>(rotations, "rotations", 4)?;
    let (slots, by, slot_count) = (to_vec(&slots), to_vec(&by), rotations.shape()[1]);
    let pairs: Vec<(i32, i32)> = slots.into_iter().zip(by).collect();
    let rotations = rotations.as_slice_mut()?;
    py.detach(|| rotation::turn_slots(rotations, slot_count, &pairs, inverse, threads)).map_err(value_error)
}

/// Angles in degrees (F, S, 3) about the axes (S, 3) of each slot, from quaternions (F, S, 4) float64; continuous from
/// frame to frame.
#[pyfunction]
fn quaternions_to_euler<'py>(
    py: Python<'py>,
    quaternions: PyReadonlyArray3<'py, f64>,
    axes: PyReadonlyArray2<'py, u8>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let axes = triples(&axes, "axes")?;
    let quaternions = input::<f64>(quaternions.as_any(), "quaternions", 4)?;
    let degrees: Bound<'py, PyArray3<f64>> =
        unwritten(py, (quaternions.shape()[0], quaternions.shape()[1], 3))?;
    let mut writing = degrees.readwrite();
    let (quaternions, out) = (quaternions.as_slice()?, writing.as_slice_mut()?);
    py.detach(|| rotation::quaternions_to_euler(quaternions, &axes, out)).map_err(value_error)?;
    drop(writing);
    Ok(degrees)
}

/// Rotations (G, S, 4) at `times` (G,) in frames between those of (F, S, 4), the short way round; float32 or float64.
#[pyfunction]
fn slerp_frames<'py>(
    py: Python<'py>,
    quaternions: &Bound<'py, PyAny>,
    times: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let times = to_vec(&times);
    match input::<f32>(quaternions, "quaternions", 4) {
        Ok(quaternions) => resample(py, &quaternions, &times),
        Err(_) => resample(py, &input::<f64>(quaternions, "quaternions", 4)?, &times),
    }
}

fn resample<'py, T: Real + Element>(
    py: Python<'py>,
    quaternions: &numpy::PyReadonlyArrayDyn<'py, T>,
    times: &[f64],
) -> PyResult<Bound<'py, PyAny>> {
    let slot_count = quaternions.shape()[1];
    let frames: Bound<'py, PyArray3<T>> = unwritten(py, (times.len(), slot_count, 4))?;
    let mut writing = frames.readwrite();
    let (quaternions, out) = (quaternions.as_slice()?, writing.as_slice_mut()?);
    py.detach(|| rotation::slerp_frames(quaternions, slot_count, times, out)).map_err(value_error)?;
    drop(writing);
    Ok(frames.into_any())
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(euler_to_quaternions, module)?)?;
    module.add_function(wrap_pyfunction!(turned_euler_to_quaternions, module)?)?;
    module.add_function(wrap_pyfunction!(turn_slots, module)?)?;
    module.add_function(wrap_pyfunction!(quaternions_to_euler, module)?)?;
    module.add_function(wrap_pyfunction!(slerp_frames, module)?)
}
