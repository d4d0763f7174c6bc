//! AVX2: 8 frames of `f32`, 4 of `f64`.

use std::arch::x86_64::{
    __m256, __m256d, _CMP_GT_OQ, _mm_loadu_ps, _mm_storeu_ps, _mm256_add_pd, _mm256_add_ps, _mm256_castpd_ps,
    _mm256_castps_pd, _mm256_castps128_ps256, _mm256_castps256_ps128, _mm256_cmp_pd, _mm256_cvtpd_ps,
    _mm256_div_pd, _mm256_div_ps, _mm256_extractf128_ps, _mm256_insertf128_ps, _mm256_loadu_pd,
    _mm256_movemask_pd, _mm256_mul_pd, _mm256_mul_ps, _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_set1_ps,
    _mm256_sqrt_pd, _mm256_sqrt_ps, _mm256_storeu_pd, _mm256_sub_pd, _mm256_sub_ps, _mm256_unpackhi_pd,
    _mm256_unpackhi_ps, _mm256_unpacklo_pd, _mm256_unpacklo_ps,
};

use super::pair::Pair;
use super::{Doubles, Kernel, Lanes, check_rows};

/// Runs a kernel of `f32`.
///
/// # Safety
/// The machine must have AVX2.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn run_f32(kernel: impl Kernel<f32>) {
    kernel.run::<F32x8>();
}

/// Runs a kernel of `f64`.
///
/// # Safety
/// The machine must have AVX2.
#[target_feature(enable = "avx2")]
pub(super) unsafe fn run_f64(kernel: impl Kernel<f64>) {
    kernel.run::<F64x4>();
}

/// Eight frames.
#[derive(Clone, Copy)]
struct F32x8(__m256);

arithmetic!(F32x8, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_div_ps);

