//! Forward kinematics over NumPy arrays.

use gmr_core::kinematics::{self, ForwardKinematics, Pose, World};
use gmr_core::lanes::Real;
use gmr_core::rotation::EulerColumns;
use gmr_core::skeleton::Topology;
use numpy::{
    Element, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn,
    PyReadwriteArrayDyn, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// Parents and rotation slots of a skeleton, checked once.
#[pyclass(name = "Topology", module = "gmr._core", frozen)]
pub(crate) struct PyTopology {
    pub(crate) inner: Topology,
}

#[pymethods]
impl PyTopology {
    #[new]
    fn new(
        parents: PyReadonlyArray1<'_, i32>,
        slots: PyReadonlyArray1<'_, i32>,
        slot_count: usize,
    ) -> PyResult<Self> {
        Topology::new(&to_vec(&parents), &to_vec(&slots), slot_count)
            .map(|inner| Self { inner })
            .map_err(value_error)
    }

    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_slice(py, self.inner.parents())
    }

    #[getter]
    fn slots<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_slice(py, self.inner.slots())
    }

    #[getter]
    fn slot_parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_slice(py, self.inner.slot_parents())
    }

    #[getter]
    fn world_slots<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_slice(py, self.inner.world_slots())
    }

    #[getter]
    fn slot_count(&self) -> usize {
        self.inner.slot_count()
    }

    #[getter]
    fn joint_count(&self) -> usize {
        self.inner.joint_count()
    }
}

/// What both entries take besides the poses.
struct Shared<'py> {
    topology: Py<PyTopology>,
    translated: Vec<i32>,
    offsets: Vec<f64>,
    joints: Option<Vec<i32>>,
    rotation_slots: Option<Vec<i32>>,
    positions_out: Option<Bound<'py, PyAny>>,
    rotations_out: Option<Bound<'py, PyAny>>,
    threads: usize,
}

impl Shared<'_> {
    fn run<T: Real + Element>(&self, py: Python<'_>, pose: Pose<'_, T>, frame_count: usize) -> PyResult<()> {
        let mut positions =
            self.positions_out.as_ref().map(|a| output::<T>(a, "positions_out", 3)).transpose()?;
        let mut rotations =
            self.rotations_out.as_ref().map(|a| output::<T>(a, "rotations_out", 4)).transpose()?;
        let world = World {
            positions: positions.as_mut().map(|a| a.as_slice_mut()).transpose()?,
            rotations: rotations.as_mut().map(|a| a.as_slice_mut()).transpose()?,
        };
        let job = ForwardKinematics {
            topology: &self.topology.get().inner,
            offsets: &self.offsets,
            translated: &self.translated,
            pose,
            frame_count,
            joints: self.joints.as_deref(),
            rotation_slots: self.rotation_slots.as_deref(),
            threads: self.threads,
        };
        py.detach(|| kinematics::forward_kinematics(&job, world)).map_err(value_error)
    }
}

/// World positions and rotations from local quaternions (F, S, 4) and translations (F, T, 3), float32 or float64,
/// into `positions_out` (F, K, 3) and `rotations_out` (F, M, 4) of the same type.
#[pyfunction]
#[pyo3(signature = (topology, rotations, translated, translations, offsets, joints=None, rotation_slots=None,
    positions_out=None, rotations_out=None, threads=1, *, normalize=false))]
