//! Binding of `character`: a body that is stepped by a program.

use std::sync::Arc;

use gmr_core::matching::character::Character;
use gmr_core::matching::database::Database;
use gmr_core::matching::ground::Placement;
use gmr_core::matching::settings::Settings;
use numpy::ndarray::ArrayView2;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::matching::PyDatabase;

type Place = (f64, f64, f64);
type Arrays<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>, Place);
type Choice = (u32, u8, f32, f32);

#[pyclass(name = "Character", module = "gmr._core")]
struct PyCharacter(Character<Arc<Database>>);

#[pymethods]
impl PyCharacter {
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        database: &PyDatabase,
        place: Place,
        search_every: f64,
        exclude_within: u32,
        transition_penalty: f32,
        tags: u32,
        weights: Option<Vec<f32>>,
        half_life: f64,
    ) -> PyResult<Self> {
        let settings = Settings { search_every, exclude_within, transition_penalty, tags, weights };
        let database = Arc::clone(&database.0);
        let made = py.detach(|| Character::new(database, &settings, half_life, placement(place)));
        made.map(Self).map_err(refused)
    }

    #[getter]
    fn times(&self) -> Vec<f64> {
        self.0.times().to_vec()
    }

    #[getter]
    fn place(&self) -> Place {
        parts(self.0.placement())
    }

    #[setter]
    fn set_place(&mut self, place: Place) -> PyResult<()> {
        self.0.place(placement(place)).map_err(refused)
    }

    /// Row, status, cost of the pose and of the trajectory.
    #[getter]
    fn choice(&self) -> Choice {
        let choice = self.0.choice();
        (choice.row, choice.status as u8, choice.cost_pose, choice.cost_trajectory)
    }

    fn search_now(&mut self) {
        self.0.search_now();
    }

    fn step<'py>(
        &mut self,
        py: Python<'py>,
        wanted: PyReadonlyArray2<'py, f64>,
        dt: f64,
    ) -> PyResult<Arrays<'py>> {
        let wanted = wanted.as_array();
        if wanted.ncols() != 3 {
            let message =
                format!("wanted has {} columns; give x, z and heading of each time", wanted.ncols());
            return Err(PyValueError::new_err(message));
        }
        let wanted: Vec<_> = wanted.outer_iter().map(|p| Placement::new(p[0], p[1], p[2])).collect();
        self.0.step(&wanted, dt).map_err(refused)?;
        self.shown(py)
    }

    fn shown<'py>(&self, py: Python<'py>) -> PyResult<Arrays<'py>> {
        let shown = self.0.shown();
        let rows = |width, values| {
            let rows = ArrayView2::from_shape((self.0.database().joint_count(), width), values);
            rows.map(|rows| PyArray2::from_array(py, &rows)).map_err(refused)
        };
        Ok((rows(3, shown.positions())?, rows(4, shown.bone_rotations())?, parts(shown.placement())))
    }
}

fn placement((x, z, heading): Place) -> Placement {
    Placement::new(x, z, heading)
}

fn parts(placement: Placement) -> Place {
    (placement.position.x, placement.position.y, placement.heading)
}

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyCharacter>()
}
