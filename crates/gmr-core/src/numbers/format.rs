//! Rows of numbers to text: each value as the shortest decimal that reads back bit-identical.
//!
//! Decimals of up to eight places, and so nearly all that motion files hold, are found by one multiplication and
//! proved by one division; the rest is left to the crate `zmij`. Magnitudes from 1e-7 up to 1e21 are written without an
//! exponent; the sign of zero is kept.

use std::fmt;

/// Rows of values, C order.
#[derive(Debug, Clone, Copy)]
pub struct FormatRows<'a> {
    /// The values, `(rows, columns)`.
    pub values: &'a [f64],
    /// Values in a row.
    pub columns: usize,
}

/// A value for which there is no decimal number: an infinity or a NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotFinite {
    /// Its row, from 0.
    pub row: usize,
    /// Its place in that row, from 0.
    pub field: usize,
}

impl fmt::Display for NotFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "value {} of row {} is not finite; text has no decimal for it", self.field, self.row)
    }
}

impl std::error::Error for NotFinite {}

/// Longest text of one value and the blank after it, rounded up.
pub(super) const LONGEST: usize = 64;
pub(super) const STAGE: usize = 8192;

impl FormatRows<'_> {
    /// Appends one line a row to `out`: values parted by a blank, `\n` at the end.
    ///
    /// # Errors
    /// When a value is not finite; then `out` holds what came before it in part.
    pub fn run(&self, out: &mut Vec<u8>) -> Result<(), NotFinite> {
        let mut stage = [0_u8; STAGE];
        let mut used = 0;
        for (row, values) in self.values.chunks(self.columns.max(1)).enumerate() {
            for (field, &value) in values.iter().enumerate() {
                if used > STAGE - LONGEST {
                    out.extend_from_slice(&stage[..used]);
                    used = 0;
                }
                if !value.is_finite() {
                    return Err(NotFinite { row, field });
                }
                used = write_value(&mut stage, used, value);
                stage[used] = b' ';
                used += 1;
            }
            stage[used - 1] = b'\n';
        }
        out.extend_from_slice(&stage[..used]);
        Ok(())
    }
}

/// Writes a finite `value` at `at` and gives the place after it.
#[inline]
pub(super) fn write_value(stage: &mut [u8; STAGE], at: usize, value: f64) -> usize {
    stage[at] = b'-';
    let at = at + usize::from(value.is_sign_negative());
    match eight_places(value.abs()) {
        Some((whole, fraction)) => write_short(stage, at, whole, fraction),
        None => write_hard(stage, at, value.abs()),
    }
}

/// `value = whole + fraction / 1e8` where that holds bit by bit with at most 15 digits in all.
///
/// No two decimals of at most 15 digits share an `f64`, so this one without its last zeros is the shortest.
#[inline]
fn eight_places(value: f64) -> Option<(u32, u32)> {
    // From 2^52 on doubles are whole numbers: adding it rounds, and leaves the number in the mantissa's bits.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let scaled = value * 1e8 + WHOLE;
    if value >= 1e7 || (scaled - WHOLE) / 1e8 != value {
        return None;
    }
    let number = scaled.to_bits() - WHOLE.to_bits();
    Some(((number / 100_000_000) as u32, (number % 100_000_000) as u32))
}

#[inline]
fn write_short(stage: &mut [u8; STAGE], at: usize, whole: u32, fraction: u32) -> usize {
    let digits = eight_digits(whole);
    let zeros = (digits.trailing_zeros() / 8).min(7);
    write_eight(stage, at, (digits | ZEROS) >> (8 * zeros));
    let at = at + 8 - zeros as usize;
    if fraction == 0 {
        return at;
    }
    let digits = eight_digits(fraction);
    stage[at] = b'.';
    write_eight(stage, at + 1, digits | ZEROS);
    at + 9 - digits.leading_zeros() as usize / 8
}

const ZEROS: u64 = 0x3030_3030_3030_3030;

#[inline]
fn write_eight(stage: &mut [u8; STAGE], at: usize, bytes: u64) {
    stage[at..at + 8].copy_from_slice(&bytes.to_le_bytes());
}

/// The eight decimal digits of a number below 1e8 as bytes, the most significant lowest.
///
/// Halves, quarters and digits are parted side by side in one register; the multiplications are divisions by 100 and
/// 10 that are exact in these ranges.
#[inline]
fn eight_digits(number: u32) -> u64 {
    let halves = u64::from(number / 10_000) | (u64::from(number % 10_000) << 32);
    let hundreds = ((halves * 10_486) >> 20) & 0x0000_007f_0000_007f;
    let pairs = hundreds | ((halves - hundreds * 100) << 16);
    let tens = ((pairs * 103) >> 10) & 0x000f_000f_000f_000f;
    tens | ((pairs - tens * 10) << 8)
}

/// Any positive finite value; `zmij` gives its digits, which are laid out here without an exponent where that is usual.
#[cold]
#[inline(never)]
fn write_hard(stage: &mut [u8; STAGE], at: usize, value: f64) -> usize {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format_finite(value);
    let text = text.strip_suffix(".0").unwrap_or(text);
    let (digits, exponent) = text.split_once('e').unwrap_or((text, ""));
    let mut put = Put { stage, at };
    match exponent.parse::<i32>() {
        Ok(places) if (0..21).contains(&places) => put.large(digits, places as usize),
        Ok(places) if (-7..0).contains(&places) => put.small(digits, places.unsigned_abs() as usize),
        _ => put.bytes(text.as_bytes()),
    }
    put.at
}

struct Put<'a> {
    stage: &'a mut [u8; STAGE],
    at: usize,
}

impl Put<'_> {
    fn bytes(&mut self, bytes: &[u8]) {
        self.stage[self.at..self.at + bytes.len()].copy_from_slice(bytes);
        self.at += bytes.len();
    }

    /// `d.ddd` times ten to the power of `places`, for a whole number of that many digits and one.
    fn large(&mut self, digits: &str, places: usize) {
        let (first, rest) = digits.split_once('.').unwrap_or((digits, ""));
        let (whole, fraction) = rest.split_at(places.min(rest.len()));
        self.bytes(first.as_bytes());
        self.bytes(whole.as_bytes());
        (whole.len()..places).for_each(|_| self.bytes(b"0"));
        if !fraction.is_empty() {
            self.bytes(b".");
            self.bytes(fraction.as_bytes());
        }
    }

    /// `d.ddd` divided by ten to the power of `places`.
    fn small(&mut self, digits: &str, places: usize) {
        self.bytes(b"0.");
        (1..places).for_each(|_| self.bytes(b"0"));
        let (first, rest) = digits.split_once('.').unwrap_or((digits, ""));
        self.bytes(first.as_bytes());
        self.bytes(rest.as_bytes());
    }
}
