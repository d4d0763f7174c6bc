//! One number from text, byte by byte: the definition, and what the fast readers hand over to.

use super::layout::EXACT_POWERS;
use std::ops::Range;

/// Largest mantissa of which every smaller whole number is an `f64`.
const EXACT_MANTISSA: u64 = 1 << 53;

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
/// (W. Clinger, "How to read floating point numbers accurately", 1990); all others go to `str::parse`.
#[inline]
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
    if count == 0 || count > 19 || mantissa > EXACT_MANTISSA {
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
    let factor = *EXACT_POWERS.get(power.unsigned_abs() as usize)?;
    let magnitude = if power < 0 { mantissa as f64 / factor } else { mantissa as f64 * factor };
    Some((if negative { -magnitude } else { magnitude }, end))
}

/// Appends the digits at `at` to `number`; wraps silently beyond 19 of them, which the caller counts.
#[inline]
fn digits(text: &[u8], mut at: usize, mut number: u64) -> (u64, usize) {
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit < 10) {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (number, at)
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
