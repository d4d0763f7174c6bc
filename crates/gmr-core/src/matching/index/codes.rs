//! Boxes and rows in a byte a number, on a grid of each node's own: what most of a search reads.
//!
//! Coordinates are those of [`super::axes::Axes`]. A node's grid begins at its lowest corner and is equally fine along
//! every axis, so a difference in codes, times the step, is a difference in coordinates. A box is rounded outwards, a
//! row to the nearest; a query is told in quarters of a step, and how many of them it may be off, whatever is rounded on
//! the way. So what is summed is never above the squared distance.

use super::super::aligned::Aligned;
use super::super::column::Column;
use super::axes::{Axes, larger, smaller};
use super::traverse::Kernel;
use super::tree::{Levels, W};

/// The codes of two axes for each of eight boxes or rows.
pub(super) type Pair = [[u8; 2]; W];

/// Steps between the lowest corner of a node and the highest, at most.
const STEPS: f32 = 254.0;

/// Parts of a step that a query is told in.
const PARTS: f32 = 4.0;

/// Parts of a step by which a query may be off: a half by rounding to the nearest, a sixteenth by what [`FINEST`]
/// leaves of errors of rows, and what is rounded while a number is put on a grid.
const SLACK: f32 = 0.6;

/// A step is at least that many times as long as a row's coordinate can be wrong.
const FINEST: f32 = 64.0;

/// The shortest step; its square has all its digits.
const SHORTEST: f32 = 1e-15;

/// Half a step, in parts: by which a row's code is rounded at most.
const HALF: i16 = 2;

/// Parts from the corner of a grid beyond which a query is not followed, so that [`PAIRS_A_SUM`] fit an `i32`.
pub(super) const FURTHEST: f32 = 7000.0;

/// Pairs of axes whose squares are summed as whole numbers.
const PAIRS_A_SUM: usize = 16;

/// What is added to a number so that the last bits of the sum are the nearest whole number.
const ROUNDER: f32 = 12_582_912.0;

/// Bytes of two axes of a node's boxes: lower edges, then upper ones.
pub(super) const BOX_PAIR: usize = 4 * W;

/// Bytes of two axes of a leaf's rows.
pub(super) const ROW_PAIR: usize = 2 * W;

/// The widest rows that are coded: turning wider ones would cost more than it spares.
pub(super) const MOST_CODED: usize = 128;

/// How many pairs of axes are coded: none of rows that are too wide.
pub(in super::super) fn pairs(dims: usize) -> usize {
    if dims > MOST_CODED { 0 } else { dims.div_ceil(2) }
}

/// Numbers of a node's grid: its corner, padded, how many parts of a step make 1, and the square of a part.
pub(in super::super) fn grid_width(dims: usize) -> usize {
    if dims > MOST_CODED { 0 } else { (dims + 2).next_multiple_of(W) }
}

/// All nodes and leaves, coded.
#[derive(Debug, Clone)]
pub(in super::super) struct Codes {
    /// Nodes x [`grid_width`].
    pub(super) grids: Column<f32>,
    /// Nodes x pairs x (lower, upper edges) x 8 x 2.
    pub(super) boxes: Column<u8>,
    /// Leaves x pairs x 8 x 2, on the grid of the node above.
    pub(super) rows: Column<u8>,
}

/// Where a node's codes begin and how long a step is.
#[derive(Clone, Copy)]
pub(super) struct Grid<'a> {
    /// All that is stored: see [`grid_width`].
    pub(super) numbers: &'a [f32],
    parts: f32,
    unit: f32,
}

impl<'a> Grid<'a> {
    #[inline(always)]
    pub(super) fn new(numbers: &'a [f32]) -> Self {
        let [.., parts, unit] = *numbers else { return Self { numbers, parts: 0.0, unit: 0.0 } };
        Self { numbers, parts, unit }
    }

    /// Whether a search can rely on it.
    #[cfg(feature = "file")]
    pub(super) fn is_sound(self) -> bool {
        let most = 2.0 * PARTS / SHORTEST;
        self.numbers.iter().all(|x| x.is_finite()) && (0.0..=most).contains(&self.parts) && self.unit >= 0.0
    }

    /// Steps from the corner.
    #[inline(always)]
    pub(super) fn steps(self, axis: usize, x: f32) -> f32 {
        (x - self.numbers[axis]) * (self.parts / PARTS)
    }
}

/// A query on the grid of a node, in parts of a step.
pub(super) struct Placed {
    q: [[i16; W]; MOST_CODED / W],
    /// By how much it may be off on each axis.
    apart: i16,
    unit: f32,
}

impl Placed {
    /// Room for a query.
    pub(super) fn new() -> Self {
        Self { q: [[0; W]; MOST_CODED / W], apart: 0, unit: 0.0 }
    }

