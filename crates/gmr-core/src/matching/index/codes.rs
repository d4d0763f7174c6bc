//! Boxes and rows in a byte a number, on a grid of each node's own: what most of a search reads.
//!
//! Coordinates are those of [`super::axes::Axes`]. A node's grid begins at its lowest corner and is equally fine along
//! every axis, so a difference in codes, times the step, is a difference in coordinates. A box is rounded outwards, a
//! row to the nearest; a query is told in quarters of a step, and how many of them it may be off, whatever is rounded on
//! the way. So what is summed is never above the squared distance.

use super::super::column::Column;
use super::kernel::Kernel;
use super::layout::{W, larger, smaller};

/// The codes of two axes for each of eight boxes or rows.
pub(super) type Pair = [[u8; 2]; W];

/// Steps between the lowest corner of a node and the highest, at most.
pub(super) const STEPS: f32 = 254.0;

/// Parts of a step that a query is told in.
pub(super) const PARTS: f32 = 4.0;

/// Parts of a step by which a query may be off: a half by rounding to the nearest, a sixteenth by what [`FINEST`]
/// leaves of errors of rows, and what is rounded while a number is put on a grid.
const SLACK: f32 = 0.6;

/// A step is at least that many times as long as a row's coordinate can be wrong.
pub(super) const FINEST: f32 = 64.0;

/// The shortest step; its square has all its digits.
pub(super) const SHORTEST: f32 = 1e-15;

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

    /// Steps from the corner's coordinate.
    #[inline(always)]
    pub(super) fn steps(self, corner: f32, x: f32) -> f32 {
        (x - corner) * (self.parts / PARTS)
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
pub(super) fn nearest(x: f32) -> i16 {
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
