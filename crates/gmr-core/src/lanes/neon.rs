//! NEON: 4 frames of `f32`, 2 of `f64`.

use std::arch::aarch64::{
    float32x4_t, float64x2_t, vabsq_f32, vabsq_f64, vaddq_f32, vaddq_f64, vcleq_f64, vcombine_f32,
    vcvt_f32_f64, vdivq_f32, vdivq_f64, vdupq_n_f32, vdupq_n_f64, vgetq_lane_u64, vld1q_f32, vld1q_f64,
    vmulq_f32, vmulq_f64, vreinterpretq_f32_f64, vreinterpretq_f64_f32, vsqrtq_f32, vsqrtq_f64, vst1q_f32,
    vst1q_f64, vsubq_f32, vsubq_f64, vtrn1q_f32, vtrn1q_f64, vtrn2q_f32, vtrn2q_f64,
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
    F32x4 = float32x4_t of 4 f32, two of F64x2 beside it;
    add vaddq_f32, sub vsubq_f32, mul vmulq_f32, div vdivq_f32, sqrt vsqrtq_f32, abs vabsq_f32, splat vdupq_n_f32,
    read vld1q_f32, write vst1q_f32, stream vst1q_f32, load load_f32, store store_f32,
    scatter scatter, narrow narrow,
}

register! {
    /// Two frames.
    F64x2 = float64x2_t of 2 f64;
    add vaddq_f64, sub vsubq_f64, mul vmulq_f64, div vdivq_f64, sqrt vsqrtq_f64, abs vabsq_f64, splat vdupq_n_f64,
    read vld1q_f64, write vst1q_f64, stream vst1q_f64, load load_f64, store store_f64, all_at_most all_at_most,
}

/// Four columns of four rows.
///
/// # Safety
/// The rows must be readable. (NEON, here and below, belongs to every AArch64 that Rust's standard library
/// runs on.)
#[inline(always)]
unsafe fn load_f32(start: *const f32, stride: usize) -> [float32x4_t; 4] {
    // SAFETY: the caller's.
    unsafe {
        let (a, b) = (vld1q_f32(start), vld1q_f32(start.add(stride)));
        let (c, d) = (vld1q_f32(start.add(2 * stride)), vld1q_f32(start.add(3 * stride)));
        transpose([a, b, c, d])
    }
}

/// The inverse of [`load_f32`].
///
/// # Safety
/// The rows must be writeable.
#[inline(always)]
unsafe fn store_f32(columns: [float32x4_t; 4], start: *mut f32, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        let [a, b, c, d] = transpose(columns);
        vst1q_f32(start, a);
        vst1q_f32(start.add(stride), b);
        vst1q_f32(start.add(2 * stride), c);
        vst1q_f32(start.add(3 * stride), d);
    }
}

/// [`store_f32`] to the rows of four numbers that `rows` names.
///
/// # Safety
/// Four rows must be named, and writeable.
#[inline(always)]
unsafe fn scatter(columns: [float32x4_t; 4], start: *mut f32, rows: *const u16) {
    // SAFETY: the caller's.
    unsafe {
        for (lane, one) in transpose(columns).into_iter().enumerate() {
            vst1q_f32(start.add(4 * usize::from(*rows.add(lane))), one);
        }
    }
}

/// Transposes 4x4 numbers.
///
/// # Safety
/// None beyond NEON.
#[inline(always)]
unsafe fn transpose([a, b, c, d]: [float32x4_t; 4]) -> [float32x4_t; 4] {
    // SAFETY: the caller's.
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

/// # Safety
/// None beyond NEON.
#[inline(always)]
unsafe fn narrow(first: float64x2_t, second: float64x2_t) -> float32x4_t {
    // SAFETY: the caller's.
    unsafe { vcombine_f32(vcvt_f32_f64(first), vcvt_f32_f64(second)) }
}

/// Four columns of two rows.
///
/// # Safety
/// The rows must be readable.
#[inline(always)]
unsafe fn load_f64(start: *const f64, stride: usize) -> [float64x2_t; 4] {
    // SAFETY: the caller's.
    unsafe {
        let next = start.add(stride);
        let (a, b) = (vld1q_f64(start), vld1q_f64(next));
        let (c, d) = (vld1q_f64(start.add(2)), vld1q_f64(next.add(2)));
        [vtrn1q_f64(a, b), vtrn2q_f64(a, b), vtrn1q_f64(c, d), vtrn2q_f64(c, d)]
    }
}

/// The inverse of [`load_f64`].
///
/// # Safety
/// The rows must be writeable.
#[inline(always)]
unsafe fn store_f64([x, y, z, w]: [float64x2_t; 4], start: *mut f64, stride: usize) {
    // SAFETY: the caller's.
    unsafe {
        vst1q_f64(start, vtrn1q_f64(x, y));
        vst1q_f64(start.add(2), vtrn1q_f64(z, w));
        vst1q_f64(start.add(stride), vtrn2q_f64(x, y));
        vst1q_f64(start.add(stride + 2), vtrn2q_f64(z, w));
    }
}

/// # Safety
/// None beyond NEON.
#[inline(always)]
unsafe fn all_at_most(lanes: float64x2_t, limit: float64x2_t) -> bool {
    // SAFETY: the caller's.
    unsafe {
        let is_within = vcleq_f64(lanes, limit);
        (vgetq_lane_u64::<0>(is_within) & vgetq_lane_u64::<1>(is_within)) != 0
    }
}
