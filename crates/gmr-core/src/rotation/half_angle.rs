//! Sine and cosine of half an angle, in registers.

use crate::lanes::{Doubles, Lanes, Real};

/// Beyond this many degrees, squared, whole turns are taken off one number at a time.
const LARGE_SQUARED: f64 = (1_u64 << 40) as f64 * (1_u64 << 40) as f64;

/// Adding and subtracting it rounds to a whole number, ties to even: 1.5 * 2^52.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Halves, in radians, of angles in degrees without their whole turns, which are taken off in `f64` degrees, where that
/// is exact; four angles at a time, and a look at their size in the end.
pub(super) struct Halves<D> {
    squares: D,
}

impl<D: Doubles> Halves<D> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { squares: D::splat(0.0) }
    }

    /// The halves of four angles, which are right if no angle [`Self::had_large`].
    #[inline(always)]
    pub(super) fn of<L: Lanes<Doubles = D>>(&mut self, [a, b, c, d]: [D; 4]) -> [L; 4] {
        self.squares = self.squares + ((a * a + b * b) + (c * c + d * d));
        [half(a), half(b), half(c), half(d)]
    }

    /// Whether one of the angles was large, or none.
    #[inline(always)]
    pub(super) fn had_large(&self) -> bool {
        !self.squares.all_at_most(LARGE_SQUARED)
    }
}

/// The halves of four angles, however large.
#[inline(always)]
pub(super) fn halves_of_large<L: Lanes>([a, b, c, d]: [L::Doubles; 4]) -> [L; 4] {
    let small = |degrees: L::Doubles| degrees.changed(without_turns);
    [half(small(a)), half(small(b)), half(small(c)), half(small(d))]
}

/// The coefficients of sine and cosine side by side, a register for each, those of the highest power first.
///
/// A step of Horner's scheme waits for the one before. Eight sums that take their steps together leave the processor
/// enough to do meanwhile; that the steps lie in memory keeps the compiler from taking each sum's in one go.
pub(crate) struct Steps<L> {
    /// The cosine's first, for which the sine has none.
    first: L,
    steps: Vec<[L; 2]>,
}

impl<L: Lanes> Steps<L> {
    pub(crate) fn new() -> Self {
        let (sine, cosine) = (L::Real::SINE, L::Real::COSINE);
        let pairs = sine.iter().zip(cosine).map(|(&s, &c)| [L::splat(s), L::splat(c)]);
        assert_eq!(cosine.len(), sine.len() + 1, "coefficients of the cosine");
        Self { first: L::splat(cosine[sine.len()]), steps: pairs.rev().collect() }
    }

    /// Sines and cosines of four angles between -pi/2 and pi/2, within 2e-7 (f32) or 6e-16 (f64).
    #[inline(always)]
    pub(super) fn sines_and_cosines(&self, x: [L; 4]) -> [[L; 2]; 4] {
        let square = [x[0] * x[0], x[1] * x[1], x[2] * x[2], x[3] * x[3]];
        let [sine, cosine] = self.steps[0];
        let (mut a, mut b, mut c, mut d) = (sine, sine, sine, sine);
        let start = |square: L| self.first * square + cosine;
        let (mut e, mut f, mut g, mut h) = (start(square[0]), start(square[1]), start(square[2]), start(square[3]));
        for &[sine, cosine] in std::hint::black_box(&self.steps[1..]) {
            (a, b, c, d) = (a * square[0] + sine, b * square[1] + sine, c * square[2] + sine, d * square[3] + sine);
            (e, f, g, h) =
                (e * square[0] + cosine, f * square[1] + cosine, g * square[2] + cosine, h * square[3] + cosine);
        }
        [[x[0] * a, e], [x[1] * b, f], [x[2] * c, g], [x[3] * d, h]]
    }
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
pub(super) fn half_angle_of<T: Real>(degrees: f64) -> [T; 2] {
    let degrees = degrees.changed(without_turns);
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
