//! What can be wrong with a skin or its transforms, in words.

use std::fmt;

use crate::Isa;
use crate::error::ShapeError;

/// What a skin or a blend can be refused for.
#[derive(Debug, Clone, PartialEq)]
pub enum SkinError {
    /// An array of the wrong length.
    Shape(ShapeError),
    /// A vertex that follows a joint that is not there.
    Joint {
        /// The vertex.
        vertex: usize,
        /// The joint that it names.
        joint: i64,
        /// How many joints there are.
        joint_count: usize,
    },
    /// A weight that is negative, infinite or no number.
    Weight {
        /// The vertex.
        vertex: usize,
        /// Its weight.
        weight: f32,
    },
    /// A vertex whose weights are all 0.
    Loose {
        /// The vertex.
        vertex: usize,
    },
    /// More joints than an influence can name.
    TooManyJoints {
        /// How many there are.
        joint_count: usize,
    },
    /// More influences than can be numbered.
    TooManyInfluences {
        /// How many each vertex has.
        each: usize,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// A triangle with a vertex that is not there.
    Face {
        /// The triangle.
        face: usize,
        /// The vertex that it names.
        vertex: i64,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// A transform whose last row is not `0 0 0 1`.
    NotAffine {
        /// The frame.
        frame: usize,
        /// The joint.
        joint: usize,
    },
    /// Normals are asked for of a skin that has none.
    NoNormals,
    /// An instruction set that this machine lacks.
    Isa(Isa),
}

impl From<ShapeError> for SkinError {
    fn from(error: ShapeError) -> Self {
        Self::Shape(error)
    }
}

impl fmt::Display for SkinError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape(error) => error.fmt(f),
            Self::Joint { vertex, joint, joint_count } => write!(
                f,
                "vertex {vertex} follows joint {joint}, but there are {joint_count}; joints count from 0, and an \
                 influence that is not used names any joint with weight 0"
            ),
            Self::Weight { vertex, weight } => {
                write!(f, "vertex {vertex} has the weight {weight}; weights are finite and not negative")
            }
            Self::Loose { vertex } => write!(
                f,
                "vertex {vertex} follows no joint, for all its weights are 0; bind it, or give it weight 1 for a \
                 joint that stays where it is"
            ),
            Self::TooManyJoints { joint_count } => {
                write!(f, "{joint_count} joints; a skin can follow {} at most", 1 << 16)
            }
            Self::TooManyInfluences { each, vertex_count } => write!(
                f,
                "{each} influences for each of {vertex_count} vertices; a skin holds {} at most, {} for each \
                 vertex. Leave out columns of weight 0, or cut the mesh",
                u32::MAX,
                1 << 16
            ),
            Self::Face { face, vertex, vertex_count } => {
                write!(f, "triangle {face} names vertex {vertex}, but there are {vertex_count}")
            }
            Self::NotAffine { frame, joint } => write!(
                f,
                "the transform of joint {joint} in frame {frame} does not end in the row 0 0 0 1; transforms are \
                 affine and stand on the left of column vectors"
            ),
            Self::NoNormals => f.write_str("normals are asked for, but the skin was made without any"),
            Self::Isa(isa) => write!(f, "this machine cannot run {isa}"),
        }
    }
}

impl std::error::Error for SkinError {}