#[allow(clippy::too_many_arguments)]
fn forward_kinematics<'py>(
    py: Python<'py>,
    topology: Py<PyTopology>,
    rotations: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = indices)] translated: Vec<i32>,
    translations: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = widened)] offsets: Vec<f64>,
    #[pyo3(from_py_with = any_indices)] joints: Option<Vec<i32>>,
    #[pyo3(from_py_with = any_indices)] rotation_slots: Option<Vec<i32>>,
    positions_out: Option<Bound<'py, PyAny>>,
    rotations_out: Option<Bound<'py, PyAny>>,
    threads: usize,
    normalize: bool,
) -> PyResult<()> {
    let shared = Shared {
        topology,
        translated,
        offsets,
        joints,
        rotation_slots,
        positions_out,
        rotations_out,
        threads,
    };
    if let Ok(rotations) = input::<f32>(rotations, "rotations", 4) {
        return from_quaternions(
            py,
            &shared,
            &rotations,
            &input(translations, "translations", 3)?,
            normalize,
        );
    }
    let rotations = input::<f64>(rotations, "rotations", 4)?;
    from_quaternions(py, &shared, &rotations, &input(translations, "translations", 3)?, normalize)
}

fn from_quaternions<T: Real + Element>(
    py: Python<'_>,
    shared: &Shared<'_>,
    rotations: &PyReadonlyArrayDyn<'_, T>,
    translations: &PyReadonlyArrayDyn<'_, T>,
    normalize: bool,
) -> PyResult<()> {
    let frame_count = rotations.shape()[0];
    let (rotations, translations) = (rotations.as_slice()?, translations.as_slice()?);
    shared.run(py, Pose::Quaternions { rotations, normalize, translations }, frame_count)
}

/// World positions and rotations from rows of degrees and positions (F, C) as files hold them, into `positions_out`
/// (F, K, 3) and `rotations_out` (F, M, 4), both float32 or both float64.
#[pyfunction]
#[pyo3(signature = (topology, rows, rotation_columns, rotation_axes, translated, translation_columns, adds_offset,
    offsets, joints=None, rotation_slots=None, positions_out=None, rotations_out=None, threads=1))]
#[allow(clippy::too_many_arguments)]
fn forward_kinematics_euler<'py>(
    py: Python<'py>,
    topology: Py<PyTopology>,
    rows: PyReadonlyArray2<'py, f64>,
    rotation_columns: PyReadonlyArray2<'py, i32>,
    rotation_axes: PyReadonlyArray2<'py, u8>,
    #[pyo3(from_py_with = indices)] translated: Vec<i32>,
    translation_columns: PyReadonlyArray2<'py, i32>,
    adds_offset: bool,
    #[pyo3(from_py_with = widened)] offsets: Vec<f64>,
    #[pyo3(from_py_with = any_indices)] joints: Option<Vec<i32>>,
    #[pyo3(from_py_with = any_indices)] rotation_slots: Option<Vec<i32>>,
    positions_out: Option<Bound<'py, PyAny>>,
    rotations_out: Option<Bound<'py, PyAny>>,
    threads: usize,
) -> PyResult<()> {
    let shared = Shared {
        topology,
        translated,
        offsets,
        joints,
        rotation_slots,
        positions_out,
        rotations_out,
        threads,
    };
    let rows = EulerRows::new(rows, &rotation_columns, &rotation_axes, &translation_columns, adds_offset)?;
    let any_out = shared.positions_out.as_ref().or(shared.rotations_out.as_ref());
    if any_out.is_some_and(|out| out.cast::<PyArrayDyn<f32>>().is_ok()) {
        return shared.run::<f32>(py, rows.pose()?, rows.frame_count());
    }
    shared.run::<f64>(py, rows.pose()?, rows.frame_count())
}

/// Rows (F, C) as files hold them, and what their columns are.
pub(crate) struct EulerRows<'py> {
    rows: PyReadonlyArray2<'py, f64>,
    rotation_columns: Vec<[i32; 3]>,
    rotation_axes: Vec<[u8; 3]>,
    translation_columns: Vec<[i32; 3]>,
    adds_offset: bool,
}

impl<'py> EulerRows<'py> {
    pub(crate) fn new(
        rows: PyReadonlyArray2<'py, f64>,
        rotation_columns: &PyReadonlyArray2<'py, i32>,
        rotation_axes: &PyReadonlyArray2<'py, u8>,
        translation_columns: &PyReadonlyArray2<'py, i32>,
        adds_offset: bool,
    ) -> PyResult<Self> {
        Ok(Self {
            rows,
            rotation_columns: triples(rotation_columns, "rotation_columns")?,
            rotation_axes: triples(rotation_axes, "rotation_axes")?,
            translation_columns: triples(translation_columns, "translation_columns")?,
            adds_offset,
        })
    }

