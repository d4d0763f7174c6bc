//! Makes a motion [`Database`] of clips, one after another.
//!
//! ```
//! # use gmr_core::matching::{builder::{ClipPoses, DatabaseBuilder}, features::Schema, root::RootTrack};
//! # use gmr_core::Topology;
//! let topology = Topology::new(&[-1, 0, 0], &[-1, 0, 0], 1)?; // hips with two feet
//! let schema = Schema::locomotion(1, 2, 0, 3)?;
//! let mut builder = DatabaseBuilder::new(topology, vec![0], schema, 60.0)?;
//! let frames = 100_usize;
//! let z = |i: usize| i as f32 / 60.0; // 1 m/s forward
//! builder.add_clip(&ClipPoses {
//!     positions: &(0..frames).flat_map(|i| [0.0, 0.9, z(i), 0.1, 0.0, z(i), -0.1, 0.0, z(i)]).collect::<Vec<f32>>(),
//!     rotations: &[0.0, 0.0, 0.0, 1.0].repeat(frames),
//!     translations: &(0..frames).flat_map(|i| [0.0, 0.9, f64::from(z(i))]).collect::<Vec<f64>>(),
//!     offsets: &[0.0, 0.9, 0.0, 0.1, -0.9, 0.0, -0.1, -0.9, 0.0],
//!     root: &RootTrack {
//!         ground: (0..frames).map(|i| [0.0, f64::from(z(i))]).collect(),
//!         heading: vec![0.0; frames],
//!     },
//!     tags: &[],
//! })?;
//! let database = builder.finish(None, 1)?;
//! assert_eq!(database.row_count(), 100);
//! assert_eq!(database.candidates().iter().filter(|&&c| c).count(), 40);
//! assert!((database.step(7).displacement[1] * 60.0 - 1.0).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::ShapeError;
use crate::matching::database::{Clip, Database, Rows};
use crate::matching::database_error::DatabaseError;
use crate::matching::features::{Extraction, Schema, extract};
use crate::matching::ground::{Placement, Step, sin_cos};
use crate::matching::index::Index;
use crate::matching::normalization::Normalization;
use crate::matching::root::RootTrack;
use crate::skeleton::{NONE, Topology};
use glam::{DQuat, DVec2};
use std::sync::Arc;

/// One clip to be added: F frames at the database's rate, metres, Y up, as the world has them.
#[derive(Debug, Clone, Copy)]
pub struct ClipPoses<'a> {
    /// World positions `(F, J, 3)`.
    pub positions: &'a [f32],
    /// Local slot quaternions `(F, S, 4)`, xyzw.
    pub rotations: &'a [f64],
    /// Translations `(F, T, 3)` of the translated joints: a root's world position, else the bone in its slot's frame.
    pub translations: &'a [f64],
    /// Offsets `(J, 3)` of this clip's skeleton.
    pub offsets: &'a [f64],
    /// Its simulation root.
    pub root: &'a RootTrack,
    /// Tag bits of each frame; empty: all bits clear.
    pub tags: &'a [u32],
}

/// Collects clips, then makes the [`Database`].
#[derive(Debug)]
pub struct DatabaseBuilder {
    topology: Topology,
    translated: Vec<i32>,
    world_slots: Vec<usize>,
    bone_sets: Vec<Vec<f32>>,
    schema: Schema,
    rate: f64,
    rows: Growing,
}

/// What becomes [`Rows`].
#[derive(Debug, Default)]
struct Growing {
    clips: Vec<Clip>,
    clip_of: Vec<u32>,
    features: Vec<f32>,
    candidates: Vec<bool>,
    tags: Vec<u32>,
    steps: Vec<[f32; 3]>,
    ground: Vec<[f64; 2]>,
    heading: Vec<f64>,
    positions: Vec<f32>,
    rotations: Vec<f32>,
    translations: Vec<f32>,
}

impl From<Growing> for Rows {
    fn from(grown: Growing) -> Self {
        Self {
            clips: grown.clips,
            clip_of: grown.clip_of.into(),
            features: grown.features.into(),
            candidates: grown.candidates.into(),
            tags: grown.tags.into(),
            steps: grown.steps.into(),
            ground: grown.ground.into(),
            heading: grown.heading.into(),
            positions: grown.positions.into(),
            rotations: grown.rotations.into(),
            translations: grown.translations.into(),
        }
    }
}

