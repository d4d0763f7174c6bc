//! The definition: one frame after the other, in plain numbers.

use std::ops::Range;

use super::plan::{Plan, Turn, Vector};
use crate::kinematics::{ForwardKinematics, World, scalar};
use crate::lanes::Real;
use crate::rotation::{multiply_inverse, rotate_inverse, straighten};

/// Works on `frames`; `out` has room for these only.
pub(super) fn run<T: Real>(
    job: &ForwardKinematics<'_, T>,
    plan: &Plan<T>,
    frames: Range<usize>,
    mut out: World<'_, T>,
) {
    let identity = [T::ZERO, T::ZERO, T::ZERO, T::ONE];
    let mut rotations = vec![identity; plan.solving.turns.len()];
    let mut positions = vec![[T::ZERO; 3]; plan.solving.bones.len()];
    for (row, frame) in frames.enumerate() {
        scalar::solve(job, &plan.solving, frame, &mut rotations, &mut positions);
        if let Some(out) = &mut out.rotations {
            let room = &mut out.as_chunks_mut::<4>().0[row * plan.turns.len()..];
            room.iter_mut().zip(&plan.turns).for_each(|(q, turn)| {
                *q = match *turn {
                    Turn::Copy(slot) => scalar::local_rotation(job, frame, slot),
                    Turn::World(own) => straighten(rotations[own]),
                    Turn::Between(above, own) => {
                        straighten(multiply_inverse(rotations[above], rotations[own]))
                    }
                    Turn::Back(above) => straighten(multiply_inverse(rotations[above], identity)),
                };
            });
        }
        if let Some(out) = &mut out.positions {
            let room = &mut out.as_chunks_mut::<3>().0[row * plan.vectors.len()..];
            room.iter_mut().zip(&plan.vectors).for_each(|(v, vector)| {
                *v = match *vector {
                    Vector::Copy { bone, is_flipped } => {
                        let vector = scalar::vector(job, frame, &plan.solving.bones[bone]);
                        if is_flipped { subtract([T::ZERO; 3], vector) } else { vector }
                    }
                    Vector::Place(bone) => positions[bone],
                    Vector::Between { turn, from, to } => {
                        let way = subtract(positions[to], positions[from]);
                        turn.map_or(way, |turn| rotate_inverse(rotations[turn], way))
                    }
                };
            });
        }
    }
}

fn subtract<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}
