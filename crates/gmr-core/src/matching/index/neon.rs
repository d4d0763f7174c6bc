//! The kernels in NEON, which every AArch64 has: 4 lanes.

use std::arch::aarch64::*;

use super::codes::{FURTHEST, both};
use super::kernel::Kernel;
use super::layout::{Edges, Lanes, edges};

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
    fn place(self, q: &Lanes<4>, corner: &Lanes<4>, parts: f32) -> [i16; 4] {
        let mut placed = [0; 4];
        // SAFETY: every AArch64 has NEON; the loads read the 4 numbers of `q` and of `corner`, the store fills `placed`.
        unsafe {
            let from_corner = vsubq_f32(vld1q_f32(q.as_ptr()), vld1q_f32(corner.as_ptr()));
            let parts = vmaxq_f32(vmulq_f32(from_corner, vdupq_n_f32(parts)), vdupq_n_f32(-FURTHEST));
            let parts = vcvtnq_s32_f32(vminq_f32(parts, vdupq_n_f32(FURTHEST)));
            vst1_s16(placed.as_mut_ptr(), vmovn_s32(parts));
        }
        placed
    }

    #[inline(always)]
    fn add_gaps(
        self,
        gaps: int32x4_t,
        q: [i16; 2],
        apart: i16,
        lower: &[[u8; 2]; 4],
        upper: &[[u8; 2]; 4],
    ) -> int32x4_t {
        // SAFETY: every AArch64 has NEON; the loads read the 8 bytes of `lower` and of `upper`.
        unsafe {
            let q = vreinterpretq_s16_s32(vdupq_n_s32(both(q)));
            let parts =
                |codes: &[[u8; 2]; 4]| vreinterpretq_s16_u16(vshll_n_u8::<2>(vld1_u8(codes.as_ptr().cast())));
            let apart = vdupq_n_s16(apart);
            let outside = vmaxq_s16(vsubq_s16(parts(lower), q), vsubq_s16(q, parts(upper)));
            let gap = vsubq_s16(vmaxq_s16(outside, apart), apart);
            let squares = vmull_s16(vget_low_s16(gap), vget_low_s16(gap));
            let more = vmull_high_s16(gap, gap);
            vaddq_s32(gaps, vpaddq_s32(squares, more))
        }
    }

    #[inline(always)]
    fn add_differences(self, gaps: int32x4_t, q: [i16; 2], apart: i16, rows: &[[u8; 2]; 4]) -> int32x4_t {
        self.add_gaps(gaps, q, apart, rows, rows)
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
