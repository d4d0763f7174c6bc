//! Sine and cosine of half an angle, in registers.

use crate::lanes::{Doubles, Lanes, Real};

/// Beyond this many degrees, squared, whole turns are taken off one number at a time.
const LARGE_SQUARED: f64 = (1_u64 << 40) as f64 * (1_u64 << 40) as f64;

/// Adding and subtracting it rounds to a whole number, ties to even: 1.5 * 2^52.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Sines and cosines of half of four angles in degrees, each pair up to a sign that both share: those of an angle
/// between -180 and 180 degrees that turns alike.
///
/// Whole turns are taken off in `f64` degrees, where that is exact; what is left goes through polynomials of the
/// register's own width, within 2e-7 (f32) or 6e-16 (f64). NaN and infinities give NaN.
#[inline(always)]
pub(super) fn half_angles<L: Lanes>(degrees: [L::Doubles; 4], steps: &Steps<L>) -> [[L; 2]; 4] {
    let [mut a, mut b, mut c, mut d] = degrees;
    if is_large(a) | is_large(b) | is_large(c) | is_large(d) {
        a = a.changed(without_turns);
        b = b.changed(without_turns);
        c = c.changed(without_turns);
        d = d.changed(without_turns);
    }
    let x: [L; 4] = [half(a), half(b), half(c), half(d)];
    let squared = [x[0] * x[0], x[1] * x[1], x[2] * x[2], x[3] * x[3]];
    let [sines, cosines] = steps.polynomials(squared);
    [
        [x[0] * sines[0], cosines[0]],
        [x[1] * sines[1], cosines[1]],
        [x[2] * sines[2], cosines[2]],
        [x[3] * sines[3], cosines[3]],
    ]
}

/// The coefficients of sine and cosine side by side, a register for each, those of the highest power first.
///
/// A step of Horner's scheme waits for the one before. Eight sums that take their steps together leave the processor
/// enough to do meanwhile; that the steps lie in memory keeps the compiler from taking each sum's in one go.
pub(crate) struct Steps<L>(Vec<[L; 2]>);

impl<L: Lanes> Steps<L> {
    pub(crate) fn new() -> Self {
        let (sine, cosine) = (L::Real::SINE, L::Real::COSINE);
        // A first step to zero makes the sum what it would begin with.
        let at =
            |power: usize| [sine, cosine].map(|c| L::splat(c.get(power).copied().unwrap_or(L::Real::ZERO)));
        Self((0..sine.len().max(cosine.len())).rev().map(at).collect())
    }

    /// Both polynomials of each of four numbers.
    #[inline(always)]
    fn polynomials(&self, x: [L; 4]) -> [[L; 4]; 2] {
        let zero = L::splat(L::Real::ZERO);
        let ([mut a, mut b, mut c, mut d], [mut e, mut f, mut g, mut h]) = ([zero; 4], [zero; 4]);
        for &[sine, cosine] in std::hint::black_box(&self.0[..]) {
            (a, b, c, d) = (a * x[0] + sine, b * x[1] + sine, c * x[2] + sine, d * x[3] + sine);
            (e, f, g, h) = (e * x[0] + cosine, f * x[1] + cosine, g * x[2] + cosine, h * x[3] + cosine);
        }
        [[a, b, c, d], [e, f, g, h]]
    }
}

#[inline(always)]
fn is_large<D: Doubles>(degrees: D) -> bool {
    (degrees * degrees).any_above(LARGE_SQUARED)
}

/// Takes whole turns off the large angles; exact.
#[cold]
#[inline(never)]
fn without_turns(degrees: &mut [f64]) {
    degrees.iter_mut().filter(|angle| **angle * **angle > LARGE_SQUARED).for_each(|angle| *angle %= 720.0);
}

/// Half of an angle in degrees without its whole turns, in radians.
#[inline(always)]
fn half<L: Lanes>(degrees: L::Doubles) -> L {
    let number = L::Doubles::splat;
    let turns = (degrees * number(1.0 / 360.0) + number(ROUNDER)) - number(ROUNDER);
    let rest = degrees - turns * number(360.0);
    L::narrow(rest * number(std::f64::consts::PI / 360.0))
}

/// [`half_angles`] of one plain number.
pub(super) fn half_angle_of<T: Real>(mut degrees: f64) -> [T; 2] {
    if is_large(degrees) {
        degrees = degrees.changed(without_turns);
    }
    let x = half::<T>(degrees);
    [x * polynomial(T::SINE, x * x), polynomial(T::COSINE, x * x)]
}

/// The polynomial with these coefficients, the constant first.
fn polynomial<T: Real>(coefficients: &[T], x: T) -> T {
    coefficients.iter().rev().fold(T::ZERO, |sum, &coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// How far off sine and cosine are, with the sign that suits them best.
    fn error<T: Real>(degrees: f64) -> f64 {
        let [sin, cos] = half_angle_of::<T>(degrees).map(Real::to_f64);
        let below_a_turn = degrees % 360.0;
        let rest = below_a_turn - 360.0 * (below_a_turn / 360.0).round();
        let (s, c) = (0.5 * rest.to_radians()).sin_cos();
        let off = |sign: f64| (sin - sign * s).abs().max((cos - sign * c).abs());
        off(1.0).min(off(-1.0))
    }

    proptest! {
        #[test]
        fn sines_and_cosines_are_those_of_the_standard_library(
            angle in -1000.0_f64..1000.0,
            scale in prop::sample::select(vec![1.0, 1e-6, 1e-300, 1e6]),
        ) {
            prop_assert!(error::<f32>(angle * scale) < 2e-7);
            prop_assert!(error::<f64>(angle * scale) < 6e-16);
        }

        #[test]
        fn huge_angles_lose_whole_turns_and_nothing_else(angle in -1e300_f64..1e300) {
            prop_assert!(error::<f64>(angle) < 6e-16);
        }
    }

    #[test]
    fn quarter_turns_are_within_rounding() {
        for quarter in -40..40 {
            assert!(error::<f32>(90.0 * f64::from(quarter)) < 2e-7);
            assert!(error::<f64>(90.0 * f64::from(quarter)) < 6e-16);
        }
    }

    #[test]
    fn no_angle_gives_no_number() {
        for angle in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(half_angle_of::<f32>(angle).iter().all(|x| x.is_nan()));
            assert!(half_angle_of::<f64>(angle).iter().all(|x| x.is_nan()));
        }
    }
}
