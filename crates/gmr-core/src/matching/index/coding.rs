//! How nodes and leaves come to their codes: from the bottom up, level by level, the nodes of a level by many threads.

use super::super::aligned::Aligned;
use super::axes::{Axes, axis_blocks};
use super::codes::{
    BOX_PAIR, Codes, FINEST, Grid, MOST_CODED, PARTS, ROW_PAIR, SHORTEST, STEPS, grid_width, nearest, pairs,
};
use super::kernel::Kernel;
use super::layout::{W, larger, smaller};
use super::tree::Levels;
use super::turned::Turned;
use super::{Kernels, Work};
use crate::parallel::for_each_part;

/// Nodes that a thread codes at a time.
const NODES_A_PART: usize = 64;

impl Codes {
    /// Codes of the leaves that hold these frames, and of the nodes above them.
    pub(super) fn of(
        axes: &Axes,
        frames: &[[u32; W]],
        levels: &Levels,
        turned: &Turned,
        kernels: Kernels,
        threads: usize,
    ) -> Self {
        let dims = axes.dims();
        if dims > MOST_CODED {
            return Self { grids: Vec::new().into(), boxes: Vec::new().into(), rows: Vec::new().into() };
        }
        let nodes = levels.node_count();
        let mut grids = Aligned::zeros(nodes * grid_width(dims));
        let mut boxes = Aligned::zeros(nodes * pairs(dims) * BOX_PAIR);
        let mut rows = Aligned::zeros(frames.len() * pairs(dims) * ROW_PAIR);
        let mut uncoded = Uncoded {
            dims,
            grids: grids.as_mut_slice(),
            boxes: boxes.as_mut_slice().as_chunks_mut().0,
            rows: rows.as_mut_slice().as_chunks_mut().0,
        };
        let shortest = (FINEST * axes.error(turned.size)).max(SHORTEST);
        let mut below = Vec::new();
        for level in 0..levels.count() {
            let width = 2 * axis_blocks(dims);
            let mut corners = vec![[0.0; W]; levels.nodes(level).len() * width];
            let children = match level {
                0 => Children::Leaves { frames, turned },
                _ => Children::Nodes { corners: &below },
            };
            let parts: Vec<Part> = corners
                .chunks_mut(NODES_A_PART * width)
                .enumerate()
                .map(|(part, corners)| uncoded.part(part * NODES_A_PART, corners, children))
                .collect();
            for_each_part(parts.into_iter(), threads, |part| {
                kernels.run(CodePart { part, children, shortest })
            });
            below = corners;
        }
        Self { grids: grids.into(), boxes: boxes.into(), rows: rows.into() }
    }
}

/// Eight numbers, in one register or two.
type Block = [f32; W];

/// What nodes of a level stand above.
#[derive(Clone, Copy)]
enum Children<'a> {
    Leaves {
        frames: &'a [[u32; W]],
        turned: &'a Turned,
    },
    Nodes {
        /// Of each: the blocks of its lowest corner, then those of its highest.
        corners: &'a [Block],
    },
}

/// Room for the codes of nodes that have none yet.
struct Uncoded<'a> {
    dims: usize,
    grids: &'a mut [f32],
    boxes: &'a mut [[u8; BOX_PAIR]],
    rows: &'a mut [[u8; ROW_PAIR]],
}

impl<'a> Uncoded<'a> {
    /// The next nodes: as many as there is room for `corners`, the first of them the `first` of its level.
    fn part<'p>(&mut self, first: usize, corners: &'p mut [Block], children: Children) -> Part<'p>
    where
        'a: 'p,
    {
        let (dims, nodes) = (self.dims, corners.len() / (2 * axis_blocks(self.dims)));
        let leaves = match children {
            Children::Leaves { .. } => (nodes * W).min(self.rows.len() / pairs(dims)),
            Children::Nodes { .. } => 0,
        };
        Part {
            dims,
            first,
            corners,
            grids: taken(&mut self.grids, nodes * grid_width(dims)),
            boxes: taken(&mut self.boxes, nodes * pairs(dims)),
            rows: taken(&mut self.rows, leaves * pairs(dims)),
        }
    }
}

/// The first `count` of `rest`, which are no longer in it.
fn taken<'a, T>(rest: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    rest.split_off_mut(..count).unwrap_or_default()
}

