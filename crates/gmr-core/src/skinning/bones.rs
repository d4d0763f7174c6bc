//! What a frame's transforms are for blending: a row of numbers for each joint.

use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};

use super::lines::Row;
use super::method::{Hemisphere, Method};
use super::polar::rotation_and_stretch;
use super::{Skin, SkinError};

/// The joints of a frame.
#[derive(Debug, Default)]
pub(super) struct Bones {
    /// The transforms' upper three rows.
    pub(super) linear: Vec<Row>,
    /// Dual quaternions, the real part, then the dual one: of each joint, or of the second of each pair of the skin,
    /// with the sign that makes it point as the first does.
    pub(super) dual: Vec<Row>,
    /// Scale and shear, three rows of which the last number is 0; empty where no joint has any.
    pub(super) residual: Vec<Row>,
}

impl Bones {
    /// Those of a frame's (B, 4, 4) transforms.
    pub(super) fn new(skin: &Skin, transforms: &[f64], method: Method<'_>) -> Self {
        let matrices: Vec<DMat4> = transforms.as_chunks::<16>().0.iter().map(affine).collect();
        let mut bones = Self::default();
        if !matches!(method, Method::DualQuaternion(_)) {
            bones.linear = matrices.iter().map(linear_row).collect();
        }
        if !matches!(method, Method::Linear) {
            let parts: Vec<(DQuat, Option<DMat3>)> =
                matrices.iter().map(|m| rotation_and_stretch(DMat3::from_mat4(*m))).collect();
            let dual =
                |joint: usize, sign| dual_row(parts[joint].0 * sign, matrices[joint].w_axis.truncate());
            bones.dual = match method {
                Method::DualQuaternion(Hemisphere::Running) => {
                    (0..parts.len()).map(|joint| dual(joint, 1.0)).collect()
                }
                _ => skin
                    .arrangement
                    .pairs
                    .iter()
                    .map(|pair| pair.map(|joint| joint as usize))
                    .map(|[pivot, joint]| dual(joint, sign(parts[pivot].0, parts[joint].0)))
                    .collect(),
            };
            if parts.iter().any(|(_, stretch)| stretch.is_some()) {
                bones.residual = parts.iter().map(|(_, stretch)| residual_row(stretch)).collect();
            }
        }
        bones
    }
}

/// Checks that the last row of every transform is `0 0 0 1`; NaN passes, for it comes out again.
pub(super) fn check(transforms: &[f64], joint_count: usize) -> Result<(), SkinError> {
    let is_affine = |m: &[f64; 16]| {
        m[12..15].iter().all(|x| x.is_nan() || x.abs() <= 1e-6)
            && (m[15].is_nan() || (m[15] - 1.0).abs() <= 1e-6)
    };
    match transforms.as_chunks::<16>().0.iter().position(|m| !is_affine(m)) {
        Some(at) => Err(SkinError::NotAffine { frame: at / joint_count, joint: at % joint_count }),
        None => Ok(()),
    }
}

/// From rows as NumPy has them.
fn affine(rows: &[f64; 16]) -> DMat4 {
    DMat4::from_cols_array(rows).transpose()
}

fn linear_row(m: &DMat4) -> Row {
    rows([0, 1, 2].map(|axis| m.row(axis)))
}

fn residual_row(stretch: &Option<DMat3>) -> Row {
    let stretch = stretch.unwrap_or(DMat3::IDENTITY);
    rows([0, 1, 2].map(|axis| stretch.row(axis).extend(0.0)))
}

/// `r + eps/2 t r`. Source: Kavan et al. 2007, Eq. 3; the spec's correction of the printed Eq. 10.
fn dual_row(r: DQuat, t: DVec3) -> Row {
    let d = DQuat::from_xyzw(t.x, t.y, t.z, 0.0) * r * 0.5;
    rows([r.into(), d.into(), DVec4::ZERO])
}

fn rows(three: [DVec4; 3]) -> Row {
    let mut row = Row::ZERO;
    for (four, numbers) in row.0.as_chunks_mut::<4>().0.iter_mut().zip(three) {
        *four = numbers.as_vec4().to_array();
    }
    row
}

fn sign(a: DQuat, b: DQuat) -> f64 {
    if a.dot(b) < 0.0 { -1.0 } else { 1.0 }
}
