//! The simulation root: where a body is on the ground and which way it faces, one smooth curve each.
//!
//! Position: the hips projected on the ground. Heading: the mean of the directions across the hips and across the
//! shoulders, turned a quarter. Both are smoothed with a zero-phase cubic Savitzky-Golay filter whose ends are the
//! end windows' own polynomials, so that steady motion stays steady to the last frame.
//! Source: Holden et al., "Learned Motion Matching" (2020), Sec. 3 and its published data preparation (half a second
//! for the position, one second for the direction); Savitzky and Golay (1964).

use crate::error::ShapeError;
use crate::matching::ground::Placement;
use std::f64::consts::{PI, TAU};

/// Seconds of hip positions that one smoothed position is fitted to.
pub const POSITION_WINDOW: f64 = 0.5;
/// Seconds of facing directions that one smoothed heading is fitted to.
pub const HEADING_WINDOW: f64 = 1.0;

/// Across vectors whose ground projection is shorter than this part of their length tell no heading.
const FLAT_ENOUGH: f64 = 0.2;

/// A left and a right joint; the line from right to left lies across the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// Joint on the body's left.
    pub left: usize,
    /// Joint on the body's right.
    pub right: usize,
}

/// The simulation root of one clip: one entry a frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RootTrack {
    /// Ground position `(x, z)`, metres.
    pub ground: Vec<[f64; 2]>,
    /// Heading in radians, forward = `(sin, cos)` in `(x, z)`, continuous from frame to frame (not wrapped).
    pub heading: Vec<f64>,
}

impl RootTrack {
    /// Number of frames.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ground.len()
    }

    /// Whether there is no frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ground.is_empty()
    }

    /// Where the root is at a frame.
    ///
    /// # Panics
    /// When there is no such frame.
    #[must_use]
    pub fn at(&self, frame: usize) -> Placement {
        Placement { position: self.ground[frame].into(), heading: self.heading[frame] }
    }
}

/// Inputs from which the simulation root of a clip is found.
#[derive(Debug, Clone, Copy)]
pub struct RootJob<'a> {
    /// World positions `(F, J, 3)`, metres, Y up.
    pub positions: &'a [f32],
    /// Number of joints J.
    pub joint_count: usize,
    /// The joint whose projection is the position.
    pub hips: usize,
    /// The pairs whose directions are averaged, hips first.
    pub across: &'a [Pair],
    /// Frames that a smoothed position is fitted to (1 or 2: not smoothed).
    pub position_window: usize,
    /// Frames that a smoothed heading is fitted to (1 or 2: not smoothed).
    pub heading_window: usize,
}

/// Why a clip has no simulation root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RootError {
    /// Arrays that do not fit together, or a joint that is not there.
    Shape(ShapeError),
    /// The body's across directions are vertical or of no length in every frame.
    NoFacing,
}

impl std::fmt::Display for RootError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shape(error) => error.fmt(f),
            Self::NoFacing => f.write_str(
                "the body shows no facing in any frame: its hips and shoulders have no width on the ground",
            ),
        }
    }
}

impl std::error::Error for RootError {}

impl From<ShapeError> for RootError {
    fn from(error: ShapeError) -> Self {
        Self::Shape(error)
    }
}

/// The smoothed root of a clip.
///
/// # Errors
/// [`RootError::Shape`] when the arrays do not fit; [`RootError::NoFacing`] when no frame tells a heading.
pub fn simulation_root(job: &RootJob<'_>) -> Result<RootTrack, RootError> {
    job.check()?;
    let stride = 3 * job.joint_count;
    let hips = |axis: usize| -> Vec<f64> {
        job.positions.chunks_exact(stride).map(|frame| f64::from(frame[3 * job.hips + axis])).collect()
    };
    let x = smooth(&hips(0), job.position_window);
    let z = smooth(&hips(2), job.position_window);
    let heading = smooth(&body_heading(job).ok_or(RootError::NoFacing)?, job.heading_window);
    Ok(RootTrack { ground: x.into_iter().zip(z).map(|(x, z)| [x, z]).collect(), heading })
}

