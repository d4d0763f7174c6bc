//! The kernels in AVX-512: 16 lanes.

use std::arch::x86_64::*;

use super::Query;
use super::best::Best;
use super::metric::Metric;
use super::traverse::{self, Kernel};
use super::tree::{Edges, Lanes, Tree, edges};
use crate::Isa;

/// Proof that this machine has AVX-512 F.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx512(());

impl Avx512 {
    pub(super) fn detect() -> Option<Self> {
        Isa::Avx512.is_available().then_some(Self(()))
    }

    /// As [`traverse::search`].
    pub(super) fn search<M: Metric>(self, tree: &Tree<16>, query: &Query, best: &mut impl Best) {
        // SAFETY: a value of this type is only made where the machine has the instructions.
        unsafe { search::<M>(self, tree, query, best) }
    }
}

#[target_feature(enable = "avx512f")]
fn search<M: Metric>(kernel: Avx512, tree: &Tree<16>, query: &Query, best: &mut impl Best) {
    traverse::search::<16, _, M>(kernel, tree, query, best);
}

impl Kernel<16> for Avx512 {
    type Sums = __m512;

    #[inline(always)]
    fn zero(self) -> __m512 {
        // SAFETY: see `Avx512::search`.
        unsafe { _mm512_setzero_ps() }
    }

    #[inline(always)]
    fn difference(self, q: f32, row: &Lanes<16>) -> __m512 {
        // SAFETY: see `Avx512::search`; the load reads the 16 numbers of `row`.
        unsafe { _mm512_sub_ps(_mm512_set1_ps(q), _mm512_loadu_ps(row.as_ptr())) }
    }

    #[inline(always)]
    fn gap(self, q: f32, edges: &Edges<16>) -> __m512 {
        // SAFETY: see `Avx512::search`; the load reads the 16 pairs of `edges`.
        unsafe {
            let q = _mm512_set1_ps(q);
            let edges = _mm512_loadu_si512(edges.as_ptr().cast());
            let low = _mm512_castsi512_ps(_mm512_slli_epi32::<16>(edges));
            let high = _mm512_castsi512_ps(_mm512_and_si512(edges, _mm512_set1_epi32(edges::UPPER as i32)));
            _mm512_sub_ps(q, _mm512_min_ps(_mm512_max_ps(q, low), high))
        }
    }

    #[inline(always)]
    fn add_squares(self, sums: __m512, difference: __m512) -> __m512 {
        // SAFETY: see `Avx512::search`.
        unsafe { _mm512_add_ps(sums, _mm512_mul_ps(difference, difference)) }
    }

    #[inline(always)]
    fn add_squares_fused(self, sums: __m512, difference: __m512) -> __m512 {
        // SAFETY: see `Avx512::search`.
        unsafe { _mm512_fmadd_ps(difference, difference, sums) }
    }

    #[inline(always)]
    fn add_weighted_squares(self, sums: __m512, weight: f32, difference: __m512) -> __m512 {
        // SAFETY: see `Avx512::search`.
        unsafe {
            let squares = _mm512_mul_ps(difference, difference);
            _mm512_add_ps(sums, _mm512_mul_ps(_mm512_set1_ps(weight), squares))
        }
    }

    #[inline(always)]
    fn add(self, a: __m512, b: __m512) -> __m512 {
        // SAFETY: see `Avx512::search`.
        unsafe { _mm512_add_ps(a, b) }
    }

    #[inline(always)]
    fn at_most(self, sums: __m512, limit: f32) -> u32 {
        // SAFETY: see `Avx512::search`.
        unsafe { u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(sums, _mm512_set1_ps(limit))) }
    }

    #[inline(always)]
    fn lowest(self, sums: __m512, among: u32) -> (usize, f32) {
        // SAFETY: see `Avx512::search`.
        unsafe {
            let among = among as u16;
            let rest = _mm512_set1_ps(f32::INFINITY);
            let lowest = _mm512_reduce_min_ps(_mm512_mask_mov_ps(rest, among, sums));
            let equal = _mm512_mask_cmp_ps_mask::<_CMP_EQ_OQ>(among, sums, _mm512_set1_ps(lowest));
            (equal.trailing_zeros() as usize, lowest)
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
