//! The row that a trial starts on: of all candidates the one whose future is nearest to what is asked for there.
//!
//! Its pose is whatever that row has, for there is none before it to continue. Trials of a grid begin alike, so a row
//! that was found is kept.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use super::database::Database;
use super::settings::Settings;

/// Starting rows in a database.
#[derive(Debug)]
pub struct Starts<'a> {
    database: &'a Database,
    tags: u32,
    /// Each with what its squared difference is multiplied by.
    dims: Vec<(usize, f32)>,
    /// By the bits of what was asked for.
    known: Mutex<HashMap<Vec<u32>, Option<u32>>>,
}

impl<'a> Starts<'a> {
    /// Among the candidates that the settings admit, by their weights.
    #[must_use]
    pub fn new(database: &'a Database, settings: &Settings) -> Self {
        // A character that starts has no past, so nothing can be asked of it.
        let ahead = database.schema().trajectory().into_iter().filter(|sample| sample.frames >= 0);
        let weight = |dim: usize| settings.weights.as_ref().map_or(1.0, |weights| weights[dim]);
        let dims = ahead.flat_map(|sample| [sample.dim, sample.dim + 1]).map(|dim| (dim, weight(dim)));
        let dims = dims.filter(|&(_, weight)| weight > 0.0).collect();
        Self { database, tags: settings.tags, dims, known: Mutex::default() }
    }

    /// The candidate whose future costs least, the first of equals; `None` where there is no candidate.
    #[must_use]
    pub fn row(&self, query: &[f32]) -> Option<u32> {
        let wanted: Vec<f32> = self.dims.iter().map(|&(dim, _)| query[dim]).collect();
        let key: Vec<u32> = wanted.iter().map(|value| value.to_bits()).collect();
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known().get(&key).copied();
        found.unwrap_or_else(|| {
            let row = self.nearest(&wanted);
            known().insert(key, row);
            row
        })
    }

    fn nearest(&self, wanted: &[f32]) -> Option<u32> {
        let (mut nearest, mut lowest) = (None, f32::INFINITY);
        for row in (0..self.database.row_count() as u32).filter(|&row| self.admits(row)) {
            let features = self.database.feature_row(row);
            let terms = wanted.iter().zip(&self.dims);
            let mut terms = terms.map(|(q, &(dim, weight))| weight * (q - features[dim]).powi(2));
            // Terms are never negative: a sum that has reached the lowest stays there.
            let cost = terms.try_fold(0.0, |sum, term| (sum < lowest).then_some(sum + term));
            if let Some(cost) = cost.filter(|&cost| cost < lowest || nearest.is_none()) {
                (nearest, lowest) = (Some(row), cost);
            }
        }
        nearest
    }

    fn admits(&self, row: u32) -> bool {
        let row = row as usize;
        self.database.candidates()[row] && self.database.tags()[row] & self.tags == self.tags
    }
}
