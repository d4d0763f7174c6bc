//! The poses that a trial shows: its rows one after the other, every jump inertialised.
//!
//! All that is needed is in the log: a jump is where a row is not the one that follows the row before. There the slot
//! rotations, the bone vectors and the root keep what they showed and how fast it changed, and their differences to
//! the new row die away ([`super::inertialization`]). Bone vectors are among them because performers differ in size.

use std::fmt;

use glam::{DQuat, DVec2, DVec3};

use super::database::Database;
use super::ground::Placement;
use super::inertialization::{
    DecaySpring, Moving, Turning, inertialize_transition, inertialize_transition_rotation,
    inertialize_update, inertialize_update_rotation,
};
use super::pose::PoseReader;
use crate::error::{JobError, ShapeError, TopologyError};
use crate::kinematics::{ForwardKinematics, Pose, World, forward_kinematics};
use crate::skeleton::NONE;

/// Half-life of the offsets in seconds.
pub const HALF_LIFE: f64 = 0.1;

/// What was shown, step by step.
#[derive(Debug, Clone, Copy)]
pub struct Playback<'a> {
    /// Where the rows are from.
    pub database: &'a Database,
    /// The row of each step (T).
    pub rows: &'a [u32],
    /// Where its root stood (T).
    pub placements: &'a [Placement],
    /// Seconds, above 0; see [`HALF_LIFE`].
    pub half_life: f64,
    /// The joints asked for (K); `None`: all.
    pub joints: Option<&'a [i32]>,
}

/// Frames that forward kinematics takes at a time: a block of poses stays in the cache.
const BLOCK: usize = 64;

/// Fills `positions` `(T, K, 3)` with the world positions of the joints, metres.
///
/// # Errors
/// When lengths do not fit, a row or a joint is not there, or the half-life is no time.
pub fn shown_positions(playback: &Playback, positions: &mut [f32]) -> Result<(), PlaybackError> {
    playback.check()?;
    let database = playback.database;
    let width = 3 * playback.joints.map_or(database.joint_count(), <[i32]>::len);
    ShapeError::check("positions", playback.rows.len() * width, positions.len()).map_err(JobError::from)?;
    if width == 0 {
        return Ok(());
    }
    let translated: Vec<i32> = (0..database.joint_count() as i32).collect();
    let offsets = vec![0.0; 3 * database.joint_count()];
    let reader = PoseReader::new(database)?;
    let mut body = Body::new(playback, &reader);
    let mut pose = LocalPoses::default();
    for block in positions.chunks_mut(width * BLOCK) {
        pose.clear();
        (0..block.len() / width).for_each(|_| body.show(&mut pose));
        let job = ForwardKinematics {
            topology: reader.topology(),
            offsets: &offsets,
            translated: &translated,
            pose: Pose::Quaternions {
                rotations: &pose.rotations,
                normalize: false,
                translations: &pose.translations,
            },
            frame_count: block.len() / width,
            joints: playback.joints,
            rotation_slots: None,
            threads: 1,
        };
        forward_kinematics(&job, World { positions: Some(block), rotations: None })?;
    }
    Ok(())
}

impl Playback<'_> {
    fn check(&self) -> Result<(), PlaybackError> {
        ShapeError::check("placements", self.rows.len(), self.placements.len()).map_err(JobError::from)?;
        let count = self.database.row_count();
        if let Some(step) = self.rows.iter().position(|&row| row as usize >= count) {
            return Err(PlaybackError::Row { step, row: self.rows[step], count });
        }
        if !(self.half_life > 0.0 && self.half_life.is_finite()) {
            return Err(PlaybackError::HalfLife { found: self.half_life });
        }
        Ok(())
    }
}

/// Local poses of some frames.
#[derive(Default)]
struct LocalPoses {
    rotations: Vec<f32>,
    translations: Vec<f32>,
}

impl LocalPoses {
    fn clear(&mut self) {
        self.rotations.clear();
        self.translations.clear();
    }
}

/// The offsets of everything that moves, and the step that is shown next.
struct Body<'a> {
    playback: &'a Playback<'a>,
    reader: &'a PoseReader<'a>,
    spring: DecaySpring,
    step: usize,
    /// `(x, heading, z)`.
    root: Moving<DVec3>,
    slots: Vec<Moving<DVec3>>,
    bones: Vec<Moving<DVec3>>,
}

