//! The definition of the kernels, one lane after another.

use super::codes::{gap, place};
use super::kernel::Kernel;
use super::layout::{Edges, Lanes, edges};

/// Plain Rust, any number of lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scalar;

impl<const W: usize> Kernel<W> for Scalar {
    type Sums = Lanes<W>;
    type Gaps = [i32; W];

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
    fn add_weighted_squares(self, sums: Lanes<W>, weight: f32, difference: Lanes<W>) -> Lanes<W> {
        std::array::from_fn(|lane| sums[lane] + weight * (difference[lane] * difference[lane]))
    }

    #[inline(always)]
    fn add(self, a: Lanes<W>, b: Lanes<W>) -> Lanes<W> {
        std::array::from_fn(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn no_gaps(self) -> [i32; W] {
        [0; W]
    }

    #[inline(always)]
    fn place(self, q: &Lanes<W>, corner: &Lanes<W>, parts: f32) -> [i16; W] {
        std::array::from_fn(|axis| place(q[axis], corner[axis], parts))
    }

    #[inline(always)]
    fn add_gaps(
        self,
        gaps: [i32; W],
        q: [i16; 2],
        apart: i16,
        lower: &[[u8; 2]; W],
        upper: &[[u8; 2]; W],
    ) -> [i32; W] {
        std::array::from_fn(|lane| {
            let one = gap(q[0], apart, lower[lane][0], upper[lane][0]);
            let other = gap(q[1], apart, lower[lane][1], upper[lane][1]);
            gaps[lane] + one * one + other * other
        })
    }

    #[inline(always)]
    fn add_differences(self, gaps: [i32; W], q: [i16; 2], apart: i16, rows: &[[u8; 2]; W]) -> [i32; W] {
        self.add_gaps(gaps, q, apart, rows, rows)
    }

    #[inline(always)]
    fn in_units(self, gaps: [i32; W], unit: f32) -> Lanes<W> {
        gaps.map(|gap| gap as f32 * unit)
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
