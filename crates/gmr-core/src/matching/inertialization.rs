//! Inertialisation: at a jump the difference between what was shown and what comes is kept, and dies away.
//!
//! An offset obeys a critically damped spring towards zero, in closed form; what is shown is the offset put on top of
//! the animation. At a jump the offset and its velocity are chosen so that what is shown goes on with the same value
//! and the same velocity. A rotation's offset is a rotation vector `d`, shown = `exp(d) q`; angular velocities are in
//! the frame that the rotation maps to, and that of what is shown is `J(d) d' + exp(d) w`, with J the left Jacobian of
//! the rotation group: taking `d' + w` in its place, as is common, kinks fast turns.
//! Sources: Bollo, "Inertialization", GDC 2018; Holden, "Spring-It-On" for the closed form and the names.

use std::f64::consts::LN_2;
use std::ops::{Add, Mul, Sub};

use glam::{DQuat, DVec3};

/// What a spring can act on: numbers and vectors.
pub trait Linear: Copy + Default + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> {}
impl<T: Copy + Default + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>> Linear for T {}

/// A value and its rate of change.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moving<T> {
    /// The value.
    pub value: T,
    /// Its change a second.
    pub velocity: T,
}

/// A rotation and its angular velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// The rotation.
    pub rotation: DQuat,
    /// Radians a second about the axes of the frame that the rotation maps to.
    pub velocity: DVec3,
}

/// A critically damped spring towards zero over one fixed step.
#[derive(Debug, Clone, Copy)]
pub struct DecaySpring {
    /// Half the damping, 1/s.
    rate: f64,
    step: f64,
    /// `exp(-rate step)`.
    decay: f64,
}

impl DecaySpring {
    /// The spring of this half-life, over steps of `step`, both in seconds and above 0.
    #[must_use]
    pub fn new(half_life: f64, step: f64) -> Self {
        let rate = 2.0 * LN_2 / half_life;
        Self { rate, step, decay: (-rate * step).exp() }
    }

    /// The offset one step later: `x'' = -2 y x' - y^2 x`, solved.
    #[must_use]
    pub fn decay_spring_damper_exact<T: Linear>(&self, offset: Moving<T>) -> Moving<T> {
        let pull = offset.velocity + offset.value * self.rate;
        Moving {
            value: (offset.value + pull * self.step) * self.decay,
            velocity: (offset.velocity - pull * (self.rate * self.step)) * self.decay,
        }
    }
}

/// The offset that makes `to`, from now on, continue what `from` with the old offset has shown.
#[must_use]
pub fn inertialize_transition<T: Linear>(offset: Moving<T>, from: Moving<T>, to: Moving<T>) -> Moving<T> {
    let shown = inertialize_update(offset, from);
    Moving { value: shown.value - to.value, velocity: shown.velocity - to.velocity }
}

/// What is shown: the animation with the offset on top.
#[must_use]
pub fn inertialize_update<T: Linear>(offset: Moving<T>, animation: Moving<T>) -> Moving<T> {
    Moving { value: offset.value + animation.value, velocity: offset.velocity + animation.velocity }
}

/// As [`inertialize_transition`], for rotations; the offset goes the shortest way, at most half a turn.
#[must_use]
pub fn inertialize_transition_rotation(offset: Moving<DVec3>, from: Turning, to: Turning) -> Moving<DVec3> {
    let shown = inertialize_update_rotation(offset, from);
    let value = log(shown.rotation * to.rotation.conjugate());
    let left_to_offset = shown.velocity - exp(value) * to.velocity;
    Moving { value, velocity: inverse_left_jacobian(value, left_to_offset) }
}

/// As [`inertialize_update`], for rotations.
#[must_use]
pub fn inertialize_update_rotation(offset: Moving<DVec3>, animation: Turning) -> Turning {
    let turn = exp(offset.value);
    Turning {
        rotation: turn * animation.rotation,
        velocity: left_jacobian(offset.value, offset.velocity) + turn * animation.velocity,
    }
}

/// The rotation about `vector` by its length.
#[must_use]
pub fn exp(vector: DVec3) -> DQuat {
    let half = 0.5 * vector.length();
    let scale = if half < SMALL { 0.5 - half * half / 12.0 } else { 0.5 * half.sin() / half };
    let part = vector * scale;
    DQuat::from_xyzw(part.x, part.y, part.z, half.cos())
}

/// The shortest rotation vector of a unit quaternion, of length at most pi.
#[must_use]
pub fn log(rotation: DQuat) -> DVec3 {
    let q = if rotation.w < 0.0 { -rotation } else { rotation };
    let sine = q.xyz().length();
    let scale = if sine == 0.0 { 2.0 } else { 2.0 * sine.atan2(q.w) / sine };
    q.xyz() * scale
}

/// Below this, the first terms of a series do as well as the closed form, which cancels there.
const SMALL: f64 = 1e-4;

/// `J(d) v`: the angular velocity of `exp(d)` when d changes at v.
fn left_jacobian(d: DVec3, v: DVec3) -> DVec3 {
    let angle = d.length();
    let (first, second) = if angle < SMALL {
        (0.5, 1.0 / 6.0)
    } else {
        let half_sine = (0.5 * angle).sin();
        (2.0 * half_sine * half_sine / (angle * angle), (angle - angle.sin()) / (angle * angle * angle))
    };
    let across = d.cross(v);
    v + across * first + d.cross(across) * second
}

