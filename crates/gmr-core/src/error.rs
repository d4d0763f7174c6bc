//! What can be wrong with a job's inputs, in words.

use std::fmt;

/// An array whose length does not fit the job it was given to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShapeError {
    /// Which array, as the job names it.
    pub what: &'static str,
    /// How many elements the job needs.
    pub expected: usize,
    /// How many elements it was given.
    pub found: usize,
}

impl ShapeError {
    /// `Ok` when `found` is what `expected` says, else the error that names `what`.
    pub fn check(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self { what, expected, found }) }
    }
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} holds {} elements where {} are needed", self.what, self.found, self.expected)
    }
}

impl std::error::Error for ShapeError {}

/// Why parents and slots do not make a forest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TopologyError {
    /// One array is longer than the other.
    LengthMismatch {
        /// Length of the parents.
        parents: usize,
        /// Length of the slots.
        slots: usize,
    },
    /// A parent or slot index outside its array.
    OutOfRange {
        /// The joint whose entry is wrong.
        joint: usize,
        /// `"parent"` or `"slot"`.
        what: &'static str,
        /// The index found.
        found: i32,
        /// The number of joints or slots there are.
        count: usize,
    },
    /// Following parents from this joint never ends.
    Cycle {
        /// One joint of the cycle.
        joint: usize,
    },
    /// Two bones share a slot but hang on different parents.
    SharedSlot {
        /// The slot.
        slot: usize,
        /// The two joints whose bones it would turn.
        joints: (usize, usize),
    },
}

impl fmt::Display for TopologyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LengthMismatch { parents, slots } => {
                write!(f, "{parents} parents but {slots} slots; give one of each for every joint")
            }
            Self::OutOfRange { joint, what, found, count } => {
                write!(f, "joint {joint} names {what} {found}, but there are {count}; use -1 for none")
            }
            Self::Cycle { joint } => write!(f, "joint {joint} is its own ancestor; parents must form trees"),
            Self::SharedSlot { slot, joints: (a, b) } => write!(
                f,
                "rotation slot {slot} turns the bones of joints {a} and {b}, which hang on different parents; \
                 only siblings can share a slot"
            ),
        }
    }
}

impl std::error::Error for TopologyError {}
