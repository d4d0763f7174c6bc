//! Which instruction set the kernels use.

use gmr_core::Isa;
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;

/// Name of the instruction set that the kernels of this process use.
#[pyfunction]
fn instruction_set() -> &'static str {
    Isa::current().name()
}

/// Names of the instruction sets that this machine can run, slowest first.
#[pyfunction]
fn instruction_sets() -> Vec<&'static str> {
    Isa::available().map(Isa::name).collect()
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    Isa::from_environment().map_err(|error| PyImportError::new_err(error.to_string()))?;
    module.add_function(wrap_pyfunction!(instruction_set, module)?)?;
    module.add_function(wrap_pyfunction!(instruction_sets, module)?)
}
