//! What is measured between every vertex and every bone.

use glam::DVec3;

use super::bone::{Bone, Boxed, Reach};
use super::strongest::Strongest;
use crate::parallel::for_each_chunk;

/// Vertices that a thread takes at a time.
const CHUNK: usize = 1024;

/// The bone nearest to a vertex; of equally near ones the first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    pub(super) bone: u32,
    pub(super) distance_squared: f64,
}

impl Default for Near {
    fn default() -> Self {
        Self { bone: 0, distance_squared: f64::INFINITY }
    }
}

pub(super) fn nearest(vertices: &[DVec3], bones: &[Bone], near: &mut [Near], threads: usize) {
    for_each_chunk(near, CHUNK, threads, |chunk, near| {
        for (near, vertex) in near.iter_mut().zip(&vertices[chunk * CHUNK..]) {
            for (bone, number) in bones.iter().zip(0..) {
                let distance_squared = bone.distance_squared(*vertex);
                if distance_squared < near.distance_squared {
                    *near = Near { bone: number, distance_squared };
                }
            }
        }
    });
}

/// Of each joint the largest gradient among those of its bones that are within reach; the strongest four of these,
/// divided by their sum. `boxes` are ordered by joint.
pub(super) fn gradients(
    vertices: &[DVec3],
    boxes: &[Boxed],
    near: &[Near],
    reach: Reach,
    followed: &mut [Strongest],
    threads: usize,
) {
    for_each_chunk(followed, CHUNK, threads, |chunk, followed| {
        let rows = vertices[chunk * CHUNK..].iter().zip(&near[chunk * CHUNK..]);
        for (followed, (vertex, near)) in followed.iter_mut().zip(rows) {
            let within = reach.squared(*near);
            for bones in boxes.chunk_by(|a, b| a.bone.joint == b.bone.joint) {
                let taken = bones.iter().filter(|boxed| boxed.bone.distance_squared(*vertex) <= within);
                let gradient = taken.map(|boxed| boxed.gradient(*vertex)).fold(0.0, f64::max);
                followed.add(bones[0].bone.joint, gradient);
            }
            followed.normalize();
        }
    });
}
