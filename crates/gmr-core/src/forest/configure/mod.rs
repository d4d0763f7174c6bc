//! A motion carried from one configuration of its skeleton to another, in one pass over the frames.

use std::collections::HashSet;

use crate::Isa;
use crate::error::{JobError, ShapeError};
use crate::kinematics::{self, ForwardKinematics, Pose, World};
use crate::lanes::{Real, cache};
use crate::parallel::{for_each_piece, thread_count};

use super::Forest;

mod block;
mod plan;
mod scalar;

use block::Frames;
use plan::Plan;

/// The job: the frames of a motion in one configuration, wanted in another.
#[derive(Debug, Clone, Copy)]
pub struct Configure<'a, T> {
    /// The configuration that the frames are in.
    pub from: &'a Forest,
    /// The one that they are wanted in; of the same forest at home.
    pub to: &'a Forest,
    /// (J, 3): the bones' vectors in `from`, where they are the same in all frames.
    pub offsets: &'a [f64],
    /// (T,): the joints that are translated per frame in `from`; all its roots are among them.
    pub translated: &'a [i32],
    /// The frames.
    pub pose: Pose<'a, T>,
    /// F.
    pub frame_count: usize,
    /// (P,): the slots of `to` whose rotations are wanted; `None`: all.
    pub slots: Option<&'a [i32]>,
    /// The joints whose translations are wanted, as far as they are translated in `to`; `None`: all.
    pub joints: Option<&'a [i32]>,
    /// How many threads share the frames; 0: all cores. The bits do not depend on it.
    pub threads: usize,
}

/// Where the answer goes.
#[derive(Debug)]
pub struct Configured<'a, T> {
    /// (F, P, 4): local rotations of the slots of `to` that are wanted.
    pub rotations: &'a mut [T],
    /// (F, U, 3): translations of the joints that [`Configure::translated_after`] lists.
    pub translations: &'a mut [T],
}

impl<T: Real> Configure<'_, T> {
    /// (U,): of the joints wanted those that are translated per frame in `to`, in their order: its roots, those whose
    /// bones are translated in `from`, and those whose bones are cut in `from` and whole in `to`.
    #[must_use]
    pub fn translated_after(&self) -> Vec<i32> {
        let mut found = plan::translated_after(self.from, self.to, self.translated);
        if let Some(joints) = self.joints {
            let wanted: HashSet<i32> = joints.iter().copied().collect();
            found.retain(|joint| wanted.contains(joint));
        }
        found
    }

    fn kinematics<'b>(&'b self, joints: &'b [i32], slots: &'b [i32]) -> ForwardKinematics<'b, T> {
        ForwardKinematics {
            topology: self.from.topology(),
            offsets: self.offsets,
            translated: self.translated,
            pose: self.pose,
            frame_count: self.frame_count,
            joints: Some(joints),
            rotation_slots: Some(slots),
            threads: self.threads,
        }
    }
}

/// Computes the frames in the other configuration.
///
/// Numbers that both configurations hold are copied. A root's translation is its position; the translation of a bone
/// that was cut is `W^-1 (P - P_parent)`, which is its offset unless somebody edited the motion in between; a slot's
/// rotation is `W_above^-1 W_own`. Source: spec "General Motion Representation", shift root, split tree, join trees.
///
/// # Errors
/// When a length does not fit, an index points outside its array, a root of `from` is not translated, or the two are
/// configurations of different forests.
pub fn configure<T: Real>(job: &Configure<'_, T>, out: Configured<'_, T>) -> Result<(), JobError> {
    let isa = if job.frame_count < 4 { Isa::Scalar } else { Isa::current() };
    configure_on(isa, job, out)
}

/// [`configure`] on a given instruction set. All give the same bits.
///
/// # Errors
/// As there; and when this machine cannot run `isa`.
pub fn configure_on<T: Real>(
    isa: Isa,
    job: &Configure<'_, T>,
    out: Configured<'_, T>,
) -> Result<(), JobError> {
    if !isa.is_available() {
        return Err(JobError::Isa(isa));
    }
    let wanted = plan::wanted(job)?;
    let solving = job.kinematics(&wanted.joints, &wanted.slots);
    let plan = Plan::new(&solving, job, &wanted)?;
    kinematics::check_poses(&solving)?;
    let (rotation_width, translation_width) = (plan.turns.len() * 4, plan.vectors.len() * 3);
    ShapeError::check("rotations out", job.frame_count * rotation_width, out.rotations.len())?;
    ShapeError::check("translations out", job.frame_count * translation_width, out.translations.len())?;

    let is_large = cache::is_large(out.rotations) || cache::is_large(out.translations);
    let one_thread = thread_count(job.threads, usize::MAX) == 1;
    let piece = if one_thread { job.frame_count } else { kinematics::FRAMES_PER_PIECE };
    let rotations = kinematics::cut(Some(out.rotations), piece * rotation_width);
    let translations = kinematics::cut(Some(out.translations), piece * translation_width);
    for_each_piece(job.frame_count.div_ceil(piece.max(1)), job.threads, |index| {
        let frames = index * piece..job.frame_count.min((index + 1) * piece);
        let out = World {
            rotations: kinematics::take(&rotations, index),
            positions: kinematics::take(&translations, index),
        };
        T::dispatch(isa, Frames { job: &solving, plan: &plan, frames, out, is_large });
    });
    Ok(())
}
