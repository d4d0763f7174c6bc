//! The motion database: all clips one after another at one rate, with what matching compares and playback shows.
//!
//! Rows are frames at [`Database::rate`]. Lengths are metres, Y is up, forward is +Z, left is +X. Poses are kept in the
//! character's frame: origin at the row's simulation root on the ground, turned so that the root's heading is +Z.
//! [`super::builder`] makes it; `super::file` saves it and maps it back into memory.

use crate::error::ShapeError;
use crate::matching::column::Column;
use crate::matching::features::Schema;
use crate::matching::ground::Step;
use crate::matching::index::{Index, Query};
use crate::matching::left::Left;
use crate::matching::normalization::Normalization;
use crate::skeleton::Topology;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Where a clip lies in the database.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Clip {
    /// Its rows.
    pub rows: Range<u32>,
    /// Which of the database's bone sets its skeleton has; see [`Database::offsets`].
    pub bones: u32,
}

/// All clips, their features and their poses; immutable once built.
#[derive(Debug, Clone)]
pub struct Database {
    pub(super) topology: Topology,
    pub(super) translated: Vec<i32>,
    /// `(B, J, 3)`.
    pub(super) bone_sets: Column<f32>,
    pub(super) schema: Schema,
    pub(super) rate: f64,
    pub(super) normalization: Normalization,
    pub(super) constant_groups: Vec<usize>,
    pub(super) index: Arc<Index>,
    pub(super) rows: Arc<Rows>,
    /// `None`: all rows.
    pub(super) left: Option<Arc<Left>>,
}

/// Everything that is kept per row, N rows.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    pub(super) clips: Vec<Clip>,
    /// Which clip each row is of; of a database in a file made when it is asked for.
    pub(super) clip_of: OnceLock<Vec<u32>>,
    pub(super) features: Column<f32>,
    /// The rows whose clip holds all that their features look at; made as `clip_of` is.
    pub(super) candidates: OnceLock<Vec<bool>>,
    pub(super) tags: Column<u32>,
    /// Displacement and turn.
    pub(super) steps: Column<[f32; 3]>,
    pub(super) ground: Column<[f64; 2]>,
    pub(super) heading: Column<f64>,
    pub(super) positions: Column<f32>,
    pub(super) rotations: Column<f32>,
    pub(super) translations: Column<f32>,
}

