//! Shift root: a tree is turned over, so that another of its joints is the root.

use super::{Forest, ForestError};
use crate::skeleton::NONE;

impl Forest {
    /// The forest in which `joint` is the root of its tree. It is its own inverse: shifting back to the old root gives
    /// back the old forest.
    ///
    /// # Errors
    /// When there is no such joint.
    pub fn shift_root(&self, joint: usize) -> Result<Self, ForestError> {
        self.check(joint)?;
        let mut parents = self.topology.parents().to_vec();
        turn_over(&mut parents, joint);
        Self::arranged(self.home.clone(), &parents)
    }
}

/// Turns every bone between `joint` and its root the other way round.
pub(super) fn turn_over(parents: &mut [i32], joint: usize) {
    let (mut below, mut here) = (NONE, joint as i32);
    while here != NONE {
        let above = std::mem::replace(&mut parents[here as usize], below);
        (below, here) = (here, above);
    }
}
