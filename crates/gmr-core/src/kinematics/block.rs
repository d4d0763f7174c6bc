//! Forward kinematics of as many frames at once as a register holds; the same numbers as [`super::scalar`].

use std::ops::Range;

use super::plan::{Bone, Plan};
use super::{ForwardKinematics, Pose, World};
use crate::lanes::rows::{SourceRows, TargetRows, blocks, groups};
use crate::lanes::{Kernel, Lanes, Real};
use crate::rotation::{EulerBlock, multiply, normalize, rotate};

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
            Pose::Quaternions { .. } => each_block(Quaternions::<L>::new(&self), self),
            Pose::Rows { .. } => each_block(Rows::<L>::new(&self), self),
        }
    }
}

/// Where a block's local rotations and its bones' vectors come from.
trait Source<L: Lanes> {
    /// Takes in a block.
    fn load(&mut self, frames: Range<usize>);
    /// Asks the memory for a share of the next block.
    fn prefetch(&self, part: usize, parts: usize);
    /// A slot's local rotation.
    fn rotation(&self, slot: usize) -> [L; 4];
    /// The vector of the bone whose joint is the `place`th translated one.
    fn translation(&self, place: usize, bone: &Bone<L::Real>) -> [L; 3];
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
fn solve<L: Lanes, S: Source<L>>(
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
            let vector = match bone.translated {
                None => splat(bone.offset),
                Some(place) => source.translation(place, bone),
            };
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
fn splat<L: Lanes>([x, y, z]: [L::Real; 3]) -> [L; 3] {
    [L::splat(x), L::splat(y), L::splat(z)]
}

#[inline(always)]
fn add<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Where each number of a row of the answer stands among the components computed.
fn columns(items: impl Iterator<Item = usize>, components: usize) -> Vec<usize> {
    items.flat_map(|item| components * item..components * (item + 1)).collect()
}

/// Writes these columns of `values`, four at a time; the last four overlap those before where they must.
#[inline(always)]
fn write<L: Lanes>(columns: &[usize], values: &[L], out: &mut TargetRows<'_, L::Real>, block: &Range<usize>) {
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

/// Poses given as quaternions.
struct Quaternions<'a, L: Lanes> {
    rotations: SourceRows<'a, L::Real>,
    normalize: bool,
    translations: SourceRows<'a, L::Real>,
    /// Columns of the translations, in groups of four that the job needs.
    groups: Vec<usize>,
    columns: Vec<L>,
}

impl<'a, L: Lanes> Quaternions<'a, L> {
    fn new(work: &Frames<'_, 'a, L::Real>) -> Self {
        let Pose::Quaternions { rotations, normalize, translations } = work.job.pose else {
            unreachable!("made for quaternions only")
        };
        let width = 3 * work.job.translated.len();
        let mut is_wanted = vec![false; width];
        for place in work.plan.bones.iter().filter_map(|bone| bone.translated) {
            is_wanted[3 * place..][..3].fill(true);
        }
        Self {
            rotations: SourceRows::new(rotations, 4 * work.job.topology.slot_count()),
            normalize,
            translations: SourceRows::new(translations, width),
            groups: groups(&is_wanted),
            columns: vec![L::splat(L::Real::ZERO); width.max(4)],
        }
    }
}

impl<L: Lanes> Source<L> for Quaternions<'_, L> {
    #[inline(always)]
    fn load(&mut self, frames: Range<usize>) {
        self.rotations.block(&frames, L::WIDTH);
        let (block, stride) = self.translations.block(&frames, L::WIDTH);
        for &group in &self.groups {
            let four = L::load_columns(&block[group..], stride);
            self.columns[group..group + 4].copy_from_slice(&four);
        }
    }

    #[inline(always)]
    fn prefetch(&self, part: usize, parts: usize) {
        self.rotations.prefetch_next(L::WIDTH, part, parts);
    }

    #[inline(always)]
    fn rotation(&self, slot: usize) -> [L; 4] {
        let (block, stride) = self.rotations.current();
        let q = L::load_columns(&block[4 * slot..], stride);
        if self.normalize { normalize(q) } else { q }
    }

    #[inline(always)]
    fn translation(&self, place: usize, _bone: &Bone<L::Real>) -> [L; 3] {
        let columns = &self.columns[3 * place..][..3];
        [columns[0], columns[1], columns[2]]
    }
}

/// Poses given as rows of degrees and positions.
struct Rows<'a, L: Lanes> {
    rows: SourceRows<'a, f64>,
    euler: EulerBlock<L>,
    translation_columns: &'a [[i32; 3]],
    adds_offset: bool,
}

impl<'a, L: Lanes> Rows<'a, L> {
    fn new(work: &Frames<'_, 'a, L::Real>) -> Self {
        let Pose::Rows { rows, column_count, angles, translation_columns, adds_offset } = work.job.pose
        else {
            unreachable!("made for rows only")
        };
        let slots = work.plan.turns.iter().filter_map(|turn| turn.slot);
        let places = work.plan.bones.iter().filter_map(|bone| bone.translated);
        let plain = places.flat_map(|place| translation_columns[place]);
        let plain: Vec<usize> = plain.filter_map(|column| usize::try_from(column).ok()).collect();
        Self {
            rows: SourceRows::new(rows, column_count),
            euler: EulerBlock::new(angles, slots, &plain, column_count),
            translation_columns,
            adds_offset,
        }
    }
}

impl<L: Lanes> Source<L> for Rows<'_, L> {
    #[inline(always)]
    fn load(&mut self, frames: Range<usize>) {
        self.euler.load(&mut self.rows, frames);
    }

    #[inline(always)]
    fn prefetch(&self, part: usize, parts: usize) {
        self.rows.prefetch_next(L::WIDTH, part, parts);
    }

    #[inline(always)]
    fn rotation(&self, slot: usize) -> [L; 4] {
        self.euler.quaternion(slot)
    }

    #[inline(always)]
    fn translation(&self, place: usize, bone: &Bone<L::Real>) -> [L; 3] {
        let mut vector: [L; 3] = splat(bone.offset);
        for (axis, &column) in self.translation_columns[place].iter().enumerate() {
            if let Ok(column) = usize::try_from(column) {
                let channel = self.euler.channel(column);
                vector[axis] = if self.adds_offset { vector[axis] + channel } else { channel };
            }
        }
        vector
    }
}
