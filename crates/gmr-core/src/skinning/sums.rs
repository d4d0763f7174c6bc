//! Weighted sums of joints' rows, for as many vertices at once as a register holds; the same numbers as those of
//! [`super::scalar`].

use super::arrangement::WIDEST;
use super::bones::Bones;
use super::formulas::Matrix;
use super::lines::{Row, Wide};
use crate::lanes::Lanes;

/// Which rows are summed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Rows {
    Linear,
    Residual,
    Dual,
}

/// The vertices of a register: those of a block from `lane` on.
#[derive(Debug, Clone, Copy)]
pub(super) struct At<'a> {
    /// Which of the run's blocks.
    pub(super) block: usize,
    /// For each influence those of the block.
    pub(super) weights: &'a [Wide],
    /// The same with the signs that dual quaternions take.
    pub(super) signed: &'a [Wide],
    pub(super) lane: usize,
}

impl<'a> At<'a> {
    #[inline(always)]
    fn weights_of(self, rows: Rows) -> &'a [Wide] {
        match rows {
            Rows::Linear | Rows::Residual => self.weights,
            Rows::Dual => self.signed,
        }
    }

    /// The first lane. The compiler sees that a register fits behind it.
    #[inline(always)]
    fn lane<L: Lanes>(self) -> usize {
        self.lane & (WIDEST - L::WIDTH)
    }
}

/// What the vertices of a run follow, a register of them at a time.
pub(super) trait Influences<L> {
    /// The first `NUMBERS` numbers, a multiple of 4, of `sum_k w_k row_k` of the vertices there.
    fn sum<const NUMBERS: usize>(&mut self, rows: Rows, at: At<'_>) -> [L; NUMBERS];
}

#[inline(always)]
pub(super) fn matrix<L: Lanes>(influences: &mut impl Influences<L>, rows: Rows, at: At<'_>) -> Matrix<L> {
    let [a, b, c, d, e, f, g, h, i, j, k, l] = influences.sum(rows, at);
    [[a, b, c, d], [e, f, g, h], [i, j, k, l]]
}

#[inline(always)]
pub(super) fn dual_quaternion<L: Lanes>(influences: &mut impl Influences<L>, at: At<'_>) -> [[L; 4]; 2] {
    let [a, b, c, d, e, f, g, h] = influences.sum(Rows::Dual, at);
    [[a, b, c, d], [e, f, g, h]]
}

/// The rows of the joints that all vertices of a run follow.
#[derive(Debug, Default)]
pub(super) struct Same {
    linear: Vec<Row>,
    residual: Vec<Row>,
    dual: Vec<Row>,
}

impl Same {
    /// From now on those of `joints`, and of `dual_joints` among the dual quaternions.
    pub(super) fn pick(&mut self, bones: &Bones, joints: &[u32], dual_joints: &[u32]) {
        pick(&mut self.linear, &bones.linear, joints);
        pick(&mut self.residual, &bones.residual, joints);
        pick(&mut self.dual, &bones.dual, dual_joints);
    }
}

fn pick(picked: &mut Vec<Row>, rows: &[Row], joints: &[u32]) {
    picked.clear();
    if !rows.is_empty() {
        picked.extend(joints.iter().map(|&joint| rows[joint as usize]));
    }
}

impl<L: Lanes<Real = f32>> Influences<L> for &mut Same {
    /// Each number of a row is the same for all lanes.
    #[inline(always)]
    fn sum<const NUMBERS: usize>(&mut self, rows: Rows, at: At<'_>) -> [L; NUMBERS] {
        let (weights, lane) = (at.weights_of(rows), at.lane::<L>());
        let rows = match rows {
            Rows::Linear => &self.linear,
            Rows::Residual => &self.residual,
            Rows::Dual => &self.dual,
        };
        let mut sums = [L::splat(0.0); NUMBERS];
        let (Some((row, rows)), Some((weight, weights))) = (rows.split_first(), weights.split_first()) else {
            return sums;
        };
        let weight = L::load(&weight.0[lane..]);
        for (sum, number) in sums.iter_mut().zip(row.0) {
            *sum = L::splat(number) * weight;
        }
        for (row, weight) in rows.iter().zip(weights) {
            let weight = L::load(&weight.0[lane..]);
            for (sum, number) in sums.iter_mut().zip(row.0) {
                *sum = *sum + L::splat(number) * weight;
            }
        }
        sums
    }
}

/// Vertices that follow each their own joints, `K` of them or ([`MANY`]) any number.
pub(super) struct Each<'a, const K: usize> {
    pub(super) bones: &'a Bones,
    /// Of each block and influence.
    pub(super) joints: &'a [[u32; WIDEST]],
    /// The same among the dual quaternions.
    pub(super) dual_joints: &'a [[u32; WIDEST]],
    /// Room for the sums of each vertex.
    pub(super) sums: &'a mut [[f32; 16]; WIDEST],
}

/// Stands for a number of influences that is known at run time only.
pub(super) const MANY: usize = 0;

impl<L: Lanes<Real = f32>, const K: usize> Influences<L> for Each<'_, K> {
    /// The rows of a vertex are summed along the row, then the sums are turned so that a register holds one number of
    /// each vertex.
    #[inline(always)]
    fn sum<const NUMBERS: usize>(&mut self, rows: Rows, at: At<'_>) -> [L; NUMBERS] {
        let (weights, lane) = (at.weights_of(rows), at.lane::<L>());
        let count = if K == MANY { weights.len() } else { K };
        let (rows, joints) = match rows {
            Rows::Linear => (&self.bones.linear, self.joints),
            Rows::Residual => (&self.bones.residual, self.joints),
            Rows::Dual => (&self.bones.dual, self.dual_joints),
        };
        let joints = &joints[at.block * count..][..count];
        let weights = &weights[..count];
        for number in 0..L::WIDTH {
            sum_of_one::<L, NUMBERS>(rows, joints, weights, lane + number, &mut self.sums[number]);
        }
        let mut sums = [L::splat(0.0); NUMBERS];
        for at in (0..NUMBERS).step_by(4) {
            let [a, b, c, d] = L::load_columns(&self.sums.as_flattened()[at..], 16);
            (sums[at], sums[at + 1], sums[at + 2], sums[at + 3]) = (a, b, c, d);
        }
        sums
    }
}

/// The sum of the vertex in one lane.
#[inline(always)]
fn sum_of_one<L: Lanes<Real = f32>, const NUMBERS: usize>(
    rows: &[Row],
    joints: &[[u32; WIDEST]],
    weights: &[Wide],
    lane: usize,
    sum: &mut [f32; 16],
) {
    let mut totals = [L::splat(0.0); 4];
    for k in 0..joints.len() {
        let row = &rows[joints[k][lane] as usize].0;
        let weight = L::splat(weights[k].0[lane]);
        for (total, at) in totals.iter_mut().zip((0..NUMBERS).step_by(L::WIDTH)) {
            let share = L::load(&row[at..]) * weight;
            *total = if k == 0 { share } else { *total + share };
        }
    }
    for (total, at) in totals.iter().zip((0..NUMBERS).step_by(L::WIDTH)) {
        total.store(&mut sum[at..]);
    }
}
