//! The poses that a trial shows: its rows one after the other, every jump inertialised.
//!
//! All that is needed is in the log: a jump is where a row is not the one that follows the row before.

use std::fmt;

pub use super::body::HALF_LIFE;
use super::body::{Body, Moment};
use super::database::Database;
use super::ground::Placement;
use crate::error::{JobError, ShapeError, TopologyError};
use crate::kinematics::{ForwardKinematics, Pose, World, forward_kinematics};

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
    let mut body = Body::new(database, playback.half_life)?;
    let (mut rotations, mut vectors) =
        (vec![0.0; BLOCK * 4 * database.slot_count()], vec![0.0; BLOCK * 3 * database.joint_count()]);
    for (number, block) in positions.chunks_mut(width * BLOCK).enumerate() {
        let frame_count = block.len() / width;
        let (rotations, vectors) = (
            &mut rotations[..frame_count * 4 * database.slot_count()],
            &mut vectors[..frame_count * 3 * database.joint_count()],
        );
        for frame in 0..frame_count {
            let step = number * BLOCK + frame;
            let (row, placement) = (playback.rows[step], playback.placements[step]);
            if let Some(before) = step.checked_sub(1) {
                body.step(playback.rows[before], row, &placement);
            }
            body.show(
                &Moment { row, share: 0.0, placement },
                &mut rotations[frame * 4 * database.slot_count()..],
                &mut vectors[frame * 3 * database.joint_count()..],
            );
        }
        let job = ForwardKinematics {
            topology: body.topology(),
            offsets: &offsets,
            translated: &translated,
            pose: Pose::Quaternions { rotations, normalize: false, translations: vectors },
            frame_count,
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
