//! Blocks of text numbers to `f64` rows and back, bit-exact.
//!
//! - [`ParseRows`]: text, one row a line, to values; every finite decimal gives the nearest `f64`, as `str::parse` does.
//! - [`FormatRows`]: values to text, each as the shortest decimal that reads back bit-identical.
//! - [`ParseFrames`], [`FormatFrames`]: the same for frames of an AMC file, whose lines begin with a bone's name.
//!
//! A token ends at any byte up to `' '`; blanks are space, tab, vertical tab and form feed; a line ends at `\n`, `\r`
//! or both. Lines without a token count for nothing, nor do NUL bytes and end-of-file marks after the last row. What is
//! no finite decimal number is a [`Fault`].

mod amc;
mod fault;
mod format;
mod layout;
mod parse;
mod scalar;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "aarch64")]
mod neon;
#[cfg(target_arch = "x86_64")]
mod window;

#[cfg(test)]
mod amc_tests;
#[cfg(test)]
mod tests;

pub use amc::{Bone, FormatFrames, FrameFault, FrameFlaw, FramesRead, ParseFrames, Places};
pub use fault::{Fault, Flaw};
pub use format::{FormatRows, NotFinite};
pub use parse::{ParseRows, RowsRead, count_rows};
