//! Forward kinematics: from local rotations to world positions and rotations, many frames at once.
//!
//! Per frame: a slot's world rotation is that of the slot above it times its own, `W_s = W_above(s) R_s`; a joint's
//! position is its parent's plus its bone's vector turned by the bone's slot, `P_j = P_parent(j) + W_s(j) t_j`; a
//! root's position is its translation. Source: the General Motion Representation.
//!
//! `scalar` is the definition, one frame at a time; `block` does the same for as many frames at once as a register
//! holds, and every instruction set gives the same bits.

use std::sync::Mutex;

use crate::Isa;
use crate::error::{JobError, ShapeError};
use crate::lanes::{Real, cache};
use crate::parallel::{for_each_piece, thread_count};
use crate::rotation::EulerColumns;
use crate::skeleton::Topology;

pub(crate) mod block;
pub(crate) mod plan;
mod roots;
pub(crate) mod scalar;
pub(crate) mod source;
#[cfg(test)]
mod tests;

use block::Frames;
use plan::Plan;
use roots::Parts;

/// Where the rotations and translations of each frame come from.
#[derive(Debug, Clone, Copy)]
pub enum Pose<'a, T> {
    /// Local rotations as quaternions, and the vectors of the translated joints.
    Quaternions {
        /// (F, S, 4): local rotation of each slot.
        rotations: &'a [T],
        /// Divide each rotation by its length. Else they must be unit to rounding: a length of 1 + e scales the
        /// bones below by about 1 + 2e.
        normalize: bool,
        /// (F, T, 3): a root's place in the world, another joint's vector from its parent in the frame of its slot.
        translations: &'a [T],
    },
    /// Rows as files hold them: Euler angles in degrees, and positions.
    Rows {
        /// (F, C).
        rows: &'a [f64],
        /// C.
        column_count: usize,
        /// The angles of each slot.
        angles: EulerColumns<'a>,
        /// (T, 3): the columns of x, y and z of each translated joint; -1: the offset's component.
        translation_columns: &'a [[i32; 3]],
        /// Whether these columns are added to the joint's offset (else they replace it).
        adds_offset: bool,
    },
}

/// The job: which skeleton, which poses, and what is asked of them.
#[derive(Debug, Clone, Copy)]
pub struct ForwardKinematics<'a, T> {
    /// Parents and slots.
    pub topology: &'a Topology,
    /// (J, 3): the vector from its parent to each joint (a root: its place), where it is not translated per frame.
    pub offsets: &'a [f64],
    /// (T,): the joints that are translated per frame; of one listed twice the last counts.
    pub translated: &'a [i32],
    /// Their poses.
    pub pose: Pose<'a, T>,
    /// F.
    pub frame_count: usize,
    /// (K,): the joints whose positions are asked for; `None`: all.
    pub joints: Option<&'a [i32]>,
    /// (M,): the slots whose world rotations are asked for, -1: the identity; `None`: all.
    pub rotation_slots: Option<&'a [i32]>,
    /// How many threads share the frames; 0: all cores. The bits do not depend on it.
    pub threads: usize,
}

/// Where the answer goes.
#[derive(Debug)]
pub struct World<'a, T> {
    /// (F, K, 3): world positions.
    pub positions: Option<&'a mut [T]>,
    /// (F, M, 4): world rotations.
    pub rotations: Option<&'a mut [T]>,
}

/// Computes what `world` has room for.
///
/// NaN in a pose gives NaN in what hangs below it in that frame, and nothing else.
///
/// # Errors
/// When a length does not fit, an index points outside its array, or a slot that turns no bone is asked for.
pub fn forward_kinematics<T: Real>(
    job: &ForwardKinematics<'_, T>,
    world: World<'_, T>,
) -> Result<(), JobError> {
    // A register that is mostly empty is slower than plain numbers, and its scratch larger than the input.
    let isa = if job.frame_count < 4 { Isa::Scalar } else { Isa::current() };
    forward_kinematics_on(isa, job, world)
}