    /// Puts a query whose coordinates are wrong by `error` at most on a grid.
    #[inline(always)]
    pub(super) fn place<K: Kernel<W>>(&mut self, kernel: K, turned: &[[f32; W]], error: f32, grid: Grid) {
        // Rounded up. Further apart than any two numbers on a grid, nothing is ruled out.
        self.apart = nearest(smaller(SLACK + 0.5 + error * grid.parts, 2.0 * FURTHEST));
        self.unit = grid.unit;
        let corners = grid.numbers.as_chunks::<W>().0;
        for ((q, turned), corner) in self.q.iter_mut().zip(turned).zip(corners) {
            *q = kernel.place(turned, corner, grid.parts);
        }
    }

    /// Lower bounds of the squared distances to eight boxes.
    #[inline(always)]
    pub(super) fn bounds_of_boxes<K: Kernel<W>>(&self, kernel: K, codes: &[[u8; BOX_PAIR]]) -> K::Sums {
        self.sum(kernel, codes, |gaps, q, codes| {
            let edges: &[Pair] = codes.as_chunks::<2>().0.as_chunks::<W>().0;
            kernel.add_gaps(gaps, q, self.apart, &edges[0], &edges[1])
        })
    }

    /// Lower bounds of the squared distances to the rows of a leaf, whose codes are rounded themselves.
    #[inline(always)]
    pub(super) fn bounds_of_rows<K: Kernel<W>>(&self, kernel: K, codes: &[[u8; ROW_PAIR]]) -> K::Sums {
        let apart = self.apart + HALF;
        self.sum(kernel, codes, |gaps, q, codes| {
            let rows: &[Pair] = codes.as_chunks::<2>().0.as_chunks::<W>().0;
            kernel.add_differences(gaps, q, apart, &rows[0])
        })
    }

    /// What `add` adds up for all pairs of axes.
    #[inline(always)]
    fn sum<K: Kernel<W>, const N: usize>(
        &self,
        kernel: K,
        codes: &[[u8; N]],
        add: impl Fn(K::Gaps, [i16; 2], &[u8; N]) -> K::Gaps,
    ) -> K::Sums {
        let q = self.q.as_flattened().as_chunks::<2>().0;
        let mut sums = kernel.zero();
        for (codes, q) in codes.chunks(PAIRS_A_SUM).zip(q.chunks(PAIRS_A_SUM)) {
            let q = &q[..codes.len()];
            let mut gaps = kernel.no_gaps();
            // By twos, for the loop itself takes as long as half a pair.
            let mut at = 0;
            while at + 1 < codes.len() {
                gaps = add(gaps, q[at], &codes[at]);
                gaps = add(gaps, q[at + 1], &codes[at + 1]);
                at += 2;
            }
            if at < codes.len() {
                gaps = add(gaps, q[at], &codes[at]);
            }
            sums = kernel.add(sums, kernel.in_units(gaps, self.unit));
        }
        sums
    }
}

/// The whole number nearest to `x`, whose size is below 2^15.
#[inline(always)]
fn nearest(x: f32) -> i16 {
    (x + ROUNDER).to_bits().wrapping_sub(ROUNDER.to_bits()) as i16
}

/// A coordinate of a query on a grid: the definition of what kernels do.
#[inline(always)]
pub(super) fn place(q: f32, corner: f32, parts: f32) -> i16 {
    nearest(smaller(larger((q - corner) * parts, -FURTHEST), FURTHEST))
}

/// Two coordinates of a query as they lie side by side.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
#[inline(always)]
pub(super) fn both([one, other]: [i16; 2]) -> i32 {
    i32::from(one) & 0xffff | i32::from(other) << 16
}

/// How far a box is from whatever is nearer than `apart` to `q`: the definition of what kernels sum.
#[inline(always)]
pub(super) fn gap(q: i16, apart: i16, lower: u8, upper: u8) -> i32 {
    let (lower, upper) = (PARTS as i32 * i32::from(lower), PARTS as i32 * i32::from(upper));
    ((lower - i32::from(q)).max(i32::from(q) - upper) - i32::from(apart)).max(0)
}

impl Codes {
    /// Codes of the leaves that hold these frames, and of the nodes above them: `row` gives the coordinates of a
    /// frame, which are of that `size` at most.
    pub(super) fn of<'a>(
        axes: &Axes,
        frames: &[[u32; W]],
        levels: &Levels,
        size: f32,
        row: impl Fn(u32) -> &'a [f32],
    ) -> Self {
        let dims = axes.dims();
        if dims > MOST_CODED {
            return Self { grids: Vec::new().into(), boxes: Vec::new().into(), rows: Vec::new().into() };
        }
        let (nodes, width) = (levels.node_count(), grid_width(dims));
        let mut codes = Coder {
            dims,
            shortest: (FINEST * axes.error(size)).max(SHORTEST),
            grids: Aligned::new(0.0, nodes * width),
            boxes: Aligned::new(0, nodes * pairs(dims) * BOX_PAIR),
            rows: Aligned::new(0, frames.len() * pairs(dims) * ROW_PAIR),
        };
        let mut below = Boxes::new(frames.len(), dims);
        let mut rows = vec![0.0; W * W * dims];
        for level in 0..levels.count() {
            let mut these = Boxes::new(levels.nodes(level).len(), dims);
            for (node, place) in levels.nodes(level).enumerate() {
                let children = node * W..((node + 1) * W).min(levels.below(level));
                // Rows lie anywhere, so they are looked up once.
                let leaves = if level == 0 { &frames[children.clone()] } else { &[] };
                for ((leaf, _, frame), copy) in held(leaves).zip(rows.chunks_exact_mut(dims)) {
                    copy.copy_from_slice(row(frame));
                    below.hold(children.start + leaf, copy, copy);
                }
                for child in children.clone() {
                    let (low, high) = below.of(child);
                    these.hold(node, low, high);
                }
                codes.lay_grid(place, these.of(node));
                for (lane, child) in children.clone().enumerate() {
                    codes.code_box(place, lane, below.of(child));
                }
                for ((leaf, lane, _), row) in held(leaves).zip(rows.chunks_exact(dims)) {
                    codes.code_row(place, children.start + leaf, lane, row);
                }
            }
            below = these;
        }
        Self { grids: codes.grids.into(), boxes: codes.boxes.into(), rows: codes.rows.into() }
    }
}

