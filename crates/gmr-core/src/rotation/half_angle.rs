//! Sine and cosine of half an angle, in registers.

use crate::lanes::{Doubles, Lanes, Real};

/// Beyond this many degrees, squared, whole turns are taken off one number at a time.
const LARGE_SQUARED: f64 = (1_u64 << 40) as f64 * (1_u64 << 40) as f64;

/// Adding and subtracting it rounds to a whole number, ties to even: 1.5 * 2^52.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Half of each of four angles in degrees, without its whole turns, in radians: right unless [`is_large`].
#[inline(always)]
pub(super) fn halves<L: Lanes>([a, b, c, d]: [L::Doubles; 4]) -> [L; 4] {
    [half(a), half(b), half(c), half(d)]
}

/// What [`is_large`] is to be asked, of four angles or of a sum over many.
#[inline(always)]
pub(super) fn squares<D: Doubles>([a, b, c, d]: [D; 4]) -> D {
    (a * a + b * b) + (c * c + d * d)
}

/// Whether there may be a large angle behind these squares; so it is where there is NaN.
#[inline(always)]
pub(super) fn is_large<D: Doubles>(squares: D) -> bool {
    !squares.all_at_most(LARGE_SQUARED)
}

/// Four angles without whole turns, where they are large.
#[inline(always)]
pub(super) fn without_turns<D: Doubles>([a, b, c, d]: [D; 4]) -> [D; 4] {
    [a.changed(take_turns), b.changed(take_turns), c.changed(take_turns), d.changed(take_turns)]
}

/// The coefficients of sine and cosine side by side, a register for each, those of the highest power first.
///
/// A step of Horner's scheme waits for the one before. Eight sums that take their steps together leave the processor
/// enough to do meanwhile; that the steps lie in memory keeps the compiler from taking each sum's in one go.
pub(crate) struct Steps<L> {
    /// The cosine's first; the sine has one power less.
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

    /// Sines and cosines of four angles between -pi/2 and pi/2, within 2e-7 (f32) or 6e-16 (f64); of NaN NaN.
    #[inline(always)]
    pub(super) fn sines_and_cosines(&self, x: [L; 4]) -> [[L; 2]; 4] {
        let square = [x[0] * x[0], x[1] * x[1], x[2] * x[2], x[3] * x[3]];
        let [sine, cosine] = self.steps[0];
        let (mut a, mut b, mut c, mut d) = (sine, sine, sine, sine);
        let start = |square: L| self.first * square + cosine;
        let (mut e, mut f, mut g, mut h) =
            (start(square[0]), start(square[1]), start(square[2]), start(square[3]));
        for &[sine, cosine] in std::hint::black_box(&self.steps[1..]) {
            (a, b, c, d) =
                (a * square[0] + sine, b * square[1] + sine, c * square[2] + sine, d * square[3] + sine);
            (e, f, g, h) = (
                e * square[0] + cosine,
                f * square[1] + cosine,
                g * square[2] + cosine,
                h * square[3] + cosine,
            );
        }
        [[x[0] * a, e], [x[1] * b, f], [x[2] * c, g], [x[3] * d, h]]
    }
}

/// Takes whole turns off the large angles; exact.
#[cold]
#[inline(never)]
fn take_turns(degrees: &mut [f64]) {
    degrees.iter_mut().filter(|angle| **angle * **angle > LARGE_SQUARED).for_each(|angle| *angle %= 720.0);
}

/// Half of an angle in degrees without its whole turns, in radians. They are taken off in `f64` degrees, where that is
/// exact.
#[inline(always)]
fn half<L: Lanes>(degrees: L::Doubles) -> L {
    let number = L::Doubles::splat;
    let turns = (degrees * number(1.0 / 360.0) + number(ROUNDER)) - number(ROUNDER);
    let rest = degrees - turns * number(360.0);
    L::narrow(rest * number(std::f64::consts::PI / 360.0))
}

/// Sine and cosine of half of an angle in degrees, in plain numbers, up to a sign that both share: those of an angle
/// between -180 and 180 degrees that turns alike. NaN and infinities give NaN.
pub(super) fn half_angle_of<T: Real>(degrees: f64) -> [T; 2] {
    let x = half::<T>(if is_large(degrees * degrees) { degrees.changed(take_turns) } else { degrees });
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
