//! What a search asks of an instruction set.

use super::layout::{Edges, Lanes};

/// What an instruction set does with one number of each of `W` frames or boxes at once.
///
/// What is generic over this trait is inlined into a function that has the instructions; a closure handed to an
/// iterator would not be.
pub(super) trait Kernel<const W: usize>: Copy {
    /// `W` sums in one register.
    type Sums: Copy;

    /// `W` whole sums in one register.
    type Gaps: Copy;

    /// Sums of nothing.
    fn zero(self) -> Self::Sums;

    /// What `q` is above the number of each of `W` frames.
    fn difference(self, q: f32, row: &Lanes<W>) -> Self::Sums;

    /// What `q` is above the nearest number between the edges of each of `W` boxes.
    fn gap(self, q: f32, edges: &Edges<W>) -> Self::Sums;

    /// Adds the squares of the differences; square and sum are each rounded to `f32`, not fused, for these are the
    /// costs.
    fn add_squares(self, sums: Self::Sums, difference: Self::Sums) -> Self::Sums;

    /// Adds the squares of the differences times `weight`; square, product and sum are each rounded to `f32`.
    fn add_weighted_squares(self, sums: Self::Sums, weight: f32, difference: Self::Sums) -> Self::Sums;

    /// Sums of sums.
    fn add(self, a: Self::Sums, b: Self::Sums) -> Self::Sums;

    /// Whole sums of nothing.
    fn no_gaps(self) -> Self::Gaps;

    /// Coordinates of a query on a grid: see [`super::codes::place`].
    fn place(self, q: &Lanes<W>, corner: &Lanes<W>, parts: f32) -> [i16; W];

    /// Adds the squares of how far boxes are from whatever is nearer than `apart` to `q`, all in parts of a step, in two
    /// dimensions side by side: see [`super::codes::gap`].
    fn add_gaps(
        self,
        gaps: Self::Gaps,
        q: [i16; 2],
        apart: i16,
        lower: &[[u8; 2]; W],
        upper: &[[u8; 2]; W],
    ) -> Self::Gaps;

    /// As [`Kernel::add_gaps`] of rows, each its own lower and upper edge.
    fn add_differences(self, gaps: Self::Gaps, q: [i16; 2], apart: i16, rows: &[[u8; 2]; W]) -> Self::Gaps;

    /// Whole sums times `unit`.
    fn in_units(self, gaps: Self::Gaps, unit: f32) -> Self::Sums;

    /// The bits of the sums at or below `limit`.
    fn at_most(self, sums: Self::Sums, limit: f32) -> u32;

    /// The lowest of the sums whose bits are in `among`, which is not 0, and where it stands; of equal ones the first.
    fn lowest(self, sums: Self::Sums, among: u32) -> (usize, f32);

    /// Begins to bring into the cache what is soon to be read.
    fn fetch<T>(self, block: &[T]);
}
