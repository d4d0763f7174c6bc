//! Exact nearest neighbour in squared distance over the feature rows of a motion database.
//!
//! The cost of a frame is the sum, over the dimensions in their order, of `(q_d - x_d)^2`, or of `w_d (q_d - x_d)^2`
//! where the query has weights, in `f32`, each step rounded by itself ([`brute_force::cost`],
//! [`brute_force::weighted_cost`]). The best frame has the lowest cost; ties go to the lowest frame index.
//! Every instruction set and every thread count gives the same bits.

use std::marker::PhantomData;
use std::ops::Range;

mod arrange;
#[cfg(target_arch = "x86_64")]
mod avx2;
mod axes;
mod batch;
mod best;
mod boxes;
pub mod brute_force;
mod build;
mod check;
mod codes;
mod coding;
mod error;
mod kernel;
mod layout;
mod metric;
#[cfg(target_arch = "aarch64")]
mod neon;
mod rows;
mod scalar;
#[cfg(feature = "file")]
mod seal;
#[cfg(target_arch = "x86_64")]
mod sse2;
#[cfg(feature = "file")]
pub(super) mod stored;
mod traverse;
mod tree;
mod turned;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod twice;

pub use batch::Batch;
pub use error::IndexError;

use crate::Isa;
use best::{Best, Nearest, Ranked};
use codes::MOST_CODED;
pub(super) use error::check_weights;
use error::{check_query, check_rows};
use kernel::Kernel;
use layout::W;
use metric::{Even, Metric, Weighted};
use rows::Rows;
use traverse::{search, search_all};
use tree::{Fixed, Tree, View, Width};

/// The width of [`super::features::Schema::locomotion`], for which searches are compiled once more.
const USUAL_DIMS: usize = 27;

/// A frame and what it costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Row of the features that the index was built from.
    pub frame: u32,
    /// Squared distance between query and frame.
    pub cost: f32,
}

impl Hit {
    /// No frame at all: what fills the places of a batch that no candidate takes.
    pub const NONE: Self = Self { frame: u32::MAX, cost: f32::INFINITY };

    /// Whether this hit comes before `other`: a lower cost, or the same cost and a lower frame.
    #[must_use]
    pub fn beats(self, other: Self) -> bool {
        self.cost < other.cost || (self.cost == other.cost && self.frame < other.frame)
    }
}

/// What to look for, and among which frames.
#[derive(Debug, Clone)]
pub struct Query<'a> {
    /// One number a dimension, finite.
    pub features: &'a [f32],
    /// What the squared difference of each dimension is multiplied by, finite and not below 0; `None`: all by 1,
    /// which is faster. Dimensions of weight 0 are left out.
    pub weights: Option<&'a [f32]>,
    /// Bits that a frame must all carry; 0 asks for none.
    pub tags: u32,
    /// Frames that are no candidates for this query, such as the neighbourhood of the one now playing.
    pub exclude: Range<u32>,
    /// Only frames that cost strictly less are hits; infinity asks for no limit.
    pub max_cost: f32,
}

impl<'a> Query<'a> {
    /// Looks for `features` among all candidates.
    #[must_use]
    pub fn new(features: &'a [f32]) -> Self {
        Self { features, weights: None, tags: 0, exclude: 0..0, max_cost: f32::INFINITY }
    }

    /// What a row of features costs, tags and exclusion aside.
    #[must_use]
    pub fn cost_of(&self, row: &[f32]) -> f32 {
        match self.weights {
            None => brute_force::cost(self.features, row),
            Some(weights) => brute_force::weighted_cost(self.features, weights, row),
        }
    }

    /// Whether a frame with these tags may be an answer.
    #[must_use]
    pub fn admits(&self, frame: u32, tags: u32) -> bool {
        tags & self.tags == self.tags && !self.exclude.contains(&frame)
    }

    /// The hit that every answer must beat: strictly below `max_cost`, for no frame index is below 0.
    fn limit(&self) -> Hit {
        Hit { frame: 0, cost: self.max_cost }
    }
}

/// The candidates of a database, laid out for search.
#[derive(Debug, Clone)]
pub struct Index {
    dims: usize,
    frame_count: usize,
    candidate_count: usize,
    kernels: Kernels,
    tree: Tree,
}

