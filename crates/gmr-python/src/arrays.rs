//! New NumPy arrays.

use numpy::ndarray::Dimension;
use numpy::{Element, PyArray, dtype};
use pyo3::prelude::*;

/// An array to write into, all of it.
///
/// NumPy makes it: it raises MemoryError where there is no room, in which `PyArray::new` would panic, and asks Linux for
/// large pages. Zeros would be written by it, or by the system a second time, before anything else is.
pub(crate) fn unwritten<'py, T: Element, D: Dimension>(
    py: Python<'py>,
    shape: impl IntoPyObject<'py>,
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    Ok(py.import("numpy")?.call_method1("empty", (shape, dtype::<T>(py)))?.cast_into()?)
}
