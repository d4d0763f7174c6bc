//! Numbers that fill a cache line: those of a joint, or one of each vertex of a block.

use super::arrangement::WIDEST;

/// The numbers of a joint: one cache line, a whole number of registers of any width.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Row(pub(super) [f32; 16]);

impl Row {
    pub(super) const ZERO: Self = Self([0.0; 16]);
}

/// A number of each vertex of a block: one cache line, a whole number of registers of any width.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Wide(pub(super) [f32; WIDEST]);

/// The points of a block.
pub(super) type Points = [Wide; 3];
