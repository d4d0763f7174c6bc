//! Eight numbers at a time out of 64 bytes, and single ones near an end of the text or among others than decimals.
//!
//! A number lies in 16 bytes; its digits are lined up by one shuffle and summed in pairs, in the manner of W. Mula,
//! "SIMD-ized integer parsing" (2016), with the decimal point taken out by the shuffle. No branch depends on a number's
//! length, sign or point.

use super::amc::{self, FramesRead, ParseFrames};
use super::layout::{DIVISORS, GATHER, WIDTH, shape};
use super::parse::{self, ParseRows, RowsRead};
use super::window::{Decimal, Decimals, SPAN, Window};
use std::arch::x86_64::*;

/// Reads the rows of `job`; the caller has seen that the machine has AVX2, which for `Isa` includes the instructions
/// that count and take bits.
pub(super) fn rows(job: &ParseRows<'_>, out: &mut [f64]) -> RowsRead {
    debug_assert!(crate::Isa::Avx2.is_available());
    // SAFETY: `ParseRows::run_on` comes here only where AVX2 and these are available.
    unsafe { rows_avx2(job, out) }
}

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn rows_avx2(job: &ParseRows<'_>, out: &mut [f64]) -> RowsRead {
    parse::rows(job, out, |text, at, room, wanted| numbers(text, at, room, wanted))
}

/// Reads the frames of `job`; the caller has seen that the machine has AVX2.
pub(super) fn frames(job: &ParseFrames<'_>) -> FramesRead {
    debug_assert!(crate::Isa::Avx2.is_available());
    // SAFETY: `ParseFrames::run_on` comes here only where AVX2, and so those instructions, are available.
    unsafe { frames_avx2(job) }
}

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn frames_avx2(job: &ParseFrames<'_>) -> FramesRead {
    amc::frames(job, |text, at| number(text, at))
}

/// Up to eight decimals with blanks between them: how many, and where the last ends.
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn numbers(text: &[u8], at: usize, room: &mut [f64], wanted: usize) -> (usize, usize) {
    let window = text.get(at..).and_then(|rest| rest.first_chunk());
    let (Some(window), Some((low, high))) =
        (window, room.first_chunk_mut::<8>().map(|room| room.split_at_mut(4)))
    else {
        return parse::one(number(text, at), at, room);
    };
    let all = look(window).decimals();
    let count = all.count().min(8);
    if count == 0 || count > wanted {
        return parse::one(number(text, at), at, room);
    }
    let mut rest = all;
    four(window, &mut rest, low);
    four(window, &mut rest, high);
    (count, at + rest.end_of_taken(&all))
}

/// 64 bytes of text, and what a load from the last of them may touch.
type Bytes = [u8; SPAN + WIDTH];

/// What the first 64 bytes are.
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn look(window: &Bytes) -> Window {
    // SAFETY: 64 bytes lie in the window; the loads need no alignment.
    let halves = unsafe {
        let start: *const __m256i = window.as_ptr().cast();
        [_mm256_loadu_si256(start), _mm256_loadu_si256(start.add(1))]
    };
    let both = |[low, high]: [__m256i; 2]| {
        let bits = |lanes: __m256i| u64::from(_mm256_movemask_epi8(lanes) as u32);
        bits(low) | bits(high) << 32
    };
    let equal = |byte: u8| halves.map(|half| _mm256_cmpeq_epi8(half, _mm256_set1_epi8(byte as i8)));
    let up_to = |halves: [__m256i; 2], byte: u8| {
        halves.map(|half| _mm256_cmpeq_epi8(_mm256_min_epu8(half, _mm256_set1_epi8(byte as i8)), half))
    };
    let raised = halves.map(|half| _mm256_sub_epi8(half, _mm256_set1_epi8(b'0' as i8)));
    let (spaces, tabs) = (equal(b' '), equal(b'\t'));
    Window {
        ends: both(up_to(halves, b' ')),
        blanks: both([_mm256_or_si256(spaces[0], tabs[0]), _mm256_or_si256(spaces[1], tabs[1])]),
        digits: both(up_to(raised, 9)),
        points: both(equal(b'.')),
        minuses: both(equal(b'-')),
    }
}

