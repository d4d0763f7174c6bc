//! Which slot turns each joint's bone in a configuration, and what its rotation is made of.

use std::collections::HashMap;

use crate::skeleton::{NONE, Topology};

/// What a slot's rotation leads from and to: world rotations of the forest at home, by the slot that makes them there;
/// -1: the world's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Span {
    /// The world rotation of the bone above.
    pub above: i32,
    /// The world rotation of the slot's own bones.
    pub own: i32,
}

/// Siblings that share a slot, or one root.
struct Group {
    span: Span,
    slot: i32,
}

/// The slot of each joint, and the span of each slot.
///
/// A bone with the world rotation of the one above needs no slot. Every other world rotation keeps the number that it
/// has at home in one place, where it leads from what it leads from at home if there is such a place; in further
/// places it gets numbers of its own, in the order of the joints.
pub(super) fn assign(home: &Topology, parents: &[i32], bones: &[u32]) -> (Vec<i32>, Vec<Option<Span>>) {
    let world = |joint: usize| home.world_slots()[bones[joint] as usize];
    let mut groups: Vec<Group> = vec![];
    let mut known: HashMap<(i32, i32), usize> = HashMap::new();
    let mut group_of = vec![None; parents.len()];
    for (joint, &parent) in parents.iter().enumerate() {
        let above = usize::try_from(parent).map_or(NONE, world);
        let span = Span { above, own: world(joint) };
        if span.own == span.above {
            continue;
        }
        let mut add = || {
            groups.push(Group { span, slot: NONE });
            groups.len() - 1
        };
        group_of[joint] =
            Some(if parent == NONE { add() } else { *known.entry((parent, span.own)).or_insert_with(add) });
    }

    let mut spans = vec![None; home.slot_count()];
    let is_at_home = |span: Span| span.own != NONE && home.slot_parents()[span.own as usize] == span.above;
    for wants_home in [true, false] {
        for group in groups.iter_mut().filter(|group| group.slot == NONE && group.span.own != NONE) {
            let room = &mut spans[group.span.own as usize];
            if room.is_none() && (is_at_home(group.span) || !wants_home) {
                *room = Some(group.span);
                group.slot = group.span.own;
            }
        }
    }
    for group in groups.iter_mut().filter(|group| group.slot == NONE) {
        group.slot = spans.len() as i32;
        spans.push(Some(group.span));
    }
    (group_of.into_iter().map(|group| group.map_or(NONE, |group: usize| groups[group].slot)).collect(), spans)
}