impl RootJob<'_> {
    fn check(&self) -> Result<(), ShapeError> {
        let stride = 3 * self.joint_count;
        let frames = self.positions.len() / stride.max(1);
        ShapeError::check("positions", frames * stride, self.positions.len())?;
        let joints = self.across.iter().flat_map(|pair| [pair.left, pair.right]).chain([self.hips]);
        let needed = joints.max().unwrap_or(0) + 1;
        ShapeError::check("joints", needed.max(self.joint_count), self.joint_count)
    }
}

/// Unsmoothed heading of every frame, continuous; frames that tell none keep the nearest earlier one (or the first).
fn body_heading(job: &RootJob<'_>) -> Option<Vec<f64>> {
    let told: Vec<Option<f64>> = job
        .positions
        .chunks_exact(3 * job.joint_count)
        .map(|frame| heading_across(frame, job.across))
        .collect();
    let mut last = *told.iter().flatten().next()?;
    Some(
        told.into_iter()
            .map(|heading| {
                last = heading.map_or(last, |heading| last + wrap(heading - last));
                last
            })
            .collect(),
    )
}

/// Heading of one pose: `across x up`, where across is the mean of the pairs' unit directions on the ground.
fn heading_across(frame: &[f32], pairs: &[Pair]) -> Option<f64> {
    let (mut x, mut z) = (0.0, 0.0);
    for pair in pairs {
        let [dx, dy, dz] = [0, 1, 2]
            .map(|axis| f64::from(frame[3 * pair.left + axis]) - f64::from(frame[3 * pair.right + axis]));
        let flat = dx.hypot(dz);
        if flat > FLAT_ENOUGH * flat.hypot(dy) {
            x += dx / flat;
            z += dz / flat;
        }
    }
    (x.hypot(z) > FLAT_ENOUGH).then(|| (-z).atan2(x))
}

/// The angle in `[-pi, pi)` that differs from `angle` by whole turns.
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Least-squares cubic through each `window` of samples, read at its middle; at the ends, the first and the last
/// window's cubic read where the samples are. Any cubic comes out as it went in, to the last sample.
///
/// A window that is even or longer than the samples is the largest odd one below.
#[must_use]
pub fn smooth(samples: &[f64], window: usize) -> Vec<f64> {
    let half = (window.min(samples.len()).saturating_sub(1)) / 2;
    if half == 0 {
        return samples.to_vec();
    }
    let width = 2 * half + 1;
    let middle = fit_weights(half, 0);
    let mut smoothed: Vec<f64> = Vec::with_capacity(samples.len());
    let fit = |at: usize, weights: &[f64]| -> f64 {
        samples[at..at + width].iter().zip(weights).map(|(sample, weight)| sample * weight).sum()
    };
    let last = samples.len() - width;
    smoothed.extend((0..half).map(|i| fit(0, &fit_weights(half, i as i64 - half as i64))));
    smoothed.extend((0..=last).map(|at| fit(at, &middle)));
    smoothed.extend((1..=half).map(|i| fit(last, &fit_weights(half, i as i64))));
    smoothed
}

