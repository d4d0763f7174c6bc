//! Binding of the motion database: simulation root, smoothing, builder, database.

use std::sync::Arc;

use gmr_core::matching::builder::{ClipPoses, DatabaseBuilder};
use gmr_core::matching::database::Database;
use gmr_core::matching::features::{Group, Measure, Schema};
use gmr_core::matching::index::Query;
use gmr_core::matching::normalization::Normalization;
use gmr_core::matching::root::{Pair, RootJob, RootTrack, simulation_root, smooth};
use numpy::ndarray::{Array3, ArrayView, ArrayView1, Dimension, ShapeBuilder, s};
use numpy::{
    Element, IntoPyArray, PyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1,
    PyReadonlyArray2, PyReadonlyArray3,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::index::PyIndex;
use crate::kinematics::PyTopology;

type Root<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);
/// Name, measure, joint, frames, weight.
type GroupParts = (String, String, Option<usize>, Vec<i32>, f32);

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn contiguous<'a, T, E>(what: &str, slice: Result<&'a [T], E>) -> PyResult<&'a [T]> {
    slice.map_err(|_| refused(format!("{what} must be C-contiguous; pass np.ascontiguousarray({what})")))
}

#[pyfunction(name = "simulation_root")]
fn py_simulation_root<'py>(
    py: Python<'py>,
    positions: PyReadonlyArray3<'py, f32>,
    hips: usize,
    across: Vec<(usize, usize)>,
    position_window: usize,
    heading_window: usize,
) -> PyResult<Root<'py>> {
    let across: Vec<Pair> = across.into_iter().map(|(left, right)| Pair { left, right }).collect();
    let joint_count = positions.as_array().dim().1;
    let positions = contiguous("positions", positions.as_slice())?;
    let job = RootJob { positions, joint_count, hips, across: &across, position_window, heading_window };
    let track = py.detach(|| simulation_root(&job)).map_err(refused)?;
    Ok((PyArray2::from_owned_array(py, track.ground.into()), track.heading.into_pyarray(py)))
}

#[pyfunction(name = "smooth")]
fn py_smooth<'py>(
    py: Python<'py>,
    samples: PyReadonlyArray1<'py, f64>,
    window: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    Ok(smooth(contiguous("samples", samples.as_slice())?, window).into_pyarray(py))
}

fn group_of((name, measure, joint, frames, weight): GroupParts) -> PyResult<Group> {
    let needed = || joint.ok_or_else(|| refused(format!("feature group '{name}' needs a joint")));
    let measure = match measure.as_str() {
        "position" => Measure::Position { joint: needed()? },
        "velocity" => Measure::Velocity { joint: needed()? },
        "root_position" => Measure::RootPosition,
        "root_facing" => Measure::RootFacing,
        other => {
            return Err(refused(format!("feature group '{name}' measures '{other}', which nobody knows")));
        }
    };
    Ok(Group { name, measure, frames, weight })
}

#[pyclass(name = "DatabaseBuilder", module = "gmr._core")]
struct PyDatabaseBuilder(Option<DatabaseBuilder>);

#[pymethods]
impl PyDatabaseBuilder {
    #[new]
    fn new(
        topology: &PyTopology,
        translated: Vec<i32>,
        groups: Vec<GroupParts>,
        rate: f64,
    ) -> PyResult<Self> {
        let topology = topology.inner.clone();
        let groups = groups.into_iter().map(group_of).collect::<PyResult<_>>()?;
        let schema = Schema::new(groups, topology.joint_count()).map_err(refused)?;
        let builder = DatabaseBuilder::new(topology, translated, schema, rate);
        Ok(Self(Some(builder.map_err(refused)?)))
    }

    #[getter]
    fn needed_frames(&mut self) -> PyResult<usize> {
        Ok(self.open()?.needed_frames())
    }

