//! The kernels in AVX2: 8 lanes.

use std::arch::x86_64::*;

use super::Query;
use super::best::Best;
use super::metric::Metric;
use super::traverse::{self, Kernel};
use super::tree::{Edges, Lanes, Tree, edges};
use crate::Isa;

/// Proof that this machine has AVX2 and FMA.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx2(());

impl Avx2 {
    pub(super) fn detect() -> Option<Self> {
        Isa::Avx2.is_available().then_some(Self(()))
    }

    /// As [`traverse::search`].
    pub(super) fn search<M: Metric>(self, tree: &Tree<8>, query: &Query, best: &mut impl Best) {
        // SAFETY: a value of this type is only made where the machine has the instructions.
        unsafe { search::<M>(self, tree, query, best) }
    }
}

#[target_feature(enable = "avx2,fma")]
fn search<M: Metric>(kernel: Avx2, tree: &Tree<8>, query: &Query, best: &mut impl Best) {
    traverse::search::<8, _, M>(kernel, tree, query, best);
}

impl Kernel<8> for Avx2 {
    type Sums = __m256;

    #[inline(always)]
    fn zero(self) -> __m256 {
        // SAFETY: see `Avx2::search`.
        unsafe { _mm256_setzero_ps() }
    }

    #[inline(always)]
    fn difference(self, q: f32, row: &Lanes<8>) -> __m256 {
        // SAFETY: see `Avx2::search`; the load reads the 8 numbers of `row`.
        unsafe { _mm256_sub_ps(_mm256_set1_ps(q), _mm256_loadu_ps(row.as_ptr())) }
    }

    #[inline(always)]
    fn gap(self, q: f32, edges: &Edges<8>) -> __m256 {
        // SAFETY: see `Avx2::search`; the load reads the 8 pairs of `edges`.
        unsafe {
            let q = _mm256_set1_ps(q);
            let edges = _mm256_loadu_si256(edges.as_ptr().cast());
            let low = _mm256_castsi256_ps(_mm256_slli_epi32::<16>(edges));
            let high = _mm256_castsi256_ps(_mm256_and_si256(edges, _mm256_set1_epi32(edges::UPPER as i32)));
            _mm256_sub_ps(q, _mm256_min_ps(_mm256_max_ps(q, low), high))
        }
    }

    #[inline(always)]
    fn add_squares(self, sums: __m256, difference: __m256) -> __m256 {
        // SAFETY: see `Avx2::search`.
        unsafe { _mm256_add_ps(sums, _mm256_mul_ps(difference, difference)) }
    }

    #[inline(always)]
    fn add_squares_fused(self, sums: __m256, difference: __m256) -> __m256 {
        // SAFETY: see `Avx2::search`.
        unsafe { _mm256_fmadd_ps(difference, difference, sums) }
    }

    #[inline(always)]
    fn add_weighted_squares(self, sums: __m256, weight: f32, difference: __m256) -> __m256 {
        // SAFETY: see `Avx2::search`.
        unsafe {
            let squares = _mm256_mul_ps(difference, difference);
            _mm256_add_ps(sums, _mm256_mul_ps(_mm256_set1_ps(weight), squares))
        }
    }

    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: see `Avx2::search`.
        unsafe { _mm256_add_ps(a, b) }
    }

    #[inline(always)]
    fn at_most(self, sums: __m256, limit: f32) -> u32 {
        // SAFETY: see `Avx2::search`.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(sums, _mm256_set1_ps(limit))) as u32 }
    }

    #[inline(always)]
    fn lowest(self, sums: __m256, among: u32) -> (usize, f32) {
        // SAFETY: see `Avx2::search`.
        unsafe {
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let asked = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(among as i32), bits), bits);
            let rest = _mm256_set1_ps(f32::INFINITY);
            let sums = _mm256_blendv_ps(rest, sums, _mm256_castsi256_ps(asked));
            let lowest = _mm256_min_ps(sums, _mm256_permute2f128_ps::<1>(sums, sums));
            let lowest = _mm256_min_ps(lowest, _mm256_permute_ps::<0b01_00_11_10>(lowest));
            let lowest = _mm256_min_ps(lowest, _mm256_permute_ps::<0b10_11_00_01>(lowest));
            let equal = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_EQ_OQ>(sums, lowest)) as u32 & among;
            (equal.trailing_zeros() as usize, _mm256_cvtss_f32(lowest))
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
