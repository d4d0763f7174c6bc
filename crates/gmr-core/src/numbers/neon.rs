//! One number at a time out of a register of 16 bytes: the method of the AVX2 file, in NEON's words.
//!
//! Masks have four bits a byte, the narrowest that one instruction gives here; one bit of each four is kept.

use super::amc::{self, FramesRead, ParseFrames};
use super::layout::{DIVISORS, GATHER, WIDTH, shape};
use super::parse::{self, ParseRows, RowsRead};
use std::arch::aarch64::*;

/// Reads the rows of `job`; every AArch64 machine has NEON.
pub(super) fn rows(job: &ParseRows<'_>, out: &mut [f64]) -> RowsRead {
    // SAFETY: NEON is part of the AArch64 base line.
    unsafe { rows_neon(job, out) }
}

#[target_feature(enable = "neon")]
fn rows_neon(job: &ParseRows<'_>, out: &mut [f64]) -> RowsRead {
    parse::rows(job, out, |text, at, room, _| parse::one(number(text, at), at, room))
}

/// Reads the frames of `job`; every AArch64 machine has NEON.
pub(super) fn frames(job: &ParseFrames<'_>) -> FramesRead {
    // SAFETY: NEON is part of the AArch64 base line.
    unsafe { frames_neon(job) }
}

#[target_feature(enable = "neon")]
fn frames_neon(job: &ParseFrames<'_>) -> FramesRead {
    amc::frames(job, |text, at| number(text, at))
}

/// `[-]digits[.digits]` of at most 15 bytes, at least 16 bytes before the text's end.
#[target_feature(enable = "neon")]
#[inline]
fn number(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let window = text.get(at..at + WIDTH)?;
    // SAFETY: the window holds 16 bytes; the load needs no alignment.
    let bytes = unsafe { vld1q_u8(window.as_ptr()) };

    let ends = mask(vcleq_u8(bytes, vdupq_n_u8(b' ')));
    if ends == 0 {
        return None;
    }
    let length = ends.trailing_zeros() / 4;
    let inside = (ends - 1) & !ends;

    let raised = vsubq_u8(bytes, vdupq_n_u8(b'0'));
    let is_digit = vcleq_u8(raised, vdupq_n_u8(9));
    let negative = u64::from(window[0] == b'-');
    let points = mask(vceqq_u8(bytes, vdupq_n_u8(b'.')));
    let digits = mask(is_digit) & inside;
    let others = inside & ONE_A_BYTE & !digits & !negative;
    if digits == 0 || others & !points != 0 || others & others.wrapping_sub(1) != 0 {
        return None;
    }
    let point = (others | ends).trailing_zeros() / 4;

    let shape = shape(length as usize, point as usize);
    let gather: &[u8; WIDTH] = &GATHER[shape];
    // SAFETY: a row of the table holds 16 bytes; the load needs no alignment.
    let gather = unsafe { vld1q_u8(gather.as_ptr()) };
    let mantissa = whole(vqtbl1q_u8(vandq_u8(raised, is_digit), gather));
    let magnitude = mantissa as f64 / DIVISORS[shape];
    Some((f64::from_bits(magnitude.to_bits() | negative << 63), at + length as usize))
}

const ONE_A_BYTE: u64 = 0x1111_1111_1111_1111;

/// One bit for each lane that is all ones, four bits apart.
#[target_feature(enable = "neon")]
#[inline]
fn mask(lanes: uint8x16_t) -> u64 {
    let nibbles = vshrn_n_u16::<4>(vreinterpretq_u16_u8(lanes));
    vget_lane_u64::<0>(vreinterpret_u64_u8(nibbles)) & ONE_A_BYTE
}

/// The number whose 16 decimal digits are the lanes, the first lane the most significant.
#[target_feature(enable = "neon")]
#[inline]
fn whole(digits: uint8x16_t) -> u64 {
    let tens = vreinterpretq_u8_u16(vdupq_n_u16(0x010a));
    let pairs = vpaddlq_u8(vmulq_u8(digits, tens));
    let hundreds = vreinterpretq_u16_u32(vdupq_n_u32(0x0001_0064));
    let fours = vpaddlq_u16(vmulq_u16(pairs, hundreds));
    let myriads = vreinterpretq_u32_u64(vdupq_n_u64(0x0000_0001_0000_2710));
    let eights = vpaddlq_u32(vmulq_u32(fours, myriads));
    vgetq_lane_u64::<0>(eights) * 100_000_000 + vgetq_lane_u64::<1>(eights)
}
