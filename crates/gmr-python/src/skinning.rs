//! Skins over NumPy arrays.

use gmr_core::skinning::bind::{Bind, INFLUENCES, bind};
use gmr_core::skinning::{self, Blend, Blended, Hemisphere, Method, Skin};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::kinematics::{input, output, value_error};

/// A mesh at rest and the joints that its vertices follow, checked once.
#[pyclass(name = "Skin", module = "gmr._core", frozen)]
struct PySkin {
    inner: Skin,
}

#[pymethods]
impl PySkin {
    #[new]
    #[pyo3(signature = (vertices, joints, weights, joint_count, normals=None))]
    fn new(
        vertices: PyReadonlyArray2<'_, f32>,
        joints: PyReadonlyArray2<'_, i32>,
        weights: PyReadonlyArray2<'_, f32>,
        joint_count: usize,
        normals: Option<PyReadonlyArray2<'_, f32>>,
    ) -> PyResult<Self> {
        let normals = normals.as_ref().map(|normals| normals.as_slice()).transpose()?;
        Skin::new(vertices.as_slice()?, normals, joints.as_slice()?, weights.as_slice()?, joint_count)
            .map(|inner| Self { inner })
            .map_err(value_error)
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.vertex_count()
    }

    #[getter]
    fn joint_count(&self) -> usize {
        self.inner.joint_count()
    }

    /// Positions, and normals where there is an array for them, (F, V, 3) float32, under transforms (F, 16 B) float64.
    #[pyo3(signature = (transforms, method, out, normals_out=None, centers=None, threads=1))]
    #[allow(clippy::too_many_arguments)]
    fn blend(
        &self,
        py: Python<'_>,
        transforms: PyReadonlyArray2<'_, f64>,
        method: &str,
        out: &Bound<'_, PyAny>,
        normals_out: Option<&Bound<'_, PyAny>>,
        centers: Option<&Bound<'_, PyAny>>,
        threads: usize,
    ) -> PyResult<()> {
        let centers = centers.map(|array| input::<f32>(array, "centers", 3)).transpose()?;
        let mut out = output::<f32>(out, "out", 3)?;
        let mut normals = normals_out.map(|array| output::<f32>(array, "normals_out", 3)).transpose()?;
        let method = match (method, &centers) {
            ("linear", _) => Method::Linear,
            ("pivot", _) => Method::DualQuaternion(Hemisphere::Pivot),
            ("running", _) => Method::DualQuaternion(Hemisphere::Running),
            ("centers", Some(centers)) => Method::Centers(centers.as_slice()?),
            _ => return Err(PyValueError::new_err(format!("there is no method '{method}'"))),
        };
        let (frame_count, transforms) = (transforms.shape()[0], transforms.as_slice()?);
        let job = Blend { skin: &self.inner, transforms, frame_count, method, threads };
        let out = Blended {
            positions: out.as_slice_mut()?,
            normals: normals.as_mut().map(|normals| normals.as_slice_mut()).transpose()?,
        };
        py.detach(|| skinning::blend(&job, out)).map_err(value_error)
    }

    /// Centres of rotation, 3 V float32, on the surface of `faces`, 3 T int32.
    fn centers<'py>(
        &self,
        py: Python<'py>,
        faces: PyReadonlyArray1<'py, i32>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let faces = faces.as_slice()?;
        let found = py.detach(|| skinning::centers_of_rotation(&self.inner, faces, threads));
        found.map(|centers| PyArray1::from_vec(py, centers)).map_err(value_error)
    }
}

/// What binding gives: joints and weights (V, 4), the vertices in no box, torn edges before and after.
type Bindings<'py> =
    (Bound<'py, PyArray2<i32>>, Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<u32>>, usize, usize);

/// Binds (V, 3) vertices of 3 T `faces` to the bones from `heads` to `tails` (B, 3), which (B,) `joints` turn.
#[pyfunction]
#[pyo3(signature = (vertices, faces, heads, tails, joints, open, threads=1))]
#[allow(clippy::too_many_arguments)]
fn bind_skin<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray1<'py, i32>,
    heads: PyReadonlyArray2<'py, f64>,
    tails: PyReadonlyArray2<'py, f64>,
    joints: PyReadonlyArray1<'py, i32>,
    open: PyReadonlyArray2<'py, bool>,
    threads: usize,
) -> PyResult<Bindings<'py>> {
    let (open, rest) = open.as_slice()?.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(PyValueError::new_err("open has two columns, head and tail"));
    }
    let job = Bind {
        vertices: vertices.as_slice()?,
        faces: faces.as_slice()?,
        heads: heads.as_slice()?,
        tails: tails.as_slice()?,
        joints: joints.as_slice()?,
        open,
        threads,
    };
    let bound = py.detach(|| bind(&job)).map_err(value_error)?;
    let shape = [vertices.shape()[0], INFLUENCES];
    Ok((
        PyArray1::from_vec(py, bound.joints).reshape(shape)?,
        PyArray1::from_vec(py, bound.weights).reshape(shape)?,
        PyArray1::from_vec(py, bound.outside),
        bound.torn,
        bound.still_torn,
    ))
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(bind_skin, module)?)?;
    module.add_class::<PySkin>()
}
