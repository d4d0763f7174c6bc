//! Why clips, or what is left of them, make no database.

use std::fmt;

use super::index::IndexError;
use crate::error::ShapeError;

/// Why clips make no database.
#[derive(Debug, Clone, PartialEq)]
pub enum DatabaseError {
    /// Arrays that do not fit together.
    Shape(ShapeError),
    /// A bone that no rotation turns, so that it cannot be seen from another heading.
    FixedBone {
        /// The joint in which it ends.
        joint: usize,
    },
    /// A number that is not finite.
    NotFinite {
        /// Which array, as [`super::builder::ClipPoses`] names it.
        what: &'static str,
        /// The first such frame.
        frame: usize,
    },
    /// No clip is longer than the schema's horizon.
    NoCandidates {
        /// Frames that a clip must have at least.
        needed: usize,
    },
    /// More rows than a row number can count.
    TooManyRows,
    /// Features that cannot be searched.
    Index(IndexError),
}

impl fmt::Display for DatabaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape(error) => error.fmt(f),
            Self::FixedBone { joint } => {
                write!(
                    f,
                    "no rotation turns the bone that ends in joint {joint}; give its root a rotation slot"
                )
            }
            Self::NotFinite { what, frame } => {
                write!(f, "{what} of frame {frame} are not all finite numbers")
            }
            Self::NoCandidates { needed } => {
                write!(f, "no clip has the {needed} frames that a row and its future need")
            }
            Self::Index(error) => error.fmt(f),
            Self::TooManyRows => f.write_str("a database holds at most 4,294,967,295 frames"),
        }
    }
}

impl std::error::Error for DatabaseError {}

impl From<ShapeError> for DatabaseError {
    fn from(error: ShapeError) -> Self {
        Self::Shape(error)
    }
}

impl From<IndexError> for DatabaseError {
    fn from(error: IndexError) -> Self {
        Self::Index(error)
    }
}
