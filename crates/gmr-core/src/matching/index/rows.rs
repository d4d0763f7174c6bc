//! What an index is built of.

/// Features and tags of the candidates of a database.
pub(super) struct Rows<'a> {
    pub(super) features: &'a [f32],
    pub(super) dims: usize,
    pub(super) candidates: &'a [bool],
    pub(super) tags: Option<&'a [u32]>,
}

impl Rows<'_> {
    /// The candidates.
    pub(super) fn frames(&self) -> Vec<u32> {
        (0..self.candidates.len() as u32).filter(|&frame| self.candidates[frame as usize]).collect()
    }
}
