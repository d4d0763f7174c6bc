//! Where the angles of Euler rows stand, and about which axes they turn.

use crate::error::{JobError, ShapeError};

/// Three axes in composing order; 0: x, 1: y, 2: z.
pub type Axes = [u8; 3];

/// Where the angles of each slot stand in a row, and about which axes they turn.
#[derive(Debug, Clone, Copy)]
pub struct EulerColumns<'a> {
    /// (S, 3): the column of each angle, -1 where there is none (angle 0).
    pub columns: &'a [[i32; 3]],
    /// (S, 3): the axis of each angle, in composing order.
    pub axes: &'a [Axes],
}

impl EulerColumns<'_> {
    /// `Ok` when every column is in a row of `column_count` numbers and every axis is one of three.
    pub(crate) fn check(&self, column_count: usize) -> Result<(), JobError> {
        ShapeError::check("rotation_axes", 3 * self.columns.len(), 3 * self.axes.len())?;
        check_indices("rotation_columns", self.columns.as_flattened(), column_count)?;
        match self.axes.as_flattened().iter().position(|&axis| axis > 2) {
            None => Ok(()),
            Some(at) => {
                let found = self.axes.as_flattened()[at].into();
                Err(JobError::Index { what: "rotation_axes", at, found, count: 3 })
            }
        }
    }

    /// The columns and axes of a slot's angles, in composing order.
    pub(super) fn turns(&self, slot: usize) -> impl Iterator<Item = (usize, u8)> {
        let turns = self.columns[slot].into_iter().zip(self.axes[slot]);
        turns.filter_map(|(column, axis)| usize::try_from(column).ok().map(|column| (column, axis)))
    }
}

/// `Ok` when every index is below `count`, or -1.
pub(crate) fn check_indices(what: &'static str, indices: &[i32], count: usize) -> Result<(), JobError> {
    let inside = |&index: &i32| index == -1 || usize::try_from(index).is_ok_and(|index| index < count);
    match indices.iter().position(|index| !inside(index)) {
        None => Ok(()),
        Some(at) => Err(JobError::Index { what, at, found: indices[at].into(), count }),
    }
}
