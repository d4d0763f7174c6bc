//! What can be wrong with a mesh or its bones, in words.

use std::fmt;

use crate::error::ShapeError;

/// What a binding can be refused for.
#[derive(Debug, Clone, PartialEq)]
pub enum BindError {
    /// An array of the wrong length.
    Shape(ShapeError),
    /// A vertex that is nowhere.
    Vertex {
        /// The vertex.
        vertex: usize,
        /// Its place.
        place: [f64; 3],
    },
    /// More vertices than a triangle can name.
    TooManyVertices {
        /// How many there are.
        vertex_count: usize,
    },
    /// A bone that is nowhere.
    Bone {
        /// The bone.
        bone: usize,
        /// The joint that turns it.
        joint: i32,
        /// Its head or tail.
        place: [f64; 3],
    },
    /// A bone that no joint turns, or one that is beyond what a skin can follow.
    Joint {
        /// The bone.
        bone: usize,
        /// The joint that it names.
        joint: i32,
    },
    /// Nothing to be bound to.
    NoBones,
    /// A triangle with a vertex that is not there.
    Face {
        /// The triangle.
        face: usize,
        /// The vertex that it names.
        vertex: i64,
        /// How many vertices there are.
        vertex_count: usize,
    },
}

impl From<ShapeError> for BindError {
    fn from(error: ShapeError) -> Self {
        Self::Shape(error)
    }
}

impl fmt::Display for BindError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape(error) => error.fmt(f),
            Self::Vertex { vertex, place } => {
                write!(
                    f,
                    "vertex {vertex} lies at {place:?}; places are finite, and no number is beyond 1e100"
                )
            }
            Self::TooManyVertices { vertex_count } => {
                write!(f, "{vertex_count} vertices; a mesh can have {} at most", i32::MAX)
            }
            Self::Bone { bone, joint, place } => write!(
                f,
                "bone {bone}, of joint {joint}, begins or ends at {place:?}; places are finite, and no number is \
                 beyond 1e100"
            ),
            Self::Joint { bone, joint } => {
                write!(
                    f,
                    "bone {bone} is turned by joint {joint}; joints count from 0 to {}",
                    super::MOST_JOINTS - 1
                )
            }
            Self::NoBones => f.write_str("there is no bone to be bound to"),
            Self::Face { face, vertex, vertex_count } => {
                write!(f, "triangle {face} names vertex {vertex}, but there are {vertex_count}")
            }
        }
    }
}

impl std::error::Error for BindError {}
