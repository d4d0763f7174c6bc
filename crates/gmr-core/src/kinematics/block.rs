//! Forward kinematics of as many frames at once as a register holds; the same numbers as [`super::scalar`].

use std::ops::Range;

use super::plan::Plan;
use super::roots::Parts;
use super::source::{Quaternions, Rows, Source};
use super::{ForwardKinematics, Pose, World, scalar};
use crate::lanes::rows::{self, TargetRows, blocks};
use crate::lanes::{Kernel, Lanes, Real};
use crate::rotation::{multiply, rotate};

/// The frames of a job that one thread works on.
pub(super) struct Frames<'a, 'b, T> {
    pub(super) job: &'a ForwardKinematics<'b, T>,
    pub(super) plan: &'a Plan<T>,
    pub(super) parts: &'a Parts,
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
            Pose::Quaternions { .. } => each_block(Quaternions::<L>::new(self.job, self.plan, &[]), self),
            Pose::Rows { .. } => each_block(Rows::<L>::new(self.job, self.plan, &[]), self),
        }
    }

    fn run_plain(self) {
        scalar::run(self.job, self.plan, self.parts, self.frames, self.world);
    }
}

#[inline(always)]
fn each_block<L: Lanes, S: Source<L>>(mut source: S, work: Frames<'_, '_, L::Real>) {
    let Frames { job, plan, parts, frames: range, world, is_large } = work;
    let zero = L::splat(L::Real::ZERO);
    let mut rotations = vec![[zero, zero, zero, L::splat(L::Real::ONE)]; plan.turns.len()];
    let mut positions = vec![[zero; 3]; plan.bones.len()];
    let joints = parts.places.iter().copied().zip(plan.joints_out.iter().copied());
    // The first turn is none: its rotation stays the identity.
    let slots = plan.slots_out.iter().map(|turn| turn.unwrap_or(0)).enumerate();
    let (position_width, rotation_width) = (parts.width(), 4 * plan.slots_out.len());
    let position_groups = groups(joints, 3, position_width);
    let rotation_groups = groups(slots, 4, rotation_width);
    let mut positions_out = TargetRows::new(world.positions.unwrap_or(&mut []), position_width, is_large);
    let mut rotations_out = TargetRows::new(world.rotations.unwrap_or(&mut []), rotation_width, is_large);
    for block in blocks::<L>(range.len()) {
        let frames = range.start + block.start..range.start + block.end;
        source.load(frames.clone());
        solve(plan, &source, &mut rotations, &mut positions);
        source.prefetch_translations();
        let (rows, stride) = positions_out.block::<L>(&block);
        store(&position_groups, positions.as_flattened(), rows, stride);
        parts.copy(job, frames, rows, stride);
        positions_out.finish::<L>(&block);
        write(&rotation_groups, rotations.as_flattened(), &mut rotations_out, &block);
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
        source.prefetch(index);
        let mut rotation = rotations[index];
        if let Some(slot) = turn.slot {
            let local = source.rotation(slot);
            rotation = match turn.above {
                None => local,
                Some(above) => multiply(rotations[above], local),
            };
            rotations[index] = rotation;
        }
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

/// Four columns of the answer, and where their numbers stand among the components computed.
pub(crate) struct Group {
    first: usize,
    values: [usize; 4],
}

/// The groups that put items, of so many components, in their places in a row of `width` numbers.
///
/// They cover the columns of these items; what they touch besides must be written after them.
pub(crate) fn groups(
    items: impl Iterator<Item = (usize, usize)>,
    components: usize,
    width: usize,
) -> Vec<Group> {
    let mut values = vec![None; width];
    for (place, item) in items {
        (0..components).for_each(|c| values[components * place + c] = Some(components * item + c));
    }
    let is_wanted: Vec<bool> = values.iter().map(Option::is_some).collect();
    let value = |column: usize| values.get(column).copied().flatten();
    let group = |first: usize| {
        let known = (first..first + 4).find_map(value).unwrap_or(0);
        Group { first, values: std::array::from_fn(|k| value(first + k).unwrap_or(known)) }
    };
    rows::groups(&is_wanted).into_iter().map(group).collect()
}

/// Writes a block of rows.
#[inline(always)]
pub(crate) fn write<L: Lanes>(
    groups: &[Group],
    values: &[L],
    out: &mut TargetRows<'_, L::Real>,
    block: &Range<usize>,
) {
    if !groups.is_empty() {
        let (rows, stride) = out.block::<L>(block);
        store(groups, values, rows, stride);
        out.finish::<L>(block);
    }
}

/// Writes groups of columns into rows that begin `stride` apart.
#[inline(always)]
fn store<L: Lanes>(groups: &[Group], values: &[L], rows: &mut [L::Real], stride: usize) {
    for Group { first, values: [a, b, c, d] } in groups {
        L::store_columns([values[*a], values[*b], values[*c], values[*d]], &mut rows[*first..], stride);
    }
}
