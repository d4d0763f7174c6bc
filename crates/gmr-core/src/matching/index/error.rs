//! What can be wrong with features, tags or a query, in words.

use std::fmt;
use std::path::PathBuf;

use super::Query;
use crate::Isa;
use crate::error::ShapeError;

/// Why an index cannot be built, or a query cannot be answered.
#[derive(Debug, Clone, PartialEq)]
pub enum IndexError {
    /// An array's length does not fit.
    Shape(ShapeError),
    /// Rows of no numbers.
    NoDimensions,
    /// More frames than indices.
    TooManyFrames {
        /// How many there are.
        found: usize,
    },
    /// A candidate's feature is NaN or infinite.
    Feature {
        /// Row of the features.
        frame: usize,
        /// Column of the features.
        dimension: usize,
        /// What stands there.
        found: f32,
    },
    /// A query's feature is NaN or infinite.
    Query {
        /// Row of the queries (0 for a single one).
        query: usize,
        /// Column of the query.
        dimension: usize,
        /// What stands there.
        found: f32,
    },
    /// A weight is negative, NaN or infinite.
    Weight {
        /// Row of the weights (0 for a single one).
        query: usize,
        /// Column of the weights.
        dimension: usize,
        /// What stands there.
        found: f32,
    },
    /// The cost that hits must stay below is NaN.
    MaxCost,
    /// A part of an index in a file is not as it was saved.
    Damaged {
        /// The file.
        file: PathBuf,
        /// A leaf or a node.
        what: &'static str,
        /// Which of them.
        number: usize,
    },
    /// What an index holds is not what the rows say.
    Contrary {
        /// What is wrong, in words.
        what: String,
    },
    /// This machine cannot run what the index was to be built for.
    Isa {
        /// What it was to be built for.
        asked: Isa,
    },
}

impl fmt::Display for IndexError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape(error) => error.fmt(f),
            Self::NoDimensions => write!(f, "features have 0 dimensions; give at least one number a frame"),
            Self::TooManyFrames { found } => {
                write!(f, "{found} frames are more than the {} that an index can hold", MOST_FRAMES)
            }
            Self::Feature { frame, dimension, found } => write!(
                f,
                "feature {dimension} of frame {frame} is {found}; give a finite number, or make the frame no candidate"
            ),
            Self::Query { query, dimension, found } => {
                write!(f, "feature {dimension} of query {query} is {found}; give a finite number")
            }
            Self::Weight { query, dimension, found } => {
                write!(f, "weight {dimension} of query {query} is {found}; give a finite number, 0 or more")
            }
            Self::MaxCost => {
                write!(f, "the cost to stay below is NaN; give a number, or infinity for no limit")
            }
            Self::Damaged { file, what, number } => write!(
                f,
                "{}: {what} {number} of its index is damaged; save the database again",
                file.display()
            ),
            Self::Contrary { what } => write!(f, "the index is not that of the rows: {what}"),
            Self::Isa { asked } => {
                let known: Vec<_> = Isa::available().map(Isa::name).collect();
                write!(f, "no index can be built for {asked} here; this machine runs {}", known.join(", "))
            }
        }
    }
}

impl std::error::Error for IndexError {}

impl From<ShapeError> for IndexError {
    fn from(error: ShapeError) -> Self {
        Self::Shape(error)
    }
}

/// One index value is kept to mean "no frame".
const MOST_FRAMES: usize = u32::MAX as usize - 1;

/// Checks what an index is to be built from.
pub(super) fn check_rows(
    features: &[f32],
    dims: usize,
    candidates: &[bool],
    tags: Option<&[u32]>,
) -> Result<(), IndexError> {
    if dims == 0 {
        return Err(IndexError::NoDimensions);
    }
    let frame_count = features.len() / dims;
    if frame_count > MOST_FRAMES {
        return Err(IndexError::TooManyFrames { found: frame_count });
    }
    ShapeError::check("features", frame_count * dims, features.len())?;
    ShapeError::check("candidates", frame_count, candidates.len())?;
    if let Some(tags) = tags {
        ShapeError::check("tags", frame_count, tags.len())?;
    }
    for (frame, row) in features.chunks_exact(dims).enumerate().filter(|&(frame, _)| candidates[frame]) {
        if let Some(dimension) = first_not_finite(row) {
            return Err(IndexError::Feature { frame, dimension, found: row[dimension] });
        }
    }
    Ok(())
}

/// Checks one query of an index with `dims` dimensions.
pub(super) fn check_query(query: &Query, dims: usize, max_cost: f32) -> Result<(), IndexError> {
    let features = query.features;
    ShapeError::check("query features", dims, features.len())?;
    if let Some(weights) = query.weights {
        ShapeError::check("query weights", dims, weights.len())?;
        check_weights(weights, 0)?;
    }
    if let Some(dimension) = first_not_finite(features) {
        return Err(IndexError::Query { query: 0, dimension, found: features[dimension] });
    }
    if max_cost.is_nan() { Err(IndexError::MaxCost) } else { Ok(()) }
}

/// Checks the weights of the query of that number.
pub(in super::super) fn check_weights(weights: &[f32], query: usize) -> Result<(), IndexError> {
    let is_weight = |weight: f32| weight >= 0.0 && weight.is_finite();
    match weights.iter().position(|&weight| !is_weight(weight)) {
        Some(dimension) => Err(IndexError::Weight { query, dimension, found: weights[dimension] }),
        None => Ok(()),
    }
}

/// Where the first NaN or infinity stands.
pub(super) fn first_not_finite(row: &[f32]) -> Option<usize> {
    // Rows are nearly always finite, and a loop without an early end runs in lanes.
    let all_finite = row.iter().fold(true, |finite, x| finite & x.is_finite());
    if all_finite { None } else { row.iter().position(|x| !x.is_finite()) }
}