/// Whether clips can be put on this skeleton.
pub(super) fn check_skeleton(topology: &Topology, translated: &[i32]) -> Result<(), DatabaseError> {
    let joints = topology.joint_count();
    if let Some(&joint) = translated.iter().find(|&&joint| joint < 0 || joint as usize >= joints) {
        return Err(ShapeError {
            what: "joints",
            expected: (joint as usize).saturating_add(1),
            found: joints,
        }
        .into());
    }
    let fixed = (0..joints).find(|&j| topology.parents()[j] != NONE && topology.world_slots()[j] == NONE);
    fixed.map_or(Ok(()), |joint| Err(DatabaseError::FixedBone { joint }))
}

impl DatabaseBuilder {
    /// A builder for clips on one skeleton; `translated` are the joints with a translation in every frame.
    ///
    /// # Errors
    /// When a translated joint is not there, or a bone stands under no rotation.
    pub fn new(
        topology: Topology,
        translated: Vec<i32>,
        schema: Schema,
        rate: f64,
    ) -> Result<Self, DatabaseError> {
        check_skeleton(&topology, &translated)?;
        let world_slots = topology
            .slot_order()
            .iter()
            .map(|&slot| slot as usize)
            .filter(|&slot| topology.slot_parents()[slot] == NONE)
            .collect();
        let rows = Growing::default();
        Ok(Self { topology, translated, world_slots, bone_sets: Vec::new(), schema, rate, rows })
    }

    /// Frames that a clip must have to hold one candidate.
    #[must_use]
    pub fn needed_frames(&self) -> usize {
        self.schema.past() + 1 + self.schema.future()
    }

    /// Adds a clip after those there are; returns its index. On an error the builder is as it was.
    ///
    /// # Errors
    /// When its arrays do not fit together or hold numbers that are not finite.
    pub fn add_clip(&mut self, clip: &ClipPoses<'_>) -> Result<usize, DatabaseError> {
        let frames = clip.root.ground.len();
        self.check(clip, frames)?;
        let start = self.rows.clip_of.len();
        let rows = u32::try_from(start).ok().zip(u32::try_from(start + frames).ok());
        let (first, end) = rows.ok_or(DatabaseError::TooManyRows)?;

        let joint_count = self.topology.joint_count();
        let seen = Extraction { positions: clip.positions, joint_count, root: clip.root, rate: self.rate };
        extract(&self.schema, &seen, &mut self.rows.features)?;
        self.add_poses(clip);
        let index = self.rows.clips.len();
        let (past, future) = (self.schema.past(), self.schema.future());
        self.rows.candidates.extend((0..frames).map(|i| i >= past && i + future < frames));
        self.rows.clip_of.extend(std::iter::repeat_n(index as u32, frames));
        if clip.tags.is_empty() {
            self.rows.tags.extend(std::iter::repeat_n(0, frames));
        } else {
            self.rows.tags.extend(clip.tags);
        }
        self.rows.steps.extend(steps(clip.root).into_iter().map(<[f32; 3]>::from));
        self.rows.ground.extend(&clip.root.ground);
        self.rows.heading.extend(&clip.root.heading);
        let bones = self.bone_set(clip.offsets);
        self.rows.clips.push(Clip { rows: first..end, bones });
        Ok(index)
    }

    /// The database of all clips added, scaled by its own candidates or by `frozen`; its index is built by `threads`
    /// threads (0: all cores), on which its bits do not depend.
    ///
    /// # Errors
    /// When no clip holds a candidate, `frozen` belongs to another schema, or a feature is too large for a number.
    pub fn finish(
        mut self,
        frozen: Option<Normalization>,
        threads: usize,
    ) -> Result<Database, DatabaseError> {
        if !self.rows.candidates.contains(&true) {
            return Err(DatabaseError::NoCandidates { needed: self.needed_frames() });
        }
        let (normalization, constant_groups) = match frozen {
            Some(normalization) => {
                ShapeError::check("normalization offset", self.schema.dims(), normalization.offset.len())?;
                ShapeError::check("normalization scale", self.schema.dims(), normalization.scale.len())?;
                (normalization, Vec::new())
            }
            None => Normalization::fit(&self.schema, &self.rows.features, &self.rows.candidates)?,
        };
        normalization.normalize(&mut self.rows.features);
        let rows = &self.rows;
        let index =
            Index::build(&rows.features, self.schema.dims(), &rows.candidates, Some(&rows.tags), threads)?;
        Ok(Database {
            topology: self.topology,
            translated: self.translated,
            bone_sets: self.bone_sets.concat().into(),
            schema: self.schema,
            rate: self.rate,
            normalization,
            constant_groups,
            index: Arc::new(index),
            rows: Arc::new(self.rows.into()),
            left: None,
        })
    }

