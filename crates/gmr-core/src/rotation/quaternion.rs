//! Quaternion algebra, written once for numbers and for registers of them.

use crate::lanes::{Lanes, Real};

/// No rotation.
pub const IDENTITY_F32: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

/// No rotation.
pub const IDENTITY_F64: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// The rotation `a` after `b`: `a b`.
#[inline(always)]
#[must_use]
pub fn multiply<L: Lanes>([ax, ay, az, aw]: [L; 4], [bx, by, bz, bw]: [L; 4]) -> [L; 4] {
    [
        aw * bx + ax * bw + (ay * bz - az * by),
        aw * by + ay * bw + (az * bx - ax * bz),
        aw * bz + az * bw + (ax * by - ay * bx),
        aw * bw - ax * bx - (ay * by + az * bz),
    ]
}

/// `q` times the rotation about one axis (0: x, 1: y, 2: z) whose half angle has this sine and cosine.
#[inline(always)]
#[must_use]
pub fn multiply_axis<L: Lanes>([x, y, z, w]: [L; 4], axis: u8, sin: L, cos: L) -> [L; 4] {
    match axis {
        0 => [x * cos + w * sin, y * cos + z * sin, z * cos - y * sin, w * cos - x * sin],
        1 => [x * cos - z * sin, y * cos + w * sin, z * cos + x * sin, w * cos - y * sin],
        _ => [x * cos + y * sin, y * cos - x * sin, z * cos + w * sin, w * cos - z * sin],
    }
}

/// `v` turned by the unit quaternion `q`: `v + 2w (u x v) + 2u x (u x v)`.
#[inline(always)]
#[must_use]
pub fn rotate<L: Lanes>([x, y, z, w]: [L; 4], v: [L; 3]) -> [L; 3] {
    let half = cross([x, y, z], v);
    let t = [half[0] + half[0], half[1] + half[1], half[2] + half[2]];
    let turned = cross([x, y, z], t);
    [v[0] + w * t[0] + turned[0], v[1] + w * t[1] + turned[1], v[2] + w * t[2] + turned[2]]
}

/// The rotation `b` as seen from the frame `a`: `a^-1 b`, of unit quaternions.
#[inline(always)]
#[must_use]
pub fn multiply_inverse<L: Lanes>([ax, ay, az, aw]: [L; 4], [bx, by, bz, bw]: [L; 4]) -> [L; 4] {
    [
        aw * bx - ax * bw - (ay * bz - az * by),
        aw * by - ay * bw - (az * bx - ax * bz),
        aw * bz - az * bw - (ax * by - ay * bx),
        aw * bw + ax * bx + (ay * by + az * bz),
    ]
}

/// `v` as seen from the frame `q`, a unit quaternion: [`rotate`] by its inverse.
#[inline(always)]
#[must_use]
pub fn rotate_inverse<L: Lanes>([x, y, z, w]: [L; 4], v: [L; 3]) -> [L; 3] {
    let half = cross([x, y, z], v);
    let t = [half[0] + half[0], half[1] + half[1], half[2] + half[2]];
    let turned = cross([x, y, z], t);
    [v[0] - w * t[0] + turned[0], v[1] - w * t[1] + turned[1], v[2] - w * t[2] + turned[2]]
}

/// The inverse of a unit quaternion.
#[must_use]
pub fn conjugate<T: Real>([x, y, z, w]: [T; 4]) -> [T; 4] {
    [-x, -y, -z, w]
}

/// The cosine of half the angle between two rotations (negative: the longer way round).
#[inline(always)]
#[must_use]
pub fn dot<L: Lanes>([ax, ay, az, aw]: [L; 4], [bx, by, bz, bw]: [L; 4]) -> L {
    (ax * bx + ay * by) + (az * bz + aw * bw)
}

/// `q` divided by its length; NaN for a quaternion of zeros, which names no rotation.
#[inline(always)]
#[must_use]
pub fn normalize<L: Lanes>(q: [L; 4]) -> [L; 4] {
    let inverse = L::splat(<L::Real as Real>::ONE) / dot(q, q).sqrt();
    [q[0] * inverse, q[1] * inverse, q[2] * inverse, q[3] * inverse]
}

