//! Binding of the nearest-neighbour index.

use std::ops::Range;
use std::sync::Arc;

use gmr_core::matching::index::{Batch, Hit, Index};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;

type Answers<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<i64>>);

#[pyclass(frozen, name = "Index", module = "gmr._core")]
pub(crate) struct PyIndex(pub(crate) Arc<Index>);

#[pymethods]
impl PyIndex {
    #[new]
    #[pyo3(signature = (features, candidates=None, tags=None, threads=0))]
    fn new(
        py: Python<'_>,
        features: PyReadonlyArray2<'_, f32>,
        candidates: Option<PyReadonlyArray1<'_, bool>>,
        tags: Option<PyReadonlyArray1<'_, u32>>,
        threads: usize,
    ) -> PyResult<Self> {
        let (frame_count, dims) = features.as_array().dim();
        let everything = candidates.is_none().then(|| vec![true; frame_count]);
        let features = contiguous("features", features.as_slice())?;
        let candidates = match (&candidates, &everything) {
            (Some(candidates), _) => contiguous("candidates", candidates.as_slice())?,
            (None, everything) => everything.as_deref().unwrap_or_default(),
        };
        let tags = tags.as_ref().map(|tags| contiguous("tags", tags.as_slice())).transpose()?;
        let built = py.detach(|| Index::build(features, dims, candidates, tags, threads));
        built.map(|index| Self(Arc::new(index))).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    #[getter]
    fn dims(&self) -> usize {
        self.0.dims()
    }

    #[getter]
    fn frame_count(&self) -> usize {
        self.0.frame_count()
    }

    #[getter]
    fn candidate_count(&self) -> usize {
        self.0.candidate_count()
    }

    #[pyo3(signature = (queries, k=1, tags=None, exclude=None, max_cost=f32::INFINITY, threads=0, weights=None))]
    #[allow(clippy::too_many_arguments)]
    fn search<'py>(
        &self,
        py: Python<'py>,
        queries: PyReadonlyArray2<'py, f32>,
        k: usize,
        tags: Option<PyReadonlyArray1<'py, u32>>,
        exclude: Option<PyReadonlyArray2<'py, u32>>,
        max_cost: f32,
        threads: usize,
        weights: Option<PyReadonlyArray2<'py, f32>>,
    ) -> PyResult<Answers<'py>> {
        let (count, dims) = queries.as_array().dim();
        let widths =
            [("queries", dims), ("weights", weights.as_ref().map_or(dims, |w| w.as_array().ncols()))];
        if let Some((what, found)) = widths.into_iter().find(|&(_, width)| width != self.0.dims()) {
            let message = format!("{what} are of {found} numbers; this index is of {}", self.0.dims());
            return Err(PyValueError::new_err(message));
        }
        let exclude = exclude.map(ranges).transpose()?;
        let batch = Batch {
            queries: contiguous("queries", queries.as_slice())?,
            weights: weights.as_ref().map(|rows| contiguous("weights", rows.as_slice())).transpose()?,
            count,
            tags: tags.as_ref().map_or(Ok(&[0][..]), |tags| contiguous("tags", tags.as_slice()))?,
            exclude: exclude.as_deref(),
            max_cost,
            threads,
        };
        let hits = self.answers(py, &batch, k)?;
        let costs = hits.iter().map(|hit| hit.cost).collect();
        let frames =
            hits.iter().map(|hit| if *hit == Hit::NONE { -1 } else { i64::from(hit.frame) }).collect();
        Ok((matrix(py, count, k, costs)?, matrix(py, count, k, frames)?))
    }

    fn __repr__(&self) -> String {
        let index = &self.0;
        let (found, frames, dims) = (index.candidate_count(), index.frame_count(), index.dims());
        format!("Index({found} candidates of {frames} frames, {dims} dimensions)")
    }
}

impl PyIndex {
    fn answers(&self, py: Python<'_>, batch: &Batch<'_>, k: usize) -> PyResult<Vec<Hit>> {
        let mut hits = Vec::new();
        let room = batch.count.checked_mul(k).filter(|&room| hits.try_reserve_exact(room).is_ok());
        let too_many =
            || PyMemoryError::new_err(format!("no room for {} x {k} hits; ask for fewer", batch.count));
        hits.resize(room.ok_or_else(too_many)?, Hit::NONE);
        let mut interrupt = Ok(());
        let mut goes_on = || {
            interrupt = Python::attach(|py| py.check_signals());
            interrupt.is_ok()
        };
        py.detach(|| self.0.search_batch(batch, k, &mut hits, &mut goes_on))
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        interrupt.map(|()| hits)
    }
}

fn contiguous<'a, T, E>(what: &str, slice: Result<&'a [T], E>) -> PyResult<&'a [T]> {
    slice.map_err(|_| {
        PyValueError::new_err(format!("{what} must be C-contiguous; pass np.ascontiguousarray({what})"))
    })
}

fn ranges(exclude: PyReadonlyArray2<'_, u32>) -> PyResult<Vec<Range<u32>>> {
    let exclude = exclude.as_array();
    if exclude.ncols() != 2 {
        let message = format!("exclude has {} columns; give first and one past last frame", exclude.ncols());
        return Err(PyValueError::new_err(message));
    }
    Ok(exclude.rows().into_iter().map(|row| row[0]..row[1]).collect())
}

fn matrix<T: numpy::Element>(
    py: Python<'_>,
    rows: usize,
    columns: usize,
    flat: Vec<T>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let array = Array2::from_shape_vec((rows, columns), flat);
    array.map(|array| array.into_pyarray(py)).map_err(|error| PyValueError::new_err(error.to_string()))
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyIndex>()
}
