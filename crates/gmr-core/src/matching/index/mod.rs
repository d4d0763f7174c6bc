//! Exact nearest neighbour in squared distance over the feature rows of a motion database.
//!
//! The cost of a frame is the sum, over the dimensions in their order, of `(q_d - x_d)^2`, or of `w_d (q_d - x_d)^2`
//! where the query has weights, in `f32`, each step rounded by itself ([`brute_force::cost`],
//! [`brute_force::weighted_cost`]). The best frame has the lowest cost; ties go to the lowest frame index.
//! Every instruction set and every thread count gives the same bits.

use std::ops::Range;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod batch;
mod best;
pub mod brute_force;
mod build;
mod check;
mod error;
mod metric;
#[cfg(target_arch = "aarch64")]
mod neon;
mod scalar;
#[cfg(feature = "file")]
mod seal;
#[cfg(target_arch = "x86_64")]
mod sse2;
#[cfg(feature = "file")]
pub(super) mod stored;
mod traverse;
mod tree;
#[cfg(feature = "file")]
mod twice;

pub use batch::Batch;
pub use error::IndexError;

use crate::Isa;
use best::{Best, Nearest, Ranked};
use build::Rows;
pub(super) use error::check_weights;
use error::{check_query, check_rows};
use metric::{Even, Metric, Weighted};
use tree::Tree;

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
    layout: Layout,
}

/// The tree that suits an instruction set.
#[derive(Debug, Clone)]
enum Layout {
    Scalar(Tree<8>),
    #[cfg(target_arch = "x86_64")]
    Sse2(Tree<4>),
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2, Tree<8>),
    #[cfg(target_arch = "x86_64")]
    Avx512(avx512::Avx512, Tree<16>),
    #[cfg(target_arch = "aarch64")]
    Neon(Tree<4>),
    /// Of a file, where the machine has four lanes.
    #[cfg(all(feature = "file", target_arch = "x86_64"))]
    Sse2Twice(Tree<8>),
    /// Of a file, where the machine has four lanes.
    #[cfg(all(feature = "file", target_arch = "aarch64"))]
    NeonTwice(Tree<8>),
}

#[cfg(feature = "file")]
impl Layout {
    /// A tree of eight lanes, searched by the widest kernels for it that `isa` has.
    fn of_eights(isa: Isa, tree: Tree<8>) -> Self {
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 | Isa::Avx2 => match avx2::Avx2::detect() {
                Some(avx2) => Self::Avx2(avx2, tree),
                None => Self::Sse2Twice(tree),
            },
            #[cfg(target_arch = "x86_64")]
            Isa::Sse2 => Self::Sse2Twice(tree),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => Self::NeonTwice(tree),
            _ => Self::Scalar(tree),
        }
    }
}

impl Index {
    /// Indexes the rows of `features` (frames x `dims`) for which `candidates` holds.
    ///
    /// `tags` holds one word of bits a frame; without it no frame carries any.
    ///
    /// # Errors
    /// When `dims` is 0, an array is not of one row or entry a frame, there are more than `u32::MAX - 1` frames, or
    /// a candidate's feature is not finite.
    pub fn build(
        features: &[f32],
        dims: usize,
        candidates: &[bool],
        tags: Option<&[u32]>,
    ) -> Result<Self, IndexError> {
        Self::build_for(Isa::current(), features, dims, candidates, tags)
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
    ) -> Result<Self, IndexError> {
        check_rows(features, dims, candidates, tags)?;
        let rows = Rows { features, dims, candidates, tags };
        let layout = match isa {
            Isa::Scalar => Some(Layout::Scalar(rows.tree())),
            #[cfg(target_arch = "x86_64")]
            Isa::Sse2 => Some(Layout::Sse2(rows.tree())),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => avx2::Avx2::detect().map(|avx2| Layout::Avx2(avx2, rows.tree())),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => avx512::Avx512::detect().map(|avx512| Layout::Avx512(avx512, rows.tree())),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => Some(Layout::Neon(rows.tree())),
            #[allow(unreachable_patterns)]
            _ => None,
        };
        let layout = layout.ok_or(IndexError::Isa { asked: isa })?;
        let candidate_count = candidates.iter().filter(|&&candidate| candidate).count();
        Ok(Self { dims, frame_count: candidates.len(), candidate_count, layout })
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
        let mut nearest = Nearest(start);
        self.visit(query, &mut nearest);
        self.check_soundness()?;
        Ok(nearest.0)
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
        let start = query.limit();
        let mut nearest = Nearest(start);
        self.visit(query, &mut nearest);
        (nearest.0 != start).then_some(nearest.0)
    }

