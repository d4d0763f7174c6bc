//! What a thread does at a time: some windows of vertices in each of some frames.

use std::ops::Range;

use super::Skin;
use super::arrangement::{Run, WINDOW};
use super::bones::Bones;
use super::lines::Points;
use super::method::Method;

/// What one thread does at a time, in each of some frames.
pub(super) struct Work<'a> {
    pub(super) skin: &'a Skin,
    pub(super) method: Method<'a>,
    /// Of each block, where the method has any.
    pub(super) centers: &'a [Points],
    pub(super) windows: Range<usize>,
    /// Whether the answer for all frames outgrows the caches.
    pub(super) is_large: bool,
}

impl Work<'_> {
    /// The first vertex and the runs of each window.
    pub(super) fn windows(&self) -> impl Iterator<Item = (usize, &[Run])> {
        self.skin.windows().skip(self.windows.start).take(self.windows.len())
    }

    pub(super) fn first_vertex(&self) -> usize {
        self.windows.start * WINDOW
    }
}

/// A frame's bones, and room for the vertices of the work.
pub(super) struct Frame<'a> {
    pub(super) bones: Bones,
    pub(super) positions: &'a mut [f32],
    pub(super) normals: Option<&'a mut [f32]>,
}

/// A window in a frame.
#[derive(Clone, Copy)]
pub(super) struct Window<'a> {
    pub(super) work: &'a Work<'a>,
    pub(super) bones: &'a Bones,
    /// The first vertex.
    pub(super) start: usize,
    /// Whether it is yet to be fetched.
    pub(super) is_far: bool,
}