/// Nodes that are coded together.
struct Part<'a> {
    dims: usize,
    /// The place of the first on its level.
    first: usize,
    /// Of each: the blocks of its lowest corner, then those of its highest.
    corners: &'a mut [Block],
    grids: &'a mut [f32],
    boxes: &'a mut [[u8; BOX_PAIR]],
    /// Of leaves below, if there are.
    rows: &'a mut [[u8; ROW_PAIR]],
}

/// Codes a part.
struct CodePart<'a> {
    part: Part<'a>,
    children: Children<'a>,
    shortest: f32,
}

impl Work for CodePart<'_> {
    type Done = ();

    #[inline(always)]
    fn run<K: Kernel<W>>(mut self, kernel: K) {
        match self.children {
            Children::Leaves { frames, turned } => self.code_above_leaves(kernel, frames, turned),
            Children::Nodes { corners } => self.code_above_nodes(corners),
        }
    }
}

impl CodePart<'_> {
    #[inline(always)]
    fn code_above_leaves<K: Kernel<W>>(&mut self, kernel: K, frames: &[[u32; W]], turned: &Turned) {
        let dims = self.part.dims;
        let blocks = axis_blocks(dims);
        let (mut rows, mut corners) = (vec![[0.0; W]; W * W * blocks], vec![[0.0; W]; W * 2 * blocks]);
        let leaves = &frames[self.part.first * W..];
        let nodes = self.part.corners.len() / (2 * blocks);
        for (node, leaves) in leaves.chunks(W).take(nodes).enumerate() {
            // Rows lie anywhere: those of a later leaf are sent for, and each is looked up once.
            let later = frames.get((self.part.first + node + 1) * W..).unwrap_or_default().as_flattened();
            for (at, (frame, row)) in held(leaves).zip(rows.chunks_exact_mut(blocks)).enumerate() {
                if let Some(&later) = later.get(at).filter(|&&frame| frame != u32::MAX) {
                    kernel.fetch(turned.row(later));
                }
                copy(turned.blocks(frame), dims, row);
            }
            let rows = &rows[..held(leaves).count() * blocks];
            let corners = &mut corners[..leaves.len() * 2 * blocks];
            for (rows, corners) in rows.chunks(W * blocks).zip(corners.chunks_exact_mut(2 * blocks)) {
                surround(rows.chunks_exact(blocks).map(|row| (row, row)), corners);
            }
            self.code_node(node, corners);
            let grid = NodeGrid::of(self.part.corners, self.part.grids, node, dims);
            let codes = self.part.rows[node * W * pairs(dims)..].chunks_exact_mut(pairs(dims));
            for (rows, codes) in rows.chunks(W * blocks).zip(codes) {
                for (lane, row) in rows.chunks_exact(blocks).enumerate() {
                    code_row(grid, row, lane, codes);
                }
            }
        }
    }

    #[inline(always)]
    fn code_above_nodes(&mut self, corners: &[Block]) {
        let width = 2 * axis_blocks(self.part.dims);
        let children = corners[self.part.first * W * width..].chunks(W * width);
        for (node, children) in children.take(self.part.corners.len() / width).enumerate() {
            self.code_node(node, children);
        }
    }

    /// Codes the boxes of a node on the grid of what is around them all.
    #[inline(always)]
    fn code_node(&mut self, node: usize, children: &[Block]) {
        let dims = self.part.dims;
        let blocks = axis_blocks(dims);
        let around = &mut self.part.corners[node * 2 * blocks..][..2 * blocks];
        surround(children.chunks_exact(2 * blocks).map(|child| child.split_at(blocks)), around);
        lay_grid(around, self.shortest, &mut self.part.grids[node * grid_width(dims)..][..grid_width(dims)]);
        let grid = NodeGrid::of(self.part.corners, self.part.grids, node, dims);
        let codes = &mut self.part.boxes[node * pairs(dims)..][..pairs(dims)];
        for (lane, child) in children.chunks_exact(2 * blocks).enumerate() {
            code_box(grid, child, lane, codes);
        }
    }
}

/// All frames in leaves.
fn held(leaves: &[[u32; W]]) -> impl Iterator<Item = u32> {
    leaves.as_flattened().iter().copied().take_while(|&frame| frame != u32::MAX)
}

/// The grid of a node, block by block.
#[derive(Clone, Copy)]
struct NodeGrid<'a> {
    corner: &'a [Block],
    grid: Grid<'a>,
}

