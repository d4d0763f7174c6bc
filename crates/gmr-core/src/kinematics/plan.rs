//! The order of work for one job: only the slots and joints that the answer needs, each after what it hangs on.

use super::ForwardKinematics;
use crate::error::{JobError, ShapeError};
use crate::lanes::Real;
use crate::rotation::check_indices;
use crate::skeleton::{NONE, Topology};

/// A slot and the bones it turns; indices into the plan's own, shorter lists unless said otherwise.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Turn {
    /// The slot in the topology; `None`: no rotation (for bones that hang straight in the world).
    pub(crate) slot: Option<usize>,
    /// The turn above.
    pub(crate) above: Option<usize>,
    /// The bones it turns, in [`Plan::bones`].
    pub(crate) bones: std::ops::Range<usize>,
}

/// A joint, and the bone that ends in it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bone<T> {
    /// The bone that ends in the parent; `None`: a root, whose vector is its place.
    pub(crate) parent: Option<usize>,
    /// The bone's vector where it is the same in all frames; what missing columns and added positions start from.
    pub(crate) offset: [T; 3],
    /// Its place among the translated joints.
    pub(crate) translated: Option<usize>,
}

/// Turns and bones, each after those it hangs on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan<T> {
    pub(crate) turns: Vec<Turn>,
    pub(crate) bones: Vec<Bone<T>>,
    /// For each position asked for: its bone.
    pub(crate) joints_out: Vec<usize>,
    /// For each rotation asked for: its turn; `None`: the identity.
    pub(crate) slots_out: Vec<Option<usize>>,
}

impl<T: Real> Plan<T> {
    pub(crate) fn new(
        job: &ForwardKinematics<'_, T>,
        has_positions: bool,
        has_rotations: bool,
    ) -> Result<Self, JobError> {
        let topology = job.topology;
        let (joint_count, slot_count) = (topology.joint_count(), topology.slot_count());
        ShapeError::check("offsets", 3 * joint_count, job.offsets.len())?;
        let translated = places(job.translated, joint_count)?;
        let joints = asked_joints(job, has_positions)?;
        let slots = asked("rotation_slots", job.rotation_slots, slot_count, has_rotations)?;

        let needed_joints = with_ancestors(&joints, topology.parents());
        // A root's own rotation moves nothing but what hangs below.
        let is_turned = |&joint: &usize| needed_joints[joint] && topology.parents()[joint] != NONE;
        let turning = (0..joint_count).filter(is_turned).map(|joint| topology.world_slots()[joint]);
        let wanted: Vec<i32> = slots.iter().copied().chain(turning).collect();
        let needed_slots = with_ancestors(&wanted, topology.slot_parents());

        let (turns, turn_of) = turns(topology, &needed_slots);
        let mut plan = Self { turns, bones: vec![], joints_out: vec![], slots_out: vec![] };
        let bone_of = plan.hang_bones(job, &needed_joints, &turn_of, &translated);
        plan.joints_out = joints.iter().filter_map(|&joint| bone_of[joint as usize]).collect();
        for slot in slots {
            plan.slots_out.push(match index(slot) {
                None => None,
                Some(slot) => Some(turn_of[slot].ok_or(JobError::IdleSlot { slot })?),
            });
        }
        Ok(plan)
    }

    /// Gives each turn its bones; where each joint's bone stands.
    fn hang_bones(
        &mut self,
        job: &ForwardKinematics<'_, T>,
        is_needed: &[bool],
        turn_of: &[Option<usize>],
        translated: &[Option<usize>],
    ) -> Vec<Option<usize>> {
        let topology = job.topology;
        let turn = |joint: usize| index(topology.world_slots()[joint]).and_then(|s| turn_of[s]).unwrap_or(0);
        let in_order = topology.order().iter().map(|&joint| joint as usize);
        let mut order: Vec<usize> = in_order.filter(|&joint| is_needed[joint]).collect();
        order.sort_by_key(|&joint| turn(joint));

        let mut bone_of = vec![None; topology.joint_count()];
        for joint in order {
            let bone = self.bones.len();
            bone_of[joint] = Some(bone);
            self.bones.push(Bone {
                parent: index(topology.parents()[joint]).and_then(|parent| bone_of[parent]),
                offset: std::array::from_fn(|axis| T::from_f64(job.offsets[3 * joint + axis])),
                translated: translated[joint],
            });
            let bones = &mut self.turns[turn(joint)].bones;
            bones.start = if bones.start == bones.end { bone } else { bones.start };
            bones.end = bone + 1;
        }
        bone_of
    }
}

/// The world, and each needed slot after the one above it; and where each slot stands.
fn turns(topology: &Topology, is_needed: &[bool]) -> (Vec<Turn>, Vec<Option<usize>>) {
    let mut turns = vec![Turn { slot: None, above: None, bones: 0..0 }];
    let mut turn_of = vec![None; topology.slot_count()];
    for slot in topology.slot_order().iter().map(|&slot| slot as usize).filter(|&slot| is_needed[slot]) {
        let above = index(topology.slot_parents()[slot]).and_then(|above| turn_of[above]);
        turn_of[slot] = Some(turns.len());
        turns.push(Turn { slot: Some(slot), above, bones: 0..0 });
    }
    (turns, turn_of)
}

fn index(index: i32) -> Option<usize> {
    usize::try_from(index).ok()
}

/// Where in `listed` each joint stands.
pub(super) fn places(listed: &[i32], joint_count: usize) -> Result<Vec<Option<usize>>, JobError> {
    let mut places = vec![None; joint_count];
    for (at, &joint) in listed.iter().enumerate() {
        let place = index(joint).and_then(|joint| places.get_mut(joint));
        let found = joint.into();
        *place.ok_or(JobError::Index { what: "translated", at, found, count: joint_count })? = Some(at);
    }
    Ok(places)
}

/// The joints whose positions are asked for; none where there is no room for them.
pub(super) fn asked_joints<T>(
    job: &ForwardKinematics<'_, T>,
    has_positions: bool,
) -> Result<Vec<i32>, JobError> {
    let count = job.topology.joint_count();
    let joints = asked("joints", job.joints, count, has_positions)?;
    match joints.iter().position(|&joint| joint == NONE) {
        Some(at) => Err(JobError::Index { what: "joints", at, found: NONE.into(), count }),
        None => Ok(joints),
    }
}

/// What is asked for, or all there is; nothing where there is no room for it.
fn asked(
    what: &'static str,
    asked: Option<&[i32]>,
    count: usize,
    has_room: bool,
) -> Result<Vec<i32>, JobError> {
    let asked = asked.map_or_else(|| (0..count as i32).collect(), <[i32]>::to_vec);
    check_indices(what, &asked, count)?;
    Ok(if has_room { asked } else { vec![] })
}

/// Whether each index is among `wanted` or above one of them.
fn with_ancestors(wanted: &[i32], parents: &[i32]) -> Vec<bool> {
    let mut needed = vec![false; parents.len()];
    for &start in wanted {
        let mut next = index(start);
        while let Some(i) = next.filter(|&i| !needed[i]) {
            needed[i] = true;
            next = index(parents[i]);
        }
    }
    needed
}
