//! Binding of the frames of AMC files.

use gmr_core::numbers::{Bone, FormatFrames, FrameFault, ParseFrames, Places};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Kind, frame, bone, value of that bone, first byte and the byte after the token.
type FaultTuple = (&'static str, usize, Option<usize>, usize, usize, usize);

/// How often, the first frame and the byte of its number.
type PlacesTuple = (usize, usize, usize);

/// Rows, number of the first frame, bones as listed, jumps, missing, the bone first missing, what ended the reading.
type FramesTuple<'py> =
    (Bound<'py, PyArray2<f64>>, u64, Vec<usize>, PlacesTuple, PlacesTuple, usize, Option<FaultTuple>);

/// Frames from `data[start:]`; `names` and `counts` are the bones and how many values each has.
#[pyfunction]
fn parse_frames<'py>(
    py: Python<'py>,
    data: &Bound<'py, PyBytes>,
    start: usize,
    names: Vec<Vec<u8>>,
    counts: Vec<usize>,
) -> PyResult<FramesTuple<'py>> {
    let text = data.as_bytes();
    let bones = bones(&names, &counts)?;
    let job = ParseFrames { text, start: start.min(text.len()), bones: &bones };
    let read = py.detach(|| job.run());
    let shape = [read.frames, counts.iter().sum()];
    let rows = PyArray1::from_vec(py, read.values).reshape(shape)?;
    let (jumps, missing) = (places(read.jumps), places(read.missing));
    Ok((rows, read.first_number, read.listed, jumps, missing, read.missing_bone, read.fault.map(fault)))
}

/// The lines of frames numbered from `first` on; the columns of `rows` are the values of the bones one after the other.
#[pyfunction]
fn format_frames<'py>(
    py: Python<'py>,
    rows: PyReadonlyArray2<'py, f64>,
    names: Vec<Vec<u8>>,
    counts: Vec<usize>,
    first: u64,
) -> PyResult<Bound<'py, PyBytes>> {
    let bones = bones(&names, &counts)?;
    let (frames, columns) = (rows.shape()[0], rows.shape()[1]);
    if counts.iter().sum::<usize>() != columns {
        return Err(PyValueError::new_err(format!("the bones do not have {columns} values")));
    }
    let values = rows.as_slice()?;
    let job = FormatFrames { values, bones: &bones, frames, first_number: first };
    let mut text = Vec::with_capacity(values.len() * 12);
    py.detach(|| job.run(&mut text)).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(PyBytes::new(py, &text))
}

fn bones<'a>(names: &'a [Vec<u8>], counts: &[usize]) -> PyResult<Vec<Bone<'a>>> {
    if names.len() != counts.len() {
        return Err(PyValueError::new_err(format!("{} names but {} counts", names.len(), counts.len())));
    }
    Ok(names.iter().zip(counts).map(|(name, &values)| Bone { name, values }).collect())
}

fn places(places: Places) -> PlacesTuple {
    (places.count, places.frame, places.at)
}

fn fault(fault: FrameFault) -> FaultTuple {
    (fault.flaw.name(), fault.frame, fault.bone, fault.field, fault.token.start, fault.token.end)
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(parse_frames, module)?)?;
    module.add_function(wrap_pyfunction!(format_frames, module)?)
}
