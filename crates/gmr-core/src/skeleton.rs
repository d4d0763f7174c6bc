//! A forest of joints whose bones are turned by rotation slots.
//!
//! The bone that ends in joint `j` is turned by slot `slots[j]`; the world rotation of a slot is that of the
//! slot above it times its own, and `P_j = P_parent + W_slot(j) t_j`. A post-rotation skeleton (BVH) is the case
//! where siblings share the slot that carries their parent's rotation; the general pre-rotation form gives every
//! bone a slot of its own. Source: the General Motion Representation, Eq. 1 and its pre-rotation order.

use crate::error::TopologyError;

/// The absent index: no parent, no slot.
pub const NONE: i32 = -1;

/// Parents and rotation slots, checked once, with what forward kinematics derives from them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topology {
    parents: Vec<i32>,
    slots: Vec<i32>,
    slot_parents: Vec<i32>,
    world_slots: Vec<i32>,
    order: Vec<u32>,
    slot_order: Vec<u32>,
}

impl Topology {
    /// Checks `parents` (-1: a root) and `slots` (-1: the bone has its parent's world rotation) and derives the rest.
    ///
    /// # Errors
    /// When an index is out of range, the parents hold a cycle, or bones of different parents share a slot.
    pub fn new(parents: &[i32], slots: &[i32], slot_count: usize) -> Result<Self, TopologyError> {
        if parents.len() != slots.len() {
            return Err(TopologyError::LengthMismatch { parents: parents.len(), slots: slots.len() });
        }
        check_range(parents, "parent", parents.len())?;
        check_range(slots, "slot", slot_count)?;
        let order = parents_first(parents)?;

        let mut world_slots = vec![NONE; parents.len()];
        let mut slot_parents = vec![NONE; slot_count];
        let mut slot_user: Vec<Option<usize>> = vec![None; slot_count];
        let mut slot_order = Vec::with_capacity(slot_count);
        for &joint in &order {
            let joint = joint as usize;
            let above = usize::try_from(parents[joint]).map_or(NONE, |parent| world_slots[parent]);
            let Ok(slot) = usize::try_from(slots[joint]) else {
                world_slots[joint] = above;
                continue;
            };
            match slot_user[slot] {
                Some(other) if parents[other] != parents[joint] || parents[joint] == NONE => {
                    return Err(TopologyError::SharedSlot { slot, joints: (other, joint) });
                }
                Some(_) => {}
                None => {
                    slot_user[slot] = Some(joint);
                    slot_parents[slot] = above;
                    slot_order.push(slot as u32);
                }
            }
            world_slots[joint] = slot as i32;
        }
        Ok(Self {
            parents: parents.to_vec(),
            slots: slots.to_vec(),
            slot_parents,
            world_slots,
            order,
            slot_order,
        })
    }

    /// Number of joints.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.parents.len()
    }

    /// Number of rotation slots.
    #[must_use]
    pub fn slot_count(&self) -> usize {
        self.slot_parents.len()
    }

    /// Parent of each joint, -1 for a root.
    #[must_use]
    pub fn parents(&self) -> &[i32] {
        &self.parents
    }

    /// Slot that turns the bone ending in each joint, -1 for none.
    #[must_use]
    pub fn slots(&self) -> &[i32] {
        &self.slots
    }

    /// Slot after which each slot is applied, -1 for the world (and for slots that turn no bone).
    #[must_use]
    pub fn slot_parents(&self) -> &[i32] {
        &self.slot_parents
    }

    /// Slot whose world rotation is the bone's, per joint; -1 for the identity.
    #[must_use]
    pub fn world_slots(&self) -> &[i32] {
        &self.world_slots
    }

    /// Joints, parents before children.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The slots that turn some bone, each after the slot above it.
    #[must_use]
    pub fn slot_order(&self) -> &[u32] {
        &self.slot_order
    }
}

fn check_range(indices: &[i32], what: &'static str, count: usize) -> Result<(), TopologyError> {
    match indices.iter().position(|&i| i < NONE || i >= 0 && i as usize >= count) {
        None => Ok(()),
        Some(joint) => Err(TopologyError::OutOfRange { joint, what, found: indices[joint], count }),
    }
}

/// Joints so ordered that each comes after its parent; file order is kept where it already does.
fn parents_first(parents: &[i32]) -> Result<Vec<u32>, TopologyError> {
    if parents.iter().enumerate().all(|(joint, &parent)| parent < joint as i32) {
        return Ok((0..parents.len() as u32).collect());
    }
    let mut order = Vec::with_capacity(parents.len());
    let mut state = vec![0_u8; parents.len()];
    let mut path = Vec::new();
    for start in 0..parents.len() {
        let mut joint = start;
        while state[joint] == 0 {
            state[joint] = 1;
            path.push(joint);
            match usize::try_from(parents[joint]) {
                Ok(parent) if state[parent] == 1 => return Err(TopologyError::Cycle { joint: parent }),
                Ok(parent) => joint = parent,
                Err(_) => break,
            }
        }
        while let Some(done) = path.pop() {
            state[done] = 2;
            order.push(done as u32);
        }
    }
    Ok(order)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn siblings_share_the_slot_of_their_parent_in_post_rotation_form() {
        // hips(0) - spine(1), left(2), right(3); spine - head(4)
        let topology = Topology::new(&[-1, 0, 0, 0, 1], &[-1, 0, 0, 0, 1], 2).unwrap();
        assert_eq!(topology.world_slots(), [-1, 0, 0, 0, 1]);
        assert_eq!(topology.slot_parents(), [-1, 0]);
    }

    #[test]
    fn children_may_be_listed_before_their_parents() {
        let topology = Topology::new(&[1, 2, -1], &[0, 1, -1], 2).unwrap();
        assert_eq!(topology.order(), [2, 1, 0]);
        assert_eq!(topology.slot_parents(), [1, -1]);
        assert_eq!(topology.slot_order(), [1, 0]);
    }

    #[test]
    fn what_is_no_forest_is_refused() {
        assert_eq!(Topology::new(&[1, 0], &[-1, -1], 0), Err(TopologyError::Cycle { joint: 0 }));
        assert!(matches!(Topology::new(&[0], &[-1], 0), Err(TopologyError::Cycle { joint: 0 })));
        assert!(matches!(Topology::new(&[7], &[-1], 0), Err(TopologyError::OutOfRange { found: 7, .. })));
        assert!(matches!(
            Topology::new(&[-1, 0, 1], &[-1, 0, 0], 1),
            Err(TopologyError::SharedSlot { slot: 0, joints: (1, 2) })
        ));
    }
}