/// [`forward_kinematics`] on a given instruction set. All give the same bits.
///
/// # Errors
/// As there; and when this machine cannot run `isa`.
pub fn forward_kinematics_on<T: Real>(
    isa: Isa,
    job: &ForwardKinematics<'_, T>,
    world: World<'_, T>,
) -> Result<(), JobError> {
    if !isa.is_available() {
        return Err(JobError::Isa(isa));
    }
    let joints = plan::asked_joints(job, world.positions.is_some())?;
    let parts = Parts::new(job, &joints)?;
    let solving = ForwardKinematics { joints: Some(&parts.solved), ..*job };
    let plan = Plan::new(&solving, world.positions.is_some(), world.rotations.is_some())?;
    check_poses(job)?;
    let (position_width, rotation_width) = (joints.len() * 3, plan.slots_out.len() * 4);
    if let Some(positions) = &world.positions {
        ShapeError::check("positions", job.frame_count * position_width, positions.len())?;
    }
    if let Some(rotations) = &world.rotations {
        ShapeError::check("rotations out", job.frame_count * rotation_width, rotations.len())?;
    }

    let is_copied = plan.joints_out.is_empty() && plan.slots_out.is_empty();
    let is_large = world.positions.as_deref().is_some_and(cache::is_large)
        || world.rotations.as_deref().is_some_and(cache::is_large);
    let piece = if thread_count(job.threads, usize::MAX) == 1 { job.frame_count } else { FRAMES_PER_PIECE };
    let positions = cut(world.positions, piece * position_width);
    let rotations = cut(world.rotations, piece * rotation_width);
    for_each_piece(job.frame_count.div_ceil(piece.max(1)), job.threads, |index| {
        let frames = index * piece..job.frame_count.min((index + 1) * piece);
        let world = World { positions: take(&positions, index), rotations: take(&rotations, index) };
        if is_copied {
            parts.copy_all(job, frames, world);
        } else {
            T::dispatch(isa, Frames { job, plan: &plan, parts: &parts, frames, world, is_large });
        }
    });
    Ok(())
}

/// What a thread takes at a time: a whole number of blocks of every instruction set.
pub(crate) const FRAMES_PER_PIECE: usize = 1024;

/// A piece of an array, until a thread takes it.
pub(crate) type Piece<'a, T> = Mutex<Option<&'a mut [T]>>;

pub(crate) fn cut<T>(array: Option<&mut [T]>, length: usize) -> Vec<Piece<'_, T>> {
    array.map_or(vec![], |array| {
        array.chunks_mut(length.max(1)).map(|piece| Mutex::new(Some(piece))).collect()
    })
}

pub(crate) fn take<'a, T>(pieces: &[Piece<'a, T>], index: usize) -> Option<&'a mut [T]> {
    pieces.get(index)?.lock().ok()?.take()
}

pub(crate) fn check_poses<T: Real>(job: &ForwardKinematics<'_, T>) -> Result<(), JobError> {
    let slot_count = job.topology.slot_count();
    match job.pose {
        Pose::Quaternions { rotations, translations, .. } => {
            ShapeError::check("rotations", job.frame_count * slot_count * 4, rotations.len())?;
            ShapeError::check(
                "translations",
                job.frame_count * job.translated.len() * 3,
                translations.len(),
            )?;
        }
        Pose::Rows { rows, column_count, angles, translation_columns, .. } => {
            ShapeError::check("rows", job.frame_count * column_count, rows.len())?;
            ShapeError::check("rotation_columns", slot_count * 3, angles.columns.len() * 3)?;
            ShapeError::check(
                "translation_columns",
                job.translated.len() * 3,
                translation_columns.len() * 3,
            )?;
            angles.check(column_count)?;
            let columns = translation_columns.as_flattened();
            crate::rotation::check_indices("translation_columns", columns, column_count)?;
        }
    }
    Ok(())
}
