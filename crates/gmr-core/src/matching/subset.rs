//! A database of which only some rows are left, without anything being read or measured again.
//!
//! A row that is gone is neither jumped to nor played on to: where one follows, the clip ends. Nor is a row jumped to
//! whose features look at one that is gone, for a file without that frame could not give them. All that is left keeps
//! its number, its features and their scale, so that trials on whole clips are, bit by bit, those on a database built
//! of these clips with the same [`super::normalization::Normalization`].

use std::sync::Arc;

use super::builder::DatabaseError;
use super::database::Database;
use super::index::Index;
use crate::error::ShapeError;

/// Which rows of a database are left (N), and which of them may be jumped to (N).
#[derive(Debug, Clone)]
pub(super) struct Left {
    pub(super) rows: Vec<bool>,
    pub(super) candidates: Vec<bool>,
}

impl Database {
    /// The rows for which `left` holds (N), of those that were left so far; the poses are shared, the index is new.
    ///
    /// # Errors
    /// When `left` has not one entry a row, or no row that may be jumped to is left.
    pub fn subset(&self, left: &[bool]) -> Result<Self, DatabaseError> {
        ShapeError::check("rows left", self.row_count(), left.len())?;
        let rows: Vec<bool> = (0..).zip(left).map(|(row, &left)| left && self.has_row(row)).collect();
        let candidates = self.with_their_support(&rows);
        if !candidates.contains(&true) {
            let needed = self.schema().past() + 1 + self.schema().future();
            return Err(DatabaseError::NoCandidates { needed });
        }
        let index = Index::build(self.features(), self.dims(), &candidates, Some(self.tags()))?;
        Ok(Self { index: Arc::new(index), left: Some(Arc::new(Left { rows, candidates })), ..self.clone() })
    }

    /// The candidates of which all rows are left that their features look at.
    fn with_their_support(&self, left: &[bool]) -> Vec<bool> {
        let (past, future) = (self.schema().past(), self.schema().future());
        let mut gone_before = vec![0_u32; left.len() + 1];
        for (row, &left) in left.iter().enumerate() {
            gone_before[row + 1] = gone_before[row] + u32::from(!left);
        }
        let is_whole = |(row, &candidate): (usize, &bool)| {
            candidate && gone_before[row + future + 1] == gone_before[row - past]
        };
        self.candidates().iter().enumerate().map(is_whole).collect()
    }
}
