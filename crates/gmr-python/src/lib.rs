//! The extension module `gmr._core`: each topic of gmr-core in a file of its own, nothing but conversions, checks,
//! the GIL and errors.

use pyo3::prelude::*;

mod amc;
mod arrays;
mod character;
mod forest;
mod index;
mod isa;
mod kinematics;
mod matching;
mod numbers;
mod playback;
mod rotation;
mod saved;
mod skinning;
mod trial;
mod watch;

#[pymodule(gil_used = false)]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    isa::register(module)?;
    numbers::register(module)?;
    amc::register(module)?;
    rotation::register(module)?;
    kinematics::register(module)?;
    forest::register(module)?;
    skinning::register(module)?;
    index::register(module)?;
    matching::register(module)?;
    saved::register(module)?;
    character::register(module)?;
    trial::register(module)?;
    playback::register(module)
}
