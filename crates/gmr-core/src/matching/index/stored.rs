//! An index as files keep it: the arrays of a tree of eight lanes, which every machine can search where they lie.
//!
//! AVX2 and AVX-512 machines search it with AVX2, all others with two of their four lanes each: see
//! [`super::twice`]. A tree of another width, as AVX-512, SSE2 and NEON build it for themselves, is built anew in eight
//! lanes when it is saved, so that files do not depend on the machine.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use super::super::column::Column;
use super::build::Rows;
use super::seal::{Seals, sums};
use super::tree::{Levels, Tree};
use super::{Index, IndexError, Layout};
use crate::Isa;

/// Lanes of a stored tree.
pub(in super::super) const WIDTH: usize = 8;

/// How many leaves and nodes the tree of so many candidates has.
pub(in super::super) fn counts(candidates: usize) -> (usize, usize) {
    let levels = Levels::above(candidates.div_ceil(WIDTH), WIDTH);
    (levels.leaf_count(), levels.node_count())
}

/// The arrays of a tree with L leaves and M nodes over rows of D numbers.
pub(in super::super) struct Arrays<'a> {
    /// D: the dimensions as they are laid out.
    pub(in super::super) order: &'a [u32],
    /// (L, D, 8).
    pub(in super::super) rows: &'a [f32],
    /// (L, 8).
    pub(in super::super) frames: &'a [[u32; WIDTH]],
    /// (L, 8).
    pub(in super::super) tags: &'a [[u32; WIDTH]],
    /// (M, D, 8).
    pub(in super::super) boxes: &'a [u32],
    /// (M, 8).
    pub(in super::super) lowest: &'a [[u32; WIDTH]],
    /// (M, 8).
    pub(in super::super) node_tags: &'a [[u32; WIDTH]],
    /// (L + M).
    pub(in super::super) sums: Cow<'a, [u64]>,
}

/// As [`Arrays`], in a file; their lengths fit each other.
pub(in super::super) struct Parts {
    pub(in super::super) file: PathBuf,
    pub(in super::super) frame_count: usize,
    pub(in super::super) candidate_count: usize,
    pub(in super::super) order: Vec<u32>,
    pub(in super::super) rows: Column<f32>,
    pub(in super::super) frames: Column<[u32; WIDTH]>,
    pub(in super::super) tags: Column<[u32; WIDTH]>,
    pub(in super::super) boxes: Column<u32>,
    pub(in super::super) lowest: Column<[u32; WIDTH]>,
    pub(in super::super) node_tags: Column<[u32; WIDTH]>,
    pub(in super::super) sums: Column<u64>,
}

impl Index {
    /// The tree of eight lanes: this index's own, or one that is built of the same rows.
    pub(in super::super) fn in_eights(
        &self,
        features: &[f32],
        candidates: &[bool],
        tags: &[u32],
    ) -> Result<Cow<'_, Tree<WIDTH>>, IndexError> {
        if let Some(tree) = self.eights() {
            return Ok(Cow::Borrowed(tree));
        }
        super::error::check_rows(features, self.dims, candidates, Some(tags))?;
        Ok(Cow::Owned(Rows { features, dims: self.dims, candidates, tags: Some(tags) }.tree()))
    }

    /// An index that is searched where it lies, on the instruction set in use.
    ///
    /// # Errors
    /// A sentence, where the order of the dimensions is none.
    pub(in super::super) fn in_file(parts: Parts) -> Result<Self, String> {
        Self::in_file_for(Isa::current(), parts)
    }

    pub(super) fn in_file_for(isa: Isa, parts: Parts) -> Result<Self, String> {
        let Parts { file, frame_count, candidate_count, order, rows, frames, tags, boxes, lowest, .. } =
            parts;
        let dims = order.len();
        let mut places = vec![u32::MAX; dims];
        for (place, &dimension) in order.iter().enumerate() {
            match places.get_mut(dimension as usize) {
                Some(free) if *free == u32::MAX => *free = place as u32,
                _ => {
                    return Err(format!("the array 'index_order' does not name {dims} dimensions once each"));
                }
            }
        }
        let tree = Tree {
            order,
            places,
            levels: Levels::above(frames.len(), WIDTH),
            rows,
            frames,
            tags,
            boxes,
            lowest,
            node_tags: parts.node_tags,
            seals: Some(Arc::new(Seals::new(parts.sums, candidate_count, frame_count, file))),
        };
        Ok(Self { dims, frame_count, candidate_count, layout: Layout::of_eights(isa, tree) })
    }
}

impl Tree<WIDTH> {
    /// What is to be saved. The sums of a tree in a file stay what they are, so that damage is not blessed.
    pub(in super::super) fn arrays(&self) -> Arrays<'_> {
        Arrays {
            order: &self.order,
            rows: &self.rows,
            frames: &self.frames,
            tags: &self.tags,
            boxes: &self.boxes,
            lowest: &self.lowest,
            node_tags: &self.node_tags,
            sums: match &self.seals {
                Some(seals) => Cow::Borrowed(&seals.sums),
                None => Cow::Owned(sums(&self.view())),
            },
        }
    }
}
