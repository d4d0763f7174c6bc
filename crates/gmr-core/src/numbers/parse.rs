//! Rows of numbers from text.

use super::fault::{Fault, Flaw};
use super::scalar::{self, Token, is_blank, is_line_end};
use crate::{Isa, ShapeError};
use std::ops::Range;

/// A block of numbers, one row a line.
#[derive(Debug, Clone, Copy)]
pub struct ParseRows<'a> {
    /// The whole text, so that places in it mean something to whoever reads an error.
    pub text: &'a [u8],
    /// Where the block begins.
    pub start: usize,
    /// Values in a row.
    pub columns: usize,
}

/// How far the reading of a block came.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowsRead {
    /// Rows that are whole.
    pub rows: usize,
    /// Byte after the last whole row's last value, where nothing is wrong.
    pub end: usize,
    /// What ended the reading before `out` was full and before the text ended.
    pub fault: Option<Fault>,
}

impl ParseRows<'_> {
    /// The most rows that can begin in the rest of the text, whatever a header declares.
    #[must_use]
    pub fn most_rows(&self) -> usize {
        let left = self.text.len().saturating_sub(self.start);
        if self.columns == 0 { 0 } else { left.div_ceil(2).div_ceil(self.columns) }
    }

    /// Reads rows into `out`, `(rows, columns)`, until it is full, the text ends, or something is wrong.
    ///
    /// # Errors
    /// When `out` does not hold whole rows. Faults of the text are part of the result.
    pub fn run(&self, out: &mut [f64]) -> Result<RowsRead, ShapeError> {
        self.run_on(Isa::current(), out)
    }

    /// [`Self::run`] with a chosen instruction set, for tests.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_on(&self, isa: Isa, out: &mut [f64]) -> Result<RowsRead, ShapeError> {
        let whole = out.len().checked_div(self.columns).unwrap_or(0) * self.columns;
        ShapeError::check("out", whole, out.len())?;
        if out.is_empty() {
            return Ok(RowsRead { rows: 0, end: self.start, fault: None });
        }
        Ok(match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 | Isa::Avx512 if isa.is_available() => super::avx2::rows(self, out),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => super::neon::rows(self, out),
            _ => rows(self, out, |_, at, _, _| (0, at)),
        })
    }
}

/// The loop of every instruction set. Of a text, a place in it, and room whose first so many values are wanted, `fast`
/// says how many values it has put there, and where the last one ends; none where the scalar reader must look.
///
/// `fast` may take a token only where the scalar reader gives the same value and end, and skip only blanks between
/// them. What it writes into the room beyond them will be written anew, or does not count.
#[inline(always)]
pub(super) fn rows(
    job: &ParseRows<'_>,
    out: &mut [f64],
    fast: impl Fn(&[u8], usize, &mut [f64], usize) -> (usize, usize),
) -> RowsRead {
    let ParseRows { text, columns, .. } = *job;
    let mut end = job.start;
    for row in 0..out.len() / columns {
        let stop = |end: usize, fault: Option<Fault>| RowsRead { rows: row, end, fault };
        let mut at = row_start(text, end);
        if at == text.len() {
            return stop(end, None);
        }
        let mut field = 0;
        while field < columns {
            let room = &mut out[row * columns + field..];
            let (count, next) = match fast(text, at, room, columns - field) {
                (0, _) => match scalar::read(text, at) {
                    Token::Value(number, next) => {
                        room[0] = number;
                        (1, next)
                    }
                    other => return stop(end, Some(fault(text, row, field, other))),
                },
                read => read,
            };
            field += count;
            at = skip_blanks(text, next);
        }
        if text.get(at).is_some_and(|&byte| !is_line_end(byte)) && !is_padding(text, at) {
            let rest = at..line_end(text, at);
            return stop(end, Some(Fault { flaw: Flaw::RowTooLong, row, field: columns, token: rest }));
        }
        end = at;
    }
    RowsRead { rows: out.len() / columns, end, fault: None }
}

/// What [`rows`] asks for, by a reader of one number.
#[inline(always)]
pub(super) fn one(read: Option<(f64, usize)>, at: usize, room: &mut [f64]) -> (usize, usize) {
    let Some((value, end)) = read else { return (0, at) };
    room[0] = value;
    (1, end)
}

/// Number of lines from `start` on that hold more than blanks and padding.
#[must_use]
pub fn count_rows(text: &[u8], start: usize) -> usize {
    let empty = |byte: &u8| is_blank(*byte) || PADDING.contains(byte);
    let rest = text.get(start..).unwrap_or_default();
    rest.split(|&byte| is_line_end(byte)).filter(|line| !line.iter().all(empty)).count()
}

#[inline(always)]
pub(super) fn skip_blanks(text: &[u8], mut at: usize) -> usize {
    while text.get(at).is_some_and(|&byte| is_blank(byte)) {
        at += 1;
    }
    at
}

/// The next token after any number of blank lines; the end of the text where only padding is left.
#[inline(always)]
pub(super) fn row_start(text: &[u8], mut at: usize) -> usize {
    while text.get(at).is_some_and(|&byte| is_blank(byte) || is_line_end(byte)) {
        at += 1;
    }
    if is_padding(text, at) { text.len() } else { at }
}

/// NUL, with which some programs fill up a file's last block, and the end-of-file mark of old systems.
const PADDING: [u8; 2] = [0, 0x1a];

/// Whether only padding is left from `at` on.
#[inline(always)]
pub(super) fn is_padding(text: &[u8], at: usize) -> bool {
    text.get(at).is_some_and(|byte| PADDING.contains(byte)) && all_padding(&text[at..])
}

#[cold]
fn all_padding(rest: &[u8]) -> bool {
    rest.iter().all(|&byte| PADDING.contains(&byte) || is_blank(byte) || is_line_end(byte))
}

pub(super) fn line_end(text: &[u8], at: usize) -> usize {
    text[at..].iter().position(|&byte| is_line_end(byte)).map_or(text.len(), |length| at + length)
}

#[cold]
fn fault(text: &[u8], row: usize, field: usize, token: Token) -> Fault {
    let (flaw, token) = match token {
        Token::Value(_, end) => (Flaw::NotANumber, end..end),
        Token::Overflow(token) => (Flaw::Overflow, token),
        Token::Other(token) => (flaw(text, &token), token),
    };
    Fault { flaw, row, field, token }
}

fn flaw(text: &[u8], token: &Range<usize>) -> Flaw {
    let at_end = row_start(text, token.end) == text.len();
    if token.is_empty() || is_padding(text, token.start) {
        return if at_end { Flaw::Cut } else { Flaw::RowTooShort };
    }
    if token.end == text.len() && may_go_on(&text[token.clone()]) { Flaw::Cut } else { Flaw::NotANumber }
}

/// Whether a number could begin with these bytes, which are none: `-`, `1.5e`, `1.5e-`.
pub(super) fn may_go_on(token: &[u8]) -> bool {
    let mut longer = token.to_vec();
    longer.push(b'0');
    matches!(scalar::read(&longer, 0), Token::Value(..) | Token::Overflow(_))
}
