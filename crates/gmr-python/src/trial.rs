//! Binding of `trial`: many trials at once, their logs as columns.

use gmr_core::matching::path::Segment;
use gmr_core::matching::settings::Settings;
use gmr_core::matching::trial::{LoggedStep, Profile, Progress, TrialLog, Trials, run_trials};
use numpy::ndarray::Array2;
use numpy::{Element, IntoPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::matching::PyDatabase;
use crate::watch::watched;

/// `((duration, speed, turn rate, drift), ...)` and the second from which the trial counts.
type Request = (Vec<(f64, f64, f64, f64)>, f64);

#[pyfunction(name = "run_trials")]
#[pyo3(signature = (
    database, profiles, tracking, search_every, exclude_within, transition_penalty, tags, threads, progress=None,
    weights=None,
))]
#[allow(clippy::too_many_arguments)]
fn run<'py>(
    py: Python<'py>,
    database: &PyDatabase,
    profiles: Vec<Request>,
    tracking: &str,
    search_every: f64,
    exclude_within: u32,
    transition_penalty: f32,
    tags: u32,
    threads: usize,
    progress: Option<Bound<'py, PyAny>>,
    weights: Option<Vec<f32>>,
) -> PyResult<Bound<'py, PyDict>> {
    let tracking = tracking.parse().map_err(value_error)?;
    let settings = Settings { search_every, exclude_within, transition_penalty, tags, weights };
    let profiles: Vec<Profile> = profiles.into_iter().map(profile).collect();
    let trials =
        Trials { database: &database.0, profiles: &profiles, tracking, settings: &settings, threads };
    let watch = Progress::default();
    let mut told = 0;
    let mut tell = || match &progress {
        Some(progress) if watch.done() > told => {
            told = watch.done();
            progress.call1((told, profiles.len())).map(drop)
        }
        _ => Ok(()),
    };
    let logs = watched(py, || run_trials(&trials, &watch), || watch.cancel(), &mut tell)?;
    let logs = logs.map_err(value_error)?;
    tell()?;
    columns(py, &logs)
}

fn profile((segments, record_from): Request) -> Profile {
    let segment = |(duration, speed, turn_rate, drift)| Segment { duration, speed, turn_rate, drift };
    Profile { segments: segments.into_iter().map(segment).collect(), record_from }
}

/// Every column of the logs, (trials, steps); what lies after a trial's end is NaN, row -1, status 255.
fn columns<'py>(py: Python<'py>, logs: &[TrialLog]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let put = |name, array: Bound<'py, PyAny>| columns.set_item(name, array);
    let lengths: Vec<i64> = logs.iter().map(|log| log.steps.len() as i64).collect();
    let recorded_from: Vec<i64> = logs.iter().map(|log| log.recorded_from as i64).collect();
    put("lengths", lengths.into_pyarray(py).into_any())?;
    put("recorded_from", recorded_from.into_pyarray(py).into_any())?;
    let number = |name, of: fn(&LoggedStep) -> f64| put(name, column(py, logs, f64::NAN, of));
    number("x", |step| step.placement.position.x)?;
    number("z", |step| step.placement.position.y)?;
    number("heading", |step| step.placement.heading)?;
    number("ref_x", |step| step.reference.position.x)?;
    number("ref_z", |step| step.reference.position.y)?;
    number("ref_heading", |step| step.reference.heading)?;
    number("ref_speed", |step| step.request.speed)?;
    number("ref_turn_rate", |step| step.request.turn_rate)?;
    number("ref_drift", |step| step.request.drift)?;
    let cost = |name, of: fn(&LoggedStep) -> f32| put(name, column(py, logs, f32::NAN, of));
    cost("cost_pose", |step| step.choice.cost_pose)?;
    cost("cost_trajectory", |step| step.choice.cost_trajectory)?;
    cost("discontinuity", |step| step.choice.discontinuity)?;
    put("row", column(py, logs, -1_i64, |step| step.choice.row.into()))?;
    put("status", column(py, logs, u8::MAX, |step| step.choice.status as u8))?;
    Ok(columns)
}

fn column<'py, T: Element + Copy>(
    py: Python<'py>,
    logs: &[TrialLog],
    padding: T,
    of: fn(&LoggedStep) -> T,
) -> Bound<'py, PyAny> {
    let longest = logs.iter().map(|log| log.steps.len()).max().unwrap_or(0);
    let mut column = Array2::from_elem((logs.len(), longest), padding);
    for (mut row, log) in column.outer_iter_mut().zip(logs) {
        row.iter_mut().zip(&log.steps).for_each(|(value, step)| *value = of(step));
    }
    column.into_pyarray(py).into_any()
}

fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(run, module)?)
}
