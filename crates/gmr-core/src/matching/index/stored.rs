//! An index as files keep it: the arrays of a tree, which every machine lays out alike and searches where they lie.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use super::super::column::Column;
use super::axes::Axes;
pub(in super::super) use super::axes::axis_blocks;
use super::codes::Codes;
pub(in super::super) use super::codes::{grid_width, pairs};
pub(in super::super) use super::layout::W;
use super::seal::{Seals, sum_of_layout, sums};
use super::tree::{Levels, Tree};
use super::{Index, Kernels};
use crate::Isa;

/// How many leaves and nodes the tree of so many candidates has.
pub(in super::super) fn counts(candidates: usize) -> (usize, usize) {
    let levels = Levels::above(candidates.div_ceil(W));
    (levels.leaf_count(), levels.node_count())
}

/// The arrays of a tree with L leaves and M nodes over rows of D numbers.
pub(in super::super) struct Arrays<'a> {
    /// D: the dimensions as they are laid out.
    pub(in super::super) order: &'a [u32],
    /// (D): what is subtracted from rows before they are turned.
    pub(in super::super) mean: &'a [f64],
    /// (A, D, 8) with A = D / 8, rounded up: the principal axes, eight side by side; none where rows are not turned.
    pub(in super::super) axes: &'a [f64],
    /// (M, G): corner and step of each node's grid.
    pub(in super::super) grids: &'a [f32],
    /// (M, P, 2, 8, 2) with P = D / 2, rounded up: lower and upper edges in steps.
    pub(in super::super) box_codes: &'a [u8],
    /// (L, P, 8, 2): rows in steps.
    pub(in super::super) row_codes: &'a [u8],
    /// (L, D, 8).
    pub(in super::super) rows: &'a [f32],
    /// (L, 8).
    pub(in super::super) frames: &'a [[u32; W]],
    /// (L, 8).
    pub(in super::super) tags: &'a [[u32; W]],
    /// (M, D, 8).
    pub(in super::super) boxes: &'a [u32],
    /// (M, 8).
    pub(in super::super) lowest: &'a [[u32; W]],
    /// (M, 8).
    pub(in super::super) node_tags: &'a [[u32; W]],
    /// (L + M + 1).
    pub(in super::super) sums: Cow<'a, [u64]>,
}

/// As [`Arrays`], in a file; their lengths fit each other.
pub(in super::super) struct Parts {
    pub(in super::super) file: PathBuf,
    pub(in super::super) frame_count: usize,
    pub(in super::super) candidate_count: usize,
    pub(in super::super) order: Vec<u32>,
    pub(in super::super) mean: Vec<f64>,
    pub(in super::super) axes: Vec<f64>,
    pub(in super::super) grids: Column<f32>,
    pub(in super::super) box_codes: Column<u8>,
    pub(in super::super) row_codes: Column<u8>,
    pub(in super::super) rows: Column<f32>,
    pub(in super::super) frames: Column<[u32; W]>,
    pub(in super::super) tags: Column<[u32; W]>,
    pub(in super::super) boxes: Column<u32>,
    pub(in super::super) lowest: Column<[u32; W]>,
    pub(in super::super) node_tags: Column<[u32; W]>,
    pub(in super::super) sums: Column<u64>,
}

impl Index {
    /// An index that is searched where it lies, on the instruction set in use.
    ///
    /// # Errors
    /// A sentence, where the order of the dimensions is none.
    pub(in super::super) fn in_file(parts: Parts) -> Result<Self, String> {
        Self::in_file_for(Isa::current(), parts)
    }

    pub(super) fn in_file_for(isa: Isa, parts: Parts) -> Result<Self, String> {
        let Parts { file, frame_count, candidate_count, order, frames, .. } = parts;
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
        let seals = Seals::new(parts.sums, candidate_count, frame_count, file);
        let tree = Tree {
            order,
            places,
            axes: Axes::new(parts.mean, parts.axes),
            levels: Levels::above(frames.len()),
            codes: Codes { grids: parts.grids, boxes: parts.box_codes, rows: parts.row_codes },
            rows: parts.rows,
            frames,
            tags: parts.tags,
            boxes: parts.boxes,
            lowest: parts.lowest,
            node_tags: parts.node_tags,
            seals: Some(Arc::new(seals)),
        };
        if tree.seals.as_ref().and_then(|seals| seals.sums.last().copied())
            != Some(sum_of_layout(&tree.view()))
        {
            return Err("the axes of its index are damaged".to_owned());
        }
        let kernels = Kernels::of(isa).ok_or_else(|| format!("this machine does not have {isa:?}"))?;
        Ok(Self { dims, frame_count, candidate_count, kernels, tree })
    }

    /// What is to be saved. The sums of a tree in a file stay what they are, so that damage is not blessed.
    pub(in super::super) fn arrays(&self) -> Arrays<'_> {
        let tree = &self.tree;
        Arrays {
            order: &tree.order,
            mean: &tree.axes.mean,
            axes: &tree.axes.turn,
            grids: &tree.codes.grids,
            box_codes: &tree.codes.boxes,
            row_codes: &tree.codes.rows,
            rows: &tree.rows,
            frames: &tree.frames,
            tags: &tree.tags,
            boxes: &tree.boxes,
            lowest: &tree.lowest,
            node_tags: &tree.node_tags,
            sums: match &tree.seals {
                Some(seals) => Cow::Borrowed(&seals.sums),
                None => Cow::Owned(sums(&tree.view())),
            },
        }
    }
}
