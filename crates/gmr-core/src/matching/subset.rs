//! A database of which only some rows are left, without anything being read or measured again.
//!
//! A row that is gone is neither jumped to nor played on to: where one follows, the clip ends. Nor is a row jumped to
//! whose features look at one that is gone, for a file without that frame could not give them. All that is left keeps
//! its number, its features and their scale, so that trials on whole clips are, bit by bit, those on a database built
//! of these clips with the same [`super::normalization::Normalization`].

use std::sync::Arc;

use super::database::Database;
use super::database_error::DatabaseError;
use super::index::Index;
use super::left::Left;
use crate::error::ShapeError;

impl Database {
    /// The rows for which `left` holds (N), of those that were left so far; the poses are shared, the index is new and
    /// built by `threads` threads (0: all cores), on which its bits do not depend.
    ///
    /// # Errors
    /// When `left` has not one entry a row, or no row that may be jumped to is left.
    pub fn subset(&self, left: &[bool], threads: usize) -> Result<Self, DatabaseError> {
        ShapeError::check("rows left", self.row_count(), left.len())?;
        let rows: Vec<u8> = (0..).zip(left).map(|(row, &left)| u8::from(left && self.has_row(row))).collect();
        let part = Self { left: Some(Arc::new(Left::new(rows))), ..self.clone() };
        if !part.candidates().contains(&true) {
            let needed = self.schema().past() + 1 + self.schema().future();
            return Err(DatabaseError::NoCandidates { needed });
        }
        let index =
            Index::build(self.features(), self.dims(), part.candidates(), Some(self.tags()), threads)?;
        Ok(Self { index: Arc::new(index), ..part })
    }

    /// Which rows may be jumped to (N): those whose clip holds all that their features look at, and of a
    /// [`Database::subset`] those of which all of that is left.
    #[must_use]
    pub fn candidates(&self) -> &[bool] {
        let whole = || self.rows.candidates.get_or_init(|| self.with_their_window());
        match &self.left {
            None => whole(),
            Some(left) => left.candidates(|rows| self.with_their_support(rows, whole())),
        }
    }

    fn with_their_window(&self) -> Vec<bool> {
        let (past, future) = (self.schema().past(), self.schema().future());
        let within = |frames: usize| (0..frames).map(move |i| i >= past && i + future < frames);
        self.clips().iter().flat_map(|clip| within(clip.rows.len())).collect()
    }

    /// The candidates of which all rows are left that their features look at.
    fn with_their_support(&self, left: &[u8], candidates: &[bool]) -> Vec<bool> {
        let (past, future) = (self.schema().past(), self.schema().future());
        let mut gone_before = vec![0_u32; left.len() + 1];
        for (row, &left) in left.iter().enumerate() {
            gone_before[row + 1] = gone_before[row] + u32::from(left == 0);
        }
        let is_whole = |(row, &candidate): (usize, &bool)| {
            candidate && gone_before[row + future + 1] == gone_before[row - past]
        };
        candidates.iter().enumerate().map(is_whole).collect()
    }
}
