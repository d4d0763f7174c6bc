//! The kernels in NEON, which every AArch64 has: 4 lanes.

use std::arch::aarch64::*;

use super::traverse::Kernel;
use super::tree::{Edges, Lanes, edges};

#[derive(Debug, Clone, Copy)]
pub(super) struct Neon;

/// The bit of each lane.
const BITS: [u32; 4] = [1, 2, 4, 8];

impl Kernel<4> for Neon {
    type Sums = float32x4_t;
    type Gaps = int32x4_t;

    #[inline(always)]
    fn zero(self) -> float32x4_t {
        // SAFETY: every AArch64 has NEON.
        unsafe { vdupq_n_f32(0.0) }
    }

    #[inline(always)]
    fn difference(self, q: f32, row: &Lanes<4>) -> float32x4_t {
        // SAFETY: every AArch64 has NEON; the load reads the 4 numbers of `row`.
        unsafe { vsubq_f32(vdupq_n_f32(q), vld1q_f32(row.as_ptr())) }
    }

    #[inline(always)]
    fn gap(self, q: f32, edges: &Edges<4>) -> float32x4_t {
        // SAFETY: every AArch64 has NEON; the load reads the 4 pairs of `edges`.
        unsafe {
            let q = vdupq_n_f32(q);
            let edges = vld1q_u32(edges.as_ptr());
            let low = vreinterpretq_f32_u32(vshlq_n_u32::<16>(edges));
            let high = vreinterpretq_f32_u32(vandq_u32(edges, vdupq_n_u32(edges::UPPER)));
            vsubq_f32(q, vminq_f32(vmaxq_f32(q, low), high))
        }
    }

    #[inline(always)]
    fn add_squares(self, sums: float32x4_t, difference: float32x4_t) -> float32x4_t {
        // SAFETY: every AArch64 has NEON.
        unsafe { vaddq_f32(sums, vmulq_f32(difference, difference)) }
    }

    #[inline(always)]
    fn add_weighted_squares(self, sums: float32x4_t, weight: f32, difference: float32x4_t) -> float32x4_t {
        // SAFETY: every AArch64 has NEON.
        unsafe {
            let squares = vmulq_f32(difference, difference);
            vaddq_f32(sums, vmulq_f32(vdupq_n_f32(weight), squares))
        }
    }

    #[inline(always)]
    fn add(self, a: float32x4_t, b: float32x4_t) -> float32x4_t {
        // SAFETY: every AArch64 has NEON.
        unsafe { vaddq_f32(a, b) }
    }

    #[inline(always)]
    fn no_gaps(self) -> int32x4_t {
        // SAFETY: every AArch64 has NEON.
        unsafe { vdupq_n_s32(0) }
    }

    #[inline(always)]
    fn add_gaps(
        self,
        gaps: int32x4_t,
        low: [i16; 2],
        high: [i16; 2],
        lower: &[[u8; 2]; 4],
        upper: &[[u8; 2]; 4],
    ) -> int32x4_t {
        // SAFETY: every AArch64 has NEON; the loads read the 8 bytes of `lower` and of `upper`.
        unsafe {
            let both = |[one, other]: [i16; 2]| {
                vreinterpretq_s16_s32(vdupq_n_s32(i32::from(one) & 0xffff | i32::from(other) << 16))
            };
            let parts =
                |codes: &[[u8; 2]; 4]| vreinterpretq_s16_u16(vshll_n_u8::<2>(vld1_u8(codes.as_ptr().cast())));
            let below = vsubq_s16(parts(lower), both(high));
            let above = vsubq_s16(both(low), parts(upper));
            let gap = vmaxq_s16(vmaxq_s16(below, above), vdupq_n_s16(0));
            let squares = vmull_s16(vget_low_s16(gap), vget_low_s16(gap));
            let more = vmull_high_s16(gap, gap);
            vaddq_s32(gaps, vpaddq_s32(squares, more))
        }
    }

    #[inline(always)]
    fn in_units(self, gaps: int32x4_t, unit: f32) -> float32x4_t {
        // SAFETY: every AArch64 has NEON.
        unsafe { vmulq_f32(vcvtq_f32_s32(gaps), vdupq_n_f32(unit)) }
    }

    #[inline(always)]
    fn at_most(self, sums: float32x4_t, limit: f32) -> u32 {
        // SAFETY: every AArch64 has NEON.
        unsafe { bits_of(vcleq_f32(sums, vdupq_n_f32(limit))) }
    }

    #[inline(always)]
    fn lowest(self, sums: float32x4_t, among: u32) -> (usize, f32) {
        // SAFETY: every AArch64 has NEON; the load reads the 4 numbers of `BITS`.
        unsafe {
            let bits = vld1q_u32(BITS.as_ptr());
            let asked = vtstq_u32(vdupq_n_u32(among), bits);
            let lowest = vminvq_f32(vbslq_f32(asked, sums, vdupq_n_f32(f32::INFINITY)));
            let equal = bits_of(vceqq_f32(sums, vdupq_n_f32(lowest))) & among;
            (equal.trailing_zeros() as usize, lowest)
        }
    }

    #[inline(always)]
    fn fetch<T>(self, _block: &[T]) {
        // The instruction has no stable name in Rust yet; the processor's own prefetching must do.
    }
}

/// One bit for each lane that is all ones.
#[inline(always)]
fn bits_of(lanes: uint32x4_t) -> u32 {
    // SAFETY: every AArch64 has NEON; the load reads the 4 numbers of `BITS`.
    unsafe {
        let bits = vld1q_u32(BITS.as_ptr());
        vaddvq_u32(vandq_u32(lanes, bits))
    }
}
