//! Skinning: a mesh follows the joints that its vertices are bound to, many frames in one call.
//!
//! A [`Skin`] holds what stays: vertices at rest, and for each vertex its *influences*, the joints that it follows
//! with their weights. [`blend`] takes for each frame and joint the transform `E = M B^-1` (the joint's world matrix
//! now, times the inverse of its bind matrix) and gives the vertices in the world:
//!
//! - [`Method::Linear`]: `v' = (sum_i w_i E_i) v`. Loses volume in bends and twists.
//! - [`Method::DualQuaternion`]: the rigid parts are blended as dual quaternions, `sum_i w_i s_i q_i`, which keeps
//!   volume; scale and shear are blended linearly before that (two phases). The signs `s_i` choose between `q` and
//!   `-q`, which are the same rotation ([`Hemisphere`]).
//! - [`Method::Centers`]: linear for a point of each vertex's own, its centre of rotation, about which the blended
//!   rotation turns the vertex: no loss of volume, and no bulge.
//!
//! Normals, where the skin has them, are turned by the inverse transpose of what moves the vertex.
//!
//! `scalar` is the definition, one vertex at a time; `block` does the same for as many vertices at once as a register
//! holds, and every instruction set gives the same bits.
//!
//! [`bind`] finds which joints a mesh should follow.
//!
//! ```
//! use gmr_core::skinning::{Blend, Blended, Hemisphere, Method, Skin, blend};
//!
//! // One vertex beside the joint of two bones, the second twisted by a quarter turn about y.
//! let skin = Skin::new(&[1.0, 0.0, 0.0], None, &[0, 1], &[0.5, 0.5], 2).unwrap();
//! let mut transforms = glam::DMat4::IDENTITY.to_cols_array().repeat(2);
//! transforms[16..].copy_from_slice(&glam::DMat4::from_rotation_y(std::f64::consts::FRAC_PI_2).transpose().to_cols_array());
//! let mut positions = [0.0; 3];
//! let method = Method::DualQuaternion(Hemisphere::Pivot);
//! let job = Blend { skin: &skin, transforms: &transforms, frame_count: 1, method, threads: 1 };
//! blend(&job, Blended { positions: &mut positions, normals: None }).unwrap();
//! let half = std::f32::consts::FRAC_1_SQRT_2; // an eighth turn, at the same distance from the axis
//! assert!((positions[0] - half).abs() < 1e-6 && (positions[2] + half).abs() < 1e-6);
//! ```
//!
//! Sources: Kavan et al. 2007, "Skinning with Dual Quaternions"; Le and Hodgins 2016, "Real-time Skeletal Skinning
//! with Optimized Centers of Rotation".

mod arrangement;
pub mod bind;
mod blend;
mod block;
mod bones;
mod centers;
mod error;
mod formulas;
mod lines;
mod method;
mod methods;
mod polar;
mod running;
mod scalar;
mod sets;
mod skin;
mod sums;
#[cfg(test)]
mod tests;
mod work;

pub use blend::{Blend, Blended, blend, blend_on};
pub use centers::centers_of_rotation;
pub use error::SkinError;
pub use method::{Hemisphere, Method};
pub use skin::Skin;