impl<'a> NodeGrid<'a> {
    fn of(corners: &'a [Block], grids: &'a [f32], node: usize, dims: usize) -> Self {
        let (blocks, width) = (axis_blocks(dims), grid_width(dims));
        Self {
            corner: &corners[node * 2 * blocks..][..blocks],
            grid: Grid::new(&grids[node * width..][..width]),
        }
    }

    #[inline(always)]
    fn coded(self, block: usize, x: &Block, round: impl Fn(f32) -> i16) -> [u8; W] {
        let corner = &self.corner[block];
        std::array::from_fn(|lane| round(self.grid.steps(corner[lane], x[lane])) as u8)
    }
}

/// Copies the blocks of a row, zeros behind its last number.
#[inline(always)]
fn copy(row: &[Block], dims: usize, to: &mut [Block]) {
    to.iter_mut().zip(row).for_each(|(to, block)| *to = *block);
    if let Some(last) = to.last_mut() {
        *last = std::array::from_fn(|lane| if (dims - 1) % W >= lane { last[lane] } else { 0.0 });
    }
}

/// Makes the corners those of what is around all these: lowest and highest blocks.
#[inline(always)]
fn surround<'a>(inner: impl Iterator<Item = (&'a [Block], &'a [Block])> + Clone, corners: &mut [Block]) {
    let (lowest, highest) = corners.split_at_mut(corners.len() / 2);
    for (block, (lowest, highest)) in lowest.iter_mut().zip(highest).enumerate() {
        let (mut low, mut high) = ([f32::INFINITY; W], [f32::NEG_INFINITY; W]);
        for (lows, highs) in inner.clone() {
            let (lows, highs) = (&lows[block], &highs[block]);
            low = std::array::from_fn(|lane| smaller(lows[lane], low[lane]));
            high = std::array::from_fn(|lane| larger(highs[lane], high[lane]));
        }
        (*lowest, *highest) = (low, high);
    }
}

/// Fills in a grid between corners.
#[inline(always)]
fn lay_grid(corners: &[Block], shortest: f32, grid: &mut [f32]) {
    let (low, high) = corners.split_at(corners.len() / 2);
    let mut widest = [0.0; W];
    for (numbers, (low, high)) in grid.as_chunks_mut::<W>().0.iter_mut().zip(low.iter().zip(high)) {
        *numbers = *low;
        widest = std::array::from_fn(|lane| larger(high[lane] - low[lane], widest[lane]));
    }
    let widest = widest.into_iter().fold(0.0, larger);
    let part = (widest / STEPS).max(shortest) / PARTS;
    let width = grid.len();
    (grid[width - 2], grid[width - 1]) = (1.0 / part, (part * part).min(f32::MAX));
}

/// Fills in a box of a node.
#[inline(always)]
fn code_box(grid: NodeGrid, corners: &[Block], lane: usize, codes: &mut [[u8; BOX_PAIR]]) {
    let (low, high) = corners.split_at(corners.len() / 2);
    let (mut lower, mut upper) = ([[0; W]; MOST_CODED / W], [[0; W]; MOST_CODED / W]);
    for (block, (low, high)) in low.iter().zip(high).enumerate() {
        (lower[block], upper[block]) = (grid.coded(block, low, floor), grid.coded(block, high, ceil));
    }
    let numbers = lower.as_flattened().as_chunks::<2>().0.iter().zip(upper.as_flattened().as_chunks::<2>().0);
    for (codes, (lower, upper)) in codes.iter_mut().zip(numbers) {
        let lanes = codes.as_chunks_mut::<2>().0;
        (lanes[lane], lanes[W + lane]) = (*lower, *upper);
    }
}

/// Fills in a row of a leaf.
#[inline(always)]
fn code_row(grid: NodeGrid, row: &[Block], lane: usize, codes: &mut [[u8; ROW_PAIR]]) {
    let mut numbers = [[0; W]; MOST_CODED / W];
    for (block, (numbers, x)) in numbers.iter_mut().zip(row).enumerate() {
        *numbers = grid.coded(block, x, nearest);
    }
    for (codes, number) in codes.iter_mut().zip(numbers.as_flattened().as_chunks::<2>().0) {
        codes.as_chunks_mut::<2>().0[lane] = *number;
    }
}

#[inline(always)]
fn floor(x: f32) -> i16 {
    nearest(x) - i16::from(f32::from(nearest(x)) > x)
}

#[inline(always)]
fn ceil(x: f32) -> i16 {
    nearest(x) + i16::from(f32::from(nearest(x)) < x)
}
