//! Euler rows of as many frames as a register holds, turned into registers column by column.

use std::ops::Range;

use super::euler::EulerColumns;
use super::half_angle::{Halves, Steps, halves_of_large};
use super::quaternion::multiply_axis;
use crate::lanes::rows::{SourceRows, groups};
use crate::lanes::{Lanes, Real};

/// The columns of one block of rows: sines and cosines of half of each angle, and plain channels.
pub(crate) struct EulerBlock<L: Lanes> {
    /// First column of each four that hold an angle.
    angle_groups: Vec<usize>,
    /// First column of each four that hold a plain channel.
    channel_groups: Vec<usize>,
    /// Half of each column, where it is an angle.
    halves: Vec<L>,
    /// Its sine and cosine.
    angles: Vec<[L; 2]>,
    /// Each column as it is, where it is plain.
    channels: Vec<L>,
    steps: Steps<L>,
    /// For each slot the columns and axes of its angles, in composing order.
    turns: Vec<Vec<(usize, u8)>>,
}

impl<L: Lanes> EulerBlock<L> {
    /// Room for the angles of these slots, and for these plain columns.
    pub(crate) fn new(
        angles: EulerColumns<'_>,
        slots: impl IntoIterator<Item = usize>,
        plain: &[usize],
        column_count: usize,
    ) -> Self {
        let mut turns = vec![vec![]; angles.columns.len()];
        let mut is_angle = vec![false; column_count];
        for slot in slots {
            turns[slot] = angles.turns(slot).collect();
            turns[slot].iter().for_each(|&(column, _)| is_angle[column] = true);
        }
        let mut is_plain = vec![false; column_count];
        plain.iter().for_each(|&column| is_plain[column] = true);
        let zero = L::splat(L::Real::ZERO);
        let room = column_count.max(4);
        Self {
            angle_groups: groups(&is_angle),
            channel_groups: groups(&is_plain),
            halves: vec![zero; room],
            angles: vec![[zero; 2]; room],
            channels: vec![zero; room],
            steps: Steps::new(),
            turns,
        }
    }

    /// Takes in the rows of `frames`.
    #[inline(always)]
    pub(crate) fn load(&mut self, rows: &mut SourceRows<'_, f64>, frames: Range<usize>) {
        let (block, stride) = rows.block(&frames, L::WIDTH);
        let mut halves = Halves::new();
        for &group in &self.angle_groups {
            let four = halves.of(L::load_doubles(&block[group..], stride));
            self.halves[group..group + 4].copy_from_slice(&four);
        }
        if halves.had_large() {
            for &group in &self.angle_groups {
                let four = halves_of_large(L::load_doubles(&block[group..], stride));
                self.halves[group..group + 4].copy_from_slice(&four);
            }
        }
        for &group in &self.angle_groups {
            let [a, b, c, d] = self.halves[group..].as_chunks::<4>().0[0];
            let four = self.steps.sines_and_cosines([a, b, c, d]);
            self.angles[group..group + 4].copy_from_slice(&four);
        }
        for &group in &self.channel_groups {
            let [a, b, c, d] = L::load_doubles(&block[group..], stride);
            let room = &mut self.channels[group..group + 4];
            room[0] = L::narrow(a);
            room[1] = L::narrow(b);
            room[2] = L::narrow(c);
            room[3] = L::narrow(d);
        }
    }

    /// A plain column.
    #[inline(always)]
    pub(crate) fn channel(&self, column: usize) -> L {
        self.channels[column]
    }

    /// A slot's local rotation.
    #[inline(always)]
    pub(crate) fn quaternion(&self, slot: usize) -> [L; 4] {
        let turns = self.turns[slot].iter();
        compose(turns.map(|&(column, axis)| (self.angles[column], axis))).unwrap_or_else(|| {
            let zero = L::splat(L::Real::ZERO);
            [zero, zero, zero, L::splat(L::Real::ONE)]
        })
    }
}

/// The product of turns about axes, each with sine and cosine of half its angle; `None` of none.
#[inline(always)]
pub(super) fn compose<L: Lanes>(turns: impl Iterator<Item = ([L; 2], u8)>) -> Option<[L; 4]> {
    let mut product = None;
    for ([sin, cos], axis) in turns {
        let zero = L::splat(L::Real::ZERO);
        product = Some(match (product, axis) {
            (Some(q), axis) => multiply_axis(q, axis, sin, cos),
            (None, 0) => [sin, zero, zero, cos],
            (None, 1) => [zero, sin, zero, cos],
            (None, _) => [zero, zero, sin, cos],
        });
    }
    product
}
