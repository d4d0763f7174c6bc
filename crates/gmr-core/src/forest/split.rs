//! Split tree: a joint becomes a root of its own.

use super::{Forest, ForestError};
use crate::skeleton::NONE;

impl Forest {
    /// The forest in which `joint` is a root too; the bone above it is cut and remembered as a soft link.
    ///
    /// # Errors
    /// When there is no such joint, or it is a root already.
    pub fn split(&self, joint: usize) -> Result<Self, ForestError> {
        self.check(joint)?;
        let mut parents = self.topology.parents().to_vec();
        if parents[joint] == NONE {
            return Err(ForestError::IsRoot { joint });
        }
        parents[joint] = NONE;
        Self::arranged(self.home.clone(), &parents)
    }
}
