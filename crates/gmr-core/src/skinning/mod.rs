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
//! Sources: Kavan et al. 2007, "Skinning with Dual Quaternions"; Le and Hodgins 2016, "Real-time Skeletal Skinning
//! with Optimized Centers of Rotation".

pub mod bind;
mod blend;
mod block;
mod bones;
mod centers;
mod error;
mod formulas;
mod polar;
mod scalar;
mod skin;
#[cfg(test)]
mod tests;

pub use blend::{Blend, Blended, Hemisphere, Method, blend, blend_on};
pub use centers::centers_of_rotation;
pub use error::SkinError;
pub use skin::Skin;
