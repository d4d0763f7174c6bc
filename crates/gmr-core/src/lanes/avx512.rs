//! AVX-512: 16 frames of `f32`, 8 of `f64`.

use std::arch::x86_64::{
    __m512, __m512d, _CMP_GT_OQ, _mm_loadu_ps, _mm_storeu_ps, _mm256_loadu_pd, _mm256_storeu_pd,
    _mm512_add_pd, _mm512_add_ps, _mm512_castpd_ps, _mm512_castpd256_pd512, _mm512_castps_pd,
    _mm512_castps128_ps512, _mm512_castps256_ps512, _mm512_cmp_pd_mask, _mm512_cvtpd_ps, _mm512_div_pd,
    _mm512_div_ps, _mm512_extractf32x4_ps, _mm512_extractf64x4_pd, _mm512_insertf32x4, _mm512_insertf32x8,
    _mm512_insertf64x4, _mm512_loadu_pd, _mm512_mul_pd, _mm512_mul_ps, _mm512_set1_pd, _mm512_set1_ps,
    _mm512_shuffle_f64x2, _mm512_sqrt_pd, _mm512_sqrt_ps, _mm512_storeu_pd, _mm512_sub_pd, _mm512_sub_ps,
    _mm512_unpackhi_pd, _mm512_unpackhi_ps, _mm512_unpacklo_pd, _mm512_unpacklo_ps,
};

use super::pair::Pair;
use super::{Doubles, Kernel, Lanes, check_rows};

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

/// Sixteen frames.
#[derive(Clone, Copy)]
struct F32x16(__m512);

arithmetic!(F32x16, _mm512_add_ps, _mm512_sub_ps, _mm512_mul_ps, _mm512_div_ps);

impl Lanes for F32x16 {
    type Real = f32;
    type Doubles = Pair<F64x8>;
    const WIDTH: usize = 16;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: registers exist only where `dispatch` has found the instruction set.
        Self(unsafe { _mm512_set1_ps(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { _mm512_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn load_columns(source: &[f32], stride: usize) -> [Self; 4] {
        check_rows(16, stride, source.len());
        // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
        unsafe {
            let (even, odd) = (source.as_ptr(), source.as_ptr().add(stride));
            let [a, b] = [load_quad(even, stride), load_quad(odd, stride)];
            let [c, d] = [load_quad(even.add(2 * stride), stride), load_quad(odd.add(2 * stride), stride)];
            let [x, y, z, w] = transpose_quarters([a, b, c, d]);
            [Self(x), Self(y), Self(z), Self(w)]
        }
    }

    #[inline(always)]
    fn store_columns(columns: [Self; 4], target: &mut [f32], stride: usize) {
        check_rows(16, stride, target.len());
        let [x, y, z, w] = columns;
        // SAFETY: as for `splat`; the rows lie inside `target`, as just checked.
        unsafe {
            let [a, b, c, d] = transpose_quarters([x.0, y.0, z.0, w.0]);
            let (even, odd) = (target.as_mut_ptr(), target.as_mut_ptr().add(stride));
            store_quad(a, even, stride);
            store_quad(b, odd, stride);
            store_quad(c, even.add(2 * stride), stride);
            store_quad(d, odd.add(2 * stride), stride);
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
            let first = _mm512_castps256_ps512(_mm512_cvtpd_ps(first.0));
            Self(_mm512_insertf32x8::<1>(first, _mm512_cvtpd_ps(second.0)))
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

/// Eight frames.
#[derive(Clone, Copy)]
struct F64x8(__m512d);

arithmetic!(F64x8, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd);

impl Lanes for F64x8 {
    type Real = f64;
    type Doubles = Self;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: registers exist only where `dispatch` has found the instruction set.
        Self(unsafe { _mm512_set1_pd(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn load_columns(source: &[f64], stride: usize) -> [Self; 4] {
        check_rows(8, stride, source.len());
        // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
        unsafe {
            let (even, odd) = (source.as_ptr(), source.as_ptr().add(stride));
            let (a, b) = (load_two(even, stride), load_two(odd, stride));
            let (c, d) = (load_two(even.add(4 * stride), stride), load_two(odd.add(4 * stride), stride));
            let (low, high) = (_mm512_unpacklo_pd(a, b), _mm512_unpacklo_pd(c, d));
            let (odd_low, odd_high) = (_mm512_unpackhi_pd(a, b), _mm512_unpackhi_pd(c, d));
            [
                Self(_mm512_shuffle_f64x2::<0b10_00_10_00>(low, high)),
                Self(_mm512_shuffle_f64x2::<0b10_00_10_00>(odd_low, odd_high)),
                Self(_mm512_shuffle_f64x2::<0b11_01_11_01>(low, high)),
                Self(_mm512_shuffle_f64x2::<0b11_01_11_01>(odd_low, odd_high)),
            ]
        }
    }

    #[inline(always)]
    fn store_columns(columns: [Self; 4], target: &mut [f64], stride: usize) {
        check_rows(8, stride, target.len());
        let [x, y, z, w] = columns;
        // SAFETY: as for `splat`; the rows lie inside `target`, as just checked.
        unsafe {
            // Pairs of numbers of the even and of the odd rows: x y, and z w.
            let (even_xy, odd_xy) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
            let (even_zw, odd_zw) = (_mm512_unpacklo_pd(z.0, w.0), _mm512_unpackhi_pd(z.0, w.0));
            store_four(even_xy, even_zw, target.as_mut_ptr(), stride);
            store_four(odd_xy, odd_zw, target.as_mut_ptr().add(stride), stride);
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

impl Doubles for F64x8 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        <Self as Lanes>::splat(value)
    }

    #[inline(always)]
    fn any_above(self, limit: f64) -> bool {
        // SAFETY: as for `Lanes::splat`.
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, _mm512_set1_pd(limit)) != 0 }
    }

    #[inline(always)]
    fn changed(self, change: fn(&mut [f64])) -> Self {
        let mut lanes = [0.0; 8];
        // SAFETY: as for `Lanes::splat`; the array holds eight numbers.
        unsafe {
            _mm512_storeu_pd(lanes.as_mut_ptr(), self.0);
            change(&mut lanes);
            Self(_mm512_loadu_pd(lanes.as_ptr()))
        }
    }
}
