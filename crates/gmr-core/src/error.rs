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

/// What a job over motion data can be refused for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum JobError {
    /// An array of the wrong length.
    Shape(ShapeError),
    /// An index that points outside what it indexes.
    Index {
        /// The array that holds the index.
        what: &'static str,
        /// Its place in that array.
        at: usize,
        /// The index found.
        found: i64,
        /// How many there are to choose from.
        count: usize,
    },
    /// Angles about these three axes (0: x, 1: y, 2: z) do not reach every rotation.
    Axes {
        /// The slot.
        slot: usize,
        /// Its axes.
        axes: [u8; 3],
    },
    /// A slot that turns no bone hangs nowhere, so it has no world rotation.
    IdleSlot {
        /// The slot.
        slot: usize,
    },
    /// A root that has no translation per frame.
    RootAtRest {
        /// The joint.
        joint: usize,
    },
    /// Two forests that are not configurations of the same one.
    OtherForest,
    /// An instruction set that this machine lacks.
    Isa(crate::Isa),
}

impl From<ShapeError> for JobError {
    fn from(error: ShapeError) -> Self {
        Self::Shape(error)
    }
}

impl fmt::Display for JobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape(error) => error.fmt(f),
            Self::Index { what, at, found, count } => {
                write!(f, "{what} holds {found} at place {at}, but there are {count} to choose from")
            }
            Self::Axes { slot, axes } => write!(
                f,
                "slot {slot} turns about the axes {axes:?}, which do not reach every rotation; \
                 use three axes of which no two neighbours are the same"
            ),
            Self::IdleSlot { slot } => {
                write!(
                    f,
                    "slot {slot} turns no bone, so it has no world rotation; ask for slots that turn one"
                )
            }
            Self::RootAtRest { joint } => {
                write!(f, "root {joint} has no translation per frame; give every root one")
            }
            Self::OtherForest => {
                f.write_str("the two configurations are of different forests; make one from the other")
            }
            Self::Isa(isa) => write!(f, "this machine cannot run {isa}"),
        }
    }
}

impl std::error::Error for JobError {}

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
