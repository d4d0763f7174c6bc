//! Where a character stands on the ground: a point and a heading.
//!
//! Points are `(x, z)` in metres. Heading `th` looks along `(sin th, cos th)`: 0 is +Z, and it grows counter-clockwise
//! seen from above, from +Z towards +X. Headings are not wrapped: two full turns to the left read 4 pi.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use glam::DVec2;

/// What the simulation root does from a row to the next one of its clip.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// Displacement on the ground, `x` to the left and `z` forward, in the row's character frame, metres.
    pub displacement: [f32; 2],
    /// Change of heading, radians, positive counter-clockwise seen from above.
    pub turn: f32,
}

impl From<[f32; 3]> for Step {
    fn from([x, z, turn]: [f32; 3]) -> Self {
        Self { displacement: [x, z], turn }
    }
}

impl From<Step> for [f32; 3] {
    fn from(Step { displacement: [x, z], turn }: Step) -> Self {
        [x, z, turn]
    }
}

/// A point of the ground and the heading there.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Placement {
    /// `(x, z)` in metres.
    pub position: DVec2,
    /// Radians, unwrapped.
    pub heading: f64,
}

impl Placement {
    /// At `(x, z)`, looking along `heading`.
    #[must_use]
    pub fn new(x: f64, z: f64, heading: f64) -> Self {
        Self { position: DVec2::new(x, z), heading }
    }

    /// The unit vector that the heading looks along.
    #[must_use]
    pub fn direction(&self) -> DVec2 {
        direction(self.heading)
    }

    /// A vector of this placement's frame (x left, z forward) in the world.
    #[must_use]
    pub fn rotate(&self, local: DVec2) -> DVec2 {
        let forward = self.direction();
        left_of(forward) * local.x + forward * local.y
    }

    /// A vector of the world in this placement's frame (x left, z forward).
    #[must_use]
    pub fn unrotate(&self, world: DVec2) -> DVec2 {
        let forward = self.direction();
        DVec2::new(left_of(forward).dot(world), forward.dot(world))
    }

    /// After a share (0 to 1) of a database row's step.
    #[must_use]
    pub fn moved(&self, step: Step, share: f64) -> Self {
        let [x, z] = step.displacement.map(f64::from);
        self.advanced(DVec2::new(x, z) * share, f64::from(step.turn) * share)
    }

    /// After a step of `displacement`, given in this placement's frame, and a turn.
    #[must_use]
    pub fn advanced(&self, displacement: DVec2, turn: f64) -> Self {
        Self { position: self.position + self.rotate(displacement), heading: self.heading + turn }
    }
}

/// The unit vector that `heading` looks along.
#[must_use]
pub fn direction(heading: f64) -> DVec2 {
    let (sin, cos) = sin_cos(heading);
    DVec2::new(sin, cos)
}

fn left_of(forward: DVec2) -> DVec2 {
    DVec2::new(forward.y, -forward.x)
}

/// Sine and cosine to within one unit in the last place for `|angle| < 1e8`, with the same bits on every machine.
///
/// The platform's own differ in the last bit between processors, which is enough to make a simulated trial take
/// another path. Reduction by multiples of pi/2 held in three parts (Cody and Waite), then the power series.
#[must_use]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let shifted = angle * FRAC_2_PI + ROUNDER;
    let quarter = shifted - ROUNDER;
    let r = ((angle - quarter * HALF_PI_HIGH) - quarter * HALF_PI_MIDDLE) - quarter * HALF_PI_LOW;
    let (sin, cos) = (r + r * series(&SINE, r * r), 1.0 + series(&COSINE, r * r));
    match shifted.to_bits() & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Added to a number below 2^51, it leaves no bits for a fraction: the sum is rounded, its last bits are the integer's.
const ROUNDER: f64 = 1.5 * (1_u64 << 52) as f64;

/// The leading 26 bits of pi/2, so that a multiple of it is exact.
const HALF_PI_HIGH: f64 = f64::from_bits(FRAC_PI_2.to_bits() & !0x7ff_ffff);
const HALF_PI_MIDDLE: f64 = FRAC_PI_2 - HALF_PI_HIGH;
/// What `FRAC_PI_2` lacks of pi/2.
const HALF_PI_LOW: f64 = 6.123_233_995_736_766e-17;

/// `(-1)^k / (2k + 1)!` for k = 1, 2, ...
const SINE: [f64; 8] = alternating_reciprocal_factorials(3);
/// `(-1)^k / (2k)!` for k = 1, 2, ...
const COSINE: [f64; 8] = alternating_reciprocal_factorials(2);

const fn alternating_reciprocal_factorials(first: u64) -> [f64; 8] {
    let mut terms = [0.0; 8];
    let (mut k, mut n, mut factorial, mut sign) = (0, 1, 1_u64, -1.0);
    while k < terms.len() {
        while n < first + 2 * k as u64 {
            n += 1;
            factorial *= n;
        }
        terms[k] = sign / factorial as f64;
        sign = -sign;
        k += 1;
    }
    terms
}

/// `sum of terms[k] square^(k + 1)`.
fn series(terms: &[f64; 8], square: f64) -> f64 {
    square * terms.iter().rev().fold(0.0, |sum, term| sum * square + term)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sine_and_cosine_agree_with_the_platform(angle in -1e4_f64..1e4) {
            let (sin, cos) = sin_cos(angle);
            prop_assert!((sin - angle.sin()).abs() <= 2.3e-16, "sin {angle}: {sin} {}", angle.sin());
            prop_assert!((cos - angle.cos()).abs() <= 2.3e-16, "cos {angle}: {cos} {}", angle.cos());
        }

        #[test]
        fn large_angles_stay_accurate(angle in -1e8_f64..1e8) {
            let (sin, cos) = sin_cos(angle);
            prop_assert!((sin - angle.sin()).abs() <= 1e-15);
            prop_assert!((cos - angle.cos()).abs() <= 1e-15);
        }

        #[test]
        fn unrotate_undoes_rotate(x in -9.0..9.0, z in -9.0..9.0, heading in -20.0..20.0) {
            let placement = Placement { position: DVec2::ZERO, heading };
            let there = placement.rotate(DVec2::new(x, z));
            prop_assert!((placement.unrotate(there) - DVec2::new(x, z)).length() < 1e-13);
        }
    }

    #[test]
    fn a_quarter_turn_to_the_left_looks_along_x() {
        assert!((direction(FRAC_PI_2) - DVec2::X).length() < 1e-15);
        assert_eq!(direction(0.0), DVec2::Y);
    }

    #[test]
    fn forward_steps_follow_the_heading() {
        let left = Placement { position: DVec2::new(1.0, 1.0), heading: FRAC_PI_2 };
        let stepped = left.advanced(DVec2::new(0.0, 2.0), 0.5);
        assert!((stepped.position - DVec2::new(3.0, 1.0)).length() < 1e-15);
        assert_eq!(stepped.heading, FRAC_PI_2 + 0.5);
    }
}
