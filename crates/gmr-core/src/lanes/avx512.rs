//! AVX-512: 16 frames of `f32`, 8 of `f64`.

use std::arch::x86_64::{
    __m512, __m512d, _CMP_LE_OQ, _mm_loadu_ps, _mm_storeu_ps, _mm256_loadu_pd, _mm256_storeu_pd,
    _mm512_abs_pd, _mm512_abs_ps, _mm512_add_pd, _mm512_add_ps, _mm512_castpd_ps, _mm512_castpd256_pd512,
    _mm512_castps_pd, _mm512_castps128_ps512, _mm512_castps256_ps512, _mm512_castps512_ps128,
    _mm512_cmp_pd_mask, _mm512_cvtpd_ps, _mm512_div_pd, _mm512_div_ps, _mm512_extractf32x4_ps,
    _mm512_extractf64x4_pd, _mm512_insertf32x4, _mm512_insertf32x8, _mm512_insertf64x4, _mm512_loadu_pd,
    _mm512_loadu_ps, _mm512_mul_pd, _mm512_mul_ps, _mm512_set1_pd, _mm512_set1_ps, _mm512_shuffle_f64x2,
    _mm512_sqrt_pd, _mm512_sqrt_ps, _mm512_storeu_pd, _mm512_storeu_ps, _mm512_stream_pd, _mm512_stream_ps,
    _mm512_sub_pd, _mm512_sub_ps, _mm512_unpackhi_pd, _mm512_unpackhi_ps, _mm512_unpacklo_pd,
    _mm512_unpacklo_ps,
};

use super::Kernel;

/// Runs a kernel of `f32`.
///
/// # Safety
/// The machine must have AVX-512 F, DQ, BW and VL.
#[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
pub(super) unsafe fn run_f32(kernel: impl Kernel<f32>) {
    kernel.run::<F32x16>();
}

/// Runs a kernel of `f64`.
///
/// # Safety
/// The machine must have AVX-512 F, DQ, BW and VL.
#[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
pub(super) unsafe fn run_f64(kernel: impl Kernel<f64>) {
    kernel.run::<F64x8>();
}

register! {
    /// Sixteen frames.
    F32x16 = __m512 of 16 f32, two of F64x8 beside it;
    add _mm512_add_ps, sub _mm512_sub_ps, mul _mm512_mul_ps, div _mm512_div_ps, sqrt _mm512_sqrt_ps, abs _mm512_abs_ps,
    splat _mm512_set1_ps, read _mm512_loadu_ps, write _mm512_storeu_ps, stream _mm512_stream_ps,
    load load_f32, store store_f32, scatter scatter, narrow narrow,
}

register! {
    /// Eight frames.
    F64x8 = __m512d of 8 f64;
    add _mm512_add_pd, sub _mm512_sub_pd, mul _mm512_mul_pd, div _mm512_div_pd, sqrt _mm512_sqrt_pd, abs _mm512_abs_pd,
    splat _mm512_set1_pd, read _mm512_loadu_pd, write _mm512_storeu_pd, stream _mm512_stream_pd,
    load load_f64, store store_f64, all_at_most all_at_most,
}

/// Four columns of sixteen rows.
///
/// # Safety
/// The machine must have AVX-512 F and DQ, and the rows must be readable.
#[inline(always)]
unsafe fn load_f32(start: *const f32, stride: usize) -> [__m512; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (even, odd) = (start, start.add(stride));
        let [a, b] = [load_quad(even, stride), load_quad(odd, stride)];
        let [c, d] = [load_quad(even.add(2 * stride), stride), load_quad(odd.add(2 * stride), stride)];
        transpose_quarters([a, b, c, d])
    }
}

