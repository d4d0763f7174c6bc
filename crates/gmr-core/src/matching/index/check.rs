//! Whether an index is that of some rows, in full: every number of it is looked at.

use super::boxes::nodes_above;
use super::rows::Rows;
use super::tree::{Tree, View};
use super::{Index, IndexError, Kernels};
use crate::error::ShapeError;

/// What an index is held against.
struct Truth<'a> {
    features: &'a [f32],
    candidates: &'a [bool],
    tags: &'a [u32],
}

impl Index {
    /// Whether searches of this index find what a look at every row would find. Reads all of the index and all
    /// candidates: an index in memory is right as it was built, one in a file is as right as the file.
    ///
    /// `features` holds frames x `dims` numbers, `candidates` and `tags` one entry a frame.
    ///
    /// # Errors
    /// When an array's length does not fit, a part of the file is not as it was saved, or the index is another one
    /// than that of these rows.
    pub fn check(&self, features: &[f32], candidates: &[bool], tags: &[u32]) -> Result<(), IndexError> {
        ShapeError::check("features", self.frame_count.saturating_mul(self.dims), features.len())?;
        ShapeError::check("candidates", self.frame_count, candidates.len())?;
        ShapeError::check("tags", self.frame_count, tags.len())?;
        let truth = Truth { features, candidates, tags };
        let found = truth.check(&self.tree, self.kernels);
        // Damage says more than what it leads to.
        self.check_soundness()?;
        found.map_err(|what| IndexError::Contrary { what })
    }
}

impl Truth<'_> {
    fn check(&self, tree: &Tree, kernels: Kernels) -> Result<(), String> {
        let tree = &tree.view();
        let mut met = vec![false; self.candidates.len()];
        for leaf in 0..tree.levels.leaf_count() {
            self.check_leaf(tree, leaf, &mut met)?;
        }
        if let Some(frame) = met.iter().zip(self.candidates).position(|(met, candidate)| met != candidate) {
            return Err(format!("row {frame} is a candidate that cannot be found"));
        }
        if let Some(node) = (0..tree.levels.node_count()).find(|&node| !tree.is_sound_node(node)) {
            return Err(format!("node {node} is damaged"));
        }
        let right = nodes_above(tree.rows, tree.frames, tree.tags, tree.levels, tree.dims(), 0);
        let is_right = right.boxes.as_slice() == tree.boxes
            && right.lowest == tree.lowest
            && right.tags == tree.node_tags;
        if !is_right {
            return Err("a box is not around what is below it".to_owned());
        }
        let rows = Rows {
            features: self.features,
            dims: tree.dims(),
            candidates: self.candidates,
            tags: Some(self.tags),
        };
        let frames = rows.frames();
        if *tree.axes != rows.axes(&frames, kernels) || *tree.order != rows.widest_first(&frames) {
            return Err("its axes are not those of the rows".to_owned());
        }
        let codes = rows.codes(tree, kernels);
        let are_codes_right = *codes.grids == *tree.grids
            && *codes.boxes == *tree.node_codes
            && *codes.rows == *tree.leaf_codes;
        are_codes_right.then_some(()).ok_or_else(|| "a code is not that of its row or box".to_owned())
    }

    fn check_leaf(&self, tree: &View, leaf: usize, met: &mut [bool]) -> Result<(), String> {
        if !tree.is_sound_leaf(leaf) {
            return Err(format!("leaf {leaf} is damaged"));
        }
        let dims = tree.dims();
        for (lane, &frame) in tree.frames[leaf].iter().enumerate().filter(|&(_, &frame)| frame != u32::MAX) {
            let at = frame as usize;
            let row = self.features.get(at * dims..(at + 1) * dims).unwrap_or_default();
            let laid_out = tree.order.iter().zip(tree.leaf(leaf));
            let is_row = !row.is_empty()
                && laid_out.clone().all(|(&dim, lanes)| lanes[lane].to_bits() == row[dim as usize].to_bits());
            if !is_row || tree.tags[leaf][lane] != self.tags[at] {
                return Err(format!("leaf {leaf} holds other numbers than row {frame}"));
            }
            if !self.candidates[at] || std::mem::replace(&mut met[at], true) {
                return Err(format!("row {frame} can be found twice, or is no candidate"));
            }
        }
        Ok(())
    }
}
