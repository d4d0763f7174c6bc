//! Forward kinematics of as many frames at once as a register holds; the same numbers as [`super::scalar`].

use std::ops::Range;

use super::plan::Plan;
use super::source::{Quaternions, Rows, Source};
use super::{ForwardKinematics, Pose, World};
use crate::lanes::rows::{TargetRows, blocks};
use crate::lanes::{Kernel, Lanes, Real};
use crate::rotation::{multiply, rotate};

/// The frames of a job that one thread works on.
pub(super) struct Frames<'a, 'b, T> {
    pub(super) job: &'a ForwardKinematics<'b, T>,
    pub(super) plan: &'a Plan<T>,
    pub(super) frames: Range<usize>,
    /// Room for these frames only.
    pub(super) world: World<'a, T>,
    /// Whether the answer for all frames outgrows the caches.
    pub(super) is_large: bool,
}

impl<T: Real> Kernel<T> for Frames<'_, '_, T> {
    #[inline(always)]
    fn run<L: Lanes<Real = T>>(self) {
        match self.job.pose {
            Pose::Quaternions { .. } => each_block(Quaternions::<L>::new(self.job, self.plan), self),
            Pose::Rows { .. } => each_block(Rows::<L>::new(self.job, self.plan, &[]), self),
        }
    }
}

#[inline(always)]
fn each_block<L: Lanes, S: Source<L>>(mut source: S, work: Frames<'_, '_, L::Real>) {
    let Frames { plan, frames: range, world, is_large, .. } = work;
    let zero = L::splat(L::Real::ZERO);
    let mut rotations = vec![[zero, zero, zero, L::splat(L::Real::ONE)]; plan.turns.len()];
    let mut positions = vec![[zero; 3]; plan.bones.len()];
    let position_columns = columns(plan.joints_out.iter().copied(), 3);
    // The first turn is none: its rotation stays the identity.
    let rotation_columns = columns(plan.slots_out.iter().map(|turn| turn.unwrap_or(0)), 4);
    let mut positions_out =
        TargetRows::new(world.positions.unwrap_or(&mut []), position_columns.len(), is_large);
    let mut rotations_out =
        TargetRows::new(world.rotations.unwrap_or(&mut []), rotation_columns.len(), is_large);
    for block in blocks::<L>(range.len()) {
        source.load(range.start + block.start..range.start + block.end);
        solve(plan, &source, &mut rotations, &mut positions);
        write(&position_columns, positions.as_flattened(), &mut positions_out, &block);
        write(&rotation_columns, rotations.as_flattened(), &mut rotations_out, &block);
    }
}

/// The world rotation of every turn and the position of every bone's end.
#[inline(always)]
pub(crate) fn solve<L: Lanes, S: Source<L>>(
    plan: &Plan<L::Real>,
    source: &S,
    rotations: &mut [[L; 4]],
    positions: &mut [[L; 3]],
) {
    for (index, turn) in plan.turns.iter().enumerate() {
        source.prefetch(index, plan.turns.len());
        if let Some(slot) = turn.slot {
            let local = source.rotation(slot);
            rotations[index] = match turn.above {
                None => local,
                Some(above) => multiply(rotations[above], local),
            };
        }
        let rotation = rotations[index];
        for (bone, index) in plan.bones[turn.bones.clone()].iter().zip(turn.bones.clone()) {
            let vector = source.vector(bone);
            positions[index] = match bone.parent {
                None => vector,
                Some(parent) => {
                    let turned = if turn.slot.is_some() { rotate(rotation, vector) } else { vector };
                    add(positions[parent], turned)
                }
            };
        }
    }
}

#[inline(always)]
fn add<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Where each number of a row of the answer stands among the components computed.
pub(crate) fn columns(items: impl Iterator<Item = usize>, components: usize) -> Vec<usize> {
    items.flat_map(|item| components * item..components * (item + 1)).collect()
}

/// Writes these columns of `values`, four at a time; the last four overlap those before where they must.
#[inline(always)]
pub(crate) fn write<L: Lanes>(
    columns: &[usize],
    values: &[L],
    out: &mut TargetRows<'_, L::Real>,
    block: &Range<usize>,
) {
    if columns.is_empty() {
        return;
    }
    let last = columns.len() - 1;
    let (target, stride) = out.block(block, L::WIDTH);
    for group in (0..columns.len()).step_by(4).map(|column| column.min(columns.len().saturating_sub(4))) {
        let value = |k: usize| values[columns[last.min(group + k)]];
        L::store_columns([value(0), value(1), value(2), value(3)], &mut target[group..], stride);
    }
    out.finish(block, L::WIDTH);
}