/// `q`, whose length is one but for rounding, made one more exactly: Newton's step for `|q| = 1`.
///
/// A chain of rotations adds up what their lengths are off, and rotations solved from chains would hand it on.
#[inline(always)]
#[must_use]
pub fn straighten<L: Lanes>(q: [L; 4]) -> [L; 4] {
    let half = L::splat(L::Real::from_f64(0.5));
    let scale = L::splat(L::Real::from_f64(1.5)) - half * dot(q, q);
    [q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale]
}

/// The rotation by `v`: about its direction, by its length in radians.
#[must_use]
pub fn exp<T: Real>(v: impl Into<[T; 3]>) -> [T; 4] {
    let [x, y, z] = v.into().map(Real::to_f64);
    let angle = (x * x + y * y + z * z).sqrt();
    // sin(a/2)/a, whose limit at 0 is 1/2: the next term, a^2/48, is lost to rounding below 1e-4.
    let scale = if angle < 1e-4 { 0.5 - angle * angle / 48.0 } else { (0.5 * angle).sin() / angle };
    [x * scale, y * scale, z * scale, (0.5 * angle).cos()].map(T::from_f64)
}

/// The rotation vector of a unit quaternion, at most half a turn long: the inverse of [`exp`].
#[must_use]
pub fn log<T: Real>(q: impl Into<[T; 4]>) -> [T; 3] {
    let [x, y, z, w] = q.into().map(Real::to_f64);
    let (x, y, z, w) = if w < 0.0 { (-x, -y, -z, -w) } else { (x, y, z, w) };
    let sine = (x * x + y * y + z * z).sqrt();
    let scale = if sine < 1e-8 { 2.0 } else { 2.0 * sine.atan2(w) / sine };
    [x * scale, y * scale, z * scale].map(T::from_f64)
}

#[inline(always)]
pub(crate) fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3, Quat, Vec3};
    use proptest::prelude::*;

    fn unit() -> impl Strategy<Value = DQuat> {
        prop::array::uniform4(-1.0_f64..1.0)
            .prop_filter("no direction", |q| q.iter().map(|c| c * c).sum::<f64>() > 1e-3)
            .prop_map(|q| DQuat::from_array(q).normalize())
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-3.0_f64..3.0).prop_map(DVec3::from)
    }

    proptest! {
        #[test]
        fn products_and_turned_vectors_are_glams(a in unit(), b in unit(), v in vector()) {
            prop_assert!(DQuat::from_array(multiply(a.to_array(), b.to_array())).abs_diff_eq(a * b, 1e-14));
            prop_assert!(DVec3::from(rotate(a.to_array(), v.to_array())).abs_diff_eq(a * v, 1e-13));
            let seen = DQuat::from_array(multiply_inverse(a.to_array(), b.to_array()));
            prop_assert!(seen.abs_diff_eq(a.inverse() * b, 1e-14));
            let back = DVec3::from(rotate_inverse(a.to_array(), v.to_array()));
            prop_assert!(back.abs_diff_eq(a.inverse() * v, 1e-13));
        }

        #[test]
        fn a_turn_about_an_axis_is_a_product(q in unit(), axis in 0_u8..3, angle in -7.0_f64..7.0) {
            let about = DQuat::from_axis_angle(DVec3::AXES[axis as usize], angle);
            let (sin, cos) = (0.5 * angle).sin_cos();
            let turned = DQuat::from_array(multiply_axis(q.to_array(), axis, sin, cos));
            prop_assert!(turned.abs_diff_eq(q * about, 1e-14));
        }

        #[test]
        fn log_undoes_exp_up_to_half_a_turn(v in vector()) {
            let v = v.clamp_length_max(std::f64::consts::PI - 1e-3);
            prop_assert!(DVec3::from(log(exp(v))).abs_diff_eq(v, 1e-12));
            prop_assert!(DQuat::from_array(exp(v)).abs_diff_eq(DQuat::from_scaled_axis(v), 1e-14));
        }

        #[test]
        fn log_undoes_exp_for_tiny_turns(v in vector(), scale in -12_i32..-3) {
            let v = v * 10.0_f64.powi(scale);
            prop_assert!(DVec3::from(log(exp(v))).abs_diff_eq(v, 1e-15));
        }
    }

    #[test]
    fn glams_types_pass_the_border() {
        let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
        assert!(Vec3::from(log(quarter)).abs_diff_eq(Vec3::Y * std::f32::consts::FRAC_PI_2, 1e-6));
        assert_eq!(Quat::from_array(exp(Vec3::ZERO)), Quat::IDENTITY);
    }
}