    pub(crate) fn frame_count(&self) -> usize {
        self.rows.shape()[0]
    }

    pub(crate) fn pose<T>(&self) -> PyResult<Pose<'_, T>> {
        Ok(Pose::Rows {
            rows: self.rows.as_slice()?,
            column_count: self.rows.shape()[1],
            angles: EulerColumns { columns: &self.rotation_columns, axes: &self.rotation_axes },
            translation_columns: &self.translation_columns,
            adds_offset: self.adds_offset,
        })
    }
}

pub(crate) fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

pub(crate) fn to_vec<T: Element + Copy>(array: &PyReadonlyArray1<'_, T>) -> Vec<T> {
    array.as_array().iter().copied().collect()
}

fn indices(array: &Bound<'_, PyAny>) -> PyResult<Vec<i32>> {
    Ok(to_vec(&array.extract::<PyReadonlyArray1<'_, i32>>()?))
}

/// [`indices`], where there are any.
fn any_indices(array: &Bound<'_, PyAny>) -> PyResult<Option<Vec<i32>>> {
    if array.is_none() { Ok(None) } else { indices(array).map(Some) }
}

/// The numbers of an array of either width.
fn widened(array: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    if let Ok(single) = array.cast::<PyArrayDyn<f32>>() {
        return Ok(single.readonly().as_array().iter().map(|&x| x.into()).collect());
    }
    let double = array.cast::<PyArrayDyn<f64>>().map_err(|_| wrong_type("offsets"))?;
    Ok(double.readonly().as_array().iter().copied().collect())
}

/// The rows of an (N, 3) array.
pub(crate) fn triples<T: Element + Copy>(
    array: &PyReadonlyArray2<'_, T>,
    name: &str,
) -> PyResult<Vec<[T; 3]>> {
    if array.shape()[1] != 3 {
        return Err(PyValueError::new_err(format!("{name} has shape {:?}; give (N, 3)", array.shape())));
    }
    Ok(array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect())
}

/// A C-contiguous array of shape (F, N, components).
pub(crate) fn input<'py, T: Element>(
    array: &Bound<'py, PyAny>,
    name: &str,
    components: usize,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let array = array.cast::<PyArrayDyn<T>>().map_err(|_| wrong_type(name))?.readonly();
    check(&array, name, components).map(|()| array)
}

/// A writeable C-contiguous array of shape (F, N, components).
pub(crate) fn output<'py, T: Element>(
    array: &Bound<'py, PyAny>,
    name: &str,
    components: usize,
) -> PyResult<PyReadwriteArrayDyn<'py, T>> {
    let array = array.cast::<PyArrayDyn<T>>().map_err(|_| wrong_type(name))?;
    let array = array.try_readwrite().map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    check(&array, name, components).map(|()| array)
}

fn wrong_type(name: &str) -> PyErr {
    PyTypeError::new_err(format!(
        "{name} is not an array of the expected type; give all arrays as float32 or all as float64"
    ))
}

fn check<'py, T: Element>(array: &Bound<'py, PyArrayDyn<T>>, name: &str, components: usize) -> PyResult<()> {
    let shape = array.shape();
    if shape.len() != 3 || shape[2] != components || !array.is_c_contiguous() {
        return Err(PyValueError::new_err(format!(
            "{name} has shape {shape:?}; give a C-contiguous array of shape (frames, N, {components})"
        )));
    }
    Ok(())
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyTopology>()?;
    module.add_function(wrap_pyfunction!(forward_kinematics, module)?)?;
    module.add_function(wrap_pyfunction!(forward_kinematics_euler, module)?)
}
