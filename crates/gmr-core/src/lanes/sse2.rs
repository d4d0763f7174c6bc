//! SSE2: 4 frames of `f32`, 2 of `f64`.

use std::arch::x86_64::{
    __m128, __m128d, _mm_add_pd, _mm_add_ps, _mm_cmpgt_pd, _mm_cvtpd_ps, _mm_div_pd, _mm_div_ps,
    _mm_loadu_pd, _mm_loadu_ps, _mm_movehl_ps, _mm_movelh_ps, _mm_movemask_pd, _mm_mul_pd, _mm_mul_ps,
    _mm_set1_pd, _mm_set1_ps, _mm_sqrt_pd, _mm_sqrt_ps, _mm_storeu_pd, _mm_storeu_ps, _mm_sub_pd, _mm_sub_ps,
    _mm_unpackhi_pd, _mm_unpackhi_ps, _mm_unpacklo_pd, _mm_unpacklo_ps,
};

use super::pair::Pair;
use super::{Doubles, Kernel, Lanes, check_rows};

/// Runs a kernel of `f32`.
pub(super) fn run_f32(kernel: impl Kernel<f32>) {
    kernel.run::<F32x4>();
}

/// Runs a kernel of `f64`.
pub(super) fn run_f64(kernel: impl Kernel<f64>) {
    kernel.run::<F64x2>();
}

/// Four frames.
#[derive(Clone, Copy)]
struct F32x4(__m128);

arithmetic!(F32x4, _mm_add_ps, _mm_sub_ps, _mm_mul_ps, _mm_div_ps);

impl Lanes for F32x4 {
    type Real = f32;
    type Doubles = Pair<F64x2>;
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: SSE2 belongs to every x86-64.
        Self(unsafe { _mm_set1_ps(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { _mm_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn load_columns(source: &[f32], stride: usize) -> [Self; 4] {
        check_rows(4, stride, source.len());
        // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
        unsafe {
            let start = source.as_ptr();
            let (a, b) = (_mm_loadu_ps(start), _mm_loadu_ps(start.add(stride)));
            let (c, d) = (_mm_loadu_ps(start.add(2 * stride)), _mm_loadu_ps(start.add(3 * stride)));
            let [x, y, z, w] = transpose([a, b, c, d]);
            [Self(x), Self(y), Self(z), Self(w)]
        }
    }

    #[inline(always)]
    fn store_columns(columns: [Self; 4], target: &mut [f32], stride: usize) {
        check_rows(4, stride, target.len());
        let [x, y, z, w] = columns;
        // SAFETY: as for `splat`; the rows lie inside `target`, as just checked.
        unsafe {
            let [a, b, c, d] = transpose([x.0, y.0, z.0, w.0]);
            let start = target.as_mut_ptr();
            _mm_storeu_ps(start, a);
            _mm_storeu_ps(start.add(stride), b);
            _mm_storeu_ps(start.add(2 * stride), c);
            _mm_storeu_ps(start.add(3 * stride), d);
        }
    }

    #[inline(always)]
    fn load_doubles(source: &[f64], stride: usize) -> [Self::Doubles; 4] {
        Pair::load_columns(source, stride)
    }

    #[inline(always)]
    fn narrow(Pair(first, second): Self::Doubles) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { _mm_movelh_ps(_mm_cvtpd_ps(first.0), _mm_cvtpd_ps(second.0)) })
    }
}

/// Transposes 4x4 numbers.
///
/// # Safety
/// None beyond SSE2, which belongs to every x86-64.
#[inline(always)]
unsafe fn transpose([a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
    // SAFETY: as for `F32x4::splat`.
    unsafe {
        let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
        let (ef, gh) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
        [_mm_movelh_ps(ab, cd), _mm_movehl_ps(cd, ab), _mm_movelh_ps(ef, gh), _mm_movehl_ps(gh, ef)]
    }
}

/// Two frames.
#[derive(Clone, Copy)]
struct F64x2(__m128d);

arithmetic!(F64x2, _mm_add_pd, _mm_sub_pd, _mm_mul_pd, _mm_div_pd);

impl Lanes for F64x2 {
    type Real = f64;
    type Doubles = Self;
    const WIDTH: usize = 2;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: SSE2 belongs to every x86-64.
        Self(unsafe { _mm_set1_pd(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { _mm_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn load_columns(source: &[f64], stride: usize) -> [Self; 4] {
        check_rows(2, stride, source.len());
        // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
        unsafe {
            let (start, next) = (source.as_ptr(), source.as_ptr().add(stride));
            let (a, b, c, d) = (
                _mm_loadu_pd(start),
                _mm_loadu_pd(next),
                _mm_loadu_pd(start.add(2)),
                _mm_loadu_pd(next.add(2)),
            );
            [
                Self(_mm_unpacklo_pd(a, b)),
                Self(_mm_unpackhi_pd(a, b)),
                Self(_mm_unpacklo_pd(c, d)),
                Self(_mm_unpackhi_pd(c, d)),
            ]
        }
    }

    #[inline(always)]
    fn store_columns(columns: [Self; 4], target: &mut [f64], stride: usize) {
        check_rows(2, stride, target.len());
        let [x, y, z, w] = columns;
        // SAFETY: as for `splat`; the rows lie inside `target`, as just checked.
        unsafe {
            let start = target.as_mut_ptr();
            _mm_storeu_pd(start, _mm_unpacklo_pd(x.0, y.0));
            _mm_storeu_pd(start.add(2), _mm_unpacklo_pd(z.0, w.0));
            _mm_storeu_pd(start.add(stride), _mm_unpackhi_pd(x.0, y.0));
            _mm_storeu_pd(start.add(stride + 2), _mm_unpackhi_pd(z.0, w.0));
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

impl Doubles for F64x2 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        <Self as Lanes>::splat(value)
    }

    #[inline(always)]
    fn any_above(self, limit: f64) -> bool {
        // SAFETY: as for `Lanes::splat`.
        unsafe { _mm_movemask_pd(_mm_cmpgt_pd(self.0, _mm_set1_pd(limit))) != 0 }
    }

    #[inline(always)]
    fn changed(self, change: fn(&mut [f64])) -> Self {
        let mut lanes = [0.0; 2];
        // SAFETY: as for `Lanes::splat`; the array holds two numbers.
        unsafe {
            _mm_storeu_pd(lanes.as_mut_ptr(), self.0);
            change(&mut lanes);
            Self(_mm_loadu_pd(lanes.as_ptr()))
        }
    }
}
