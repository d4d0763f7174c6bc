//! Signs by the sum so far.

use super::arrangement::WIDEST;
use super::lines::{Row, Wide};
use crate::rotation::dot;

/// What a vertex follows: the vertex in `lane` of a block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Signing<'a> {
    /// Of each joint.
    pub(super) rows: &'a [Row],
    /// For each influence those of the block.
    pub(super) weights: &'a [Wide],
    /// Which influence was given first, which second and so on; empty where that is their order.
    pub(super) orders: &'a [[u16; WIDEST]],
    pub(super) lane: usize,
}

impl Signing<'_> {
    /// [`Signing::sign`] of all lanes; `joint` tells which row an influence takes in a lane.
    #[inline(always)]
    pub(super) fn sign_block(self, joint: impl Fn(usize, usize) -> u32, signed: &mut [Wide]) {
        for lane in 0..WIDEST {
            Self { lane, ..self }.sign(|k| joint(k, lane), signed);
        }
    }

    /// The weights, each with the sign that makes its row point as the sum of those that were given before it does,
    /// go to the vertex's lane of `signed`. `joint` tells which row an influence takes.
    #[inline(always)]
    pub(super) fn sign(self, joint: impl Fn(usize) -> u32, signed: &mut [Wide]) {
        let signed = &mut signed[..self.weights.len()];
        let mut real = [0.0; 4];
        for turn in 0..self.weights.len() {
            let k = self.orders.get(turn).map_or(turn, |order| usize::from(order[self.lane]));
            let [x, y, z, w, ..] = self.rows[joint(k) as usize].0;
            let weight = self.weights[k].0[self.lane];
            let weight = if dot(real, [x, y, z, w]) < 0.0 { -weight } else { weight };
            real = [real[0] + weight * x, real[1] + weight * y, real[2] + weight * z, real[3] + weight * w];
            signed[k].0[self.lane] = weight;
        }
    }
}