impl<'a> Body<'a> {
    fn new(playback: &'a Playback<'a>, reader: &'a PoseReader<'a>) -> Self {
        let database = playback.database;
        Self {
            playback,
            reader,
            spring: DecaySpring::new(playback.half_life, 1.0 / database.rate()),
            step: 0,
            root: Moving::default(),
            slots: vec![Moving::default(); database.slot_count()],
            bones: vec![Moving::default(); database.joint_count()],
        }
    }

    /// Appends the pose of the next step.
    fn show(&mut self, out: &mut LocalPoses) {
        let row = self.playback.rows[self.step];
        if self.step > 0 {
            self.decay();
            let before = self.playback.rows[self.step - 1];
            let continuing = self.playback.database.next_row(before);
            if continuing != Some(row) {
                self.jump(continuing.unwrap_or(before), row);
            }
        }
        self.append(row, out);
        self.step += 1;
    }

    fn decay(&mut self) {
        for offset in self.slots.iter_mut().chain(&mut self.bones).chain([&mut self.root]) {
            *offset = self.spring.decay_spring_damper_exact(*offset);
        }
    }

    fn jump(&mut self, from: u32, to: u32) {
        self.root = inertialize_transition(self.root, self.root_at(from), self.root_at(to));
        for (slot, offset) in self.slots.iter_mut().enumerate() {
            let [from, to] = [from, to].map(|row| self.reader.turning(row, slot));
            *offset = inertialize_transition_rotation(*offset, from, to);
        }
        for (joint, offset) in self.bones.iter_mut().enumerate() {
            let [from, to] = [from, to].map(|row| self.reader.moving(row, joint));
            *offset = inertialize_transition(*offset, from, to);
        }
    }

    fn append(&self, row: u32, out: &mut LocalPoses) {
        let topology = self.reader.topology();
        let root = inertialize_update(self.root, self.root_at(row)).value;
        let heading = DQuat::from_rotation_y(root.y);
        for (slot, &offset) in self.slots.iter().enumerate() {
            let animation = Turning { rotation: self.reader.rotation(row, slot), velocity: DVec3::ZERO };
            let local = inertialize_update_rotation(offset, animation).rotation;
            let under_world = topology.slot_parents()[slot] == NONE;
            let shown = if under_world { heading * local } else { local };
            out.rotations.extend(shown.normalize().as_quat().to_array());
        }
        for (joint, offset) in self.bones.iter().enumerate() {
            let local = offset.value + self.reader.vector(row, joint);
            let is_root = topology.parents()[joint] == NONE;
            let shown = if is_root { DVec3::new(root.x, 0.0, root.z) + heading * local } else { local };
            out.translations.extend(shown.as_vec3().to_array());
        }
    }

    /// `(x, heading, z)` of the root as it would be now on `row`, and how it would move on.
    fn root_at(&self, row: u32) -> Moving<DVec3> {
        let placement = self.playback.placements[self.step];
        let rate = self.playback.database.rate();
        let step = self.playback.database.step(row);
        let [x, z] = step.displacement.map(f64::from);
        let moved = placement.rotate(DVec2::new(x, z)) * rate;
        Moving {
            value: DVec3::new(placement.position.x, placement.heading, placement.position.y),
            velocity: DVec3::new(moved.x, f64::from(step.turn) * rate, moved.y),
        }
    }
}

/// Why there are no poses.
#[derive(Debug, Clone, PartialEq)]
pub enum PlaybackError {
    /// A length that does not fit, or a joint that is not there.
    Job(JobError),
    /// A skeleton that is no forest once its carriers are roots.
    Topology(TopologyError),
    /// A row that the database does not have.
    Row {
        /// The step that shows it.
        step: usize,
        /// The row.
        row: u32,
        /// How many rows there are.
        count: usize,
    },
    /// A half-life that is no time.
    HalfLife {
        /// The seconds asked for.
        found: f64,
    },
}

impl fmt::Display for PlaybackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Job(error) => error.fmt(f),
            Self::Topology(error) => error.fmt(f),
            Self::Row { step, row, count } => {
                write!(f, "step {step} shows row {row}, but the database has {count} rows")
            }
            Self::HalfLife { found } => {
                write!(f, "a half-life of {found} s is not possible; use a finite time above 0 s")
            }
        }
    }
}

impl std::error::Error for PlaybackError {}

impl From<JobError> for PlaybackError {
    fn from(error: JobError) -> Self {
        Self::Job(error)
    }
}

impl From<TopologyError> for PlaybackError {
    fn from(error: TopologyError) -> Self {
        Self::Topology(error)
    }
}