    /// As [`Index::search_top`], of a query that was checked.
    fn rank(&self, query: &Query, hits: &mut [Hit]) -> usize {
        if let [hit] = hits {
            let found = self.nearest(query);
            *hit = found.unwrap_or(Hit::NONE);
            return usize::from(found.is_some());
        }
        let mut ranked = Ranked::new(hits, query.limit());
        self.visit(query, &mut ranked);
        ranked.finish()
    }

    /// An error where a search met a part of a file that is not as it was saved: then no answer can be trusted.
    fn check_soundness(&self) -> Result<(), IndexError> {
        #[cfg(feature = "file")]
        if let Some(tree) = self.eights()
            && let Some(seals) = &tree.seals
        {
            return seals.check(tree.levels.leaf_count());
        }
        Ok(())
    }

    /// The tree where it is one of eight lanes.
    #[cfg(feature = "file")]
    fn eights(&self) -> Option<&Tree<8>> {
        match &self.layout {
            Layout::Scalar(tree) => Some(tree),
            #[cfg(target_arch = "x86_64")]
            Layout::Avx2(_, tree) | Layout::Sse2Twice(tree) => Some(tree),
            #[cfg(target_arch = "x86_64")]
            Layout::Sse2(_) | Layout::Avx512(..) => None,
            #[cfg(target_arch = "aarch64")]
            Layout::NeonTwice(tree) => Some(tree),
            #[cfg(target_arch = "aarch64")]
            Layout::Neon(_) => None,
        }
    }

    fn visit(&self, query: &Query, best: &mut impl Best) {
        match query.weights {
            None => self.visit_by::<Even>(query, best),
            Some(_) => self.visit_by::<Weighted>(query, best),
        }
    }

    fn visit_by<M: Metric>(&self, query: &Query, best: &mut impl Best) {
        match &self.layout {
            Layout::Scalar(tree) => traverse::search::<8, _, M>(scalar::Scalar, tree, query, best),
            #[cfg(target_arch = "x86_64")]
            Layout::Sse2(tree) => traverse::search::<4, _, M>(sse2::Sse2, tree, query, best),
            #[cfg(target_arch = "x86_64")]
            Layout::Avx2(avx2, tree) => avx2.search::<M>(tree, query, best),
            #[cfg(target_arch = "x86_64")]
            Layout::Avx512(avx512, tree) => avx512.search::<M>(tree, query, best),
            #[cfg(target_arch = "aarch64")]
            Layout::Neon(tree) => traverse::search::<4, _, M>(neon::Neon, tree, query, best),
            #[cfg(all(feature = "file", target_arch = "x86_64"))]
            Layout::Sse2Twice(tree) => {
                traverse::search::<8, _, M>(twice::Twice(sse2::Sse2), tree, query, best);
            }
            #[cfg(all(feature = "file", target_arch = "aarch64"))]
            Layout::NeonTwice(tree) => {
                traverse::search::<8, _, M>(twice::Twice(neon::Neon), tree, query, best);
            }
        }
    }
}

#[cfg(all(test, feature = "file"))]
mod stored_tests;
#[cfg(test)]
mod tests;