/// The kernels of an instruction set.
#[derive(Debug, Clone, Copy)]
enum Kernels {
    Scalar,
    #[cfg(target_arch = "x86_64")]
    Sse2,
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
    #[cfg(target_arch = "aarch64")]
    Neon,
}

/// What is done with the kernels of whatever instruction set there is.
trait Work {
    /// What comes of it.
    type Done;

    fn run<K: Kernel<W>>(self, kernel: K) -> Self::Done;
}

impl Kernels {
    /// The widest of an instruction set; none where this machine does not have it.
    fn of(isa: Isa) -> Option<Self> {
        match isa {
            Isa::Scalar => Some(Self::Scalar),
            #[cfg(target_arch = "x86_64")]
            Isa::Sse2 => Some(Self::Sse2),
            // Codes are read eight at a time, whatever more a register holds.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 | Isa::Avx512 if isa.is_available() => avx2::Avx2::detect().map(Self::Avx2),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => Some(Self::Neon),
            _ => None,
        }
    }

    fn run<T: Work>(self, work: T) -> T::Done {
        match self {
            Self::Scalar => work.run(scalar::Scalar),
            #[cfg(target_arch = "x86_64")]
            Self::Sse2 => work.run(twice::Twice(sse2::Sse2)),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(avx2) => avx2.run(work),
            #[cfg(target_arch = "aarch64")]
            Self::Neon => work.run(twice::Twice(neon::Neon)),
        }
    }
}

/// One search.
struct One<'a, D, M, B> {
    tree: View<'a, D>,
    query: &'a Query<'a>,
    best: B,
    metric: PhantomData<M>,
}

impl<D: Width, M: Metric<D>, B: Best> Work for One<'_, D, M, B> {
    type Done = B;

    #[inline(always)]
    fn run<K: Kernel<W>>(self, kernel: K) -> B {
        search::<K, D, M, B>(kernel, self.tree, self.query.clone(), self.best)
    }
}

/// Searches side by side.
struct Many<'a, D, M, I> {
    tree: View<'a, D>,
    asked: I,
    metric: PhantomData<M>,
}

impl<'a, D: Width, M: Metric<D>, B: Best, I: Iterator<Item = (Query<'a>, B)>> Work for Many<'a, D, M, I> {
    type Done = ();

    #[inline(always)]
    fn run<K: Kernel<W>>(self, kernel: K) {
        search_all::<K, D, M, B>(kernel, self.tree, self.asked);
    }
}

impl Index {
    /// Indexes the rows of `features` (frames x `dims`) for which `candidates` holds.
    ///
    /// `tags` holds one word of bits a frame; without it no frame carries any. The work is shared among `threads`
    /// threads (0: all cores); the bits do not depend on it.
    ///
    /// # Errors
    /// When `dims` is 0, an array is not of one row or entry a frame, there are more than `u32::MAX - 1` frames, or
    /// a candidate's feature is not finite.
    pub fn build(
        features: &[f32],
        dims: usize,
        candidates: &[bool],
        tags: Option<&[u32]>,
        threads: usize,
    ) -> Result<Self, IndexError> {
        Self::build_for(Isa::current(), features, dims, candidates, tags, threads)
    }

    /// As [`Index::build`], for an instruction set other than the process's own.
    ///
    /// # Errors
    /// As [`Index::build`].
    pub fn build_for(
        isa: Isa,
        features: &[f32],
        dims: usize,
        candidates: &[bool],
        tags: Option<&[u32]>,
        threads: usize,
    ) -> Result<Self, IndexError> {
        check_rows(features, dims, candidates, tags)?;
        let kernels = Kernels::of(isa).ok_or(IndexError::Isa { asked: isa })?;
        let tree = Rows { features, dims, candidates, tags }.tree(kernels, threads);
        let candidate_count = candidates.iter().filter(|&&candidate| candidate).count();
        Ok(Self { dims, frame_count: candidates.len(), candidate_count, kernels, tree })
    }