/// Leaf, lane and number of all frames in leaves.
fn held(leaves: &[[u32; W]]) -> impl Iterator<Item = (usize, usize, u32)> {
    let lanes = leaves.as_flattened().iter().copied().enumerate();
    lanes.map(|(at, frame)| (at / W, at % W, frame)).filter(|&(_, _, frame)| frame != u32::MAX)
}

/// Codes in the making.
struct Coder {
    dims: usize,
    shortest: f32,
    grids: Aligned<f32>,
    boxes: Aligned<u8>,
    rows: Aligned<u8>,
}

impl Coder {
    fn lay_grid(&mut self, node: usize, (low, high): (&[f32], &[f32])) {
        let width = grid_width(self.dims);
        let numbers = &mut self.grids.as_mut_slice()[node * width..][..width];
        numbers[..self.dims].copy_from_slice(low);
        let widest = low.iter().zip(high).map(|(low, high)| high - low).fold(0.0, f32::max);
        let part = (widest / STEPS).max(self.shortest) / PARTS;
        (numbers[width - 2], numbers[width - 1]) = (1.0 / part, (part * part).min(f32::MAX));
    }

    fn code_box(&mut self, node: usize, lane: usize, (low, high): (&[f32], &[f32])) {
        let (grids, boxes) = (&self.grids, &mut self.boxes);
        let grid = grid_of(grids.as_slice(), self.dims, node);
        let boxes: &mut [[u8; BOX_PAIR]] = block_mut(boxes.as_mut_slice(), node, pairs(self.dims));
        for (axis, (&low, &high)) in low.iter().zip(high).enumerate() {
            let (lower, upper) = (grid.steps(axis, low), grid.steps(axis, high));
            let at = 2 * lane + axis % 2;
            boxes[axis / 2][at] = lower as u8;
            boxes[axis / 2][at + 2 * W] = upper as u8 + u8::from(f32::from(upper as u8) < upper);
        }
    }

    fn code_row(&mut self, node: usize, leaf: usize, lane: usize, row: &[f32]) {
        let (grids, rows) = (&self.grids, &mut self.rows);
        let grid = grid_of(grids.as_slice(), self.dims, node);
        let steps_a_unit = grid.parts / PARTS;
        let mut codes = [[0_u8; 2]; MOST_CODED / 2];
        for ((code, &x), &corner) in codes.as_flattened_mut().iter_mut().zip(row).zip(grid.numbers) {
            *code = nearest((x - corner) * steps_a_unit) as u8;
        }
        let rows: &mut [[u8; ROW_PAIR]] = block_mut(rows.as_mut_slice(), leaf, pairs(self.dims));
        for (pair, code) in rows.iter_mut().zip(codes) {
            pair.as_chunks_mut::<2>().0[lane] = code;
        }
    }
}

fn grid_of(grids: &[f32], dims: usize, node: usize) -> Grid<'_> {
    let width = grid_width(dims);
    Grid::new(&grids[node * width..][..width])
}

fn block_mut<T, const N: usize>(values: &mut [T], place: usize, lines: usize) -> &mut [[T; N]] {
    values[place * lines * N..][..lines * N].as_chunks_mut().0
}

/// Boxes with edges as they are.
struct Boxes {
    dims: usize,
    low: Vec<f32>,
    high: Vec<f32>,
}

impl Boxes {
    /// Boxes that hold nothing.
    fn new(count: usize, dims: usize) -> Self {
        let low = vec![f32::INFINITY; count * dims];
        Self { dims, low, high: vec![f32::NEG_INFINITY; count * dims] }
    }

    fn of(&self, number: usize) -> (&[f32], &[f32]) {
        (&self.low[number * self.dims..][..self.dims], &self.high[number * self.dims..][..self.dims])
    }

    /// Makes a box hold another.
    fn hold(&mut self, number: usize, low: &[f32], high: &[f32]) {
        let edges = self.low[number * self.dims..].iter_mut().zip(&mut self.high[number * self.dims..]);
        for ((here_low, here_high), (&low, &high)) in edges.zip(low.iter().zip(high)) {
            *here_low = smaller(low, *here_low);
            *here_high = larger(high, *here_high);
        }
    }
}