/// The next four decimals; any numbers for those that there are not.
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn four(window: &Bytes, rest: &mut Decimals, room: &mut [f64]) {
    let decimals: [Decimal; 4] = std::array::from_fn(|_| rest.take());
    let [a, b, c, d] = decimals.map(|decimal| window[decimal.start..].first_chunk::<WIDTH>().unwrap());
    let [e, f, g, h] = decimals.map(|decimal| shape(decimal.length, decimal.point));
    let texts = [two(a, c), two(b, d)];
    let gathers = [two(&GATHER[e], &GATHER[g]), two(&GATHER[f], &GATHER[h])];
    let fours = [0, 1].map(|k| {
        // A minus and a point are less than any digit, and so become 0.
        let digits = _mm256_subs_epu8(texts[k], _mm256_set1_epi8(b'0' as i8));
        let pairs = _mm256_maddubs_epi16(_mm256_shuffle_epi8(digits, gathers[k]), _mm256_set1_epi16(0x010a));
        _mm256_madd_epi16(pairs, _mm256_set1_epi32(0x0001_0064))
    });
    let eights = _mm256_madd_epi16(_mm256_packus_epi32(fours[0], fours[1]), _mm256_set1_epi32(0x0001_2710));
    let upper = _mm256_mul_epu32(eights, _mm256_set1_epi64x(100_000_000));
    let mantissas = _mm256_add_epi64(upper, _mm256_srli_epi64::<32>(eights));
    // Below 2^52 a whole number's bits under the exponent of 2^52 are their sum.
    let base = _mm256_set1_pd((1_u64 << 52) as f64);
    let sums = _mm256_castsi256_pd(_mm256_or_si256(mantissas, _mm256_castpd_si256(base)));
    let divisors = _mm256_set_pd(DIVISORS[h], DIVISORS[g], DIVISORS[f], DIVISORS[e]);
    let magnitudes = _mm256_div_pd(_mm256_sub_pd(sums, base), divisors);
    let is_minus = _mm256_cmpeq_epi8(_mm256_unpacklo_epi64(texts[0], texts[1]), _mm256_set1_epi8(b'-' as i8));
    let signs = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(is_minus));
    let room: &mut [f64; 4] = room.try_into().unwrap();
    // SAFETY: there is room for four values; the store needs no alignment.
    unsafe { _mm256_storeu_pd(room.as_mut_ptr(), _mm256_or_pd(magnitudes, signs)) }
}

/// Sixteen bytes and sixteen others.
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn two(first: &[u8; WIDTH], second: &[u8; WIDTH]) -> __m256i {
    // SAFETY: both hold 16 bytes; the loads need no alignment.
    unsafe { _mm256_loadu2_m128i(second.as_ptr().cast(), first.as_ptr().cast()) }
}

/// `[-]digits[.digits]` of at most 15 bytes, at least 16 bytes before the text's end.
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
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

    let shape = shape(length as usize, point as usize);
    let gather: &[u8; WIDTH] = &GATHER[shape];
    // SAFETY: a row of the table holds 16 bytes; the load needs no alignment.
    let gather = unsafe { _mm_loadu_si128(gather.as_ptr().cast()) };
    let mantissa = whole(_mm_shuffle_epi8(_mm_and_si128(raised, is_digit), gather));
    let magnitude = mantissa as f64 / DIVISORS[shape];
    Some((f64::from_bits(magnitude.to_bits() | u64::from(negative) << 63), at + length as usize))
}

/// The number whose 16 decimal digits are the lanes, the first lane the most significant.
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn whole(digits: __m128i) -> i64 {
    let pairs = _mm_maddubs_epi16(digits, _mm_set1_epi16(0x010a));
    let fours = _mm_madd_epi16(pairs, _mm_set1_epi32(0x0001_0064));
    let packed = _mm_packus_epi32(fours, fours);
    let eights = _mm_cvtsi128_si64(_mm_madd_epi16(packed, _mm_set1_epi32(0x0001_2710)));
    (eights & 0xffff_ffff) * 100_000_000 + (eights >> 32)
}