impl Database {
    /// Frames a second.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Number of rows N.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.rows.tags.len()
    }

    /// Numbers per feature row D.
    #[must_use]
    pub fn dims(&self) -> usize {
        self.schema.dims()
    }

    /// The feature groups; tells which dimensions are trajectory.
    #[must_use]
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// Offset and scale of the features.
    #[must_use]
    pub fn normalization(&self) -> &Normalization {
        &self.normalization
    }

    /// The feature groups that do not vary in this database and so were not scaled.
    #[must_use]
    pub fn constant_groups(&self) -> &[usize] {
        &self.constant_groups
    }

    /// Normalised features `(N, D)`.
    #[must_use]
    pub fn features(&self) -> &[f32] {
        &self.rows.features
    }

    /// Normalised features of one row, D numbers.
    ///
    /// # Panics
    /// When there is no such row (so do all accessors that take a row).
    #[must_use]
    pub fn feature_row(&self, row: u32) -> &[f32] {
        row_of(&self.rows.features, row, self.dims())
    }

    /// The candidates, laid out for search.
    #[must_use]
    pub fn index(&self) -> &Arc<Index> {
        &self.index
    }

    /// The clips, in the order in which they were added.
    #[must_use]
    pub fn clips(&self) -> &[Clip] {
        &self.rows.clips
    }

    /// Index of the clip that each row belongs to (N).
    #[must_use]
    pub fn clip_of(&self) -> &[u32] {
        self.rows.clip_of.get_or_init(|| {
            let rows = self.rows.clips.iter().zip(0..);
            rows.flat_map(|(clip, number)| std::iter::repeat_n(number, clip.rows.len())).collect()
        })
    }

    /// The clip that a row belongs to.
    fn clip_at(&self, row: u32) -> &Clip {
        let number = match self.rows.clip_of.get() {
            Some(clip_of) => clip_of[row as usize] as usize,
            None => self.rows.clips.partition_point(|clip| clip.rows.end <= row),
        };
        &self.rows.clips[number]
    }

    /// The rows of the clip that `row` belongs to.
    #[must_use]
    pub fn clip_rows(&self, row: u32) -> Range<u32> {
        self.clip_at(row).rows.clone()
    }

    /// The row played after `row`: the next of its clip, `None` at the clip's end and where the next one is gone.
    #[must_use]
    pub fn next_row(&self, row: u32) -> Option<u32> {
        (row + 1 < self.clip_rows(row).end && self.has_row(row + 1)).then_some(row + 1)
    }

    /// Whether a row may be shown: all may, but in a [`Database::subset`].
    #[must_use]
    pub fn has_row(&self, row: u32) -> bool {
        self.left.as_ref().is_none_or(|left| left.has(row))
    }

    /// Tag bits of each row (N).
    #[must_use]
    pub fn tags(&self) -> &[u32] {
        &self.rows.tags
    }

    /// What the root does from each row to the next (N). The last row of a clip repeats the step before it.
    #[must_use]
    pub fn steps(&self) -> impl ExactSizeIterator<Item = Step> + '_ {
        self.rows.steps.iter().map(|&step| step.into())
    }

    /// What the root does from `row` to the next one.
    #[must_use]
    pub fn step(&self, row: u32) -> Step {
        self.rows.steps[row as usize].into()
    }

    /// Ground position of the simulation root in its clip's own world (N), metres.
    #[must_use]
    pub fn ground(&self) -> &[[f64; 2]] {
        &self.rows.ground
    }

    /// Heading of the simulation root in its clip's own world (N), radians, continuous within a clip.
    #[must_use]
    pub fn heading(&self) -> &[f64] {
        &self.rows.heading
    }

    /// Positions of all joints in the character's frame `(N, J, 3)`.
    #[must_use]
    pub fn positions(&self) -> &[f32] {
        &self.rows.positions
    }

    /// Positions of one row `(J, 3)`.
    #[must_use]
    pub fn position_row(&self, row: u32) -> &[f32] {
        row_of(&self.rows.positions, row, 3 * self.joint_count())
    }

    /// What a row costs a query by feature group, in the schema's order: each group's part of the cost, its dimensions
    /// summed in their order. The parts add up to the cost, but for rounding.
    ///
    /// `query.features` holds D numbers; of the rest of the query only the weights are looked at.
    ///
    /// # Errors
    /// When features, weights or `costs` are not as many as dimensions and groups.
    pub fn costs_by_group(&self, query: &Query, row: u32, costs: &mut [f32]) -> Result<(), ShapeError> {
        let (dims, groups) = (self.dims(), self.schema.groups().len());
        ShapeError::check("query features", dims, query.features.len())?;
        ShapeError::check("query weights", dims, query.weights.map_or(dims, <[f32]>::len))?;
        ShapeError::check("costs by group", groups, costs.len())?;
        for (group, cost) in costs.iter_mut().enumerate() {
            let range = self.schema.range(group);
            let weights = query.weights.map(|weights| &weights[range.clone()]);
            let part = Query { weights, ..Query::new(&query.features[range.clone()]) };
            *cost = part.cost_of(&self.feature_row(row)[range]);
        }
        Ok(())
    }

    /// Local slot quaternions `(N, S, 4)`, xyzw; the slots that stand under the world are in the character's frame.
    #[must_use]
    pub fn rotations(&self) -> &[f32] {
        &self.rows.rotations
    }

    /// Slot quaternions of one row `(S, 4)`.
    #[must_use]
    pub fn rotation_row(&self, row: u32) -> &[f32] {
        row_of(&self.rows.rotations, row, 4 * self.slot_count())
    }

    /// Translations `(N, T, 3)` of the translated joints; those of roots are in the character's frame.
    #[must_use]
    pub fn translations(&self) -> &[f32] {
        &self.rows.translations
    }

    /// Translations of one row `(T, 3)`.
    #[must_use]
    pub fn translation_row(&self, row: u32) -> &[f32] {
        row_of(&self.rows.translations, row, 3 * self.translated.len())
    }

    /// Parents and slots of the skeleton that all clips share.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Number of joints J.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.topology.joint_count()
    }

    /// Number of rotation slots S.
    #[must_use]
    pub fn slot_count(&self) -> usize {
        self.topology.slot_count()
    }

    /// The joints with a translation in every frame (T).
    #[must_use]
    pub fn translated(&self) -> &[i32] {
        &self.translated
    }

    /// Offsets `(J, 3)`, metres, of the skeleton of the clip that `row` belongs to: performers differ in size.
    #[must_use]
    pub fn offsets(&self, row: u32) -> &[f32] {
        row_of(&self.bone_sets, self.clip_at(row).bones, 3 * self.joint_count())
    }
}

fn row_of(values: &[f32], row: u32, width: usize) -> &[f32] {
    let start = row as usize * width;
    &values[start..start + width]
}
