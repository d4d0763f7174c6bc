//! Join trees: a root hangs on its old parent again.

use super::shift::turn_over;
use super::{Forest, ForestError};
use crate::skeleton::NONE;

impl Forest {
    /// The forest in which the tree of `root` hangs, by the bone that was cut, on the joint that its soft link names.
    /// A tree that was turned over since is turned back first.
    ///
    /// # Errors
    /// When there is no such joint, it is no root, it is the last root, or its tree has no soft link since it holds
    /// the joint at which the forest begins at home.
    pub fn join(&self, root: usize) -> Result<Self, ForestError> {
        self.check(root)?;
        let mut parents = self.topology.parents().to_vec();
        if parents[root] != NONE {
            return Err(ForestError::NoRoot { joint: root, root: self.root_of(root) });
        }
        let top = self.top_of(root);
        let link = self.home.parents()[top];
        if link == NONE {
            let is_last = parents.iter().filter(|&&parent| parent == NONE).count() == 1;
            return Err(if is_last {
                ForestError::LastRoot { joint: root }
            } else {
                ForestError::NoLink { joint: root }
            });
        }
        turn_over(&mut parents, top);
        parents[top] = link;
        Self::arranged(self.home.clone(), &parents)
    }
}
