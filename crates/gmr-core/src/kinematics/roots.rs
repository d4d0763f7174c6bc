//! Positions of roots are their translations: where many stand side by side they are copied from row to row, and only
//! the other joints are solved.

use std::ops::Range;

use super::plan::places;
use super::{ForwardKinematics, Pose, World};
use crate::error::JobError;
use crate::lanes::Real;
use crate::skeleton::NONE;

/// The fewest numbers side by side that are copied. Fewer are quicker turned round in registers with the solved ones.
const LONG: usize = 12;

/// Frames that are copied run by run before the next ones are.
const FRAMES_AT_ONCE: usize = 64;

/// The positions asked for, parted by how they are come by.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Parts {
    /// The joints to solve for.
    pub(super) solved: Vec<i32>,
    /// For each of them its place in a row of the answer.
    pub(super) places: Vec<usize>,
    copied: Vec<Run>,
    width: usize,
}

/// Numbers that stand side by side in a row of translations and in a row of positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Run {
    from: usize,
    to: usize,
    length: usize,
}

impl Parts {
    /// Of the positions of `joints`, which are some of the job's.
    pub(super) fn new<T: Real>(job: &ForwardKinematics<'_, T>, joints: &[i32]) -> Result<Self, JobError> {
        let translated = places(job.translated, job.topology.joint_count())?;
        let is_stored = matches!(job.pose, Pose::Quaternions { .. });
        let stored = |joint: i32| {
            let is_root = job.topology.parents()[joint as usize] == NONE;
            translated[joint as usize].filter(|_| is_stored && is_root)
        };
        let is_all_stored = joints.iter().all(|&joint| stored(joint).is_some());
        let runs = runs(joints.iter().map(|&joint| stored(joint)));
        let copied: Vec<Run> = runs.into_iter().filter(|run| is_all_stored || run.length >= LONG).collect();

        let mut is_copied = vec![false; joints.len()];
        copied.iter().for_each(|run| is_copied[run.to / 3..][..run.length / 3].fill(true));
        let places: Vec<usize> = (0..joints.len()).filter(|&place| !is_copied[place]).collect();
        let solved = places.iter().map(|&place| joints[place]).collect();
        Ok(Self { solved, places, copied, width: 3 * joints.len() })
    }

    /// Numbers in a row of the answer.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// Copies what is copied of `frames` into rows that begin `stride` apart.
    #[inline(always)]
    pub(super) fn copy<T: Real>(
        &self,
        job: &ForwardKinematics<'_, T>,
        frames: Range<usize>,
        rows: &mut [T],
        stride: usize,
    ) {
        let Pose::Quaternions { translations, .. } = job.pose else { return };
        let width = 3 * job.translated.len();
        let translations = &translations[frames.start * width..frames.end * width];
        for run in &self.copied {
            match run.length {
                16.. => run.copy::<16, T>(translations, width, rows, stride, frames.len()),
                8.. => run.copy::<8, T>(translations, width, rows, stride, frames.len()),
                4.. => run.copy::<4, T>(translations, width, rows, stride, frames.len()),
                _ => run.copy::<3, T>(translations, width, rows, stride, frames.len()),
            }
        }
    }

    /// Copies `frames` where nothing is to be solved; `world` has room for these frames only.
    pub(super) fn copy_all<T: Real>(
        &self,
        job: &ForwardKinematics<'_, T>,
        frames: Range<usize>,
        world: World<'_, T>,
    ) {
        let (Pose::Quaternions { translations, .. }, Some(positions)) = (job.pose, world.positions) else {
            return;
        };
        let width = 3 * job.translated.len();
        if self.width == width && self.copied == [Run { from: 0, to: 0, length: width }] {
            positions.copy_from_slice(&translations[frames.start * width..frames.end * width]);
            return;
        }
        let starts = frames.clone().step_by(FRAMES_AT_ONCE);
        for (start, rows) in starts.zip(positions.chunks_mut(self.width.max(1) * FRAMES_AT_ONCE)) {
            self.copy(job, start..frames.end.min(start + FRAMES_AT_ONCE), rows, self.width);
        }
    }
}

impl Run {
    /// Copies a run of at least `N` numbers, `N` at a time; the last `N` overlap those before where they must.
    #[inline(always)]
    fn copy<const N: usize, T: Real>(
        self,
        source: &[T],
        source_stride: usize,
        target: &mut [T],
        target_stride: usize,
        count: usize,
    ) {
        for start in (0..self.length).step_by(N).map(|start| start.min(self.length - N)) {
            for row in 0..count {
                let from = &source[row * source_stride + self.from + start..][..N];
                let to = &mut target[row * target_stride + self.to + start..][..N];
                to.copy_from_slice(from);
            }
        }
    }
}

/// The runs of joints that are stored at these places, `None`: not stored.
fn runs(stored: impl Iterator<Item = Option<usize>>) -> Vec<Run> {
    let mut runs: Vec<Run> = vec![];
    for (to, from) in stored.enumerate() {
        let Some(from) = from else { continue };
        match runs.last_mut() {
            Some(run) if run.to + run.length == 3 * to && run.from + run.length == 3 * from => {
                run.length += 3
            }
            _ => runs.push(Run { from: 3 * from, to: 3 * to, length: 3 }),
        }
    }
    runs
}
