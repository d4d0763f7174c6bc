//! The definition of forward kinematics: one frame after the other, in plain numbers.

use std::ops::Range;

use super::plan::{Bone, Plan};
use super::roots::Parts;
use super::{ForwardKinematics, Pose, World};
use crate::lanes::Real;
use crate::rotation::{multiply, normalize, rotate};

/// Works on `frames`; `world` has room for these only.
pub(super) fn run<T: Real>(
    job: &ForwardKinematics<'_, T>,
    plan: &Plan<T>,
    parts: &Parts,
    frames: Range<usize>,
    mut world: World<'_, T>,
) {
    let mut rotations = vec![[T::ZERO; 4]; plan.turns.len()];
    let mut positions = vec![[T::ZERO; 3]; plan.bones.len()];
    for (row, frame) in frames.enumerate() {
        solve(job, plan, frame, &mut rotations, &mut positions);
        if let Some(out) = &mut world.positions {
            let room = &mut out[row * parts.width()..][..parts.width()];
            let solved = parts.places.iter().zip(&plan.joints_out);
            solved.for_each(|(&place, &bone)| room.as_chunks_mut::<3>().0[place] = positions[bone]);
            parts.copy(job, frame..frame + 1, room, parts.width());
        }
        if let Some(out) = &mut world.rotations {
            let room = &mut out.as_chunks_mut::<4>().0[row * plan.slots_out.len()..];
            room.iter_mut().zip(&plan.slots_out).for_each(|(q, turn)| {
                *q = turn.map_or([T::ZERO, T::ZERO, T::ZERO, T::ONE], |turn| rotations[turn]);
            });
        }
    }
}

/// The world rotation of every turn and the position of every bone's end in one frame.
pub(crate) fn solve<T: Real>(
    job: &ForwardKinematics<'_, T>,
    plan: &Plan<T>,
    frame: usize,
    rotations: &mut [[T; 4]],
    positions: &mut [[T; 3]],
) {
    for (index, turn) in plan.turns.iter().enumerate() {
        if let Some(slot) = turn.slot {
            let local = local_rotation(job, frame, slot);
            rotations[index] = turn.above.map_or(local, |above| multiply(rotations[above], local));
        }
        for bone in turn.bones.clone() {
            let vector = vector(job, frame, &plan.bones[bone]);
            positions[bone] = match plan.bones[bone].parent {
                None => vector,
                Some(parent) => {
                    let turned = turn.slot.map_or(vector, |_| rotate(rotations[index], vector));
                    std::array::from_fn(|axis| positions[parent][axis] + turned[axis])
                }
            };
        }
    }
}

pub(crate) fn local_rotation<T: Real>(job: &ForwardKinematics<'_, T>, frame: usize, slot: usize) -> [T; 4] {
    match job.pose {
        Pose::Quaternions { rotations, normalize: asked, .. } => {
            let q = rotations.as_chunks::<4>().0[frame * job.topology.slot_count() + slot];
            if asked { normalize(q) } else { q }
        }
        Pose::Rows { rows, column_count, angles, .. } => {
            angles.quaternion(slot, &rows[frame * column_count..][..column_count])
        }
    }
}

/// The vector of a bone before its slot turns it, or a root's place.
pub(crate) fn vector<T: Real>(job: &ForwardKinematics<'_, T>, frame: usize, bone: &Bone<T>) -> [T; 3] {
    let Some(place) = bone.translated else { return bone.offset };
    match job.pose {
        Pose::Quaternions { translations, .. } => {
            translations.as_chunks::<3>().0[frame * job.translated.len() + place]
        }
        Pose::Rows { rows, column_count, translation_columns, adds_offset, .. } => {
            std::array::from_fn(|axis| match usize::try_from(translation_columns[place][axis]) {
                Err(_) => bone.offset[axis],
                Ok(column) => {
                    let channel = T::from_f64(rows[frame * column_count + column]);
                    if adds_offset { bone.offset[axis] + channel } else { channel }
                }
            })
        }
    }
}