    #[pyo3(signature = (positions, rotations, translations, offsets, ground, heading, tags=None))]
    #[allow(clippy::too_many_arguments)]
    fn add_clip(
        &mut self,
        py: Python<'_>,
        positions: PyReadonlyArray3<'_, f32>,
        rotations: PyReadonlyArray3<'_, f64>,
        translations: PyReadonlyArray3<'_, f64>,
        offsets: PyReadonlyArray2<'_, f64>,
        ground: PyReadonlyArray2<'_, f64>,
        heading: PyReadonlyArray1<'_, f64>,
        tags: Option<PyReadonlyArray1<'_, u32>>,
    ) -> PyResult<usize> {
        let root = RootTrack {
            ground: contiguous("ground", ground.as_slice())?.as_chunks().0.to_vec(),
            heading: contiguous("heading", heading.as_slice())?.to_vec(),
        };
        let clip = ClipPoses {
            positions: contiguous("positions", positions.as_slice())?,
            rotations: contiguous("rotations", rotations.as_slice())?,
            translations: contiguous("translations", translations.as_slice())?,
            offsets: contiguous("offsets", offsets.as_slice())?,
            root: &root,
            tags: tags.as_ref().map_or(Ok(&[][..]), |tags| contiguous("tags", tags.as_slice()))?,
        };
        let builder = self.open()?;
        py.detach(|| builder.add_clip(&clip)).map_err(refused)
    }

    #[pyo3(signature = (offset=None, scale=None, threads=0))]
    fn finish(
        &mut self,
        py: Python<'_>,
        offset: Option<Vec<f32>>,
        scale: Option<Vec<f32>>,
        threads: usize,
    ) -> PyResult<PyDatabase> {
        let frozen = offset.zip(scale).map(|(offset, scale)| Normalization { offset, scale });
        self.open()?;
        let builder = self.0.take();
        let built = builder.map(|builder| py.detach(|| builder.finish(frozen, threads)));
        let database = built.transpose().map_err(refused)?;
        Ok(PyDatabase(Arc::new(database.ok_or_else(finished)?)))
    }
}

impl PyDatabaseBuilder {
    fn open(&mut self) -> PyResult<&mut DatabaseBuilder> {
        self.0.as_mut().ok_or_else(finished)
    }
}

fn finished() -> PyErr {
    refused("this builder has made its database; begin a new one")
}

#[pyclass(frozen, name = "Database", module = "gmr._core")]
pub(crate) struct PyDatabase(pub(crate) Arc<Database>);

/// A read-only array of the database's own memory.
fn view<'py, T: Element, D: Dimension>(
    this: &Bound<'py, PyDatabase>,
    values: &[T],
    shape: impl ShapeBuilder<Dim = D>,
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let values = ArrayView::from_shape(shape.into_shape_with_order(), values).map_err(refused)?;
    // SAFETY: the class is frozen and never gives out its Arc mutably, so the memory neither moves nor changes while
    // the array, which holds a reference to the object, is alive; and the array is made read-only here.
    let array = unsafe { PyArray::borrow_from_array(&values, this.clone().into_any()) };
    array.readwrite().make_nonwriteable();
    Ok(array)
}

