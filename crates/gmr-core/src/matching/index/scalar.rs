//! The definition of the kernels, one lane after another.

use super::traverse::Kernel;
use super::tree::{Edges, Lanes, edges};

/// Plain Rust, any number of lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scalar;

impl<const W: usize> Kernel<W> for Scalar {
    type Sums = Lanes<W>;

    #[inline(always)]
    fn zero(self) -> Lanes<W> {
        [0.0; W]
    }

    #[inline(always)]
    fn difference(self, q: f32, row: &Lanes<W>) -> Lanes<W> {
        row.map(|x| q - x)
    }

    #[inline(always)]
    fn gap(self, q: f32, edges: &Edges<W>) -> Lanes<W> {
        edges.map(|edges| q - q.max(edges::low(edges)).min(edges::high(edges)))
    }

    #[inline(always)]
    fn add_squares(self, sums: Lanes<W>, difference: Lanes<W>) -> Lanes<W> {
        std::array::from_fn(|lane| sums[lane] + difference[lane] * difference[lane])
    }

    #[inline(always)]
    fn add_squares_fused(self, sums: Lanes<W>, difference: Lanes<W>) -> Lanes<W> {
        self.add_squares(sums, difference)
    }

    #[inline(always)]
    fn add_weighted_squares(self, sums: Lanes<W>, weight: f32, difference: Lanes<W>) -> Lanes<W> {
        std::array::from_fn(|lane| sums[lane] + weight * (difference[lane] * difference[lane]))
    }

    #[inline(always)]
    fn add(self, a: Lanes<W>, b: Lanes<W>) -> Lanes<W> {
        std::array::from_fn(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn at_most(self, sums: Lanes<W>, limit: f32) -> u32 {
        sums.iter().enumerate().fold(0, |bits, (lane, sum)| bits | u32::from(*sum <= limit) << lane)
    }

    #[inline(always)]
    fn lowest(self, sums: Lanes<W>, among: u32) -> (usize, f32) {
        let lanes = (0..W).filter(|lane| among >> lane & 1 == 1);
        let lowest =
            lanes.reduce(|best, lane| if sums[lane] < sums[best] { lane } else { best }).unwrap_or(0);
        (lowest, sums[lowest])
    }

    #[inline(always)]
    fn fetch<T>(self, _block: &[T]) {}
}
