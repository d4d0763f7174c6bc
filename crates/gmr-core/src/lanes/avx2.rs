//! AVX2: 8 frames of `f32`, 4 of `f64`.

use std::arch::x86_64::{
    __m256, __m256d, _CMP_LE_OQ, _mm_loadu_ps, _mm_storeu_ps, _mm256_add_pd, _mm256_add_ps, _mm256_andnot_pd,
    _mm256_andnot_ps, _mm256_castpd_ps, _mm256_castps_pd, _mm256_castps128_ps256, _mm256_castps256_ps128,
    _mm256_cmp_pd, _mm256_cvtpd_ps, _mm256_div_pd, _mm256_div_ps, _mm256_extractf128_ps,
    _mm256_insertf128_ps, _mm256_loadu_pd, _mm256_loadu_ps, _mm256_movemask_pd, _mm256_mul_pd, _mm256_mul_ps,
    _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_set1_ps, _mm256_sqrt_pd, _mm256_sqrt_ps, _mm256_storeu_pd,
    _mm256_storeu_ps, _mm256_stream_pd, _mm256_stream_ps, _mm256_sub_pd, _mm256_sub_ps, _mm256_unpackhi_pd,
    _mm256_unpackhi_ps, _mm256_unpacklo_pd, _mm256_unpacklo_ps,
};

use super::Kernel;

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

register! {
    /// Eight frames.
    F32x8 = __m256 of 8 f32, two of F64x4 beside it;
    add _mm256_add_ps, sub _mm256_sub_ps, mul _mm256_mul_ps, div _mm256_div_ps, sqrt _mm256_sqrt_ps, abs abs_f32,
    splat _mm256_set1_ps, read _mm256_loadu_ps, write _mm256_storeu_ps, stream _mm256_stream_ps,
    load load_f32, store store_f32, scatter scatter, narrow narrow,
}

register! {
    /// Four frames.
    F64x4 = __m256d of 4 f64;
    add _mm256_add_pd, sub _mm256_sub_pd, mul _mm256_mul_pd, div _mm256_div_pd, sqrt _mm256_sqrt_pd, abs abs_f64,
    splat _mm256_set1_pd, read _mm256_loadu_pd, write _mm256_storeu_pd, stream _mm256_stream_pd,
    load load_f64, store store_f64, all_at_most all_at_most,
}

/// Without the sign bit.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn abs_f32(lanes: __m256) -> __m256 {
    // SAFETY: the caller's.
    unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), lanes) }
}

/// Without the sign bit.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn abs_f64(lanes: __m256d) -> __m256d {
    // SAFETY: the caller's.
    unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), lanes) }
}

/// Four columns of eight rows.
///
/// # Safety
/// The machine must have AVX2, and the rows must be readable.
#[inline(always)]
unsafe fn load_f32(start: *const f32, stride: usize) -> [__m256; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (even, odd) = (start, start.add(stride));
        let [a, b] = [load_two(even, stride), load_two(odd, stride)];
        let [c, d] = [load_two(even.add(2 * stride), stride), load_two(odd.add(2 * stride), stride)];
        transpose_halves([a, b, c, d])
    }
}

/// The inverse of [`load_f32`].
///
/// # Safety
/// The machine must have AVX2, and the rows must be writeable.
#[inline(always)]
unsafe fn store_f32(columns: [__m256; 4], start: *mut f32, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        let [a, b, c, d] = transpose_halves(columns);
        let (even, odd) = (start, start.add(stride));
        store_two(a, even, stride);
        store_two(b, odd, stride);
        store_two(c, even.add(2 * stride), stride);
        store_two(d, odd.add(2 * stride), stride);
    }
}

/// [`store_f32`] to the rows of four numbers that `rows` names.
///
/// # Safety
/// The machine must have AVX2; eight rows must be named, and writeable.
#[inline(always)]
unsafe fn scatter(columns: [__m256; 4], start: *mut f32, rows: *const u16) {
    // SAFETY: the caller's.
    unsafe {
        for (lane, two) in transpose_halves(columns).into_iter().enumerate() {
            let (first, second) = (usize::from(*rows.add(lane)), usize::from(*rows.add(lane + 4)));
            _mm_storeu_ps(start.add(4 * first), _mm256_castps256_ps128(two));
            _mm_storeu_ps(start.add(4 * second), _mm256_extractf128_ps::<1>(two));
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

/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn narrow(first: __m256d, second: __m256d) -> __m256 {
    // SAFETY: the caller's.
    unsafe {
        let first = _mm256_castps128_ps256(_mm256_cvtpd_ps(first));
        _mm256_insertf128_ps::<1>(first, _mm256_cvtpd_ps(second))
    }
}

/// Four columns of four rows.
///
/// # Safety
/// The machine must have AVX2, and the rows must be readable.
#[inline(always)]
unsafe fn load_f64(start: *const f64, stride: usize) -> [__m256d; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (a, b) = (_mm256_loadu_pd(start), _mm256_loadu_pd(start.add(stride)));
        let (c, d) = (_mm256_loadu_pd(start.add(2 * stride)), _mm256_loadu_pd(start.add(3 * stride)));
        transpose([a, b, c, d])
    }
}

/// The inverse of [`load_f64`].
///
/// # Safety
/// The machine must have AVX2, and the rows must be writeable.
#[inline(always)]
unsafe fn store_f64(columns: [__m256d; 4], start: *mut f64, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        let [a, b, c, d] = transpose(columns);
        _mm256_storeu_pd(start, a);
        _mm256_storeu_pd(start.add(stride), b);
        _mm256_storeu_pd(start.add(2 * stride), c);
        _mm256_storeu_pd(start.add(3 * stride), d);
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

/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn all_at_most(lanes: __m256d, limit: __m256d) -> bool {
    // SAFETY: the caller's.
    unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(lanes, limit)) == 0b1111 }
}
