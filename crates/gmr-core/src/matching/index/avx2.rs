//! The kernels in AVX2: 8 lanes.

use std::arch::x86_64::*;

use super::Work;
use super::codes::{FURTHEST, Pair, both};
use super::kernel::Kernel;
use super::layout::{Edges, Lanes, edges};
use crate::Isa;

/// Proof that this machine has AVX2 and FMA.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx2(());

impl Avx2 {
    pub(super) fn detect() -> Option<Self> {
        Isa::Avx2.is_available().then_some(Self(()))
    }

    /// Does the work with these kernels.
    pub(super) fn run<T: Work>(self, work: T) -> T::Done {
        // SAFETY: a value of this type is only made where the machine has the instructions.
        unsafe { run(self, work) }
    }
}

#[target_feature(enable = "avx2,fma")]
fn run<T: Work>(kernel: Avx2, work: T) -> T::Done {
    work.run(kernel)
}

/// Codes in parts of a step.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn parts(codes: &Pair) -> __m256i {
    // SAFETY: the caller's; the load reads the 16 bytes of `codes`.
    unsafe { _mm256_slli_epi16::<2>(_mm256_cvtepu8_epi16(_mm_loadu_si128(codes.as_ptr().cast()))) }
}

impl Kernel<8> for Avx2 {
    type Sums = __m256;
    type Gaps = __m256i;

    #[inline(always)]
    fn zero(self) -> __m256 {
        // SAFETY: see `Avx2::run`.
        unsafe { _mm256_setzero_ps() }
    }

    #[inline(always)]
    fn difference(self, q: f32, row: &Lanes<8>) -> __m256 {
        // SAFETY: see `Avx2::run`; the load reads the 8 numbers of `row`.
        unsafe { _mm256_sub_ps(_mm256_set1_ps(q), _mm256_loadu_ps(row.as_ptr())) }
    }

    #[inline(always)]
    fn gap(self, q: f32, edges: &Edges<8>) -> __m256 {
        // SAFETY: see `Avx2::run`; the load reads the 8 pairs of `edges`.
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
        // SAFETY: see `Avx2::run`.
        unsafe { _mm256_add_ps(sums, _mm256_mul_ps(difference, difference)) }
    }

    #[inline(always)]
    fn add_weighted_squares(self, sums: __m256, weight: f32, difference: __m256) -> __m256 {
        // SAFETY: see `Avx2::run`.
        unsafe {
            let squares = _mm256_mul_ps(difference, difference);
            _mm256_add_ps(sums, _mm256_mul_ps(_mm256_set1_ps(weight), squares))
        }
    }

    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: see `Avx2::run`.
        unsafe { _mm256_add_ps(a, b) }
    }

    #[inline(always)]
    fn no_gaps(self) -> __m256i {
        // SAFETY: see `Avx2::run`.
        unsafe { _mm256_setzero_si256() }
    }

    #[inline(always)]
    fn place(self, q: &Lanes<8>, corner: &Lanes<8>, parts: f32) -> [i16; 8] {
        let mut placed = [0; 8];
        // SAFETY: see `Avx2::run`; the loads read the 8 numbers of `q` and of `corner`, the store fills `placed`.
        unsafe {
            let from_corner = _mm256_sub_ps(_mm256_loadu_ps(q.as_ptr()), _mm256_loadu_ps(corner.as_ptr()));
            let parts = _mm256_mul_ps(from_corner, _mm256_set1_ps(parts));
            let parts = _mm256_max_ps(parts, _mm256_set1_ps(-FURTHEST));
            let parts = _mm256_cvtps_epi32(_mm256_min_ps(parts, _mm256_set1_ps(FURTHEST)));
            let (first, last) = (_mm256_castsi256_si128(parts), _mm256_extracti128_si256::<1>(parts));
            _mm_storeu_si128(placed.as_mut_ptr().cast(), _mm_packs_epi32(first, last));
        }
        placed
    }

    #[inline(always)]
    fn add_gaps(self, gaps: __m256i, q: [i16; 2], apart: i16, lower: &Pair, upper: &Pair) -> __m256i {
        // SAFETY: see `Avx2::run`.
        unsafe {
            let (q, apart) = (_mm256_set1_epi32(both(q)), _mm256_set1_epi16(apart));
            let below = _mm256_sub_epi16(parts(lower), q);
            let above = _mm256_sub_epi16(q, parts(upper));
            let gap = _mm256_sub_epi16(_mm256_max_epi16(_mm256_max_epi16(below, above), apart), apart);
            _mm256_add_epi32(gaps, _mm256_madd_epi16(gap, gap))
        }
    }

    #[inline(always)]
    fn add_differences(self, gaps: __m256i, q: [i16; 2], apart: i16, rows: &Pair) -> __m256i {
        // SAFETY: see `Avx2::run`.
        unsafe {
            let difference = _mm256_abs_epi16(_mm256_sub_epi16(parts(rows), _mm256_set1_epi32(both(q))));
            let gap = _mm256_subs_epu16(difference, _mm256_set1_epi16(apart));
            _mm256_add_epi32(gaps, _mm256_madd_epi16(gap, gap))
        }
    }

    #[inline(always)]
    fn in_units(self, gaps: __m256i, unit: f32) -> __m256 {
        // SAFETY: see `Avx2::run`.
        unsafe { _mm256_mul_ps(_mm256_cvtepi32_ps(gaps), _mm256_set1_ps(unit)) }
    }

    #[inline(always)]
    fn at_most(self, sums: __m256, limit: f32) -> u32 {
        // SAFETY: see `Avx2::run`.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(sums, _mm256_set1_ps(limit))) as u32 }
    }

    #[inline(always)]
    fn lowest(self, sums: __m256, among: u32) -> (usize, f32) {
        // SAFETY: see `Avx2::run`.
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
