//! How the transforms of joints are blended.

/// Which of `q` and `-q` an influence adds to the sum: the one that points as...
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hemisphere {
    /// ...that of the joint that weighs most for the vertex (of equal ones the first).
    Pivot,
    /// ...the sum of the influences before it. What Blender does; it depends on their order.
    Running,
}

/// How transforms are blended.
#[derive(Debug, Clone, Copy)]
pub enum Method<'a> {
    /// Linear blending.
    Linear,
    /// Dual quaternion blending, scale and shear linearly before it.
    DualQuaternion(Hemisphere),
    /// About the vertices' centres of rotation (V, 3), from [`super::centers_of_rotation`].
    Centers(&'a [f32]),
}
