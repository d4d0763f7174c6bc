//! A matrix as a rotation after a stretch: `A = R S`, S symmetric (polar decomposition).

use glam::{DMat3, DQuat, DVec3};

/// How far from the identity `A^T A` may be for A to be taken for a rotation.
const RIGID: f64 = 1e-6;

/// Sweeps of Jacobi's rotations; four suffice, more cost nothing once it has converged.
const SWEEPS: usize = 12;

/// The rotation R nearest to `a`, and S where it is not the identity.
///
/// Where `a` mirrors, S does. Where it flattens, R is one of the rotations that are equally near.
pub(super) fn rotation_and_stretch(a: DMat3) -> (DQuat, Option<DMat3>) {
    let gram = a.transpose() * a;
    if gram.abs_diff_eq(DMat3::IDENTITY, RIGID) && a.determinant() > 0.0 {
        return (DQuat::from_mat3(&a).normalize(), None);
    }
    let (u, v) = orthogonal_factors(a);
    let rotation = u * v.transpose();
    (DQuat::from_mat3(&rotation).normalize(), Some(rotation.transpose() * a))
}

/// Rotations U and V with `U^T A V` diagonal, by one-sided Jacobi rotations: columns of A V made orthogonal.
fn orthogonal_factors(a: DMat3) -> (DMat3, DMat3) {
    let (mut av, mut v) = (a, DMat3::IDENTITY);
    for (p, q) in (0..SWEEPS).flat_map(|_| [(0, 1), (0, 2), (1, 2)]) {
        let (x, y) = (av.col(p), av.col(q));
        let overlap = x.dot(y);
        if overlap.abs() <= f64::EPSILON * (x.length() * y.length()) {
            continue;
        }
        let zeta = (y.length_squared() - x.length_squared()) / (2.0 * overlap);
        let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
        let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
        turn_columns(&mut av, p, q, cosine, tangent * cosine);
        turn_columns(&mut v, p, q, cosine, tangent * cosine);
    }
    (right_handed(av), v)
}

fn turn_columns(m: &mut DMat3, p: usize, q: usize, cosine: f64, sine: f64) {
    let (x, y) = (m.col(p), m.col(q));
    *m.col_mut(p) = x * cosine - y * sine;
    *m.col_mut(q) = x * sine + y * cosine;
}

/// A rotation whose columns point as those of `m`, which are orthogonal, do: the shortest, which may be none at all,
/// gives way to what the two others leave it.
fn right_handed(m: DMat3) -> DMat3 {
    let lengths = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| lengths[b].total_cmp(&lengths[a]));
    let [first, second, last] = order;
    let x = m.col(first).try_normalize().unwrap_or(DVec3::X);
    let y = m.col(second) - x * x.dot(m.col(second));
    let y = y.try_normalize().filter(|_| lengths[second] > 1e-12 * lengths[first]);
    let y = y.unwrap_or_else(|| x.any_orthonormal_vector());
    let is_even = (second + 3 - first) % 3 == 1;
    let mut rotation = DMat3::IDENTITY;
    *rotation.col_mut(first) = x;
    *rotation.col_mut(second) = y;
    *rotation.col_mut(last) = if is_even { x.cross(y) } else { y.cross(x) };
    rotation
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn matrix() -> impl Strategy<Value = DMat3> {
        prop::array::uniform9(-2.0_f64..2.0).prop_map(|m| DMat3::from_cols_array(&m))
    }

    proptest! {
        #[test]
        fn a_matrix_is_its_rotation_after_its_stretch(a in matrix()) {
            let (rotation, stretch) = rotation_and_stretch(a);
            let stretch = stretch.unwrap_or(DMat3::IDENTITY);
            prop_assert!((DMat3::from_quat(rotation) * stretch).abs_diff_eq(a, 1e-9));
            prop_assert!(stretch.abs_diff_eq(stretch.transpose(), 1e-9));
        }

        #[test]
        fn no_rotation_is_nearer(a in matrix(), axis in prop::array::uniform3(-1.0_f64..1.0), angle in 0.01_f64..3.0) {
            let Some(axis) = DVec3::from(axis).try_normalize() else { return Ok(()) };
            let distance = |q: DQuat| (a - DMat3::from_quat(q)).to_cols_array().iter().map(|x| x * x).sum::<f64>();
            let (rotation, _) = rotation_and_stretch(a);
            prop_assert!(distance(rotation) <= distance(DQuat::from_axis_angle(axis, angle) * rotation) + 1e-9);
        }
    }

    #[test]
    fn flat_and_mirrored_matrices_have_a_rotation_too() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::new(2.0, 0.0, 3.0), DVec3::new(-1.0, 1.0, 1.0)];
        for a in flat.map(DMat3::from_diagonal) {
            let (rotation, stretch) = rotation_and_stretch(a);
            assert!(rotation.is_normalized());
            assert!((DMat3::from_quat(rotation) * stretch.unwrap()).abs_diff_eq(a, 1e-12));
        }
    }
}
