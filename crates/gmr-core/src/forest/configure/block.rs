//! As many frames at once as a register holds; the same numbers as [`super::scalar`].

use std::ops::Range;

use super::plan::{Plan, Turn, Vector};
use super::scalar;
use crate::kinematics::block::{groups, solve, write};
use crate::kinematics::source::{Quaternions, Rows, Source};
use crate::kinematics::{ForwardKinematics, Pose, World};
use crate::lanes::rows::{TargetRows, blocks};
use crate::lanes::{Kernel, Lanes, Real};
use crate::rotation::{multiply_inverse, rotate_inverse, straighten};

/// The frames of a job that one thread works on.
pub(super) struct Frames<'a, 'b, T> {
    pub(super) job: &'a ForwardKinematics<'b, T>,
    pub(super) plan: &'a Plan<T>,
    pub(super) frames: Range<usize>,
    /// Room for these frames only: the translations are the positions.
    pub(super) out: World<'a, T>,
    /// Whether the answer for all frames outgrows the caches.
    pub(super) is_large: bool,
}

impl<T: Real> Kernel<T> for Frames<'_, '_, T> {
    #[inline(always)]
    fn run<L: Lanes<Real = T>>(self) {
        let solving = &self.plan.solving;
        match self.job.pose {
            Pose::Quaternions { .. } => {
                each_block(Quaternions::<L>::new(self.job, solving, &self.plan.copied), self);
            }
            Pose::Rows { .. } => {
                each_block(Rows::<L>::new(self.job, solving, &self.plan.copied), self);
            }
        }
    }

    fn run_plain(self) {
        scalar::run(self.job, self.plan, self.frames, self.out);
    }
}

#[inline(always)]
fn each_block<L: Lanes, S: Source<L>>(mut source: S, work: Frames<'_, '_, L::Real>) {
    let Frames { plan, frames: range, out, is_large, .. } = work;
    let zero = L::splat(L::Real::ZERO);
    let identity = [zero, zero, zero, L::splat(L::Real::ONE)];
    let mut rotations = vec![identity; plan.solving.turns.len()];
    let bone_count = plan.solving.bones.len();
    // The positions of the bones' ends, and behind them the translations that are something else.
    let (mut places, mut moved) = (vec![[zero; 3]; bone_count], vec![]);
    let (turned_width, moved_width) = (4 * plan.turns.len(), 3 * plan.vectors.len());
    let items = plan.vectors.iter().map(|vector| match vector {
        Vector::Place(bone) => *bone,
        _ => {
            moved.push(*vector);
            places.push([zero; 3]);
            places.len() - 1
        }
    });
    let moved_groups = groups(items.enumerate(), 3, moved_width);
    let mut rotations_out = TargetRows::new(out.rotations.unwrap_or(&mut []), turned_width, is_large);
    let mut translations_out = TargetRows::new(out.positions.unwrap_or(&mut []), moved_width, is_large);
    for block in blocks::<L>(range.len()) {
        source.load(range.start + block.start..range.start + block.end);
        let (positions, vectors) = places.split_at_mut(bone_count);
        solve(&plan.solving, &source, &mut rotations, positions);
        source.prefetch_translations();
        if turned_width > 0 {
            let (rows, stride) = rotations_out.block::<L>(&block);
            for (slot, turn) in plan.turns.iter().enumerate() {
                let q = match *turn {
                    Turn::Copy(slot) => source.rotation(slot),
                    Turn::World(own) => straighten(rotations[own]),
                    Turn::Between(above, own) => {
                        straighten(multiply_inverse(rotations[above], rotations[own]))
                    }
                    Turn::Back(above) => straighten(multiply_inverse(rotations[above], identity)),
                };
                L::store_columns(q, &mut rows[4 * slot..], stride);
            }
            rotations_out.finish::<L>(&block);
        }
        for (v, vector) in vectors.iter_mut().zip(&moved) {
            *v = match *vector {
                Vector::Copy { bone, is_flipped } => {
                    let bone = &plan.solving.bones[bone];
                    let vector = source.vector(bone);
                    if is_flipped { subtract([zero; 3], vector) } else { vector }
                }
                Vector::Place(bone) => positions[bone],
                Vector::Between { turn, from, to } => {
                    let way = subtract(positions[to], positions[from]);
                    match turn {
                        Some(turn) => rotate_inverse(rotations[turn], way),
                        None => way,
                    }
                }
            };
        }
        write(&moved_groups, places.as_flattened(), &mut translations_out, &block);
    }
}

#[inline(always)]
fn subtract<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
