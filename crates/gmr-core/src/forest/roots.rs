//! Any to any: the configuration with just these roots.

use super::shift::turn_over;
use super::{Forest, ForestError};
use crate::skeleton::NONE;

impl Forest {
    /// The configuration whose roots are `roots`, whatever this one is: every other bone is whole.
    ///
    /// At home every tree begins at one joint. Where that joint is not among the roots, the tree is turned over to the
    /// first of the roots below it, in the order of the joints; the bones above all others are cut.
    ///
    /// # Errors
    /// When a joint does not exist or is named twice, or a tree would have no root.
    pub fn with_roots(&self, roots: &[usize]) -> Result<Self, ForestError> {
        let home = self.home.parents();
        let mut is_root = vec![false; home.len()];
        for &root in roots {
            self.check(root)?;
            if std::mem::replace(&mut is_root[root], true) {
                return Err(ForestError::Twice { joint: root });
            }
        }
        let mut begins = vec![0; home.len()];
        for &joint in self.home.order() {
            let joint = joint as usize;
            begins[joint] = usize::try_from(home[joint]).map_or(joint, |above| begins[above]);
        }
        let mut parents = home.to_vec();
        let mut has_root = is_root.clone();
        let in_order = self.home.order().iter().map(|&joint| joint as usize);
        for joint in in_order.filter(|&joint| is_root[joint]) {
            if std::mem::replace(&mut has_root[begins[joint]], true) {
                parents[joint] = NONE;
            } else {
                turn_over(&mut parents, joint);
            }
        }
        match (0..home.len()).find(|&joint| home[joint] == NONE && !has_root[joint]) {
            Some(joint) => Err(ForestError::NoRootIn { joint }),
            None => Self::arranged(self.home.clone(), &parents),
        }
    }
}
