//! Joints above the hips that only carry the body.
//!
//! Bandai-Namco's `joint_Root` is one: it stands somewhere on the ground, in a heading of its own, and the hips below
//! have positions. Where it stands and how it is turned says nothing about the pose.

use crate::skeleton::{NONE, Topology};

/// The joints that are carried: below a root, as long as only one child leads on, and that is among the `translated`.
#[must_use]
pub fn carried(topology: &Topology, translated: &[i32]) -> Vec<usize> {
    let children = |parent: usize| {
        let is_child = move |&joint: &usize| topology.parents()[joint] == parent as i32;
        (0..topology.joint_count()).filter(is_child)
    };
    let mut carried = Vec::new();
    for root in (0..topology.joint_count()).filter(|&joint| topology.parents()[joint] == NONE) {
        let mut joint = root;
        loop {
            let mut leading_on = children(joint).filter(|&child| children(child).next().is_some());
            match (leading_on.next(), leading_on.next()) {
                (Some(child), None) if translated.contains(&(child as i32)) => joint = child,
                _ => break,
            }
            carried.push(joint);
        }
    }
    carried
}

/// The joints of the body: all but the carriers, and what ends on one.
#[must_use]
pub fn body(topology: &Topology, translated: &[i32]) -> Vec<usize> {
    let carried = carried(topology, translated);
    let is_carrier = |joint: i32| carried.iter().any(|&below| topology.parents()[below] == joint);
    let is_body = |&joint: &usize| {
        let ends_on_a_carrier = is_carrier(topology.parents()[joint]) && !carried.contains(&joint);
        !is_carrier(joint as i32) && !ends_on_a_carrier
    };
    (0..topology.joint_count()).filter(is_body).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topology(parents: &[i32]) -> Topology {
        Topology::new(parents, &vec![NONE; parents.len()], 0).unwrap()
    }

    #[test]
    fn hips_with_positions_below_a_lone_root_are_carried() {
        // root(0) - hips(1) - legs(2, 3) - feet(4, 5); a marker(6) on the root leads nowhere.
        let skeleton = topology(&[-1, 0, 1, 1, 2, 3, 0]);
        for translated in [&[0, 1][..], &[0, 1, 2, 3, 4, 5, 6]] {
            assert_eq!(carried(&skeleton, translated), [1]);
            assert_eq!(body(&skeleton, translated), [1, 2, 3, 4, 5]);
        }
        assert_eq!(carried(&skeleton, &[0]), [0_usize; 0], "a rigid bone is no carrier");
        assert_eq!(body(&skeleton, &[0]), [0, 1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn a_root_with_several_limbs_carries_nothing() {
        let skeleton = topology(&[-1, 0, 0, 1, 2]);
        assert_eq!(carried(&skeleton, &[0, 1, 2, 3, 4]), [0_usize; 0]);
        assert_eq!(body(&skeleton, &[0, 1, 2, 3, 4]), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn several_carriers_are_all_found_and_several_roots_looked_below() {
        // world(0) - root(1) - hips(2) - legs; and a second body, 7 - 8 - 9.
        let skeleton = topology(&[-1, 0, 1, 2, 2, 3, 4, -1, 7, 8]);
        assert_eq!(carried(&skeleton, &[0, 1, 2, 7]), [1, 2]);
        assert_eq!(body(&skeleton, &[0, 1, 2, 7]), [2, 3, 4, 5, 6, 7, 8, 9]);
    }
}
