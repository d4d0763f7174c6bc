//! A register of numbers: the same arithmetic on one, two, four, eight or sixteen frames at a time.
//!
//! Kernels are written once, over [`Lanes`]; each instruction set has a file that says what a register is there, and
//! [`Real::dispatch`] is the single place that chooses. Nothing here fuses a multiplication with an addition, and
//! every operation is correctly rounded, so every instruction set gives the same bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::Isa;

#[macro_use]
mod register;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
pub(crate) mod cache;
#[cfg(target_arch = "aarch64")]
mod neon;
mod pair;
pub(crate) mod rows;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod sse2;
#[cfg(test)]
mod tests;

/// A register that holds the same quantity of [`Lanes::WIDTH`] frames.
///
/// The types of an instruction set are reached through [`Real::dispatch`] only, which checks that the machine has it.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The number in one lane.
    type Real: Real;

    /// The same frames in `f64`.
    type Doubles: Doubles;

    /// How many frames a register holds.
    const WIDTH: usize;

    /// `value` in every lane.
    fn splat(value: Self::Real) -> Self;

    /// The square root of every lane.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Every lane without its sign.
    #[must_use]
    fn abs(self) -> Self;

    /// The first [`Lanes::WIDTH`] numbers of `source`, one in each lane.
    fn load(source: &[Self::Real]) -> Self;

    /// The inverse of [`Lanes::load`].
    fn store(self, target: &mut [Self::Real]);

    /// Copies whole cache lines to a place where one begins, past the caches if the instruction set can.
    fn stream(source: &[Self::Real], target: &mut [Self::Real]);

    /// Four consecutive numbers of [`Lanes::WIDTH`] rows that begin `stride` apart: a register for each column.
    fn load_columns(source: &[Self::Real], stride: usize) -> [Self; 4];

    /// The inverse of [`Lanes::load_columns`].
    fn store_columns(columns: [Self; 4], target: &mut [Self::Real], stride: usize);

    /// As [`Lanes::store_columns`], but each lane's four numbers become the row of `target` that `rows` names.
    /// Where two lanes name one row, the row may be either's.
    #[inline(always)]
    fn scatter_columns(columns: [Self; 4], target: &mut [[Self::Real; 4]], rows: &[u16]) {
        let mut fours = [[Self::Real::ZERO; 4]; 16];
        Self::store_columns(columns, fours.as_flattened_mut(), 4);
        for (four, &row) in fours[..Self::WIDTH].iter().zip(&rows[..Self::WIDTH]) {
            target[usize::from(row)] = *four;
        }
    }

    /// [`Lanes::load_columns`] of `f64` rows.
    fn load_doubles(source: &[f64], stride: usize) -> [Self::Doubles; 4];

    /// Every lane to the nearest number of this width.
    fn narrow(doubles: Self::Doubles) -> Self;
}

/// As many `f64` as a register of [`Lanes`] has frames.
pub trait Doubles: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// `value` in every lane.
    fn splat(value: f64) -> Self;

    /// Whether no lane is greater than `limit`, or NaN.
    fn all_at_most(self, limit: f64) -> bool;

    /// `change` applied to the lanes: for what is rare and need not be fast.
    #[must_use]
    fn changed(self, change: fn(&mut [f64])) -> Self;
}

/// Work written once for all registers of numbers `T`.
pub trait Kernel<T: Real> {
    /// Does the work with registers `L`. To be marked `#[inline(always)]`, as all that it calls with registers:
    /// only then is it compiled for the instruction set that it is dispatched to.
    fn run<L: Lanes<Real = T>>(self);

    /// Does the work in plain numbers. A kernel whose definition stands by itself runs that.
    fn run_plain(self)
    where
        Self: Sized,
    {
        self.run::<T>();
    }
}

/// `f32` or `f64`: a number, and a register of one lane.
pub trait Real:
    Lanes<Real = Self, Doubles = f64> + Neg<Output = Self> + PartialOrd + Default + Send + Sync + 'static
{
    /// Zero.
    const ZERO: Self;

    /// One.
    const ONE: Self;

    /// Coefficients in x^2 of sin(x)/x for |x| <= pi/2.
    const SINE: &'static [Self];

    /// Coefficients in x^2 of cos(x) for |x| <= pi/2.
    const COSINE: &'static [Self];

    /// The nearest number of this width.
    fn from_f64(value: f64) -> Self;

    /// The same number as `f64`.
    fn to_f64(self) -> f64;

    /// Runs `kernel` with the registers of `isa`, or of [`Isa::Scalar`] where this machine cannot run `isa`.
    fn dispatch(isa: Isa, kernel: impl Kernel<Self>);
}

/// Panics unless there are as many numbers on both sides, and whole cache lines of them in the target: the check
/// before raw stores past the caches, which must be aligned.
#[inline(always)]
fn check_lines<T>(source: &[T], target: &[T]) {
    assert!(
        source.len() == target.len()
            && target.as_ptr().addr().is_multiple_of(cache::LINE)
            && size_of_val(target).is_multiple_of(cache::LINE),
        "no whole cache lines"
    );
}

/// Panics unless rows of four numbers, `stride` apart, lie in so many numbers: the check before raw loads and stores.
#[inline(always)]
fn check_rows(rows: usize, stride: usize, length: usize) {
    assert!(
        stride <= isize::MAX as usize / 64 && (rows - 1) * stride + 4 <= length,
        "rows outside the array"
    );
}
