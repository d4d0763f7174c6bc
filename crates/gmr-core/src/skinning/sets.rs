//! The joints that vertices follow, and how a vertex's are put in order.

use std::collections::HashMap;

use super::SkinError;

/// A joint that a vertex follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Influence {
    pub(super) joint: u32,
    pub(super) weight: f32,
    /// How many influences of the vertex were given before it.
    pub(super) given: u16,
}

/// What vertices are to follow: (V, K) joints and weights as the caller gives them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given<'a> {
    pub(super) joints: &'a [i32],
    pub(super) weights: &'a [f32],
    /// K.
    pub(super) each: usize,
}

impl Given<'_> {
    /// Checks what `vertex` follows.
    pub(super) fn check(&self, vertex: usize, joint_count: usize) -> Result<(), SkinError> {
        let mut is_loose = true;
        for (joint, weight) in self.row(vertex) {
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(SkinError::Weight { vertex, weight });
            }
            if weight > 0.0 && !(0..joint_count as i64).contains(&joint.into()) {
                return Err(SkinError::Joint { vertex, joint: joint.into(), joint_count });
            }
            is_loose &= weight == 0.0;
        }
        if is_loose { Err(SkinError::Loose { vertex }) } else { Ok(()) }
    }

    /// Puts what weighs anything for `vertex`, which is checked, into `found`, by ascending joint.
    pub(super) fn influences(&self, vertex: usize, found: &mut Vec<Influence>) {
        found.clear();
        for (joint, weight) in self.row(vertex).filter(|(_, weight)| *weight > 0.0) {
            let (joint, given) = (joint as u32, found.len());
            let place = found.iter().rposition(|other| other.joint <= joint).map_or(0, |at| at + 1);
            found.insert(place, Influence { joint, weight, given: given as u16 });
        }
    }

    fn row(&self, vertex: usize) -> impl Iterator<Item = (i32, f32)> {
        let row = vertex * self.each..(vertex + 1) * self.each;
        self.joints[row.clone()].iter().copied().zip(self.weights[row].iter().copied())
    }
}

/// The joint that weighs most; of equal ones the first that was given.
pub(super) fn pivot(influences: &[Influence]) -> u32 {
    let mut most = influences[0];
    for other in &influences[1..] {
        if other.weight > most.weight || (other.weight == most.weight && other.given < most.given) {
            most = *other;
        }
    }
    most.joint
}

/// Pairs of a pivot and a joint that some vertex follows.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    /// Each joint beside itself comes first, in their order.
    pub(super) pairs: Vec<[u32; 2]>,
    /// Places, by the pivot in the upper half and the joint in the lower.
    known: HashMap<u64, u32>,
}

impl Pairs {
    pub(super) fn new(joint_count: usize) -> Self {
        Self { pairs: (0..joint_count as u32).map(|joint| [joint; 2]).collect(), known: HashMap::new() }
    }

    /// The place of a pair.
    fn find(&mut self, pivot: u32, joint: u32) -> u32 {
        if pivot == joint {
            return pivot;
        }
        *self.known.entry(u64::from(pivot) << 32 | u64::from(joint)).or_insert_with(|| {
            self.pairs.push([pivot, joint]);
            (self.pairs.len() - 1) as u32
        })
    }
}

/// Joints that are followed.
#[derive(Debug, Clone)]
pub(super) struct Followed<T> {
    pub(super) joints: Vec<T>,
    /// The place among the pairs of each of them beside its pivot.
    pub(super) paired: Vec<T>,
}

impl<T> Default for Followed<T> {
    fn default() -> Self {
        Self { joints: vec![], paired: vec![] }
    }
}

impl Followed<u32> {
    /// Adds `joints` that are followed beside a pivot.
    pub(super) fn add(&mut self, joints: &[u32], pivot: u32, pairs: &mut Pairs) {
        self.joints.extend_from_slice(joints);
        self.paired.extend(joints.iter().map(|&joint| pairs.find(pivot, joint)));
    }
}