#[pymethods]
impl PyDatabase {
    #[getter]
    fn features<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let database = &this.get().0;
        view(this, database.features(), (database.row_count(), database.dims()))
    }

    #[getter]
    fn clips<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        view(this, this.get().0.clip_of(), this.get().0.row_count())
    }

    #[getter]
    fn candidates<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        view(this, this.get().0.candidates(), this.get().0.row_count())
    }

    #[getter]
    fn tags<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        view(this, this.get().0.tags(), this.get().0.row_count())
    }

    #[getter]
    fn ground<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        view(this, this.get().0.ground().as_flattened(), (this.get().0.row_count(), 2))
    }

    #[getter]
    fn heading<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        view(this, this.get().0.heading(), this.get().0.row_count())
    }

    #[getter]
    fn positions<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let database = &this.get().0;
        view(this, database.positions(), (database.row_count(), database.joint_count(), 3))
    }

    #[getter]
    fn rotations<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let database = &this.get().0;
        view(this, database.rotations(), (database.row_count(), database.slot_count(), 4))
    }

    #[getter]
    fn translations<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let database = &this.get().0;
        view(this, database.translations(), (database.row_count(), database.translated().len(), 3))
    }

    #[getter]
    fn displacements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let steps: Vec<[f32; 2]> = self.0.steps().map(|step| step.displacement).collect();
        Ok(PyArray2::from_owned_array(py, steps.into()))
    }

    #[getter]
    fn turns<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_iter(py, self.0.steps().map(|step| step.turn))
    }

    #[getter]
    fn clip_ranges(&self) -> Vec<(u32, u32)> {
        self.0.clips().iter().map(|clip| (clip.rows.start, clip.rows.end)).collect()
    }

    #[getter]
    fn normalization(&self) -> (Vec<f32>, Vec<f32>) {
        let fitted = self.0.normalization();
        (fitted.offset.clone(), fitted.scale.clone())
    }

    #[getter]
    fn constant_groups(&self) -> Vec<usize> {
        self.0.constant_groups().to_vec()
    }

    #[getter]
    fn is_trajectory(&self) -> Vec<bool> {
        self.0.schema().is_trajectory()
    }

    #[getter]
    fn rate(&self) -> f64 {
        self.0.rate()
    }

    #[getter]
    fn translated(&self) -> Vec<i32> {
        self.0.translated().to_vec()
    }

    #[getter]
    fn index(&self) -> PyIndex {
        PyIndex(Arc::clone(self.0.index()))
    }

    #[pyo3(signature = (left, threads=0))]
    fn subset(&self, py: Python<'_>, left: PyReadonlyArray1<'_, bool>, threads: usize) -> PyResult<Self> {
        let left = contiguous("left", left.as_slice())?;
        py.detach(|| self.0.subset(left, threads)).map(|database| Self(Arc::new(database))).map_err(refused)
    }

    fn offsets<'py>(&self, py: Python<'py>, row: u32) -> PyResult<Bound<'py, PyArray2<f32>>> {
        if row as usize >= self.0.row_count() {
            return Err(refused(format!("there is no row {row}; the database has {}", self.0.row_count())));
        }
        let rows: Vec<[f32; 3]> = self.0.offsets(row).as_chunks().0.to_vec();
        Ok(PyArray2::from_owned_array(py, rows.into()))
    }

    /// (Q, k, G) costs of rows (Q, k) by group.
    #[pyo3(signature = (queries, rows, weights=None))]
    fn costs_by_group<'py>(
        &self,
        py: Python<'py>,
        queries: PyReadonlyArray2<'py, f32>,
        rows: PyReadonlyArray2<'py, i64>,
        weights: Option<PyReadonlyArray2<'py, f32>>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (queries, rows) = (queries.as_array(), rows.as_array());
        let weights = weights.as_ref().map(|weights| weights.as_array());
        if queries.nrows() != rows.nrows()
            || weights.is_some_and(|w| ![1, queries.nrows()].contains(&w.nrows()))
        {
            return Err(refused("give rows for each query, and one row of weights for all or for each"));
        }
        let groups = self.0.schema().groups().len();
        let mut costs = Array3::from_elem((rows.nrows(), rows.ncols(), groups), f32::NAN);
        for ((i, k), &row) in rows.indexed_iter().filter(|(_, row)| **row >= 0) {
            let row = u32::try_from(row).ok().filter(|&row| (row as usize) < self.0.row_count());
            let row = row.ok_or_else(|| refused(format!("there is no row {}", rows[(i, k)])))?;
            let features = queries.row(i).to_vec();
            let own = weights.map(|weights| weights.row(if weights.nrows() == 1 { 0 } else { i }).to_vec());
            let query = Query { weights: own.as_deref(), ..Query::new(&features) };
            let mut parts = vec![0.0; groups];
            self.0.costs_by_group(&query, row, &mut parts).map_err(refused)?;
            costs.slice_mut(s![i, k, ..]).assign(&ArrayView1::from(&parts));
        }
        Ok(costs.into_pyarray(py))
    }

    fn normalize<'py>(
        &self,
        py: Python<'py>,
        raw: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        if raw.as_array().ncols() != self.0.dims() {
            let (found, dims) = (raw.as_array().ncols(), self.0.dims());
            return Err(refused(format!("raw features are of {found} numbers; this database has {dims}")));
        }
        let mut rows = raw.as_array().as_standard_layout().into_owned();
        if let Some(rows) = rows.as_slice_mut() {
            self.0.normalization().normalize(rows);
        }
        Ok(PyArray2::from_owned_array(py, rows))
    }
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(py_simulation_root, module)?)?;
    module.add_function(wrap_pyfunction!(py_smooth, module)?)?;
    module.add_class::<PyDatabaseBuilder>()?;
    module.add_class::<PyDatabase>()
}