/// What each of the `2 half + 1` samples contributes to the fitted cubic's value at `at` (0: the middle):
/// `sum_k p_k(at) p_k(i) / |p_k|^2` over the polynomials orthogonal on `-half..=half`.
fn fit_weights(half: usize, at: i64) -> Vec<f64> {
    let m = half as f64;
    let polynomials: [&dyn Fn(f64) -> f64; 4] = [&|_| 1.0, &|x| x, &|x| x * x - m * (m + 1.0) / 3.0, &|x| {
        x * (x * x - (3.0 * m * (m + 1.0) - 1.0) / 5.0)
    }];
    let points = || (0..=2 * half).map(|i| i as f64 - m);
    let mut weights = vec![0.0; 2 * half + 1];
    for p in polynomials {
        let norm: f64 = points().map(|x| p(x) * p(x)).sum();
        if norm > 0.0 {
            let value = p(at as f64) / norm;
            weights.iter_mut().zip(points()).for_each(|(weight, x)| *weight += value * p(x));
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body of three joints: hips, left and right, walking on a path given by time.
    fn walk(frames: usize, path: impl Fn(f64) -> ([f64; 2], f64)) -> Vec<f32> {
        (0..frames)
            .flat_map(|i| {
                let ([x, z], heading) = path(i as f64 / 60.0);
                let root = Placement { position: [x, z].into(), heading };
                let [lx, lz] = root.rotate([0.1, 0.0].into()).to_array();
                [x, 0.9, z, x + lx, 0.9, z + lz, x - lx, 0.9, z - lz].map(|v| v as f32)
            })
            .collect()
    }

    fn root_of(positions: &[f32]) -> RootTrack {
        let across = [Pair { left: 1, right: 2 }];
        let job = RootJob {
            positions,
            joint_count: 3,
            hips: 0,
            across: &across,
            position_window: 31,
            heading_window: 61,
        };
        simulation_root(&job).unwrap()
    }

    #[test]
    fn constant_speed_stays_constant_to_the_last_frame() {
        let track = root_of(&walk(200, |t| ([1.2 * t, 0.9 * t], 0.3)));
        for pair in track.ground.windows(2) {
            let speed = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) * 60.0;
            assert!((speed - 1.5).abs() < 2e-5, "{speed}");
        }
        assert!(track.heading.iter().all(|heading| (heading - 0.3).abs() < 1e-5));
    }

    #[test]
    fn constant_turn_rate_stays_constant_through_many_turns() {
        let track = root_of(&walk(600, |t| ([0.0, 0.0], 2.0 * t)));
        for pair in track.heading.windows(2) {
            let rate = (pair[1] - pair[0]) * 60.0;
            assert!((rate - 2.0).abs() < 2e-4, "{rate}");
        }
        assert!((track.heading[599] - track.heading[0] - 2.0 * 599.0 / 60.0).abs() < 1e-4);
    }

    #[test]
    fn the_left_joint_on_plus_x_means_heading_plus_z() {
        assert!(root_of(&walk(3, |_| ([0.0, 0.0], 0.0))).heading[0].abs() < 1e-6);
        let quarter = root_of(&walk(3, |_| ([0.0, 0.0], PI / 2.0))).heading[0];
        assert!((quarter - PI / 2.0).abs() < 1e-6, "forward is then +X, so left is -Z");
    }

    #[test]
    fn any_cubic_passes_unchanged_and_short_clips_too() {
        for frames in 0..80 {
            let cubic: Vec<f64> =
                (0..frames).map(f64::from).map(|t| 1.0 + t * (2.0 - t * (0.3 - 0.01 * t))).collect();
            for window in [0, 1, 2, 3, 4, 5, 31, 1000] {
                let smoothed = smooth(&cubic, window);
                assert_eq!(smoothed.len(), cubic.len());
                assert!(cubic.iter().zip(&smoothed).all(|(a, b)| (a - b).abs() < 1e-6 * (1.0 + a.abs())));
            }
        }
    }

    #[test]
    fn noise_is_reduced() {
        let noise: Vec<f64> = (0..300_i32).map(|i| f64::from((i * 7919) % 101) / 101.0 - 0.5).collect();
        let power = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
        assert!(power(&smooth(&noise, 31)) < 0.25 * power(&noise));
    }

    #[test]
    fn a_pose_without_width_keeps_the_heading_before_it() {
        let mut positions = walk(10, |_| ([0.0, 0.0], 1.0));
        positions[9 * 4 + 3..9 * 4 + 9].copy_from_slice(&[0.0, 1.0, 0.0, 0.0, 0.5, 0.0]);
        assert!(root_of(&positions).heading.iter().all(|heading| (heading - 1.0).abs() < 1e-5));
        let upright = [0.0, 0.9, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, 0.0];
        let across = [Pair { left: 1, right: 2 }];
        let job = RootJob {
            positions: &upright,
            joint_count: 3,
            hips: 0,
            across: &across,
            position_window: 1,
            heading_window: 1,
        };
        assert_eq!(simulation_root(&job), Err(RootError::NoFacing));
        assert!(matches!(simulation_root(&RootJob { hips: 7, ..job }), Err(RootError::Shape(_))));
    }
}
