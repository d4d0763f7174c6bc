//! Binding of `numbers`.

use gmr_core::numbers::{FormatRows, ParseRows, count_rows};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::unwritten;

/// Kind, row and field from 0, first byte and the byte after the token.
type FaultTuple = (&'static str, usize, usize, usize, usize);

/// Rows, the byte after the last whole one, and what ended the reading early.
type RowsTuple<'py> = (Bound<'py, PyArray2<f64>>, usize, Option<FaultTuple>);

/// Rows of `columns` numbers from `data[start:]`, at most `limit` of them.
#[pyfunction]
fn parse_rows<'py>(
    py: Python<'py>,
    data: &Bound<'py, PyBytes>,
    start: usize,
    columns: usize,
    limit: usize,
) -> PyResult<RowsTuple<'py>> {
    let text = data.as_bytes();
    let job = ParseRows { text, start: start.min(text.len()), columns };
    let room = limit.min(job.most_rows());
    let rows: Bound<'py, PyArray2<f64>> = unwritten(py, (room, columns))?;
    let read = {
        let mut out = rows.readwrite();
        let out = out.as_slice_mut()?;
        py.detach(|| job.run(out)).map_err(|error| PyValueError::new_err(error.to_string()))?
    };
    let rows = if read.rows == room { rows } else { first_rows(&rows, read.rows)? };
    let fault = read
        .fault
        .map(|fault| (fault.flaw.name(), fault.row, fault.field, fault.token.start, fault.token.end));
    Ok((rows, read.end, fault))
}

/// A copy of the first rows, so that the room kept for the others can be given back.
fn first_rows<'py>(rows: &Bound<'py, PyArray2<f64>>, count: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let columns = rows.shape()[1];
    let read = rows.readonly();
    let kept: Bound<'py, PyArray2<f64>> = unwritten(rows.py(), (count, columns))?;
    kept.readwrite().as_slice_mut()?.copy_from_slice(&read.as_slice()?[..count * columns]);
    Ok(kept)
}

/// Number of lines of `data[start:]` that hold more than blanks and padding.
#[pyfunction(name = "count_rows")]
fn count_lines(py: Python<'_>, data: &Bound<'_, PyBytes>, start: usize) -> usize {
    let text = data.as_bytes();
    py.detach(|| count_rows(text, start))
}

/// One line for each row, its values as the shortest decimals that read back bit-identical.
#[pyfunction]
fn format_rows<'py>(py: Python<'py>, rows: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyBytes>> {
    let columns = rows.shape()[1];
    let values = rows.as_slice()?;
    let mut text = Vec::with_capacity(values.len() * 9);
    py.detach(|| FormatRows { values, columns }.run(&mut text))
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(PyBytes::new(py, &text))
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(parse_rows, module)?)?;
    module.add_function(wrap_pyfunction!(count_lines, module)?)?;
    module.add_function(wrap_pyfunction!(format_rows, module)?)
}
