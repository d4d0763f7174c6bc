//! What an operation can be refused for, in words.

use std::fmt;

use crate::error::TopologyError;

/// Why a forest cannot be arranged as asked; joints by their index.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ForestError {
    /// An index that is no joint.
    NoJoint {
        /// The index.
        joint: usize,
        /// How many joints there are.
        count: usize,
    },
    /// A joint that is a root already.
    IsRoot {
        /// The joint.
        joint: usize,
    },
    /// A joint that is no root.
    NoRoot {
        /// The joint.
        joint: usize,
        /// The root of its tree.
        root: usize,
    },
    /// The only root there is.
    LastRoot {
        /// The joint.
        joint: usize,
    },
    /// A root without soft link: its tree is where the forest begins.
    NoLink {
        /// The joint.
        joint: usize,
    },
    /// A joint that is named twice.
    Twice {
        /// The joint.
        joint: usize,
    },
    /// A tree in which no joint is to be a root.
    NoRootIn {
        /// The joint at which the tree begins at home.
        joint: usize,
    },
    /// A joint that hangs on one that it has no bone with.
    NoBone {
        /// The joint.
        joint: usize,
        /// What it is said to hang on.
        parent: i32,
    },
    /// Parents that form no trees.
    Topology(TopologyError),
}

impl ForestError {
    /// The error in words, with joints called by `name`.
    #[must_use]
    pub fn describe(&self, name: impl Fn(usize) -> String) -> String {
        match self {
            Self::NoJoint { joint, count } => {
                format!("there is no joint {joint}; the skeleton has joints 0 to {}", count - 1)
            }
            Self::IsRoot { joint } => {
                format!("{} is a root already; split a joint that hangs on another", name(*joint))
            }
            Self::NoRoot { joint, root } => format!(
                "{} is no root, so it cannot be joined; the root of its tree is {}",
                name(*joint),
                name(*root)
            ),
            Self::LastRoot { joint } => format!(
                "{} is the last root, and a skeleton needs one; make another joint the root instead: shift_root",
                name(*joint)
            ),
            Self::NoLink { joint } => format!(
                "{} has no soft link: its tree is where the skeleton begins. Join the other roots, or choose the \
                 roots that are to stay: with_roots",
                name(*joint)
            ),
            Self::Twice { joint } => format!("{} is named twice; name each root once", name(*joint)),
            Self::NoRootIn { joint } => {
                format!("the tree of {} would have no root; name one of its joints too", name(*joint))
            }
            Self::NoBone { joint, parent } => format!(
                "{} cannot hang on {}: they have no bone with each other",
                name(*joint),
                usize::try_from(*parent).map_or_else(|_| parent.to_string(), &name)
            ),
            Self::Topology(error) => error.to_string(),
        }
    }
}

impl From<TopologyError> for ForestError {
    fn from(error: TopologyError) -> Self {
        Self::Topology(error)
    }
}

impl fmt::Display for ForestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe(|joint| format!("joint {joint}")))
    }
}

impl std::error::Error for ForestError {}
