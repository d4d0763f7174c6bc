//! The General Motion Representation: a motion is a forest, and any of its joints can be a root.
//!
//! A [`Forest`] is a skeleton in one of its *configurations*: which of its bones are cut, and which joint of each
//! tree is the root. [`Forest::split`] cuts the bone above a joint, [`Forest::join`] mends the cut above a root's
//! tree (its *soft link*), [`Forest::shift_root`] turns a tree over so that another joint is its root, and
//! [`Forest::with_roots`] goes from any configuration to the one with just these roots. They move no numbers:
//! [`configure`] carries the frames of a motion from one configuration to another in one pass.
//!
//! # What stays
//! Every joint's world position, and every bone's world rotation. The bones are those of the forest at home, before
//! any root was moved: bone `j` is the one between joint `j` and its parent there. A joint's slot turns the bone above
//! it; after a shift that is the bone of the former parent, and a tree's root carries the rotation of the bone that is
//! cut above its *top*, the joint nearest to home ([`Forest::bones`]). So a configuration alone determines the
//! motion, whatever operations led to it: the rotation of a joint's slot is `W_above^-1 W_own`, the world rotations of
//! two bones of the forest at home, and bones with one world rotation share one slot wherever siblings can.
//!
//! Source: "General Motion Representation", its operations shift root, split tree and join trees.

use crate::error::TopologyError;
use crate::skeleton::{NONE, Topology};

mod configure;
mod error;
mod join;
mod roots;
mod shift;
mod slots;
mod split;
#[cfg(test)]
mod tests;

pub use configure::{Configure, Configured, configure, configure_on};
pub use error::ForestError;
pub use slots::Span;

/// A skeleton in one of its configurations.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Forest {
    home: Topology,
    topology: Topology,
    bones: Vec<u32>,
    spans: Vec<Option<Span>>,
}

impl Forest {
    /// The forest at home: nothing cut, nothing turned over.
    #[must_use]
    pub fn new(home: &Topology) -> Self {
        let bones: Vec<u32> = (0..home.joint_count() as u32).collect();
        let mut spans = vec![None; home.slot_count()];
        for &slot in home.slot_order() {
            let above = home.slot_parents()[slot as usize];
            spans[slot as usize] = Some(Span { above, own: slot as i32 });
        }
        Self { home: home.clone(), topology: home.clone(), bones, spans }
    }

    /// The configuration in which each joint hangs on the one that `parents` says, -1: a root.
    ///
    /// # Errors
    /// When a joint hangs on one that it has no bone with at home, or the parents form no trees.
    pub fn with_parents(&self, parents: &[i32]) -> Result<Self, ForestError> {
        let home = self.home.parents();
        if parents.len() != home.len() {
            let (parents, slots) = (parents.len(), home.len());
            return Err(TopologyError::LengthMismatch { parents, slots }.into());
        }
        for (joint, &parent) in parents.iter().enumerate() {
            let Ok(above) = usize::try_from(parent) else { continue };
            let is_bone = home[joint] == parent || home.get(above) == Some(&(joint as i32));
            if !is_bone {
                return Err(ForestError::NoBone { joint, parent });
            }
        }
        Self::arranged(self.home.clone(), parents)
    }

    /// The forest at home.
    #[must_use]
    pub fn home(&self) -> &Topology {
        &self.home
    }

    /// Parents and slots in this configuration. Slots that turn a bone at home keep their number; further ones follow.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// For each joint the bone at home, by the joint in which it ends there, whose rotation its slot makes; each bone
    /// is carried by just one joint.
    #[must_use]
    pub fn bones(&self) -> &[u32] {
        &self.bones
    }

    /// For each slot the two world rotations that it leads from and to; `None`: it turns no bone.
    #[must_use]
    pub fn spans(&self) -> &[Option<Span>] {
        &self.spans
    }

    /// For each joint that is cut off from its parent at home: that parent; -1 for all others.
    #[must_use]
    pub fn links(&self) -> Vec<i32> {
        let (home, parents) = (self.home.parents(), self.topology.parents());
        let is_cut = |joint: usize, above: i32| {
            parents[joint] != above && above != NONE && parents[above as usize] != joint as i32
        };
        home.iter()
            .enumerate()
            .map(|(joint, &above)| if is_cut(joint, above) { above } else { NONE })
            .collect()
    }

    /// The root of the tree that a joint belongs to.
    #[must_use]
    pub fn root_of(&self, joint: usize) -> usize {
        last_of(self.topology.parents(), joint, |_| true)
    }

    /// The joint of a joint's tree that is nearest to home: its root, but for shifts.
    #[must_use]
    pub fn top_of(&self, joint: usize) -> usize {
        let parents = self.topology.parents();
        last_of(self.home.parents(), joint, |(below, above)| {
            parents[below] == above as i32 || parents[above] == below as i32
        })
    }

    /// The forest with these parents, whose bones are known to be bones at home.
    fn arranged(home: Topology, parents: &[i32]) -> Result<Self, ForestError> {
        let bones = bones(&home, parents);
        let (slots, spans) = slots::assign(&home, parents, &bones);
        let topology = Topology::new(parents, &slots, spans.len())?;
        Ok(Self { home, topology, bones, spans })
    }

    fn check(&self, joint: usize) -> Result<(), ForestError> {
        let count = self.home.joint_count();
        if joint < count { Ok(()) } else { Err(ForestError::NoJoint { joint, count }) }
    }
}

/// The last joint on the way up from `joint` that is reached by steps of which `goes_on` holds.
fn last_of(parents: &[i32], mut joint: usize, goes_on: impl Fn((usize, usize)) -> bool) -> usize {
    while let Some(above) = usize::try_from(parents[joint]).ok().filter(|&above| goes_on((joint, above))) {
        joint = above;
    }
    joint
}

/// The bone at home that each joint carries: the one above it, the former parent's where the tree is turned over, and
/// for a root the one that is cut above the top of its tree.
fn bones(home: &Topology, parents: &[i32]) -> Vec<u32> {
    let carried = |joint: usize| match usize::try_from(parents[joint]) {
        Ok(parent) if home.parents()[parent] == joint as i32 => parent,
        Ok(_) => joint,
        Err(_) => last_of(home.parents(), joint, |(below, above)| parents[above] == below as i32),
    };
    (0..parents.len()).map(|joint| carried(joint) as u32).collect()
}