/// The inverse of [`load_f32`].
///
/// # Safety
/// The machine must have AVX-512 F, and the rows must be writeable.
#[inline(always)]
unsafe fn store_f32(columns: [__m512; 4], start: *mut f32, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        let [a, b, c, d] = transpose_quarters(columns);
        let (even, odd) = (start, start.add(stride));
        store_quad(a, even, stride);
        store_quad(b, odd, stride);
        store_quad(c, even.add(2 * stride), stride);
        store_quad(d, odd.add(2 * stride), stride);
    }
}

/// [`store_f32`] to the rows of four numbers that `rows` names.
///
/// # Safety
/// The machine must have AVX-512 F and DQ; sixteen rows must be named, and writeable.
#[inline(always)]
unsafe fn scatter(columns: [__m512; 4], start: *mut f32, rows: *const u16) {
    // SAFETY: the caller's.
    unsafe {
        for (lane, quad) in transpose_quarters(columns).into_iter().enumerate() {
            let row = [0, 4, 8, 12].map(|further| start.add(4 * usize::from(*rows.add(lane + further))));
            _mm_storeu_ps(row[0], _mm512_castps512_ps128(quad));
            _mm_storeu_ps(row[1], _mm512_extractf32x4_ps::<1>(quad));
            _mm_storeu_ps(row[2], _mm512_extractf32x4_ps::<2>(quad));
            _mm_storeu_ps(row[3], _mm512_extractf32x4_ps::<3>(quad));
        }
    }
}

/// Rows 0, 4, 8 and 12 side by side, so that transposing quarters puts frames in order.
///
/// # Safety
/// The machine must have AVX-512 F and DQ, and the rows must be readable.
#[inline(always)]
unsafe fn load_quad(start: *const f32, stride: usize) -> __m512 {
    // SAFETY: the caller's.
    unsafe {
        let first = _mm512_castps128_ps512(_mm_loadu_ps(start));
        let two = _mm512_insertf32x4::<1>(first, _mm_loadu_ps(start.add(4 * stride)));
        let three = _mm512_insertf32x4::<2>(two, _mm_loadu_ps(start.add(8 * stride)));
        _mm512_insertf32x4::<3>(three, _mm_loadu_ps(start.add(12 * stride)))
    }
}

/// The inverse of [`load_quad`].
///
/// # Safety
/// The machine must have AVX-512 F, and the rows must be writeable.
#[inline(always)]
unsafe fn store_quad(quad: __m512, start: *mut f32, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        _mm_storeu_ps(start, _mm512_extractf32x4_ps::<0>(quad));
        _mm_storeu_ps(start.add(4 * stride), _mm512_extractf32x4_ps::<1>(quad));
        _mm_storeu_ps(start.add(8 * stride), _mm512_extractf32x4_ps::<2>(quad));
        _mm_storeu_ps(start.add(12 * stride), _mm512_extractf32x4_ps::<3>(quad));
    }
}

/// Transposes the 4x4 numbers that the four registers hold in each of their quarters.
///
/// # Safety
/// The machine must have AVX-512 F.
#[inline(always)]
unsafe fn transpose_quarters([a, b, c, d]: [__m512; 4]) -> [__m512; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (ab, cd) =
            (_mm512_castps_pd(_mm512_unpacklo_ps(a, b)), _mm512_castps_pd(_mm512_unpacklo_ps(c, d)));
        let (ef, gh) =
            (_mm512_castps_pd(_mm512_unpackhi_ps(a, b)), _mm512_castps_pd(_mm512_unpackhi_ps(c, d)));
        [
            _mm512_castpd_ps(_mm512_unpacklo_pd(ab, cd)),
            _mm512_castpd_ps(_mm512_unpackhi_pd(ab, cd)),
            _mm512_castpd_ps(_mm512_unpacklo_pd(ef, gh)),
            _mm512_castpd_ps(_mm512_unpackhi_pd(ef, gh)),
        ]
    }
}

/// # Safety
/// The machine must have AVX-512 F and DQ.
#[inline(always)]
unsafe fn narrow(first: __m512d, second: __m512d) -> __m512 {
    // SAFETY: the caller's.
    unsafe {
        let first = _mm512_castps256_ps512(_mm512_cvtpd_ps(first));
        _mm512_insertf32x8::<1>(first, _mm512_cvtpd_ps(second))
    }
}