/// `J(d)^-1 w`, for `|d|` below a full turn.
fn inverse_left_jacobian(d: DVec3, w: DVec3) -> DVec3 {
    let half = 0.5 * d.length();
    let second = if half < SMALL { 1.0 / 12.0 } else { (1.0 - half / half.tan()) / (4.0 * half * half) };
    let across = d.cross(w);
    w - across * 0.5 + d.cross(across) * second
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn vector(limit: f64) -> impl Strategy<Value = DVec3> {
        (-limit..limit, -limit..limit, -limit..limit).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    fn moving(value: f64, velocity: f64) -> impl Strategy<Value = Moving<DVec3>> {
        (vector(value), vector(velocity)).prop_map(|(value, velocity)| Moving { value, velocity })
    }

    fn turning() -> impl Strategy<Value = Turning> {
        (vector(3.0), vector(6.0)).prop_map(|(v, velocity)| Turning { rotation: exp(v), velocity })
    }

    fn later(offset: Moving<DVec3>, time: f64) -> Moving<DVec3> {
        DecaySpring::new(0.1, time).decay_spring_damper_exact(offset)
    }

    /// An animation that keeps turning at its present angular velocity.
    fn turned(animation: Turning, time: f64) -> Turning {
        Turning { rotation: exp(animation.velocity * time) * animation.rotation, ..animation }
    }

    fn angle_between(a: DQuat, b: DQuat) -> f64 {
        log(a * b.conjugate()).length()
    }

    proptest! {
        #[test]
        fn the_spring_solves_its_equation(offset in moving(1.0, 5.0), time in 0.01..0.5_f64) {
            let (y, h) = (2.0 * LN_2 / 0.1, 1e-5);
            let [before, now, after] = [time - h, time, time + h].map(|t| later(offset, t));
            let velocity = (after.value - before.value) / (2.0 * h);
            let acceleration = (after.velocity - before.velocity) / (2.0 * h);
            prop_assert!((velocity - now.velocity).length() < 1e-5);
            prop_assert!((acceleration + now.velocity * (2.0 * y) + now.value * (y * y)).length() < 1e-3);
        }

        #[test]
        fn two_half_steps_make_a_whole_one(offset in moving(1.0, 5.0), time in 0.001..0.5_f64) {
            let halves = later(later(offset, time / 2.0), time / 2.0);
            let whole = later(offset, time);
            prop_assert!((halves.value - whole.value).length() < 1e-12);
            prop_assert!((halves.velocity - whole.velocity).length() < 1e-11);
        }

        #[test]
        fn a_transition_keeps_value_and_velocity(old in moving(1.0, 5.0), from in moving(2.0, 5.0), to in moving(2.0, 5.0)) {
            let new = inertialize_transition(old, from, to);
            let (before, after) = (inertialize_update(old, from), inertialize_update(new, to));
            prop_assert!((before.value - after.value).length() < 1e-14);
            prop_assert!((before.velocity - after.velocity).length() < 1e-14);
        }

        #[test]
        fn a_rotation_keeps_value_and_velocity_through_a_transition(
            old in moving(1.0, 5.0), from in turning(), to in turning(),
        ) {
            let new = inertialize_transition_rotation(old, from, to);
            let (before, after) = (inertialize_update_rotation(old, from), inertialize_update_rotation(new, to));
            prop_assert!(angle_between(before.rotation, after.rotation) < 1e-12);
            prop_assert!((before.velocity - after.velocity).length() < 1e-8, "{before:?} {after:?}");
            prop_assert!(new.value.length() <= PI + 1e-12);
        }

        /// The shown velocity is not only what the formula says: it is the slope of what is shown.
        #[test]
        fn the_shown_angular_velocity_is_the_slope_of_the_shown_rotation(offset in moving(1.0, 5.0), animation in turning()) {
            let h = 1e-6;
            let shown = inertialize_update_rotation(offset, animation);
            let next = inertialize_update_rotation(later(offset, h), turned(animation, h));
            let slope = log(next.rotation * shown.rotation.conjugate()) / h;
            prop_assert!((slope - shown.velocity).length() < 1e-2, "{slope} {}", shown.velocity);
        }

        #[test]
        fn log_undoes_exp_within_half_a_turn(v in vector(1.8)) {
            prop_assert!((log(exp(v)) - v).length() < 1e-12);
            prop_assert!((log(-exp(v)) - v).length() < 1e-12);
        }

        #[test]
        fn the_jacobians_are_inverse(d in vector(1.8), v in vector(5.0)) {
            prop_assert!((inverse_left_jacobian(d, left_jacobian(d, v)) - v).length() < 1e-9);
        }
    }

    #[test]
    fn half_of_an_offset_is_gone_near_the_half_life_and_all_of_it_soon() {
        let offset = Moving { value: 1.0, velocity: 0.0 };
        // With no velocity at the start a critically damped spring lags the pure exponential: (1 + y t) exp(-y t).
        let half = DecaySpring::new(0.1, 0.1).decay_spring_damper_exact(offset).value;
        assert!((half - (1.0 + 2.0 * LN_2) / 4.0).abs() < 1e-15);
        assert!(DecaySpring::new(0.1, 1.0).decay_spring_damper_exact(offset).value < 2e-5);
    }

    #[test]
    fn small_rotations_have_no_seam() {
        for length in [0.99999e-4, 1.00001e-4, 1.99999e-4, 2.00001e-4] {
            let v = DVec3::new(0.6, 0.0, 0.8) * length;
            assert!((log(exp(v)) - v).length() < 1e-19);
        }
    }
}
