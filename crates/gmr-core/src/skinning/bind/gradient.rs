//! What is measured between every vertex and every bone.

use glam::DVec3;

use super::bone::{Bone, Boxed, Near, Reach};
use super::strongest::Strongest;
use crate::parallel::for_each_chunk;

/// Vertices that a thread takes at a time.
const CHUNK: usize = 1024;

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

/// Of each joint the largest gradient among those of its bones, less what they lose by being far; the strongest four
/// of these, divided by their sum. `boxes` are ordered by joint.
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
            for bones in boxes.chunk_by(|a, b| a.bone.joint == b.bone.joint) {
                let shares = bones.iter().map(|boxed| {
                    let share = reach.share(*near, boxed.bone.distance_squared(*vertex));
                    if share > 0.0 { share * boxed.gradient(*vertex) } else { 0.0 }
                });
                followed.add(bones[0].bone.joint, shares.fold(0.0, f64::max));
            }
            followed.normalize();
        }
    });
}
