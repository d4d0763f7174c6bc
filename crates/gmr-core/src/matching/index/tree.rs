//! The layout that is searched: leaves of eight frames in the order of a kd-tree, and above them boxes, eight to a node.
//!
//! Every node but the last of its level is full, so child `j` of node `i` is node `8 i + j` of the level below, and
//! nothing needs to be stored to find it. What eight lanes share stands side by side: one number of each of eight
//! frames, the edges of each of eight boxes.
//!
//! Rows and boxes are kept twice. Coded, along principal axes, they are a quarter as large: they rule out nearly
//! everything where all dimensions count alike ([`super::codes`]). As they are, along the features' own dimensions, the
//! widest first, rows give the costs, and boxes rule out where dimensions have weights of their own.

use std::ops::Range;
#[cfg(feature = "file")]
use std::sync::Arc;

use super::super::column::Column;
use super::axes::Axes;
use super::codes::{BOX_PAIR, Codes, Grid, ROW_PAIR, grid_width, pairs};
use super::layout::{Edges, Lanes, W, block};
#[cfg(feature = "file")]
use super::seal::Seals;

/// Leaves and the nodes above them.
#[derive(Debug, Clone)]
pub(in super::super) struct Tree {
    /// The dimensions as they are laid out.
    pub(super) order: Vec<u32>,
    /// Where each dimension is laid out: the inverse of `order`.
    pub(super) places: Vec<u32>,
    pub(super) axes: Axes,
    pub(super) levels: Levels,
    pub(super) codes: Codes,
    /// Leaves x dims x 8.
    pub(super) rows: Column<f32>,
    /// Frames of each leaf, ascending; `u32::MAX` behind the last.
    pub(super) frames: Column<[u32; W]>,
    /// Tag bits of each of them.
    pub(super) tags: Column<[u32; W]>,
    /// Nodes x dims x 8.
    pub(super) boxes: Column<u32>,
    /// Lowest frame in each box of each node.
    pub(super) lowest: Column<[u32; W]>,
    /// All bits that the frames in each box of each node carry.
    pub(super) node_tags: Column<[u32; W]>,
    /// Of a tree in a file: what each of its blocks must sum up to.
    #[cfg(feature = "file")]
    pub(super) seals: Option<Arc<Seals>>,
}

/// How many nodes there are on each level: the level above the leaves first, the root's last; none where one leaf holds
/// all. They lie one level after the other.
#[derive(Debug, Clone)]
pub(super) struct Levels {
    leaf_count: usize,
    /// The first node of each level, and one past the last.
    starts: Vec<usize>,
}

impl Levels {
    /// The levels above so many leaves.
    pub(super) fn above(leaf_count: usize) -> Self {
        let (mut starts, mut below) = (vec![0], leaf_count);
        while below > 1 {
            below = below.div_ceil(W);
            starts.push(starts[starts.len() - 1] + below);
        }
        Self { leaf_count, starts }
    }

    pub(super) fn leaf_count(&self) -> usize {
        self.leaf_count
    }

    pub(super) fn node_count(&self) -> usize {
        self.starts[self.count()]
    }

    /// How many levels there are.
    pub(super) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The nodes of a level.
    #[inline(always)]
    pub(super) fn nodes(&self, level: usize) -> Range<usize> {
        self.starts[level]..self.starts[level + 1]
    }

    /// Nodes on the level below, or leaves.
    #[inline(always)]
    pub(super) fn below(&self, level: usize) -> usize {
        level.checked_sub(1).map_or(self.leaf_count, |below| self.nodes(below).len())
    }
}

/// How many numbers a row has.
pub(super) trait Width: Copy {
    fn dims(self) -> usize;
}

/// Known when the tree is met.
#[derive(Clone, Copy)]
pub(super) struct AnyWidth(usize);

/// Known when a search is compiled: then so are the sizes of all blocks, and no instruction is spent on them.
#[derive(Clone, Copy)]
pub(super) struct Fixed<const DIMS: usize>;

impl Width for AnyWidth {
    #[inline(always)]
    fn dims(self) -> usize {
        self.0
    }
}

impl<const DIMS: usize> Width for Fixed<DIMS> {
    #[inline(always)]
    fn dims(self) -> usize {
        DIMS
    }
}

