//! Rotations: quaternions `(x, y, z, w)` and the twelve Euler orders.
//!
//! A quaternion is an array of its four components, of `f32`, `f64` or registers of either; glam's `Quat` and
//! `DQuat` become one with `.to_array()` or `.into()` and come back with `from_array`.

mod euler;
mod euler_block;
mod euler_columns;
mod half_angle;
mod quaternion;
mod slerp;
mod turn_slots;

pub use euler::{euler_to_quaternions, quaternions_to_euler, turned_euler_to_quaternions};
pub(crate) use euler_block::EulerBlock;
pub(crate) use euler_columns::check_indices;
pub use euler_columns::{Axes, EulerColumns};
pub(crate) use quaternion::cross;
pub use quaternion::{
    IDENTITY_F32, IDENTITY_F64, conjugate, dot, exp, log, multiply, multiply_axis, multiply_inverse,
    normalize, rotate, rotate_inverse, straighten,
};
pub use slerp::{slerp, slerp_frames};
pub use turn_slots::turn_slots;
