//! Euler rows of as many frames as a register holds, turned into registers column by column.

use std::ops::Range;

use super::euler_columns::EulerColumns;
use super::half_angle::{Steps, halves, is_large, squares, without_turns};
use super::quaternion::multiply_axis;
use crate::lanes::rows::{SourceRows, groups};
use crate::lanes::{Doubles, Lanes, Real};

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
    /// The columns and axes of the angles, slot after slot, each slot's in composing order.
    turns: Vec<(usize, u8)>,
    /// Where each slot's begin and end.
    ranges: Vec<Range<usize>>,
}

impl<L: Lanes> EulerBlock<L> {
    /// Room for the angles of these slots, and for these plain columns.
    pub(crate) fn new(
        angles: EulerColumns<'_>,
        slots: impl IntoIterator<Item = usize>,
        plain: &[usize],
        column_count: usize,
    ) -> Self {
        let (mut turns, mut ranges) = (vec![], vec![0..0; angles.columns.len()]);
        let mut is_angle = vec![false; column_count];
        for slot in slots {
            let start = turns.len();
            turns.extend(angles.turns(slot));
            ranges[slot] = start..turns.len();
        }
        turns.iter().for_each(|&(column, _)| is_angle[column] = true);
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
            ranges,
        }
    }

    /// Takes in the rows of `frames`.
    #[inline(always)]
    pub(crate) fn load(&mut self, rows: &mut SourceRows<'_, f64>, frames: Range<usize>) {
        let (block, stride) = rows.block(&frames, L::WIDTH);
        let mut sum = L::Doubles::splat(0.0);
        for &group in &self.angle_groups {
            let degrees = L::load_doubles(&block[group..], stride);
            sum = sum + squares(degrees);
            self.halves[group..group + 4].copy_from_slice(&halves(degrees));
        }
        if is_large(sum) {
            for &group in &self.angle_groups {
                let degrees = L::load_doubles(&block[group..], stride);
                if is_large(squares(degrees)) {
                    self.halves[group..group + 4].copy_from_slice(&halves(without_turns(degrees)));
                }
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
        let Range { start, end } = self.ranges[slot];
        let turns = self.turns[start..end].iter();
        compose(turns.map(|&(column, axis)| (self.angles[column], axis)))
    }
}

/// The product of turns about axes, each with sine and cosine of half its angle.
#[inline(always)]
pub(super) fn compose<L: Lanes>(mut turns: impl Iterator<Item = ([L; 2], u8)>) -> [L; 4] {
    let zero = L::splat(L::Real::ZERO);
    let Some(([sin, cos], axis)) = turns.next() else { return [zero, zero, zero, L::splat(L::Real::ONE)] };
    let mut product = match axis {
        0 => [sin, zero, zero, cos],
        1 => [zero, sin, zero, cos],
        _ => [zero, zero, sin, cos],
    };
    for ([sin, cos], axis) in turns {
        product = multiply_axis(product, axis, sin, cos);
    }
    product
}
