//! Rotations: quaternions `(x, y, z, w)` and the twelve Euler orders.
