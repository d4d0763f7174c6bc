//! How rows are searched for: how often, among which, at what weights.

use std::fmt;

use super::index::{IndexError, check_weights};
use crate::error::ShapeError;

/// How rows are searched for.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Seconds from a search to the next; rounded to whole steps, at least one.
    pub search_every: f64,
    /// Rows of the playing clip at most this many frames from the continuing row are no candidates.
    pub exclude_within: u32,
    /// Added to the cost of every row but the continuing one; 0 or more.
    pub transition_penalty: f32,
    /// Tag bits that every candidate carries; 0 asks for none.
    pub tags: u32,
    /// What the squared difference of each dimension is multiplied by; `None`: all by 1.
    pub weights: Option<Vec<f32>>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { search_every: 0.1, exclude_within: 20, transition_penalty: 0.0, tags: 0, weights: None }
    }
}

const LONGEST_SEARCH_INTERVAL: f64 = 3600.0;

impl Settings {
    /// Whether a database of `dims` dimensions can be searched like this.
    ///
    /// # Errors
    /// When a number is out of bounds, or there is not one weight a dimension.
    pub fn check(&self, dims: usize) -> Result<(), SettingsError> {
        let Self { search_every, transition_penalty, .. } = *self;
        if !(search_every > 0.0 && search_every <= LONGEST_SEARCH_INTERVAL) {
            return Err(SettingsError::SearchEvery { found: search_every });
        }
        if !(transition_penalty >= 0.0 && transition_penalty.is_finite()) {
            return Err(SettingsError::TransitionPenalty { found: transition_penalty });
        }
        let Some(weights) = &self.weights else { return Ok(()) };
        let count = ShapeError::check("weights", dims, weights.len()).map_err(IndexError::from);
        count.and_then(|()| check_weights(weights, 0)).map_err(SettingsError::Weights)
    }
}

/// Settings by which nothing can be searched.
#[derive(Debug, Clone, PartialEq)]
pub enum SettingsError {
    /// Time between searches that is no time.
    SearchEvery {
        /// The seconds asked for.
        found: f64,
    },
    /// A penalty that is negative or not finite.
    TransitionPenalty {
        /// The penalty asked for.
        found: f32,
    },
    /// Not one weight a dimension, or a weight that is none.
    Weights(IndexError),
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SearchEvery { found } => write!(
                f,
                "a search every {found} s is not possible; use more than 0 s, at most {LONGEST_SEARCH_INTERVAL} s"
            ),
            Self::TransitionPenalty { found } => {
                write!(f, "a transition penalty of {found} is not possible; use a finite number, 0 or more")
            }
            Self::Weights(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SettingsError {}