    fn check(&self, clip: &ClipPoses<'_>, frames: usize) -> Result<(), DatabaseError> {
        let (joints, slots) = (self.topology.joint_count(), self.topology.slot_count());
        ShapeError::check("root headings", frames, clip.root.heading.len())?;
        ShapeError::check("positions", frames * joints * 3, clip.positions.len())?;
        ShapeError::check("rotations", frames * slots * 4, clip.rotations.len())?;
        ShapeError::check("translations", frames * self.translated.len() * 3, clip.translations.len())?;
        ShapeError::check("offsets", joints * 3, clip.offsets.len())?;
        if !clip.tags.is_empty() {
            ShapeError::check("tags", frames, clip.tags.len())?;
        }
        let not_finite = |what, bad: Option<usize>, width: usize| match bad {
            Some(at) => Err(DatabaseError::NotFinite { what, frame: at / width.max(1) }),
            None => Ok(()),
        };
        let bad = |values: &[f64]| values.iter().position(|x| !x.is_finite());
        not_finite("positions", clip.positions.iter().position(|x| !x.is_finite()), joints * 3)?;
        not_finite("rotations", bad(clip.rotations), slots * 4)?;
        not_finite("translations", bad(clip.translations), self.translated.len() * 3)?;
        not_finite("root headings", bad(&clip.root.heading), 1)?;
        not_finite("root positions", bad(clip.root.ground.as_flattened()), 2)
    }

    /// Positions, rotations and translations, turned from the world into the character's frame.
    fn add_poses(&mut self, clip: &ClipPoses<'_>) {
        let widths =
            [3 * self.topology.joint_count(), 4 * self.topology.slot_count(), 3 * self.translated.len()];
        let is_root = |&joint: &i32| self.topology.parents()[joint as usize] == NONE;
        let roots: Vec<bool> = self.translated.iter().map(is_root).collect();
        let positions = grown(&mut self.rows.positions, clip.positions.len());
        let rotations = grown(&mut self.rows.rotations, clip.rotations.len());
        let translations = grown(&mut self.rows.translations, clip.translations.len());
        for frame in 0..clip.root.len() {
            let frame_of = CharacterFrame::new(clip.root.at(frame));
            let [joints, slots, moving] = widths.map(|width| frame * width..(frame + 1) * width);
            let world = clip.positions[joints.clone()].as_chunks::<3>().0;
            for (p, out) in world.iter().zip(positions[joints].as_chunks_mut::<3>().0) {
                *out = frame_of.point(p.map(f64::from));
            }
            let (local, row) = (&clip.rotations[slots.clone()], &mut rotations[slots]);
            local.iter().zip(&mut *row).for_each(|(&x, out)| *out = x as f32);
            for &slot in &self.world_slots {
                let turned = frame_of.turn * DQuat::from_slice(&local[4 * slot..]);
                turned.as_quat().write_to_slice(&mut row[4 * slot..]);
            }
            let bones = clip.translations[moving.clone()].as_chunks::<3>().0;
            let row = translations[moving].as_chunks_mut::<3>().0;
            for ((t, out), &is_root) in bones.iter().zip(row).zip(&roots) {
                *out = if is_root { frame_of.point(*t) } else { t.map(|x| x as f32) };
            }
        }
    }

    /// The bone set with these offsets, new if none has them.
    fn bone_set(&mut self, offsets: &[f64]) -> u32 {
        let offsets: Vec<f32> = offsets.iter().map(|&x| x as f32).collect();
        let known = self.bone_sets.iter().position(|set| *set == offsets);
        known.unwrap_or_else(|| {
            self.bone_sets.push(offsets);
            self.bone_sets.len() - 1
        }) as u32
    }
}

