//! What blended numbers do to a vertex, written once for numbers and for registers of them. (No closures: only
//! functions are inlined into those that have an instruction set.)

use crate::lanes::Lanes;
use crate::rotation::cross;

/// The upper three rows of an affine matrix.
pub(super) type Matrix<L> = [[L; 4]; 3];

/// `M v`.
#[inline(always)]
pub(super) fn transform<L: Lanes>(m: &Matrix<L>, v: [L; 3]) -> [L; 3] {
    [transform_row(m[0], v), transform_row(m[1], v), transform_row(m[2], v)]
}

#[inline(always)]
fn transform_row<L: Lanes>(row: [L; 4], v: [L; 3]) -> L {
    (row[0] * v[0] + row[1] * v[1]) + (row[2] * v[2] + row[3])
}

/// The direction of a normal under `M`: by the inverse transpose of its linear part, of length 1; of length 0 where
/// `M` flattens.
///
/// The inverse transpose is the matrix of cofactors, `[b x c, c x a, a x b]` for the rows a, b, c, over the
/// determinant, of which only the sign matters.
#[inline(always)]
pub(super) fn transform_normal<L: Lanes<Real = f32>>(m: &Matrix<L>, n: [L; 3]) -> [L; 3] {
    let [[ax, ay, az, _], [bx, by, bz, _], [cx, cy, cz, _]] = *m;
    let (a, b, c) = ([ax, ay, az], [bx, by, bz], [cx, cy, cz]);
    let bc = cross(b, c);
    let turned = [dot(bc, n), dot(cross(c, a), n), dot(cross(a, b), n)];
    let determinant = dot(a, bc);
    let length = determinant.abs() * dot(turned, turned).sqrt();
    // An f32 this small is lost in any length but 0.
    let scale = determinant / (length + L::splat(f32::MIN_POSITIVE));
    [turned[0] * scale, turned[1] * scale, turned[2] * scale]
}

/// `v` moved by the dual quaternion `r + eps d`, of any length: `v + 2 (r x (r x v + w v + d) + w d - d_w r) / r.r`,
/// r and d without their real parts w and d_w. Source: Kavan et al. 2007, Algorithm 1.
#[inline(always)]
pub(super) fn move_by<L: Lanes<Real = f32>>([r, d]: [[L; 4]; 2], v: [L; 3]) -> [L; 3] {
    let ([x, y, z, w], [dx, dy, dz, dw]) = (r, d);
    let turn = cross([x, y, z], v);
    let inner = [turn[0] + w * v[0] + dx, turn[1] + w * v[1] + dy, turn[2] + w * v[2] + dz];
    let outer = cross([x, y, z], inner);
    let way = [outer[0] + (w * dx - dw * x), outer[1] + (w * dy - dw * y), outer[2] + (w * dz - dw * z)];
    along(v, two_over_square(r), way)
}

/// `v` turned by the quaternion `r`, of any length.
#[inline(always)]
pub(super) fn turn_by<L: Lanes<Real = f32>>(r: [L; 4], v: [L; 3]) -> [L; 3] {
    let [x, y, z, w] = r;
    let turn = cross([x, y, z], v);
    let way = cross([x, y, z], [turn[0] + w * v[0], turn[1] + w * v[1], turn[2] + w * v[2]]);
    along(v, two_over_square(r), way)
}

/// `a - b`.
#[inline(always)]
pub(super) fn subtract<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + b`.
#[inline(always)]
pub(super) fn add<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn two_over_square<L: Lanes<Real = f32>>(r: [L; 4]) -> L {
    L::splat(2.0) / crate::rotation::dot(r, r)
}

#[inline(always)]
fn along<L: Lanes>(v: [L; 3], scale: L, way: [L; 3]) -> [L; 3] {
    [v[0] + scale * way[0], v[1] + scale * way[1], v[2] + scale * way[2]]
}

#[inline(always)]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
