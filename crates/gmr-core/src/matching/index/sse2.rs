//! The kernels in SSE2, which every x86-64 has: 4 lanes.

use std::arch::x86_64::*;

use super::codes::{FURTHEST, both};
use super::kernel::Kernel;
use super::layout::{Edges, Lanes, edges};

#[derive(Debug, Clone, Copy)]
pub(super) struct Sse2;

/// Codes in parts of a step.
#[inline(always)]
fn parts(codes: &[[u8; 2]; 4]) -> __m128i {
    // SAFETY: every x86-64 has SSE2; the load reads the 8 bytes of `codes`.
    unsafe {
        let codes = _mm_loadl_epi64(codes.as_ptr().cast());
        _mm_slli_epi16::<2>(_mm_unpacklo_epi8(codes, _mm_setzero_si128()))
    }
}

impl Kernel<4> for Sse2 {
    type Sums = __m128;
    type Gaps = __m128i;

    #[inline(always)]
    fn zero(self) -> __m128 {
        // SAFETY: every x86-64 has SSE2.
        unsafe { _mm_setzero_ps() }
    }

    #[inline(always)]
    fn difference(self, q: f32, row: &Lanes<4>) -> __m128 {
        // SAFETY: every x86-64 has SSE2; the load reads the 4 numbers of `row`.
        unsafe { _mm_sub_ps(_mm_set1_ps(q), _mm_loadu_ps(row.as_ptr())) }
    }

    #[inline(always)]
    fn gap(self, q: f32, edges: &Edges<4>) -> __m128 {
        // SAFETY: every x86-64 has SSE2; the load reads the 4 pairs of `edges`.
        unsafe {
            let q = _mm_set1_ps(q);
            let edges = _mm_loadu_si128(edges.as_ptr().cast());
            let low = _mm_castsi128_ps(_mm_slli_epi32::<16>(edges));
            let high = _mm_castsi128_ps(_mm_and_si128(edges, _mm_set1_epi32(edges::UPPER as i32)));
            _mm_sub_ps(q, _mm_min_ps(_mm_max_ps(q, low), high))
        }
    }

    #[inline(always)]
    fn add_squares(self, sums: __m128, difference: __m128) -> __m128 {
        // SAFETY: every x86-64 has SSE2.
        unsafe { _mm_add_ps(sums, _mm_mul_ps(difference, difference)) }
    }

    #[inline(always)]
    fn add_weighted_squares(self, sums: __m128, weight: f32, difference: __m128) -> __m128 {
        // SAFETY: every x86-64 has SSE2.
        unsafe {
            let squares = _mm_mul_ps(difference, difference);
            _mm_add_ps(sums, _mm_mul_ps(_mm_set1_ps(weight), squares))
        }
    }

    #[inline(always)]
    fn add(self, a: __m128, b: __m128) -> __m128 {
        // SAFETY: every x86-64 has SSE2.
        unsafe { _mm_add_ps(a, b) }
    }

    #[inline(always)]
    fn no_gaps(self) -> __m128i {
        // SAFETY: every x86-64 has SSE2.
        unsafe { _mm_setzero_si128() }
    }

    #[inline(always)]
    fn place(self, q: &Lanes<4>, corner: &Lanes<4>, parts: f32) -> [i16; 4] {
        let mut placed = [0; 4];
        // SAFETY: every x86-64 has SSE2; the loads read the 4 numbers of `q` and of `corner`, the store fills `placed`.
        unsafe {
            let from_corner = _mm_sub_ps(_mm_loadu_ps(q.as_ptr()), _mm_loadu_ps(corner.as_ptr()));
            let parts = _mm_mul_ps(from_corner, _mm_set1_ps(parts));
            let parts = _mm_max_ps(parts, _mm_set1_ps(-FURTHEST));
            let parts = _mm_cvtps_epi32(_mm_min_ps(parts, _mm_set1_ps(FURTHEST)));
            _mm_storel_epi64(placed.as_mut_ptr().cast(), _mm_packs_epi32(parts, parts));
        }
        placed
    }

    #[inline(always)]
    fn add_gaps(
        self,
        gaps: __m128i,
        q: [i16; 2],
        apart: i16,
        lower: &[[u8; 2]; 4],
        upper: &[[u8; 2]; 4],
    ) -> __m128i {
        // SAFETY: every x86-64 has SSE2.
        unsafe {
            let (q, apart) = (_mm_set1_epi32(both(q)), _mm_set1_epi16(apart));
            let below = _mm_sub_epi16(parts(lower), q);
            let above = _mm_sub_epi16(q, parts(upper));
            let gap = _mm_sub_epi16(_mm_max_epi16(_mm_max_epi16(below, above), apart), apart);
            _mm_add_epi32(gaps, _mm_madd_epi16(gap, gap))
        }
    }

    #[inline(always)]
    fn add_differences(self, gaps: __m128i, q: [i16; 2], apart: i16, rows: &[[u8; 2]; 4]) -> __m128i {
        self.add_gaps(gaps, q, apart, rows, rows)
    }

    #[inline(always)]
    fn in_units(self, gaps: __m128i, unit: f32) -> __m128 {
        // SAFETY: every x86-64 has SSE2.
        unsafe { _mm_mul_ps(_mm_cvtepi32_ps(gaps), _mm_set1_ps(unit)) }
    }

    #[inline(always)]
    fn at_most(self, sums: __m128, limit: f32) -> u32 {
        // SAFETY: every x86-64 has SSE2.
        unsafe { _mm_movemask_ps(_mm_cmple_ps(sums, _mm_set1_ps(limit))) as u32 }
    }

    #[inline(always)]
    fn lowest(self, sums: __m128, among: u32) -> (usize, f32) {
        // SAFETY: every x86-64 has SSE2.
        unsafe {
            let bits = _mm_setr_epi32(1, 2, 4, 8);
            let asked = _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(among as i32), bits), bits);
            let asked = _mm_castsi128_ps(asked);
            let rest = _mm_andnot_ps(asked, _mm_set1_ps(f32::INFINITY));
            let sums = _mm_or_ps(_mm_and_ps(asked, sums), rest);
            let lowest = _mm_min_ps(sums, _mm_shuffle_ps::<0b01_00_11_10>(sums, sums));
            let lowest = _mm_min_ps(lowest, _mm_shuffle_ps::<0b10_11_00_01>(lowest, lowest));
            let equal = _mm_movemask_ps(_mm_cmpeq_ps(sums, lowest)) as u32 & among;
            (equal.trailing_zeros() as usize, _mm_cvtss_f32(lowest))
        }
    }

    #[inline(always)]
    fn fetch<T>(self, block: &[T]) {
        for line in (0..size_of_val(block)).step_by(64) {
            // SAFETY: the address lies in `block`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(block.as_ptr().cast::<i8>().add(line)) };
        }
    }
}
