//! Kernels for skeletal motion at memory speed.
//!
//! - [`numbers`]: blocks of text numbers to `f64` rows and back, bit-exact.
//! - [`skeleton`]: a forest of joints whose bones are turned by rotation slots.
//! - [`rotation`]: quaternions and the twelve Euler orders.
//! - [`lanes`]: the same arithmetic on one to sixteen frames at once, for each instruction set.
//! - [`kinematics`]: forward kinematics of many frames at once.
//! - [`forest`]: the General Motion Representation: any joint can be a root; shift, split, join.
//! - [`skinning`]: linear and dual quaternion blending, centres of rotation.
//! - [`matching`]: motion matching: features, exact search, controller, trials.
//!
//! Conventions: right-handed, Y up, forward +Z; column vectors; quaternions `(x, y, z, w)`;
//! angles in radians except in Euler rows as files write them (degrees); arrays are C-contiguous,
//! frames first, then joints, then components. Nothing here knows of Python.

pub mod error;
pub mod forest;
pub mod isa;
pub mod kinematics;
pub mod lanes;
pub mod matching;
pub mod numbers;
pub mod parallel;
pub mod rotation;
pub mod skeleton;
pub mod skinning;

pub use error::{JobError, ShapeError, TopologyError};
pub use forest::Forest;
pub use isa::Isa;
pub use skeleton::Topology;
