//! What stays from frame to frame: vertices at rest and what they follow, laid out for blending.

use std::collections::HashMap;

use super::SkinError;
use crate::error::ShapeError;

/// Vertices that the widest register takes at a time; arrays are padded to a multiple of it.
const WIDEST: usize = 16;

/// The influences that the fast path has room for.
pub(super) const FEW: usize = 4;

/// A mesh at rest and the joints that its vertices follow.
#[derive(Debug, Clone)]
pub struct Skin {
    pub(super) vertex_count: usize,
    pub(super) joint_count: usize,
    /// Influences of a vertex, [`FEW`] or more; those that are not used have weight 0 and the pivot's joint.
    pub(super) influence_count: usize,
    /// (V, 3), padded.
    pub(super) positions: Vec<f32>,
    /// (V, 3), padded; empty where there are none.
    pub(super) normals: Vec<f32>,
    /// (V, K), padded.
    pub(super) weights: Vec<f32>,
    /// (V, K), padded.
    pub(super) joints: Vec<u32>,
    /// (V, K), padded: the place among `pairs` of each influence beside its vertex's pivot.
    pub(super) paired: Vec<u32>,
    /// A vertex's pivot, which is the joint that weighs most for it (of equal ones the first), and a joint that it
    /// follows. Each joint beside itself comes first, in their order.
    pub(super) pairs: Vec<[u32; 2]>,
}

impl Skin {
    /// A skin of (V, 3) `vertices` that follow (V, K) `joints`, each below `joint_count`, by (V, K) `weights`.
    ///
    /// Weights are taken as they are: they should sum to 1. `normals` are (V, 3) where there are any. What has weight
    /// 0 is no influence, whatever joint it names.
    ///
    /// # Errors
    /// When a length does not fit, a vertex follows a joint that is not there or none at all, or a weight is negative
    /// or not finite.
    pub fn new(
        vertices: &[f32],
        normals: Option<&[f32]>,
        joints: &[i32],
        weights: &[f32],
        joint_count: usize,
    ) -> Result<Self, SkinError> {
        let vertex_count = vertices.len() / 3;
        ShapeError::check("vertices", 3 * vertex_count, vertices.len())?;
        ShapeError::check("weights", joints.len(), weights.len())?;
        let given = joints.len().checked_div(vertex_count).unwrap_or(0);
        ShapeError::check("joints", vertex_count * given, joints.len())?;
        if let Some(normals) = normals {
            ShapeError::check("normals", vertices.len(), normals.len())?;
        }
        if joint_count > 1 << 16 {
            return Err(SkinError::TooManyJoints { joint_count });
        }
        let influence_count = given.max(FEW);
        let padded = vertex_count.next_multiple_of(WIDEST);
        let mut skin = Self {
            vertex_count,
            joint_count,
            influence_count,
            positions: padded_rows(vertices, padded),
            normals: normals.map_or(vec![], |normals| padded_rows(normals, padded)),
            weights: vec![0.0; padded * influence_count],
            joints: vec![0; padded * influence_count],
            paired: vec![0; padded * influence_count],
            pairs: (0..joint_count as u32).map(|joint| [joint; 2]).collect(),
        };
        let mut known = HashMap::new();
        for vertex in 0..vertex_count {
            let row = vertex * given..(vertex + 1) * given;
            skin.bind(vertex, &joints[row.clone()], &weights[row], &mut known)?;
        }
        Ok(skin)
    }

    /// V.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// How many joints the transforms are of.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.joint_count
    }

    /// Whether there are normals to be turned.
    #[must_use]
    pub fn has_normals(&self) -> bool {
        !self.normals.is_empty() || self.vertex_count == 0
    }

    fn bind(
        &mut self,
        vertex: usize,
        joints: &[i32],
        weights: &[f32],
        known: &mut HashMap<[u32; 2], u32>,
    ) -> Result<(), SkinError> {
        let mut pivot = None;
        for (&joint, &weight) in joints.iter().zip(weights) {
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(SkinError::Weight { vertex, weight });
            }
            if weight > 0.0 && !(0..self.joint_count as i64).contains(&joint.into()) {
                return Err(SkinError::Joint { vertex, joint: joint.into(), joint_count: self.joint_count });
            }
            if weight > pivot.map_or(0.0, |(most, _)| most) {
                pivot = Some((weight, joint as u32));
            }
        }
        let Some((_, pivot)) = pivot else { return Err(SkinError::Loose { vertex }) };
        let row = vertex * self.influence_count..(vertex + 1) * self.influence_count;
        self.joints[row.clone()].fill(pivot);
        self.paired[row.clone()].fill(pivot);
        for (place, (&joint, &weight)) in row.zip(joints.iter().zip(weights)) {
            if weight > 0.0 {
                self.weights[place] = weight;
                self.joints[place] = joint as u32;
                self.paired[place] = self.pair([pivot, joint as u32], known);
            }
        }
        Ok(())
    }

    fn pair(&mut self, pair: [u32; 2], known: &mut HashMap<[u32; 2], u32>) -> u32 {
        if pair[0] == pair[1] {
            return pair[0];
        }
        *known.entry(pair).or_insert_with(|| {
            self.pairs.push(pair);
            (self.pairs.len() - 1) as u32
        })
    }
}

/// Rows of three, with rows of zeros up to `count` of them and one number more, so that four can be read of any.
pub(super) fn padded_rows(rows: &[f32], count: usize) -> Vec<f32> {
    let mut padded = Vec::with_capacity(3 * count + 1);
    padded.extend_from_slice(rows);
    padded.resize(3 * count + 1, 0.0);
    padded
}
