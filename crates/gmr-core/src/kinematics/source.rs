//! Where a block of frames takes its local rotations and its bones' vectors from: quaternions, or rows of a file.

use std::collections::BTreeSet;
use std::ops::Range;

use super::plan::{Bone, Plan};
use super::{ForwardKinematics, Pose};
use crate::lanes::rows::{SourceRows, groups};
use crate::lanes::{Lanes, Real, cache};
use crate::rotation::{EulerBlock, normalize};

/// Where a block's local rotations and its bones' vectors come from.
pub(crate) trait Source<L: Lanes> {
    /// Takes in a block.
    fn load(&mut self, frames: Range<usize>);
    /// Asks the memory for the share of the next block that belongs to a turn.
    fn prefetch(&self, turn: usize);
    /// Asks the memory for what else the next block needs, once in each block.
    fn prefetch_translations(&self);
    /// A slot's local rotation.
    fn rotation(&self, slot: usize) -> [L; 4];
    /// The vector of the bone whose joint is the `place`th translated one.
    fn translation(&self, place: usize, bone: &Bone<L::Real>) -> [L; 3];

    /// The vector of a bone before its slot turns it, or a root's place.
    #[inline(always)]
    fn vector(&self, bone: &Bone<L::Real>) -> [L; 3] {
        match bone.translated {
            None => splat(bone.offset),
            Some(place) => self.translation(place, bone),
        }
    }
}

/// Poses given as quaternions.
pub(crate) struct Quaternions<'a, L: Lanes> {
    rotations: SourceRows<'a, L::Real>,
    normalize: bool,
    translations: SourceRows<'a, L::Real>,
    /// Columns of the translations, in groups of four that the job needs.
    groups: Vec<usize>,
    columns: Vec<L>,
    /// Where the next block begins, in rotations and in translations.
    next: [usize; 2],
    /// How many numbers of its rotations each turn asks the memory for; none where few rotations are needed.
    share: usize,
    /// What is asked for at once then: a number in each cache line that is needed of a block.
    lines: Vec<usize>,
}

impl<'a, L: Lanes> Quaternions<'a, L> {
    /// For the turns and bones of `plan`, and for these slots besides.
    pub(crate) fn new(
        job: &ForwardKinematics<'a, L::Real>,
        plan: &Plan<L::Real>,
        other_slots: &[usize],
    ) -> Self {
        let Pose::Quaternions { rotations, normalize, translations } = job.pose else {
            unreachable!("made for quaternions only")
        };
        let width = 3 * job.translated.len();
        let mut is_wanted = vec![false; width];
        for place in plan.bones.iter().filter_map(|bone| bone.translated) {
            is_wanted[3 * place..][..3].fill(true);
        }
        let slot_count = job.topology.slot_count();
        let slots = plan.turns.iter().filter_map(|turn| turn.slot).chain(other_slots.iter().copied());
        let slots: BTreeSet<usize> = slots.collect();
        let is_sparse = 2 * slots.len() < slot_count;
        let lines = if is_sparse { lines(rotations, slot_count, &slots, L::WIDTH) } else { vec![] };
        Self {
            rotations: SourceRows::new(rotations, 4 * slot_count),
            normalize,
            translations: SourceRows::new(translations, width),
            groups: groups(&is_wanted),
            columns: vec![L::splat(L::Real::ZERO); width.max(4)],
            next: [0; 2],
            share: if is_sparse { 0 } else { share::<L::Real, _>(4 * slot_count * L::WIDTH, plan) },
            lines,
        }
    }
}

impl<L: Lanes> Source<L> for Quaternions<'_, L> {
    #[inline(always)]
    fn load(&mut self, frames: Range<usize>) {
        let next = frames.start + L::WIDTH;
        self.next = [next * self.rotations.width(), next * self.translations.width()];
        self.lines.iter().for_each(|line| cache::prefetch(self.rotations.data(), self.next[0] + line, 1));
        self.rotations.block(&frames, L::WIDTH);
        let (block, stride) = self.translations.block(&frames, L::WIDTH);
        for &group in &self.groups {
            let four = L::load_columns(&block[group..], stride);
            self.columns[group..group + 4].copy_from_slice(&four);
        }
    }

    #[inline(always)]
    fn prefetch(&self, turn: usize) {
        cache::prefetch(self.rotations.data(), self.next[0] + turn * self.share, self.share);
    }

    #[inline(always)]
    fn prefetch_translations(&self) {
        let count = L::WIDTH * self.translations.width();
        cache::prefetch(self.translations.data(), self.next[1], count);
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

/// How many of the numbers of a block of so many belong to each turn, so that it asks for whole cache lines.
fn share<T, R: Real>(count: usize, plan: &Plan<R>) -> usize {
    let line = cache::LINE / size_of::<T>();
    count.div_ceil(plan.turns.len() * line) * line
}

/// Where these slots lie in a block of `height` rows: a number in each cache line that they touch.
fn lines<T>(data: &[T], slot_count: usize, slots: &BTreeSet<usize>, height: usize) -> Vec<usize> {
    let first = data.as_ptr().addr() / size_of::<T>();
    let slots = (0..height).flat_map(|row| slots.iter().map(move |slot| 4 * (row * slot_count + slot)));
    let mut lines: Vec<usize> = slots.flat_map(|start| [start, start + 3]).collect();
    lines.dedup_by_key(|place| (first + *place) * size_of::<T>() / cache::LINE);
    lines
}

/// Poses given as rows of degrees and positions.
pub(crate) struct Rows<'a, L: Lanes> {
    rows: SourceRows<'a, f64>,
    next: usize,
    share: usize,
    euler: EulerBlock<L>,
    translation_columns: &'a [[i32; 3]],
    adds_offset: bool,
}

impl<'a, L: Lanes> Rows<'a, L> {
    /// For the turns and bones of `plan`, and for these slots besides.
    pub(crate) fn new(
        job: &ForwardKinematics<'a, L::Real>,
        plan: &Plan<L::Real>,
        other_slots: &[usize],
    ) -> Self {
        let Pose::Rows { rows, column_count, angles, translation_columns, adds_offset } = job.pose else {
            unreachable!("made for rows only")
        };
        let slots = plan.turns.iter().filter_map(|turn| turn.slot).chain(other_slots.iter().copied());
        let places = plan.bones.iter().filter_map(|bone| bone.translated);
        let plain = places.flat_map(|place| translation_columns[place]);
        let plain: Vec<usize> = plain.filter_map(|column| usize::try_from(column).ok()).collect();
        Self {
            rows: SourceRows::new(rows, column_count),
            next: 0,
            share: share::<f64, _>(column_count * L::WIDTH, plan),
            euler: EulerBlock::new(angles, slots, &plain, column_count),
            translation_columns,
            adds_offset,
        }
    }
}

impl<L: Lanes> Source<L> for Rows<'_, L> {
    #[inline(always)]
    fn load(&mut self, frames: Range<usize>) {
        self.next = (frames.start + L::WIDTH) * self.rows.width();
        self.euler.load(&mut self.rows, frames);
    }

    #[inline(always)]
    fn prefetch(&self, turn: usize) {
        cache::prefetch(self.rows.data(), self.next + turn * self.share, self.share);
    }

    #[inline(always)]
    fn prefetch_translations(&self) {}

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

#[inline(always)]
fn splat<L: Lanes>([x, y, z]: [L::Real; 3]) -> [L; 3] {
    [L::splat(x), L::splat(y), L::splat(z)]
}
