//! The General Motion Representation over NumPy arrays: configurations, and motions carried between them.

use gmr_core::forest::{self, Configure, Configured, Forest, ForestError};
use gmr_core::kinematics::Pose;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::unwritten;
use crate::kinematics::{EulerRows, PyTopology, input, to_vec, value_error};

/// A skeleton in one of its configurations.
#[pyclass(name = "Forest", module = "gmr._core", frozen)]
pub(crate) struct PyForest {
    inner: Forest,
}

#[pymethods]
impl PyForest {
    #[new]
    #[pyo3(signature = (home, parents=None))]
    fn new(home: &PyTopology, parents: Option<PyReadonlyArray1<'_, i32>>) -> PyResult<Self> {
        let forest = Forest::new(&home.inner);
        let inner = match parents {
            None => forest,
            Some(parents) => forest.with_parents(&to_vec(&parents)).map_err(value_error)?,
        };
        Ok(Self { inner })
    }

    /// The forest in which `joint` is the root of its tree; `names` are for errors.
    fn shift_root(&self, joint: usize, names: &Bound<'_, PyAny>) -> PyResult<Self> {
        named(self.inner.shift_root(joint), names)
    }

    /// The forest in which `joint` is a root too.
    fn split(&self, joint: usize, names: &Bound<'_, PyAny>) -> PyResult<Self> {
        named(self.inner.split(joint), names)
    }

    /// The forest in which `root` hangs on its old parent again.
    fn join(&self, root: usize, names: &Bound<'_, PyAny>) -> PyResult<Self> {
        named(self.inner.join(root), names)
    }

    /// The forest with just these roots.
    fn with_roots(&self, roots: Vec<usize>, names: &Bound<'_, PyAny>) -> PyResult<Self> {
        named(self.inner.with_roots(&roots), names)
    }

    /// The root of a joint's tree.
    fn root_of(&self, joint: usize) -> usize {
        self.inner.root_of(joint)
    }

    /// The joint of a joint's tree that is nearest to home.
    fn top_of(&self, joint: usize) -> usize {
        self.inner.top_of(joint)
    }

    #[getter]
    fn topology(&self) -> PyTopology {
        PyTopology { inner: self.inner.topology().clone() }
    }

    #[getter]
    fn bones<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_iter(py, self.inner.bones().iter().map(|&bone| bone as i32))
    }

    #[getter]
    fn links<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_vec(py, self.inner.links())
    }
}

fn named(result: Result<Forest, ForestError>, names: &Bound<'_, PyAny>) -> PyResult<PyForest> {
    let name = |joint: usize| match names.get_item(joint) {
        Ok(name) => format!("'{name}'"),
        Err(_) => format!("joint {joint}"),
    };
    result.map(|inner| PyForest { inner }).map_err(|error| PyValueError::new_err(error.describe(name)))
}

/// Frames as they come from Python: quaternions (F, S, 4) and translations (F, T, 3); or rows (F, C) as files hold
/// them, the columns and axes of each rotation, the columns of each translation, and whether these add to offsets.
#[derive(FromPyObject)]
enum Frames<'py> {
    Quaternions(Bound<'py, PyAny>, Bound<'py, PyAny>),
    Rows(
        PyReadonlyArray2<'py, f64>,
        PyReadonlyArray2<'py, i32>,
        PyReadonlyArray2<'py, u8>,
        PyReadonlyArray2<'py, i32>,
        bool,
    ),
}

/// Rotations (F, S, 4), the joints translated (U,) and their translations (F, U, 3) in `to`, of frames in `from`; of
/// some of its slots and joints alone where they are given.
#[pyfunction]
#[pyo3(signature = (from, to, offsets, translated, frames, threads=1, slots=None, joints=None))]
#[allow(clippy::too_many_arguments)]
fn configure<'py>(
    py: Python<'py>,
    from: &PyForest,
    to: &PyForest,
    offsets: PyReadonlyArray2<'py, f64>,
    translated: PyReadonlyArray1<'py, i32>,
    frames: Frames<'py>,
    threads: usize,
    slots: Option<PyReadonlyArray1<'py, i32>>,
    joints: Option<PyReadonlyArray1<'py, i32>>,
) -> PyResult<Answer<'py>> {
    let run = |pose: Pose<'_, f64>, frame_count| {
        carried(py, from, to, &offsets, &to_vec(&translated), pose, frame_count, threads, [slots, joints])
    };
    match frames {
        Frames::Quaternions(rotations, translations) => {
            let rotations = input::<f64>(&rotations, "rotations", 4)?;
            let translations = input::<f64>(&translations, "translations", 3)?;
            let frame_count = rotations.shape()[0];
            let (rotations, translations) = (rotations.as_slice()?, translations.as_slice()?);
            run(Pose::Quaternions { rotations, normalize: false, translations }, frame_count)
        }
        Frames::Rows(rows, columns, axes, places, adds_offset) => {
            let rows = EulerRows::new(rows, &columns, &axes, &places, adds_offset)?;
            run(rows.pose()?, rows.frame_count())
        }
    }
}

type Answer<'py> = (Bound<'py, PyArray3<f64>>, Bound<'py, PyArray1<i32>>, Bound<'py, PyArray3<f64>>);

#[allow(clippy::too_many_arguments)]
fn carried<'py>(
    py: Python<'py>,
    from: &PyForest,
    to: &PyForest,
    offsets: &PyReadonlyArray2<'py, f64>,
    translated: &[i32],
    pose: Pose<'_, f64>,
    frame_count: usize,
    threads: usize,
    wanted: [Option<PyReadonlyArray1<'py, i32>>; 2],
) -> PyResult<Answer<'py>> {
    let (from, to, offsets) = (&from.inner, &to.inner, offsets.as_slice()?);
    let [slots, joints] = wanted.map(|indices| indices.map(|indices| to_vec(&indices)));
    let (slots, joints) = (slots.as_deref(), joints.as_deref());
    let job = Configure { from, to, offsets, translated, pose, frame_count, slots, joints, threads };
    let after = job.translated_after();
    let slot_count = slots.map_or(to.topology().slot_count(), <[i32]>::len);
    let rotations: Bound<'py, PyArray3<f64>> = unwritten(py, (frame_count, slot_count, 4))?;
    let translations: Bound<'py, PyArray3<f64>> = unwritten(py, (frame_count, after.len(), 3))?;
    {
        let (mut rotations, mut translations) = (rotations.readwrite(), translations.readwrite());
        let out =
            Configured { rotations: rotations.as_slice_mut()?, translations: translations.as_slice_mut()? };
        py.detach(|| forest::configure(&job, out)).map_err(value_error)?;
    }
    Ok((rotations, PyArray1::from_vec(py, after), translations))
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyForest>()?;
    module.add_function(wrap_pyfunction!(configure, module)?)
}