impl Lanes for F32x8 {
    type Real = f32;
    type Doubles = Pair<F64x4>;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: registers exist only where `dispatch` has found the instruction set.
        Self(unsafe { _mm256_set1_ps(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { _mm256_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn load_columns(source: &[f32], stride: usize) -> [Self; 4] {
        check_rows(8, stride, source.len());
        // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
        unsafe {
            let (even, odd) = (source.as_ptr(), source.as_ptr().add(stride));
            let [a, b] = [load_two(even, stride), load_two(odd, stride)];
            let [c, d] = [load_two(even.add(2 * stride), stride), load_two(odd.add(2 * stride), stride)];
            let [x, y, z, w] = transpose_halves([a, b, c, d]);
            [Self(x), Self(y), Self(z), Self(w)]
        }
    }

    #[inline(always)]
    fn store_columns(columns: [Self; 4], target: &mut [f32], stride: usize) {
        check_rows(8, stride, target.len());
        let [x, y, z, w] = columns;
        // SAFETY: as for `splat`; the rows lie inside `target`, as just checked.
        unsafe {
            let [a, b, c, d] = transpose_halves([x.0, y.0, z.0, w.0]);
            let (even, odd) = (target.as_mut_ptr(), target.as_mut_ptr().add(stride));
            store_two(a, even, stride);
            store_two(b, odd, stride);
            store_two(c, even.add(2 * stride), stride);
            store_two(d, odd.add(2 * stride), stride);
        }
    }

    #[inline(always)]
    fn load_doubles(source: &[f64], stride: usize) -> [Self::Doubles; 4] {
        Pair::load_columns(source, stride)
    }

    #[inline(always)]
    fn narrow(Pair(first, second): Self::Doubles) -> Self {
        // SAFETY: as for `splat`.
        unsafe {
            let first = _mm256_castps128_ps256(_mm256_cvtpd_ps(first.0));
            Self(_mm256_insertf128_ps::<1>(first, _mm256_cvtpd_ps(second.0)))
        }
    }
}

/// Rows 0 and 4 side by side, so that transposing halves puts frames in order.
///
/// # Safety
/// The machine must have AVX2, and the rows must be readable.
#[inline(always)]
unsafe fn load_two(start: *const f32, stride: usize) -> __m256 {
    // SAFETY: the caller's.
    unsafe {
        let first = _mm256_castps128_ps256(_mm_loadu_ps(start));
        _mm256_insertf128_ps::<1>(first, _mm_loadu_ps(start.add(4 * stride)))
    }
}

/// The inverse of [`load_two`].
///
/// # Safety
/// The machine must have AVX2, and the rows must be writeable.
#[inline(always)]
unsafe fn store_two(two: __m256, start: *mut f32, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        _mm_storeu_ps(start, _mm256_castps256_ps128(two));
        _mm_storeu_ps(start.add(4 * stride), _mm256_extractf128_ps::<1>(two));
    }
}

/// Transposes the 4x4 numbers that the four registers hold in each of their halves.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn transpose_halves([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (ab, cd) =
            (_mm256_castps_pd(_mm256_unpacklo_ps(a, b)), _mm256_castps_pd(_mm256_unpacklo_ps(c, d)));
        let (ef, gh) =
            (_mm256_castps_pd(_mm256_unpackhi_ps(a, b)), _mm256_castps_pd(_mm256_unpackhi_ps(c, d)));
        [
            _mm256_castpd_ps(_mm256_unpacklo_pd(ab, cd)),
            _mm256_castpd_ps(_mm256_unpackhi_pd(ab, cd)),
            _mm256_castpd_ps(_mm256_unpacklo_pd(ef, gh)),
            _mm256_castpd_ps(_mm256_unpackhi_pd(ef, gh)),
        ]
    }
}

/// Four frames.
#[derive(Clone, Copy)]
struct F64x4(__m256d);

arithmetic!(F64x4, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd);

impl Lanes for F64x4 {
    type Real = f64;
    type Doubles = Self;
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: registers exist only where `dispatch` has found the instruction set.
        Self(unsafe { _mm256_set1_pd(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn load_columns(source: &[f64], stride: usize) -> [Self; 4] {
        check_rows(4, stride, source.len());
        // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
        unsafe {
            let start = source.as_ptr();
            let (a, b) = (_mm256_loadu_pd(start), _mm256_loadu_pd(start.add(stride)));
            let (c, d) = (_mm256_loadu_pd(start.add(2 * stride)), _mm256_loadu_pd(start.add(3 * stride)));
            let [x, y, z, w] = transpose([a, b, c, d]);
            [Self(x), Self(y), Self(z), Self(w)]
        }
    }

    #[inline(always)]
    fn store_columns(columns: [Self; 4], target: &mut [f64], stride: usize) {
        check_rows(4, stride, target.len());
        let [x, y, z, w] = columns;
        // SAFETY: as for `splat`; the rows lie inside `target`, as just checked.
        unsafe {
            let [a, b, c, d] = transpose([x.0, y.0, z.0, w.0]);
            let start = target.as_mut_ptr();
            _mm256_storeu_pd(start, a);
            _mm256_storeu_pd(start.add(stride), b);
            _mm256_storeu_pd(start.add(2 * stride), c);
            _mm256_storeu_pd(start.add(3 * stride), d);
        }
    }

    #[inline(always)]
    fn load_doubles(source: &[f64], stride: usize) -> [Self; 4] {
        Self::load_columns(source, stride)
    }

    #[inline(always)]
    fn narrow(doubles: Self) -> Self {
        doubles
    }
}

/// Transposes 4x4 numbers.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn transpose([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (ab, cd) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
        let (ef, gh) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab, cd),
            _mm256_permute2f128_pd::<0x20>(ef, gh),
            _mm256_permute2f128_pd::<0x31>(ab, cd),
            _mm256_permute2f128_pd::<0x31>(ef, gh),
        ]
    }
}

impl Doubles for F64x4 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        <Self as Lanes>::splat(value)
    }

    #[inline(always)]
    fn any_above(self, limit: f64) -> bool {
        // SAFETY: as for `Lanes::splat`.
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(self.0, _mm256_set1_pd(limit))) != 0 }
    }

    #[inline(always)]
    fn changed(self, change: fn(&mut [f64])) -> Self {
        let mut lanes = [0.0; 4];
        // SAFETY: as for `Lanes::splat`; the array holds four numbers.
        unsafe {
            _mm256_storeu_pd(lanes.as_mut_ptr(), self.0);
            change(&mut lanes);
            Self(_mm256_loadu_pd(lanes.as_ptr()))
        }
    }
}
