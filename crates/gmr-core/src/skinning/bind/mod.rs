//! Binding: which joints each vertex of a mesh follows, found from where mesh and skeleton are at rest.
//!
//! A bone is a segment from head to tail, and belongs to the joint that turns it. Round each lies an oriented box (see
//! `bone`). For a vertex in a box, the *gradient* along the bone's direction is 1 beside the bone and falls linearly
//! through each of its joints, so that two consecutive bones share a vertex half and half there. Of several bones of
//! one joint the largest gradient counts. The four largest, divided by their sum, are the weights; what is in no box
//! follows the nearest bone, and is then smoothed over the edges of the mesh (see `mend`).
//!
//! Every vertex is measured against every bone twice: once for its nearest bone, from which the boxes follow, and
//! once for its gradients. Weights depend on places relative to each other only: they stay when mesh and skeleton are
//! moved, mirrored or scaled together, but for rounding.

mod bone;
mod error;
mod gradient;
mod mend;
mod strongest;
#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::error::ShapeError;

use bone::{Bone, Near, Reach};
pub use error::BindError;
use strongest::Strongest;

/// Joints that a vertex follows at most.
pub const INFLUENCES: usize = 4;

/// As many as a skin can follow.
const MOST_JOINTS: i32 = 1 << 16;

/// A mesh and the bones of a skeleton, both at rest, in one frame and one unit.
#[derive(Debug, Clone, Copy)]
pub struct Bind<'a> {
    /// (V, 3).
    pub vertices: &'a [f64],
    /// (T, 3) triangles of vertices; they may be degenerate, and edges may have any number of them.
    pub faces: &'a [i32],
    /// (B, 3) where bones begin.
    pub heads: &'a [f64],
    /// (B, 3) where they end.
    pub tails: &'a [f64],
    /// (B,) the joint that turns each; several bones may have one joint.
    pub joints: &'a [i32],
    /// (B, 2) whether no other meets a bone at its head, at its tail: there it does not fall off, and its box is open.
    pub open: &'a [[bool; 2]],
    /// Threads, 0 for all cores; the bits do not depend on them.
    pub threads: usize,
}

/// Which joints vertices follow, and what there is to say about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// (V, 4) joints, the strongest first; 0 where the weight is.
    pub joints: Vec<i32>,
    /// (V, 4) weights; not negative, the sum of each row is 1.
    pub weights: Vec<f32>,
    /// The vertices that were in no box, ascending.
    pub outside: Vec<u32>,
    /// Edges whose ends followed no joint in common before they were smoothed.
    pub torn: usize,
    /// Those that are left.
    pub still_torn: usize,
}

/// Binds a mesh to bones.
///
/// # Errors
/// When a length does not fit, a number is not finite (or beyond 1e100), there is no bone, a joint is none that a skin
/// can follow, or a face names a vertex that is not there.
pub fn bind(job: &Bind<'_>) -> Result<Bound, BindError> {
    let vertices = job.checked()?;
    let bones = job.bones();
    let mut near = vec![Near::default(); vertices.len()];
    gradient::nearest(&vertices, &bones, &mut near, job.threads);
    let boxes = bone::boxes(&vertices, &bones, &near);
    let reach = Reach::of(&bones);
    let mut followed = vec![Strongest::default(); vertices.len()];
    gradient::gradients(&vertices, &boxes, &near, reach, &mut followed, job.threads);

    let outside: Vec<u32> = (0..vertices.len() as u32).filter(|v| followed[*v as usize].is_empty()).collect();
    for &vertex in &outside {
        let nearest = &bones[near[vertex as usize].bone as usize];
        followed[vertex as usize].add(nearest.joint, 1.0);
    }
    let mended = mend::mend(&vertices, job.faces, &outside, &mut followed);
    Ok(Bound {
        joints: followed.iter().flat_map(|followed| followed.joints).collect(),
        weights: followed.iter().flat_map(|followed| followed.weights.map(|w| w as f32)).collect(),
        outside,
        torn: mended.torn,
        still_torn: mended.still_torn,
    })
}

/// Squares of numbers up to this are numbers.
const LARGEST: f64 = 1e100;

impl Bind<'_> {
    fn checked(&self) -> Result<Vec<DVec3>, BindError> {
        let bone_count = self.joints.len();
        ShapeError::check("vertices", self.vertices.len() / 3 * 3, self.vertices.len())?;
        ShapeError::check("faces", self.faces.len() / 3 * 3, self.faces.len())?;
        ShapeError::check("heads", 3 * bone_count, self.heads.len())?;
        ShapeError::check("tails", 3 * bone_count, self.tails.len())?;
        ShapeError::check("open", bone_count, self.open.len())?;
        let vertices = points(self.vertices);
        if vertices.len() > i32::MAX as usize {
            return Err(BindError::TooManyVertices { vertex_count: vertices.len() });
        }
        if let Some(vertex) = vertices.iter().position(|place| !is_place(*place)) {
            return Err(BindError::Vertex { vertex, place: vertices[vertex].to_array() });
        }
        if bone_count == 0 {
            return Err(BindError::NoBones);
        }
        for (bone, (head, tail)) in points(self.heads).into_iter().zip(points(self.tails)).enumerate() {
            if let Some(place) = [head, tail].into_iter().find(|place| !is_place(*place)) {
                return Err(BindError::Bone { bone, joint: self.joints[bone], place: place.to_array() });
            }
        }
        if let Some(bone) = self.joints.iter().position(|joint| !(0..MOST_JOINTS).contains(joint)) {
            return Err(BindError::Joint { bone, joint: self.joints[bone] });
        }
        let known = 0..vertices.len() as i64;
        if let Some(place) = self.faces.iter().position(|v| !known.contains(&i64::from(*v))) {
            let (face, vertex) = (place / 3, self.faces[place].into());
            return Err(BindError::Face { face, vertex, vertex_count: vertices.len() });
        }
        Ok(vertices)
    }

    /// By joint, then as they are given.
    fn bones(&self) -> Vec<Bone> {
        let ends = points(self.heads).into_iter().zip(points(self.tails));
        let rest = self.joints.iter().zip(self.open);
        let mut bones: Vec<Bone> = ends
            .zip(rest)
            .map(|((head, tail), (joint, open))| Bone::new(head, tail, *joint, *open))
            .collect();
        bones.sort_by_key(|bone| bone.joint);
        bones
    }
}

fn points(rows: &[f64]) -> Vec<DVec3> {
    rows.as_chunks::<3>().0.iter().copied().map(DVec3::from_array).collect()
}

fn is_place(place: DVec3) -> bool {
    place.abs().cmple(DVec3::splat(LARGEST)).all()
}