/// `values` with `more` zeros after them, and those zeros.
fn grown(values: &mut Vec<f32>, more: usize) -> &mut [f32] {
    let start = values.len();
    values.resize(start + more, 0.0);
    &mut values[start..]
}

/// A root's placement, ready to turn points and rotations into it.
struct CharacterFrame {
    origin: DVec2,
    turn: DQuat,
    sin: f64,
    cos: f64,
}

impl CharacterFrame {
    fn new(root: Placement) -> Self {
        let (sin, cos) = sin_cos(root.heading);
        let (half_sin, half_cos) = sin_cos(-0.5 * root.heading);
        Self { origin: root.position, turn: DQuat::from_xyzw(0.0, half_sin, 0.0, half_cos), sin, cos }
    }

    fn point(&self, [x, y, z]: [f64; 3]) -> [f32; 3] {
        let (x, z) = (x - self.origin.x, z - self.origin.y);
        [x * self.cos - z * self.sin, y, x * self.sin + z * self.cos].map(|v| v as f32)
    }
}

/// From each frame to the next; the last repeats the one before.
fn steps(root: &RootTrack) -> Vec<Step> {
    let mut steps: Vec<Step> = (1..root.len())
        .map(|i| {
            let (from, to) = (root.at(i - 1), root.at(i));
            let displacement = from.unrotate(to.position - from.position).as_vec2().to_array();
            Step { displacement, turn: (to.heading - from.heading) as f32 }
        })
        .collect();
    if !root.is_empty() {
        steps.push(steps.last().copied().unwrap_or_default());
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::index::{Hit, Query};
    use glam::DVec3;

    const FRAMES: usize = 90;

    /// Hips (translated), a foot on a bone turned by the hips' slot; the root turns at 1 rad/s while walking at 1 m/s.
    struct Walk {
        positions: Vec<f32>,
        rotations: Vec<f64>,
        translations: Vec<f64>,
        offsets: Vec<f64>,
        root: RootTrack,
    }

    impl Walk {
        fn new(turn: f64, foot: [f64; 3]) -> Self {
            let mut walk = Self {
                positions: Vec::new(),
                rotations: Vec::new(),
                translations: Vec::new(),
                offsets: [[0.0; 3], foot].concat(),
                root: RootTrack::default(),
            };
            for i in 0..FRAMES {
                let t = i as f64 / 60.0;
                let heading = t + turn;
                let hips = DVec3::new(3.0 - heading.cos(), 0.9, heading.sin());
                let turned = DQuat::from_rotation_y(heading);
                let foot = hips + turned * DVec3::from(foot);
                walk.positions.extend(hips.as_vec3().to_array());
                walk.positions.extend(foot.as_vec3().to_array());
                walk.rotations.extend(turned.to_array());
                walk.translations.extend(hips.to_array());
                walk.root.ground.push([hips.x, hips.z]);
                walk.root.heading.push(heading);
            }
            walk
        }

        fn clip(&self) -> ClipPoses<'_> {
            ClipPoses {
                positions: &self.positions,
                rotations: &self.rotations,
                translations: &self.translations,
                offsets: &self.offsets,
                root: &self.root,
                tags: &[],
            }
        }
    }

    fn builder() -> DatabaseBuilder {
        let topology = Topology::new(&[-1, 0], &[-1, 0], 1).unwrap();
        DatabaseBuilder::new(topology, vec![0], Schema::locomotion(1, 1, 0, 2).unwrap(), 60.0).unwrap()
    }

    #[test]
    fn poses_are_kept_in_the_character_frame() {
        let walk = Walk::new(0.5, [0.1, -0.9, 0.2]);
        let mut builder = builder();
        builder.add_clip(&walk.clip()).unwrap();
        let database = builder.finish(None, 1).unwrap();
        for row in 0..FRAMES as u32 {
            let expected = [0.0, 0.9, 0.0, 0.1, 0.0, 0.2];
            assert!(database.position_row(row).iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6));
            assert!((database.rotation_row(row)[3].abs() - 1.0).abs() < 1e-6, "no rotation is left");
            assert!((database.translation_row(row)[1] - 0.9).abs() < 1e-6);
            assert!(database.translation_row(row)[0].abs() < 1e-6);
        }
    }

    #[test]
    fn steps_integrate_to_the_root_of_the_clip() {
        let walk = Walk::new(-1.0, [0.1, -0.9, 0.2]);
        let mut builder = builder();
        builder.add_clip(&walk.clip()).unwrap();
        let database = builder.finish(None, 1).unwrap();
        let mut root = walk.root.at(0);
        assert_eq!((root.position.to_array(), root.heading), (database.ground()[0], database.heading()[0]));
        for row in 0..FRAMES as u32 - 1 {
            let step = database.step(row);
            root = root.advanced(step.displacement.map(f64::from).into(), f64::from(step.turn));
        }
        let end = walk.root.at(FRAMES - 1);
        assert!((root.position - end.position).length() < 1e-5 && (root.heading - end.heading).abs() < 1e-5);
        assert_eq!(database.step(FRAMES as u32 - 1), database.step(FRAMES as u32 - 2));
        assert!(database.step(3).displacement[1] > 0.0 && database.step(3).turn > 0.0);
    }

    #[test]
    fn only_rows_with_their_whole_future_are_candidates() {
        let mut builder = builder();
        assert_eq!(builder.needed_frames(), 61);
        let (a, b) = (Walk::new(0.0, [0.1, -0.9, 0.2]), Walk::new(1.0, [0.1, -0.8, 0.2]));
        assert_eq!(builder.add_clip(&a.clip()), Ok(0));
        assert_eq!(builder.add_clip(&b.clip()), Ok(1));
        let database = builder.finish(None, 1).unwrap();
        for row in 0..2 * FRAMES {
            assert_eq!(database.candidates()[row], row % FRAMES < 30);
        }
        assert_eq!(database.index().candidate_count(), 60);
        let found = database.index().search(&Query::new(database.feature_row(107))).unwrap();
        assert_eq!(found, Some(Hit { frame: 107, cost: 0.0 }));
        assert_eq!(database.next_row(88), Some(89));
        assert_eq!(database.next_row(89), None);
        assert_eq!(database.clip_rows(90), 90..180);
        assert_eq!((database.offsets(0)[4], database.offsets(90)[4]), (-0.9, -0.8));
    }

    #[test]
    fn a_frozen_normalization_is_kept() {
        let (a, b) = (Walk::new(0.0, [0.1, -0.9, 0.2]), Walk::new(1.0, [0.1, -0.8, 0.3]));
        let mut whole = builder();
        whole.add_clip(&a.clip()).unwrap();
        whole.add_clip(&b.clip()).unwrap();
        let whole = whole.finish(None, 1).unwrap();
        let mut part = builder();
        part.add_clip(&b.clip()).unwrap();
        let part = part.finish(Some(whole.normalization().clone()), 1).unwrap();
        assert_eq!(part.features(), &whole.features()[FRAMES * 27..]);
    }

    #[test]
    fn what_does_not_fit_is_refused_and_leaves_the_builder_as_it_was() {
        let walk = Walk::new(0.0, [0.1, -0.9, 0.2]);
        let mut builder = builder();
        let short = ClipPoses { rotations: &walk.rotations[4..], ..walk.clip() };
        assert!(matches!(builder.add_clip(&short), Err(DatabaseError::Shape(_))));
        let mut positions = walk.positions.clone();
        positions[6 * 7 + 2] = f32::NAN;
        let broken = ClipPoses { positions: &positions, ..walk.clip() };
        assert_eq!(builder.add_clip(&broken), Err(DatabaseError::NotFinite { what: "positions", frame: 7 }));
        assert_eq!(builder.finish(None, 1).unwrap_err(), DatabaseError::NoCandidates { needed: 61 });
        let fixed = Topology::new(&[-1, 0], &[-1, -1], 0).unwrap();
        let schema = Schema::locomotion(1, 1, 0, 2).unwrap();
        let refused = DatabaseBuilder::new(fixed, vec![0], schema, 60.0);
        assert_eq!(refused.unwrap_err(), DatabaseError::FixedBone { joint: 1 });
    }
}
