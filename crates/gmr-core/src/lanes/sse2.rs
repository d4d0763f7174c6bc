//! SSE2: 4 frames of `f32`, 2 of `f64`.

use std::arch::x86_64::{
    __m128, __m128d, _mm_add_pd, _mm_add_ps, _mm_andnot_pd, _mm_andnot_ps, _mm_cmple_pd, _mm_cvtpd_ps,
    _mm_div_pd, _mm_div_ps, _mm_loadu_pd, _mm_loadu_ps, _mm_movehl_ps, _mm_movelh_ps, _mm_movemask_pd,
    _mm_mul_pd, _mm_mul_ps, _mm_set1_pd, _mm_set1_ps, _mm_sqrt_pd, _mm_sqrt_ps, _mm_storeu_pd, _mm_storeu_ps,
    _mm_stream_pd, _mm_stream_ps, _mm_sub_pd, _mm_sub_ps, _mm_unpackhi_pd, _mm_unpackhi_ps, _mm_unpacklo_pd,
    _mm_unpacklo_ps,
};

use super::Kernel;

/// Runs a kernel of `f32`.
#[inline(never)]
pub(super) fn run_f32(kernel: impl Kernel<f32>) {
    kernel.run::<F32x4>();
}

/// Runs a kernel of `f64`.
#[inline(never)]
pub(super) fn run_f64(kernel: impl Kernel<f64>) {
    kernel.run::<F64x2>();
}

register! {
    /// Four frames.
    F32x4 = __m128 of 4 f32, two of F64x2 beside it;
    add _mm_add_ps, sub _mm_sub_ps, mul _mm_mul_ps, div _mm_div_ps, sqrt _mm_sqrt_ps, abs abs_f32, splat _mm_set1_ps,
    read _mm_loadu_ps, write _mm_storeu_ps, stream _mm_stream_ps,
    load load_f32, store store_f32, scatter scatter, narrow narrow,
}

register! {
    /// Two frames.
    F64x2 = __m128d of 2 f64;
    add _mm_add_pd, sub _mm_sub_pd, mul _mm_mul_pd, div _mm_div_pd, sqrt _mm_sqrt_pd, abs abs_f64, splat _mm_set1_pd,
    read _mm_loadu_pd, write _mm_storeu_pd, stream _mm_stream_pd,
    load load_f64, store store_f64, all_at_most all_at_most,
}

/// Without the sign bit.
///
/// # Safety
/// None beyond SSE2.
#[inline(always)]
unsafe fn abs_f32(lanes: __m128) -> __m128 {
    // SAFETY: the caller's.
    unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), lanes) }
}

/// Without the sign bit.
///
/// # Safety
/// None beyond SSE2.
#[inline(always)]
unsafe fn abs_f64(lanes: __m128d) -> __m128d {
    // SAFETY: the caller's.
    unsafe { _mm_andnot_pd(_mm_set1_pd(-0.0), lanes) }
}

/// Four columns of four rows.
///
/// # Safety
/// The rows must be readable. (SSE2, here and below, belongs to every x86-64.)
#[inline(always)]
unsafe fn load_f32(start: *const f32, stride: usize) -> [__m128; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (a, b) = (_mm_loadu_ps(start), _mm_loadu_ps(start.add(stride)));
        let (c, d) = (_mm_loadu_ps(start.add(2 * stride)), _mm_loadu_ps(start.add(3 * stride)));
        transpose([a, b, c, d])
    }
}

/// The inverse of [`load_f32`].
///
/// # Safety
/// The rows must be writeable.
#[inline(always)]
unsafe fn store_f32(columns: [__m128; 4], start: *mut f32, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        let [a, b, c, d] = transpose(columns);
        _mm_storeu_ps(start, a);
        _mm_storeu_ps(start.add(stride), b);
        _mm_storeu_ps(start.add(2 * stride), c);
        _mm_storeu_ps(start.add(3 * stride), d);
    }
}

/// [`store_f32`] to the rows of four numbers that `rows` names.
///
/// # Safety
/// Four rows must be named, and writeable.
#[inline(always)]
unsafe fn scatter(columns: [__m128; 4], start: *mut f32, rows: *const u16) {
    // SAFETY: the caller's.
    unsafe {
        for (lane, one) in transpose(columns).into_iter().enumerate() {
            _mm_storeu_ps(start.add(4 * usize::from(*rows.add(lane))), one);
        }
    }
}

/// Transposes 4x4 numbers.
///
/// # Safety
/// None beyond SSE2.
#[inline(always)]
unsafe fn transpose([a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
        let (ef, gh) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
        [_mm_movelh_ps(ab, cd), _mm_movehl_ps(cd, ab), _mm_movelh_ps(ef, gh), _mm_movehl_ps(gh, ef)]
    }
}

/// # Safety
/// None beyond SSE2.
#[inline(always)]
unsafe fn narrow(first: __m128d, second: __m128d) -> __m128 {
    // SAFETY: the caller's.
    unsafe { _mm_movelh_ps(_mm_cvtpd_ps(first), _mm_cvtpd_ps(second)) }
}

/// Four columns of two rows.
///
/// # Safety
/// The rows must be readable.
#[inline(always)]
unsafe fn load_f64(start: *const f64, stride: usize) -> [__m128d; 4] {
    // SAFETY: the caller's.
    unsafe {
        let next = start.add(stride);
        let (a, b) = (_mm_loadu_pd(start), _mm_loadu_pd(next));
        let (c, d) = (_mm_loadu_pd(start.add(2)), _mm_loadu_pd(next.add(2)));
        [_mm_unpacklo_pd(a, b), _mm_unpackhi_pd(a, b), _mm_unpacklo_pd(c, d), _mm_unpackhi_pd(c, d)]
    }
}

/// The inverse of [`load_f64`].
///
/// # Safety
/// The rows must be writeable.
#[inline(always)]
unsafe fn store_f64([x, y, z, w]: [__m128d; 4], start: *mut f64, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        _mm_storeu_pd(start, _mm_unpacklo_pd(x, y));
        _mm_storeu_pd(start.add(2), _mm_unpacklo_pd(z, w));
        _mm_storeu_pd(start.add(stride), _mm_unpackhi_pd(x, y));
        _mm_storeu_pd(start.add(stride + 2), _mm_unpackhi_pd(z, w));
    }
}

/// # Safety
/// None beyond SSE2.
#[inline(always)]
unsafe fn all_at_most(lanes: __m128d, limit: __m128d) -> bool {
    // SAFETY: the caller's.
    unsafe { _mm_movemask_pd(_mm_cmple_pd(lanes, limit)) == 0b11 }
}
