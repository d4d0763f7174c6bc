//! Many queries at once, shared among threads.

use std::ops::Range;

use super::best::{Nearest, Ranked};
use super::codes::MOST_CODED;
use super::error::{check_weights, first_not_finite};
use super::layout::W;
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
const QUERIES_A_PIECE: usize = 256;

/// Hits that are kept for one slab, unless a single query asks for more.
const MOST_HITS_A_SLAB: usize = 1 << 20;

/// Axes by whose coordinates queries are put in order: most of what tells rows of motion apart.
const SORTED_AXES: usize = 5;

/// The bits of a number below 16, [`SORTED_AXES`] places apart: as many of them, each one place further, are a place on
/// a curve along which near places are mostly near (Morton 1966).
const SPREAD: [u32; 16] = {
    let mut spread = [0; 16];
    let mut number = 0;
    while number < 16 {
        let mut bit = 0;
        while bit < 4 {
            spread[number] |= (number as u32 >> bit & 1) << (bit * SORTED_AXES);
            bit += 1;
        }
        number += 1;
    }
    spread
};

/// Queries answered between two looks at whether to go on: well under a second of work.
const QUERIES_A_SLAB: usize = 64 * QUERIES_A_PIECE;

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
        if batch.count == 1 && goes_on() {
            self.rank(&batch.query(0, self.dims), hits);
            return self.check_soundness();
        }
        // Many hits a query need room twice.
        let slab_size = (MOST_HITS_A_SLAB / k).clamp(1, QUERIES_A_SLAB);
        for (slab, hits) in hits.chunks_mut(k.saturating_mul(slab_size)).enumerate() {
            if !goes_on() {
                break;
            }
            let first = slab * slab_size;
            let order = self.side_by_side(batch, first..first + hits.len() / k);
            let mut found = vec![Hit::NONE; hits.len()];
            for_each_chunk(&mut found, k * QUERIES_A_PIECE, batch.threads, |piece, found| {
                self.answer(batch, &order[piece * QUERIES_A_PIECE..], k, found);
            });
            self.check_soundness()?;
            for (&query, found) in order.iter().zip(found.chunks_exact(k)) {
                hits[(query as usize - first) * k..][..k].copy_from_slice(found);
            }
        }
        Ok(())
    }

    /// Answers the first queries of `order`, one for each `k` of `hits`.
    fn answer(&self, batch: &Batch, order: &[u32], k: usize, hits: &mut [Hit]) {
        let queries = order.iter().map(|&query| batch.query(query as usize, self.dims));
        if k == 1 {
            let asked = queries.zip(hits);
            self.visit_all(
                batch.weights,
                asked.map(|(query, hit)| {
                    let best = Nearest::new(hit, query.limit());
                    (query, best)
                }),
            );
        } else {
            let asked = queries.zip(hits.chunks_exact_mut(k));
            self.visit_all(
                batch.weights,
                asked.map(|(query, hits)| {
                    let best = Ranked::new(hits, query.limit());
                    (query, best)
                }),
            );
        }
    }

    /// The queries in an order in which those that look at the same part of the tree mostly follow each other: what one
    /// has brought into the cache serves the next.
    fn side_by_side(&self, batch: &Batch, queries: Range<usize>) -> Vec<u32> {
        let root = self.tree.levels.node_count().checked_sub(1).filter(|_| self.dims <= MOST_CODED);
        let Some(root) = root else { return queries.map(|query| query as u32).collect() };
        let tree = self.tree.view();
        let grid = tree.grid(root);
        let mut keyed: Vec<(u32, u32)> = queries
            .map(|query| {
                let mut turned = [[0.0; W]];
                tree.axes.turn(&batch.queries[query * self.dims..][..self.dims], &mut turned);
                let first = turned[0].iter().take(SORTED_AXES.min(self.dims)).enumerate();
                let place = first.fold(0, |place, (axis, &q)| {
                    place
                        | SPREAD[usize::from(grid.steps(grid.numbers[axis], q) as u8 >> 4)]
                            << (SORTED_AXES - 1 - axis)
                });
                (place, query as u32)
            })
            .collect();
        keyed.sort_unstable();
        keyed.into_iter().map(|(_, query)| query).collect()
    }
}
