//! NEON: 4 frames of `f32`, 2 of `f64`.

use std::arch::aarch64::{
    float32x4_t, float64x2_t, vaddq_f32, vaddq_f64, vcgtq_f64, vcombine_f32, vcvt_f32_f64, vdivq_f32,
    vdivq_f64, vdupq_n_f32, vdupq_n_f64, vgetq_lane_u64, vld1q_f32, vld1q_f64, vmulq_f32, vmulq_f64,
    vreinterpretq_f32_f64, vreinterpretq_f64_f32, vsqrtq_f32, vsqrtq_f64, vst1q_f32, vst1q_f64, vsubq_f32,
    vsubq_f64, vtrn1q_f32, vtrn1q_f64, vtrn2q_f32, vtrn2q_f64,
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
struct F32x4(float32x4_t);

arithmetic!(F32x4, vaddq_f32, vsubq_f32, vmulq_f32, vdivq_f32);

impl Lanes for F32x4 {
    type Real = f32;
    type Doubles = Pair<F64x2>;
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: NEON belongs to every AArch64 that Rust's standard library runs on.
        Self(unsafe { vdupq_n_f32(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { vsqrtq_f32(self.0) })
    }

    #[inline(always)]
    fn load_columns(source: &[f32], stride: usize) -> [Self; 4] {
        check_rows(4, stride, source.len());
        // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
        unsafe {
            let start = source.as_ptr();
            let (a, b) = (vld1q_f32(start), vld1q_f32(start.add(stride)));
            let (c, d) = (vld1q_f32(start.add(2 * stride)), vld1q_f32(start.add(3 * stride)));
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
            vst1q_f32(start, a);
            vst1q_f32(start.add(stride), b);
            vst1q_f32(start.add(2 * stride), c);
            vst1q_f32(start.add(3 * stride), d);
        }
    }

    #[inline(always)]
    fn load_doubles(source: &[f64], stride: usize) -> [Self::Doubles; 4] {
        Pair::load_columns(source, stride)
    }

    #[inline(always)]
    fn narrow(Pair(first, second): Self::Doubles) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { vcombine_f32(vcvt_f32_f64(first.0), vcvt_f32_f64(second.0)) })
    }
}

/// Transposes 4x4 numbers.
///
/// # Safety
/// None beyond NEON, which belongs to every AArch64.
#[inline(always)]
unsafe fn transpose([a, b, c, d]: [float32x4_t; 4]) -> [float32x4_t; 4] {
    // SAFETY: as for `F32x4::splat`.
    unsafe {
        let ab = vreinterpretq_f64_f32(vtrn1q_f32(a, b));
        let cd = vreinterpretq_f64_f32(vtrn1q_f32(c, d));
        let ef = vreinterpretq_f64_f32(vtrn2q_f32(a, b));
        let gh = vreinterpretq_f64_f32(vtrn2q_f32(c, d));
        [
            vreinterpretq_f32_f64(vtrn1q_f64(ab, cd)),
            vreinterpretq_f32_f64(vtrn1q_f64(ef, gh)),
            vreinterpretq_f32_f64(vtrn2q_f64(ab, cd)),
            vreinterpretq_f32_f64(vtrn2q_f64(ef, gh)),
        ]
    }
}

/// Two frames.
#[derive(Clone, Copy)]
struct F64x2(float64x2_t);

arithmetic!(F64x2, vaddq_f64, vsubq_f64, vmulq_f64, vdivq_f64);

impl Lanes for F64x2 {
    type Real = f64;
    type Doubles = Self;
    const WIDTH: usize = 2;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: NEON belongs to every AArch64 that Rust's standard library runs on.
        Self(unsafe { vdupq_n_f64(value) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `splat`.
        Self(unsafe { vsqrtq_f64(self.0) })
    }

    #[inline(always)]
    fn load_columns(source: &[f64], stride: usize) -> [Self; 4] {
        check_rows(2, stride, source.len());
        // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
        unsafe {
            let (start, next) = (source.as_ptr(), source.as_ptr().add(stride));
            let (a, b, c, d) =
                (vld1q_f64(start), vld1q_f64(next), vld1q_f64(start.add(2)), vld1q_f64(next.add(2)));
            [Self(vtrn1q_f64(a, b)), Self(vtrn2q_f64(a, b)), Self(vtrn1q_f64(c, d)), Self(vtrn2q_f64(c, d))]
        }
    }

    #[inline(always)]
    fn store_columns(columns: [Self; 4], target: &mut [f64], stride: usize) {
        check_rows(2, stride, target.len());
        let [x, y, z, w] = columns;
        // SAFETY: as for `splat`; the rows lie inside `target`, as just checked.
        unsafe {
            let start = target.as_mut_ptr();
            vst1q_f64(start, vtrn1q_f64(x.0, y.0));
            vst1q_f64(start.add(2), vtrn1q_f64(z.0, w.0));
            vst1q_f64(start.add(stride), vtrn2q_f64(x.0, y.0));
            vst1q_f64(start.add(stride + 2), vtrn2q_f64(z.0, w.0));
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
        unsafe {
            let above = vcgtq_f64(self.0, vdupq_n_f64(limit));
            (vgetq_lane_u64::<0>(above) | vgetq_lane_u64::<1>(above)) != 0
        }
    }

    #[inline(always)]
    fn changed(self, change: fn(&mut [f64])) -> Self {
        let mut lanes = [0.0; 2];
        // SAFETY: as for `Lanes::splat`; the array holds two numbers.
        unsafe {
            vst1q_f64(lanes.as_mut_ptr(), self.0);
            change(&mut lanes);
            Self(vld1q_f64(lanes.as_ptr()))
        }
    }
}
