//! What each method does with the sums of a register of vertices.

use super::arrangement::{Arrangement, Follows, Run, WIDEST};
use super::formulas::{add, move_by, subtract, transform, transform_normal, turn_by};
use super::lines::Wide;
use super::sums::{At, Influences, Rows, dual_quaternion, matrix};
use super::work::Window;
use crate::lanes::Lanes;

/// What stays of the vertices of a register.
#[derive(Clone, Copy)]
pub(super) struct Rest<L> {
    pub(super) v: [L; 3],
    pub(super) n: [L; 3],
    pub(super) center: [L; 3],
    /// Whether any joint scales or shears in this frame.
    pub(super) is_stretched: bool,
}

/// A method.
pub(super) trait Blending {
    /// Whether there are centres of rotation.
    const ABOUT_CENTERS: bool = false;

    /// Whether there is a dual quaternion for each pair of a pivot and a joint.
    const IS_PAIRED: bool = true;

    /// The weights of a block with the signs that dual quaternions take, put into `room`; none where these do without.
    #[inline(always)]
    fn signed<'a>(
        _window: Window<'_>,
        _run: &Run,
        _block: usize,
        _room: &'a mut [Wide],
    ) -> Option<&'a [Wide]> {
        None
    }

    /// The vertices and their normals, blended: by dual quaternions.
    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
        influences: &mut I,
        at: At<'_>,
        rest: Rest<L>,
    ) -> ([L; 3], [L; 3]) {
        let (v, n) = stretched::<L, I, NORMALS>(influences, at, rest.v, rest);
        let q = dual_quaternion(influences, at);
        (move_by(q, v), if NORMALS { turn_by(q[0], n) } else { n })
    }
}

pub(super) struct Linear;
pub(super) struct Pivot;
pub(super) struct Running;
pub(super) struct Centers;

impl Blending for Linear {
    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
        influences: &mut I,
        at: At<'_>,
        rest: Rest<L>,
    ) -> ([L; 3], [L; 3]) {
        let m = matrix(influences, Rows::Linear, at);
        (transform(&m, rest.v), if NORMALS { transform_normal(&m, rest.n) } else { rest.n })
    }
}

impl Blending for Pivot {}

impl Blending for Running {
    const IS_PAIRED: bool = false;

    #[inline(always)]
    fn signed<'a>(window: Window<'_>, run: &Run, block: usize, room: &'a mut [Wide]) -> Option<&'a [Wide]> {
        let Window { work, bones, start, .. } = window;
        let (skin, count) = (work.skin, run.influence_count);
        let Arrangement { shared, own, .. } = &skin.arrangement;
        let signing = skin.lane(start, run, WIDEST * block).signing(&bones.dual);
        match run.follows {
            Follows::Same(at) => {
                let joints = &shared.joints[at..][..count];
                signing.sign_block(|k, _| joints[k], room);
            }
            Follows::Each(at) => {
                let joints = &own.joints[at + block * count..][..count];
                signing.sign_block(|k, lane| joints[k][lane], room);
            }
        }
        Some(&room[..count])
    }
}

impl Blending for Centers {
    const ABOUT_CENTERS: bool = true;

    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
        influences: &mut I,
        at: At<'_>,
        rest: Rest<L>,
    ) -> ([L; 3], [L; 3]) {
        let arm = subtract(rest.v, rest.center);
        let (arm, n) = stretched::<L, I, NORMALS>(influences, at, arm, rest);
        let m = matrix(influences, Rows::Linear, at);
        let q = dual_quaternion(influences, at)[0];
        (add(turn_by(q, arm), transform(&m, rest.center)), if NORMALS { turn_by(q, n) } else { n })
    }
}

/// `v` and the normal after scale and shear, where there are any.
#[inline(always)]
fn stretched<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
    influences: &mut I,
    at: At<'_>,
    v: [L; 3],
    rest: Rest<L>,
) -> ([L; 3], [L; 3]) {
    if !rest.is_stretched {
        return (v, rest.n);
    }
    let m = matrix(influences, Rows::Residual, at);
    (transform(&m, v), if NORMALS { transform_normal(&m, rest.n) } else { rest.n })
}