/// A tree as a search sees it: where its numbers lie, whatever keeps them.
#[derive(Clone, Copy)]
pub(super) struct View<'a, D = AnyWidth> {
    width: D,
    pub(super) order: &'a [u32],
    pub(super) places: &'a [u32],
    pub(super) axes: &'a Axes,
    pub(super) levels: &'a Levels,
    pub(super) frames: &'a [[u32; W]],
    pub(super) tags: &'a [[u32; W]],
    pub(super) lowest: &'a [[u32; W]],
    pub(super) node_tags: &'a [[u32; W]],
    pub(super) rows: &'a [f32],
    pub(super) boxes: &'a [u32],
    pub(super) grids: &'a [f32],
    pub(super) node_codes: &'a [u8],
    pub(super) leaf_codes: &'a [u8],
    #[cfg(feature = "file")]
    seals: Option<&'a Seals>,
}

impl Tree {
    pub(super) fn view(&self) -> View<'_> {
        self.view_as(AnyWidth(self.order.len()))
    }

    /// As [`Tree::view`] of a tree whose rows are known to have that width.
    pub(super) fn view_as<D: Width>(&self, width: D) -> View<'_, D> {
        assert_eq!(width.dims(), self.order.len());
        View {
            width,
            order: &self.order,
            places: &self.places,
            axes: &self.axes,
            levels: &self.levels,
            frames: &self.frames,
            tags: &self.tags,
            lowest: &self.lowest,
            node_tags: &self.node_tags,
            rows: &self.rows,
            boxes: &self.boxes,
            grids: &self.codes.grids,
            node_codes: &self.codes.boxes,
            leaf_codes: &self.codes.rows,
            #[cfg(feature = "file")]
            seals: self.seals.as_deref(),
        }
    }
}

impl<'a, D: Width> View<'a, D> {
    #[inline(always)]
    pub(super) fn dims(&self) -> usize {
        self.width.dims()
    }

    /// The frames of a leaf, eight side by side in every dimension.
    #[inline(always)]
    pub(super) fn leaf(&self, leaf: usize) -> &'a [Lanes<W>] {
        block(self.rows, leaf, self.dims())
    }

    /// The boxes of a node, eight side by side in every dimension.
    #[inline(always)]
    pub(super) fn node(&self, node: usize) -> &'a [Edges<W>] {
        block(self.boxes, node, self.dims())
    }

    /// The grid of a node's codes.
    #[inline(always)]
    pub(super) fn grid(&self, node: usize) -> Grid<'a> {
        let width = grid_width(self.dims());
        Grid::new(&self.grids[node * width..][..width])
    }

    /// The boxes of a node, coded.
    #[inline(always)]
    pub(super) fn coded_node(&self, node: usize) -> &'a [[u8; BOX_PAIR]] {
        block(self.node_codes, node, pairs(self.dims()))
    }

    /// The frames of a leaf, coded on the grid of the node above.
    #[inline(always)]
    pub(super) fn coded_leaf(&self, leaf: usize) -> &'a [[u8; ROW_PAIR]] {
        block(self.leaf_codes, leaf, pairs(self.dims()))
    }

    /// The node of that place on its level, among all nodes.
    #[inline(always)]
    pub(super) fn place(&self, level: usize, node: usize) -> usize {
        self.levels.starts[level] + node
    }

    /// The bits of a node's children: eight of them, or what is left for the last node of a level.
    #[inline(always)]
    pub(super) fn children(&self, level: usize, node: usize) -> u32 {
        u32::MAX >> (32 - (self.levels.below(level) - node * W).min(W))
    }

    /// Whether a leaf may be looked at. What was found damaged is remembered, so that no answer is given.
    #[inline(always)]
    pub(super) fn is_sound_leaf(&self, leaf: usize) -> bool {
        #[cfg(feature = "file")]
        if let Some(seals) = self.seals {
            return seals.is_leaf_sound(self, leaf);
        }
        let _ = leaf;
        true
    }

    /// As [`View::is_sound_leaf`], of the node of this number among all.
    #[inline(always)]
    pub(super) fn is_sound_node(&self, node: usize) -> bool {
        #[cfg(feature = "file")]
        if let Some(seals) = self.seals {
            return seals.is_node_sound(self, node);
        }
        let _ = node;
        true
    }
}
