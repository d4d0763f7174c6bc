//! One number from text, byte by byte: the definition, and what the fast readers hand over to.

use super::layout::{EXACT_POWERS, FIVES};
use std::ops::Range;

/// Largest mantissa of which every smaller whole number is an `f64`.
const EXACT_MANTISSA: u64 = 1 << 53;

/// Digits of which every number is a `u64`.
const MOST_DIGITS: usize = 19;

/// What stands where a value should be.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    /// A finite number, and where the text goes on.
    Value(f64, usize),
    /// A decimal number beyond the range of an `f64`.
    Overflow(Range<usize>),
    /// Something else; empty where a line or the text ends.
    Other(Range<usize>),
}

/// Reads the token that starts at `at`.
///
/// Decimals of up to 19 digits whose mantissa and power of ten are both exact in an `f64` need one rounding only
/// (W. Clinger, "How to read floating point numbers accurately", 1990); of the others, those that are a whole number
/// over a power of ten are one division of whole numbers; all else goes to `str::parse`.
// Inlined it would crowd the loops of the fast readers, which seldom need it.
#[inline(never)]
pub(super) fn read(text: &[u8], at: usize) -> Token {
    match simple(text, at) {
        Some((value, end)) => Token::Value(value, end),
        None => hard(text, at),
    }
}

/// `[-]digits[.digits][e[+-]digits]` where one rounding is enough.
#[inline]
fn simple(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let byte = |i: usize| text.get(i).copied().unwrap_or(b' ');
    let negative = byte(at) == b'-';
    let first = at + usize::from(negative);
    let (whole, point) = digits(text, first, 0);
    let (mantissa, end, fraction) = if byte(point) == b'.' {
        let (mantissa, end) = digits(text, point + 1, whole);
        (mantissa, end, end - point - 1)
    } else {
        (whole, point, 0)
    };
    let count = point - first + fraction;
    if count == 0 || count > MOST_DIGITS && significant(&text[first..end]) > MOST_DIGITS {
        return None;
    }
    let (exponent, end) = match byte(end) {
        b'e' | b'E' => exponent(text, end + 1)?,
        _ => (0, end),
    };
    if byte(end) > b' ' {
        return None;
    }
    let power = exponent - fraction as i32;
    let magnitude = match EXACT_POWERS.get(power.unsigned_abs() as usize) {
        Some(factor) if mantissa <= EXACT_MANTISSA && power < 0 => mantissa as f64 / factor,
        Some(factor) if mantissa <= EXACT_MANTISSA => mantissa as f64 * factor,
        _ => quotient(mantissa, power.checked_neg()?)?,
    };
    Some((if negative { -magnitude } else { magnitude }, end))
}

/// `mantissa / 10^places`, rounded once, to even where it lies in the middle; `None` where 0 or out of reach.
///
/// With both brought to 64 bits, `mantissa 2^63 / 5^places` has 63 of them or 64, ten more than an `f64`; whether
/// anything is left over goes into the last, so that the conversion rounds as if it saw all.
#[inline]
fn quotient(mantissa: u64, places: i32) -> Option<f64> {
    let divisor = *FIVES.get(usize::try_from(places).ok()?)?;
    if mantissa == 0 {
        return None;
    }
    let (raised, lowered) = (mantissa.leading_zeros(), divisor.leading_zeros());
    let (dividend, divisor) = (u128::from(mantissa << raised) << 63, divisor << lowered);
    let whole = (dividend / u128::from(divisor)) as u64;
    let is_inexact = whole.wrapping_mul(divisor) != dividend as u64;
    let power = lowered as i32 - raised as i32 - 63 - places;
    let scale = f64::from_bits(((1023 + power) as u64) << 52);
    Some((whole | u64::from(is_inexact)) as f64 * scale)
}

/// How many digits there are from the first that is not 0.
#[cold]
fn significant(decimal: &[u8]) -> usize {
    let digits = decimal.iter().filter(|&&byte| byte != b'.');
    digits.skip_while(|&&byte| byte == b'0').count()
}

/// Appends the digits at `at` to `number`; wraps silently beyond 19 of them, which the caller counts.
#[inline]
fn digits(text: &[u8], mut at: usize, mut number: u64) -> (u64, usize) {
    while let Some(eight) =
        text.get(at..).and_then(<[u8]>::first_chunk).and_then(|bytes| eight_digits(*bytes))
    {
        number = number.wrapping_mul(100_000_000).wrapping_add(eight);
        at += 8;
    }
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit < 10) {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (number, at)
}

/// The number that eight digits are: pairs, then fours, then all of them.
#[inline]
fn eight_digits(bytes: [u8; 8]) -> Option<u64> {
    const ZEROS: u64 = 0x3030_3030_3030_3030;
    let digits = u64::from_le_bytes(bytes) ^ ZEROS;
    // A byte above 9 reaches 16 when 6 is added, or is above that already.
    if (digits | digits.wrapping_add(0x0606_0606_0606_0606)) & 0xf0f0_f0f0_f0f0_f0f0 != 0 {
        return None;
    }
    let pairs = (digits.wrapping_mul((10 << 8) + 1) >> 8) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs.wrapping_mul((100 << 16) + 1) >> 16) & 0x0000_ffff_0000_ffff;
    Some(fours.wrapping_mul((10_000 << 32) + 1) >> 32)
}

/// An exponent of at most three digits.
#[inline]
fn exponent(text: &[u8], at: usize) -> Option<(i32, usize)> {
    let sign = text.get(at).copied();
    let first = at + usize::from(matches!(sign, Some(b'+' | b'-')));
    let (number, end) = digits(text, first, 0);
    let number = if (1..=3).contains(&(end - first)) { number as i32 } else { return None };
    Some((if sign == Some(b'-') { -number } else { number }, end))
}

/// Any decimal number, by the standard library; or what stands there instead.
#[cold]
#[inline(never)]
fn hard(text: &[u8], at: usize) -> Token {
    let end = token_end(text, at);
    let token = &text[at..end];
    // `str::parse` would take `inf` and `nan` too.
    let decimal = token.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
    let value =
        std::str::from_utf8(token).ok().filter(|_| decimal).and_then(|token| token.parse::<f64>().ok());
    match value {
        Some(value) if value.is_finite() => Token::Value(value, end),
        Some(_) => Token::Overflow(at..end),
        None => Token::Other(at..end),
    }
}

/// Where the token at `at` ends; a control byte that is no blank and no line end is a token of its own.
fn token_end(text: &[u8], at: usize) -> usize {
    let length = text[at..].iter().position(|&byte| byte <= b' ').unwrap_or(text.len() - at);
    match text.get(at) {
        Some(&byte) if length == 0 && !is_blank(byte) && !is_line_end(byte) => at + 1,
        _ => at + length,
    }
}

/// Whether `byte` separates the values of a row.
#[inline]
pub(super) fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c)
}

/// Whether `byte` ends a row.
#[inline]
pub(super) fn is_line_end(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}