/// Four columns of eight rows.
///
/// # Safety
/// The machine must have AVX-512 F, and the rows must be readable.
#[inline(always)]
unsafe fn load_f64(start: *const f64, stride: usize) -> [__m512d; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (even, odd) = (start, start.add(stride));
        let (a, b) = (load_two(even, stride), load_two(odd, stride));
        let (c, d) = (load_two(even.add(4 * stride), stride), load_two(odd.add(4 * stride), stride));
        let (low, high) = (_mm512_unpacklo_pd(a, b), _mm512_unpacklo_pd(c, d));
        let (odd_low, odd_high) = (_mm512_unpackhi_pd(a, b), _mm512_unpackhi_pd(c, d));
        [
            _mm512_shuffle_f64x2::<0b10_00_10_00>(low, high),
            _mm512_shuffle_f64x2::<0b10_00_10_00>(odd_low, odd_high),
            _mm512_shuffle_f64x2::<0b11_01_11_01>(low, high),
            _mm512_shuffle_f64x2::<0b11_01_11_01>(odd_low, odd_high),
        ]
    }
}

/// The inverse of [`load_f64`].
///
/// # Safety
/// The machine must have AVX-512 F and DQ, and the rows must be writeable.
#[inline(always)]
unsafe fn store_f64([x, y, z, w]: [__m512d; 4], start: *mut f64, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        // Pairs of numbers of the even and of the odd rows: x y, and z w.
        let (even_xy, odd_xy) = (_mm512_unpacklo_pd(x, y), _mm512_unpackhi_pd(x, y));
        let (even_zw, odd_zw) = (_mm512_unpacklo_pd(z, w), _mm512_unpackhi_pd(z, w));
        store_four(even_xy, even_zw, start, stride);
        store_four(odd_xy, odd_zw, start.add(stride), stride);
    }
}

/// Rows 0 and 2 side by side.
///
/// # Safety
/// The machine must have AVX-512 F, and the rows must be readable.
#[inline(always)]
unsafe fn load_two(start: *const f64, stride: usize) -> __m512d {
    // SAFETY: the caller's.
    unsafe {
        let first = _mm512_castpd256_pd512(_mm256_loadu_pd(start));
        _mm512_insertf64x4::<1>(first, _mm256_loadu_pd(start.add(2 * stride)))
    }
}

/// Stores rows 0, 2, 4 and 6, of which `xy` holds the first two numbers each and `zw` the last two.
///
/// # Safety
/// The machine must have AVX-512 F and DQ, and the rows must be writeable.
#[inline(always)]
unsafe fn store_four(xy: __m512d, zw: __m512d, start: *mut f64, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        let first = _mm512_shuffle_f64x2::<0b01_00_01_00>(xy, zw);
        let last = _mm512_shuffle_f64x2::<0b11_10_11_10>(xy, zw);
        let first = _mm512_shuffle_f64x2::<0b11_01_10_00>(first, first);
        let last = _mm512_shuffle_f64x2::<0b11_01_10_00>(last, last);
        _mm256_storeu_pd(start, _mm512_extractf64x4_pd::<0>(first));
        _mm256_storeu_pd(start.add(2 * stride), _mm512_extractf64x4_pd::<1>(first));
        _mm256_storeu_pd(start.add(4 * stride), _mm512_extractf64x4_pd::<0>(last));
        _mm256_storeu_pd(start.add(6 * stride), _mm512_extractf64x4_pd::<1>(last));
    }
}

/// # Safety
/// The machine must have AVX-512 F.
#[inline(always)]
unsafe fn all_at_most(lanes: __m512d, limit: __m512d) -> bool {
    // SAFETY: the caller's.
    unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(lanes, limit) == 0xff }
}
