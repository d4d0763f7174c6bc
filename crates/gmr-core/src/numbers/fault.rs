//! What can be wrong with a block of numbers, and where.

use std::fmt;
use std::ops::Range;

/// Why the reading of a block ended early.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// What is wrong.
    pub flaw: Flaw,
    /// Row in which it is, from 0; blank lines are no rows.
    pub row: usize,
    /// Value of that row at which it is, from 0.
    pub field: usize,
    /// The bytes that it is about; empty where something is missing.
    pub token: Range<usize>,
}

/// What is wrong with a value or a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flaw {
    /// The token is no decimal number.
    NotANumber,
    /// The number is too large for an `f64`.
    Overflow,
    /// The line ends before the row has all its values.
    RowTooShort,
    /// The line goes on after the row has all its values.
    RowTooLong,
    /// The text ends inside the row: it has too few values, or its last token stops where a number could go on.
    Cut,
}

impl Flaw {
    /// A word for it, the same in every release.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NotANumber => "not a number",
            Self::Overflow => "overflow",
            Self::RowTooShort => "row too short",
            Self::RowTooLong => "row too long",
            Self::Cut => "cut",
        }
    }
}

impl Fault {
    /// 1-based number of the line on which the fault lies in `text`.
    #[must_use]
    pub fn line(&self, text: &[u8]) -> usize {
        let before = &text[..self.token.start.min(text.len())];
        let mut previous = 0;
        let mut lines = 1;
        for &byte in before {
            lines += usize::from(byte == b'\r' || byte == b'\n' && previous != b'\r');
            previous = byte;
        }
        lines
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (row, field, at) = (self.row + 1, self.field + 1, self.token.start);
        write!(f, "row {row}, value {field}, byte {at}: {}", self.flaw.name())
    }
}

impl std::error::Error for Fault {}
