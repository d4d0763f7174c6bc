//! Eight lanes on a machine that has four: all trees have eight.

use super::codes::Pair;
use super::kernel::Kernel;
use super::layout::{Edges, Lanes};

/// The lower four lanes and the upper four, one after the other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Twice<K>(pub(super) K);

impl<K: Kernel<4>> Kernel<8> for Twice<K> {
    type Sums = [K::Sums; 2];
    type Gaps = [K::Gaps; 2];

    #[inline(always)]
    fn zero(self) -> Self::Sums {
        [self.0.zero(); 2]
    }

    #[inline(always)]
    fn difference(self, q: f32, row: &Lanes<8>) -> Self::Sums {
        let (halves, _) = row.as_chunks::<4>();
        [self.0.difference(q, &halves[0]), self.0.difference(q, &halves[1])]
    }

    #[inline(always)]
    fn gap(self, q: f32, edges: &Edges<8>) -> Self::Sums {
        let (halves, _) = edges.as_chunks::<4>();
        [self.0.gap(q, &halves[0]), self.0.gap(q, &halves[1])]
    }

    #[inline(always)]
    fn add_squares(self, sums: Self::Sums, difference: Self::Sums) -> Self::Sums {
        [self.0.add_squares(sums[0], difference[0]), self.0.add_squares(sums[1], difference[1])]
    }

    #[inline(always)]
    fn add_weighted_squares(self, sums: Self::Sums, weight: f32, difference: Self::Sums) -> Self::Sums {
        let add = |half: usize| self.0.add_weighted_squares(sums[half], weight, difference[half]);
        [add(0), add(1)]
    }

    #[inline(always)]
    fn add(self, a: Self::Sums, b: Self::Sums) -> Self::Sums {
        [self.0.add(a[0], b[0]), self.0.add(a[1], b[1])]
    }

    #[inline(always)]
    fn no_gaps(self) -> Self::Gaps {
        [self.0.no_gaps(); 2]
    }

    #[inline(always)]
    fn place(self, q: &Lanes<8>, corner: &Lanes<8>, parts: f32) -> [i16; 8] {
        let (q, corner) = (q.as_chunks::<4>().0, corner.as_chunks::<4>().0);
        let mut placed = [0; 8];
        for (half, placed) in placed.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            *placed = self.0.place(&q[half], &corner[half], parts);
        }
        placed
    }

    #[inline(always)]
    fn add_gaps(self, gaps: Self::Gaps, q: [i16; 2], apart: i16, lower: &Pair, upper: &Pair) -> Self::Gaps {
        let (lower, upper) = (lower.as_chunks::<4>().0, upper.as_chunks::<4>().0);
        let add = |half: usize| self.0.add_gaps(gaps[half], q, apart, &lower[half], &upper[half]);
        [add(0), add(1)]
    }

    #[inline(always)]
    fn add_differences(self, gaps: Self::Gaps, q: [i16; 2], apart: i16, rows: &Pair) -> Self::Gaps {
        let rows = rows.as_chunks::<4>().0;
        let add = |half: usize| self.0.add_differences(gaps[half], q, apart, &rows[half]);
        [add(0), add(1)]
    }

    #[inline(always)]
    fn in_units(self, gaps: Self::Gaps, unit: f32) -> Self::Sums {
        [self.0.in_units(gaps[0], unit), self.0.in_units(gaps[1], unit)]
    }

    #[inline(always)]
    fn at_most(self, sums: Self::Sums, limit: f32) -> u32 {
        self.0.at_most(sums[0], limit) | self.0.at_most(sums[1], limit) << 4
    }

    #[inline(always)]
    fn lowest(self, sums: Self::Sums, among: u32) -> (usize, f32) {
        let lower = (among & 15 != 0).then(|| self.0.lowest(sums[0], among & 15));
        let upper = (among >> 4 != 0).then(|| self.0.lowest(sums[1], among >> 4));
        match (lower, upper) {
            (Some(lower), Some((_, least))) if lower.1 <= least => lower,
            (_, Some((lane, least))) => (lane + 4, least),
            (lower, None) => lower.unwrap_or((0, f32::INFINITY)),
        }
    }

    #[inline(always)]
    fn fetch<T>(self, block: &[T]) {
        self.0.fetch(block);
    }
}
