//! A register of numbers: the same arithmetic on one, four, eight or sixteen frames at a time.
//!
//! Kernels are written once, over [`Lanes`]; each instruction set has a file that says what a register is there.
//! Nothing here fuses a multiplication with an addition, so every width gives the same bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

mod scalar;

/// A register that holds the same quantity of [`Lanes::WIDTH`] frames.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The number in one lane.
    type Real: Real;

    /// How many frames a register holds.
    const WIDTH: usize;

    /// `value` in every lane.
    fn splat(value: Self::Real) -> Self;

    /// The square root of every lane, correctly rounded.
    #[must_use]
    fn sqrt(self) -> Self;
}

/// `f32` or `f64`: a number, and a register of one lane.
pub trait Real: Lanes<Real = Self> + PartialOrd + Default + Send + Sync + 'static {
    /// Zero.
    const ZERO: Self;

    /// One.
    const ONE: Self;

    /// The nearest number of this width.
    fn from_f64(value: f64) -> Self;

    /// The same number as `f64`.
    fn to_f64(self) -> f64;
}
