//! Many queries at once, shared among threads.

use std::ops::Range;

use super::error::{check_weights, first_not_finite};
use super::{Hit, Index, IndexError, Query};
use crate::error::ShapeError;
use crate::parallel::for_each_chunk;

/// Many queries, answered with their `k` best frames each.
#[derive(Debug, Clone)]
pub struct Batch<'a> {
    /// Queries x dims numbers, finite.
    pub queries: &'a [f32],
    /// How many queries there are.
    pub count: usize,
    /// What squared differences are multiplied by: none, one row of dims numbers for all queries, or one a query.
    pub weights: Option<&'a [f32]>,
    /// Bits that a frame must all carry: one word for all queries, or one a query.
    pub tags: &'a [u32],
    /// Frames that are no candidates: none, or one range a query.
    pub exclude: Option<&'a [Range<u32>]>,
    /// Only frames that cost strictly less are hits.
    pub max_cost: f32,
    /// Threads to share the queries among; 0 means all cores.
    pub threads: usize,
}

/// Queries that one thread takes at a time: enough to make the taking cheap, few enough to share evenly.
const QUERIES_A_PIECE: usize = 64;

/// Queries answered between two looks at whether to go on: well under a second of work.
const QUERIES_A_SLAB: usize = 256 * QUERIES_A_PIECE;

impl Batch<'_> {
    fn check(&self, dims: usize) -> Result<(), IndexError> {
        ShapeError::check("queries", self.count.saturating_mul(dims), self.queries.len())?;
        if self.tags.len() != 1 {
            ShapeError::check("tags", self.count, self.tags.len())?;
        }
        if let Some(exclude) = self.exclude {
            ShapeError::check("exclude", self.count, exclude.len())?;
        }
        if let Some(weights) = self.weights {
            if weights.len() != dims {
                ShapeError::check("weights", self.count.saturating_mul(dims), weights.len())?;
            }
            let mut rows = weights.chunks_exact(dims).enumerate();
            rows.try_for_each(|(query, row)| check_weights(row, query))?;
        }
        if self.max_cost.is_nan() {
            return Err(IndexError::MaxCost);
        }
        for (query, row) in self.queries.chunks_exact(dims).enumerate() {
            if let Some(dimension) = first_not_finite(row) {
                return Err(IndexError::Query { query, dimension, found: row[dimension] });
            }
        }
        Ok(())
    }

    fn query(&self, i: usize, dims: usize) -> Query<'_> {
        Query {
            features: &self.queries[i * dims..][..dims],
            weights: self
                .weights
                .map(|rows| if rows.len() == dims { rows } else { &rows[i * dims..][..dims] }),
            tags: if self.tags.len() == 1 { self.tags[0] } else { self.tags[i] },
            exclude: self.exclude.map_or(0..0, |exclude| exclude[i].clone()),
            max_cost: self.max_cost,
        }
    }
}

impl Index {
    /// Fills `hits` (queries x `k`) with the best frames of every query, best first, [`Hit::NONE`] where there are
    /// fewer. `goes_on` is asked now and then; once it says no, the rest of `hits` is left as it was.
    ///
    /// # Errors
    /// When an array's length does not fit, a query is not finite, or what was met in a file is damaged.
    pub fn search_batch(
        &self,
        batch: &Batch,
        k: usize,
        hits: &mut [Hit],
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<(), IndexError> {
        batch.check(self.dims)?;
        ShapeError::check("hits", batch.count.saturating_mul(k), hits.len())?;
        if k == 0 {
            return Ok(());
        }
        for (slab, hits) in hits.chunks_mut(k.saturating_mul(QUERIES_A_SLAB)).enumerate() {
            if !goes_on() {
                break;
            }
            for_each_chunk(hits, k * QUERIES_A_PIECE, batch.threads, |piece, hits| {
                let first = slab * QUERIES_A_SLAB + piece * QUERIES_A_PIECE;
                for (i, hits) in hits.chunks_exact_mut(k).enumerate() {
                    self.rank(&batch.query(first + i, self.dims), hits);
                }
            });
            self.check_soundness()?;
        }
        Ok(())
    }
}
