//! One number at a time out of a register of 16 bytes: its digits are lined up by one shuffle and summed in pairs.
//!
//! The method is in the manner of W. Mula, "SIMD-ized integer parsing" (2016), with the decimal point taken out by the
//! shuffle. It has no branch that depends on a number's length, sign or point.

use super::amc::{self, FramesRead, ParseFrames};
use super::layout::{DIVISORS, GATHER, WIDTH};
use super::parse::{self, ParseRows, RowsRead};
use std::arch::x86_64::*;

/// Reads the rows of `job`; the caller has seen that the machine has AVX2, which for `Isa` includes BMI: its counts
/// of zeros are a tenth of the work.
pub(super) fn rows(job: &ParseRows<'_>, out: &mut [f64]) -> RowsRead {
    debug_assert!(crate::Isa::Avx2.is_available());
    // SAFETY: `ParseRows::run_on` comes here only where AVX2 and BMI are available.
    unsafe { rows_avx2(job, out) }
}

#[target_feature(enable = "avx2,bmi1,bmi2")]
fn rows_avx2(job: &ParseRows<'_>, out: &mut [f64]) -> RowsRead {
    parse::rows(job, out, |text, at| number(text, at))
}

/// Reads the frames of `job`; the caller has seen that the machine has AVX2.
pub(super) fn frames(job: &ParseFrames<'_>) -> FramesRead {
    debug_assert!(crate::Isa::Avx2.is_available());
    // SAFETY: `ParseFrames::run_on` comes here only where AVX2 is available.
    unsafe { frames_avx2(job) }
}

#[target_feature(enable = "avx2,bmi1,bmi2")]
fn frames_avx2(job: &ParseFrames<'_>) -> FramesRead {
    amc::frames(job, |text, at| number(text, at))
}

/// `[-]digits[.digits]` of at most 15 bytes, at least 16 bytes before the text's end.
#[target_feature(enable = "avx2,bmi1,bmi2")]
#[inline]
fn number(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let window = text.get(at..at + WIDTH)?;
    // SAFETY: the window holds 16 bytes; the load needs no alignment.
    let bytes = unsafe { _mm_loadu_si128(window.as_ptr().cast()) };
    let mask = |lanes: __m128i| _mm_movemask_epi8(lanes) as u32;

    let ends = mask(_mm_cmpeq_epi8(_mm_min_epu8(bytes, _mm_set1_epi8(b' ' as i8)), bytes));
    if ends == 0 {
        return None;
    }
    let length = ends.trailing_zeros();
    let inside = (ends - 1) & !ends;

    let raised = _mm_sub_epi8(bytes, _mm_set1_epi8(b'0' as i8));
    let is_digit = _mm_cmpeq_epi8(_mm_min_epu8(raised, _mm_set1_epi8(9)), raised);
    let negative = u32::from(window[0] == b'-');
    let points = mask(_mm_cmpeq_epi8(bytes, _mm_set1_epi8(b'.' as i8)));
    let digits = mask(is_digit) & inside;
    let others = inside & !digits & !negative;
    if digits == 0 || others & !points != 0 || others & others.wrapping_sub(1) != 0 {
        return None;
    }
    let point = (others | ends).trailing_zeros();

    let gather: &[u8; WIDTH] = &GATHER[length as usize & (WIDTH - 1)][point as usize & (WIDTH - 1)];
    // SAFETY: a row of the table holds 16 bytes; the load needs no alignment.
    let gather = unsafe { _mm_loadu_si128(gather.as_ptr().cast()) };
    let mantissa = whole(_mm_shuffle_epi8(_mm_and_si128(raised, is_digit), gather));
    let magnitude = mantissa as f64 / DIVISORS[(length - point) as usize & (WIDTH - 1)];
    Some((f64::from_bits(magnitude.to_bits() | u64::from(negative) << 63), at + length as usize))
}

/// The number whose 16 decimal digits are the lanes, the first lane the most significant.
#[target_feature(enable = "avx2,bmi1,bmi2")]
#[inline]
fn whole(digits: __m128i) -> i64 {
    let pairs = _mm_maddubs_epi16(digits, _mm_set1_epi16(0x010a));
    let fours = _mm_madd_epi16(pairs, _mm_set1_epi32(0x0001_0064));
    let packed = _mm_packus_epi32(fours, fours);
    let eights = _mm_cvtsi128_si64(_mm_madd_epi16(packed, _mm_set1_epi32(0x0001_2710)));
    (eights & 0xffff_ffff) * 100_000_000 + (eights >> 32)
}