    /// Numbers a row.
    #[must_use]
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// Rows that the index was built from, candidates or not.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.frame_count
    }

    /// Rows that can be found.
    #[must_use]
    pub fn candidate_count(&self) -> usize {
        self.candidate_count
    }

    /// The best frame below `query.max_cost`, or none.
    ///
    /// # Errors
    /// When the query is not of `dims` finite numbers, a weight is no weight, or `max_cost` is NaN; or when what the
    /// search met in a file is damaged.
    pub fn search(&self, query: &Query) -> Result<Option<Hit>, IndexError> {
        check_query(query, self.dims, query.max_cost)?;
        let nearest = self.nearest(query);
        self.check_soundness()?;
        Ok(nearest)
    }

    /// The better of `start` and the best frame: `start`, the continuing pose with its cost, counts as one more
    /// candidate, excluded or not, and bounds the search from its beginning.
    ///
    /// A start of frame 0 is left only for what costs strictly less. `query.max_cost` is not looked at.
    ///
    /// # Errors
    /// When the query is not of `dims` finite numbers, a weight is no weight, or the start's cost is NaN; or
    /// when what the search met in a file is damaged.
    pub fn search_from(&self, query: &Query, start: Hit) -> Result<Hit, IndexError> {
        check_query(query, self.dims, start.cost)?;
        let mut hit = start;
        self.visit(query, Nearest::new(&mut hit, start));
        self.check_soundness()?;
        Ok(hit)
    }

    /// Fills `hits` with the best frames below `query.max_cost`, best first, and says how many there are; the rest
    /// becomes [`Hit::NONE`].
    ///
    /// # Errors
    /// When the query is not of `dims` finite numbers, a weight is no weight, or `max_cost` is NaN; or when what the
    /// search met in a file is damaged.
    pub fn search_top(&self, query: &Query, hits: &mut [Hit]) -> Result<usize, IndexError> {
        check_query(query, self.dims, query.max_cost)?;
        let found = self.rank(query, hits);
        self.check_soundness()?;
        Ok(found)
    }

    /// As [`Index::search`], of a query that was checked.
    fn nearest(&self, query: &Query) -> Option<Hit> {
        let mut hit = Hit::NONE;
        let found = self.visit(query, Nearest::new(&mut hit, query.limit())).finish();
        (found == 1).then_some(hit)
    }

    /// As [`Index::search_top`], of a query that was checked.
    fn rank(&self, query: &Query, hits: &mut [Hit]) -> usize {
        match hits {
            [hit] => self.visit(query, Nearest::new(hit, query.limit())).finish(),
            hits => self.visit(query, Ranked::new(hits, query.limit())).finish(),
        }
    }

    /// An error where a search met a part of a file that is not as it was saved: then no answer can be trusted.
    fn check_soundness(&self) -> Result<(), IndexError> {
        #[cfg(feature = "file")]
        if let Some(seals) = &self.tree.seals {
            return seals.check(self.tree.levels.leaf_count());
        }
        Ok(())
    }

    /// Whether queries of these weights are searched by the codes.
    fn counts_evenly(&self, weights: Option<&[f32]>) -> bool {
        weights.is_none() && self.dims <= MOST_CODED
    }

    fn visit<'a, B: Best>(&'a self, query: &'a Query<'a>, best: B) -> B {
        let tree = self.tree.view();
        match (self.counts_evenly(query.weights), self.dims) {
            (true, USUAL_DIMS) => {
                let tree = self.tree.view_as(Fixed::<USUAL_DIMS>);
                self.kernels.run(One { tree, query, best, metric: PhantomData::<Even> })
            }
            (true, _) => self.kernels.run(One { tree, query, best, metric: PhantomData::<Even> }),
            (false, _) => self.kernels.run(One { tree, query, best, metric: PhantomData::<Weighted> }),
        }
    }

    /// As [`Index::visit`], of many queries, which all have weights or none.
    fn visit_all<'a, B: Best>(
        &'a self,
        weights: Option<&[f32]>,
        asked: impl Iterator<Item = (Query<'a>, B)>,
    ) {
        let tree = self.tree.view();
        match (self.counts_evenly(weights), self.dims) {
            (true, USUAL_DIMS) => {
                let tree = self.tree.view_as(Fixed::<USUAL_DIMS>);
                self.kernels.run(Many { tree, asked, metric: PhantomData::<Even> });
            }
            (true, _) => self.kernels.run(Many { tree, asked, metric: PhantomData::<Even> }),
            (false, _) => self.kernels.run(Many { tree, asked, metric: PhantomData::<Weighted> }),
        }
    }
}

#[cfg(all(test, feature = "file"))]
mod stored_tests;
#[cfg(test)]
mod tests;
