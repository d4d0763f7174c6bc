//! What a pose and its near future are compared by: a schema of feature groups, their extraction, their scaling.
//!
//! The default is the 27 numbers of Holden et al., "Learned Motion Matching" (2020), Sec. 3: see [`Schema::locomotion`].
//! Everything is expressed in the character's frame: the simulation root of the row's own frame.

use crate::error::ShapeError;
use crate::matching::ground::direction;
use crate::matching::root::RootTrack;
use glam::{DVec2, DVec3};
use std::fmt;
use std::ops::Range;

/// What a feature group measures, at each of its times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Position of a joint, 3 numbers (metres).
    Position {
        /// The joint.
        joint: usize,
    },
    /// World velocity of a joint, turned into the character's frame, 3 numbers (metres a second).
    Velocity {
        /// The joint.
        joint: usize,
    },
    /// Ground position `(x, z)` of the simulation root (metres).
    RootPosition,
    /// Facing direction `(x, z)` of the simulation root (a unit vector).
    RootFacing,
}

impl Measure {
    /// How many numbers one sample has.
    #[must_use]
    pub fn width(self) -> usize {
        match self {
            Self::Position { .. } | Self::Velocity { .. } => 3,
            Self::RootPosition | Self::RootFacing => 2,
        }
    }

    /// Whether it tells where the character goes rather than how it stands.
    #[must_use]
    pub fn is_trajectory(self) -> bool {
        matches!(self, Self::RootPosition | Self::RootFacing)
    }

    fn joint(self) -> Option<usize> {
        match self {
            Self::Position { joint } | Self::Velocity { joint } => Some(joint),
            Self::RootPosition | Self::RootFacing => None,
        }
    }
}

/// Features that are scaled together.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its name in tables and cost breakdowns.
    pub name: String,
    /// What it measures.
    pub measure: Measure,
    /// When, in database frames after the row's (negative: before).
    pub frames: Vec<i32>,
    /// How much it counts once scaled; 0 leaves it out of every cost.
    pub weight: f32,
}

impl Group {
    /// How many numbers the group has.
    #[must_use]
    pub fn width(&self) -> usize {
        self.measure.width() * self.frames.len()
    }
}

/// One sample of the trajectory features: two numbers of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrajectorySample {
    /// The first of its two dimensions, `x` then `z`.
    pub dim: usize,
    /// When, in frames after the row's.
    pub frames: i32,
    /// True: the direction faced; false: the position.
    pub is_facing: bool,
}

/// The feature groups of a database, in the order of their numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Schema {
    groups: Vec<Group>,
    starts: Vec<usize>,
}

/// Why groups make no schema.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SchemaError {
    /// No group has a number.
    Empty,
    /// A weight that is negative or not finite.
    Weight {
        /// The group's name.
        group: String,
    },
    /// A joint that the skeleton does not have.
    Joint {
        /// The group's name.
        group: String,
        /// The joint asked for.
        joint: usize,
        /// How many there are.
        count: usize,
    },
}

impl fmt::Display for SchemaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a schema needs at least one group with at least one time"),
            Self::Weight { group } => {
                write!(f, "the weight of feature group '{group}' must be a finite number, 0 or more")
            }
            Self::Joint { group, joint, count } => {
                write!(f, "feature group '{group}' asks for joint {joint}, but the skeleton has {count}")
            }
        }
    }
}

impl std::error::Error for SchemaError {}

impl Schema {
    /// Checks the groups against a skeleton of `joint_count` joints.
    ///
    /// # Errors
    /// When there is nothing to measure, a weight is no weight, or a joint is not there.
    pub fn new(groups: Vec<Group>, joint_count: usize) -> Result<Self, SchemaError> {
        for group in &groups {
            if !(group.weight.is_finite() && group.weight >= 0.0) {
                return Err(SchemaError::Weight { group: group.name.clone() });
            }
            if let Some(joint) = group.measure.joint().filter(|&joint| joint >= joint_count) {
                return Err(SchemaError::Joint { group: group.name.clone(), joint, count: joint_count });
            }
        }
        let mut starts = vec![0];
        for group in &groups {
            starts.push(starts[starts.len() - 1] + group.width());
        }
        if starts[groups.len()] == 0 {
            return Err(SchemaError::Empty);
        }
        Ok(Self { groups, starts })
    }

    /// The 27 numbers for locomotion at 60 frames a second: both feet's positions and velocities, the hips' velocity,
    /// and the root's position and facing after 20, 40 and 60 frames; weights 0.75, 1, 1, 1 and 1.5.
    ///
    /// # Errors
    /// When a joint is not there.
    pub fn locomotion(
        left_foot: usize,
        right_foot: usize,
        hips: usize,
        joint_count: usize,
    ) -> Result<Self, SchemaError> {
        let group = |name: &str, measure, frames: &[i32], weight| Group {
            name: name.to_owned(),
            measure,
            frames: frames.to_vec(),
            weight,
        };
        let ahead = [20, 40, 60];
        let groups = vec![
            group("left foot position", Measure::Position { joint: left_foot }, &[0], 0.75),
            group("right foot position", Measure::Position { joint: right_foot }, &[0], 0.75),
            group("left foot velocity", Measure::Velocity { joint: left_foot }, &[0], 1.0),
            group("right foot velocity", Measure::Velocity { joint: right_foot }, &[0], 1.0),
            group("hips velocity", Measure::Velocity { joint: hips }, &[0], 1.0),
            group("trajectory position", Measure::RootPosition, &ahead, 1.0),
            group("trajectory facing", Measure::RootFacing, &ahead, 1.5),
        ];
        Self::new(groups, joint_count)
    }

    /// The groups, in the order of their numbers.
    #[must_use]
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// How many numbers a row has.
    #[must_use]
    pub fn dims(&self) -> usize {
        self.starts[self.groups.len()]
    }

    /// The dimensions of one group.
    ///
    /// # Panics
    /// When there is no such group.
    #[must_use]
    pub fn range(&self, group: usize) -> Range<usize> {
        self.starts[group]..self.starts[group + 1]
    }

    /// The trajectory samples, in the order of their dimensions.
    #[must_use]
    pub fn trajectory(&self) -> Vec<TrajectorySample> {
        let mut samples = Vec::new();
        for (group, &start) in self.groups.iter().zip(&self.starts) {
            if group.measure.is_trajectory() {
                let is_facing = group.measure == Measure::RootFacing;
                samples.extend(group.frames.iter().enumerate().map(|(k, &frames)| TrajectorySample {
                    dim: start + 2 * k,
                    frames,
                    is_facing,
                }));
            }
        }
        samples
    }

    /// For each dimension, whether it belongs to the trajectory (else to the pose).
    #[must_use]
    pub fn is_trajectory(&self) -> Vec<bool> {
        self.groups.iter().flat_map(|group| vec![group.measure.is_trajectory(); group.width()]).collect()
    }

    /// How many frames after its own a row looks at.
    #[must_use]
    pub fn future(&self) -> usize {
        self.all_frames().map(|frames| frames.max(0).unsigned_abs() as usize).max().unwrap_or(0)
    }

    /// How many frames before its own a row looks at.
    #[must_use]
    pub fn past(&self) -> usize {
        self.all_frames().map(|frames| frames.min(0).unsigned_abs() as usize).max().unwrap_or(0)
    }

    fn all_frames(&self) -> impl Iterator<Item = i32> + '_ {
        self.groups.iter().flat_map(|group| group.frames.iter().copied())
    }
}

/// One clip to be measured.
#[derive(Debug, Clone, Copy)]
pub struct Extraction<'a> {
    /// World positions `(F, J, 3)`, metres, Y up.
    pub positions: &'a [f32],
    /// Number of joints J.
    pub joint_count: usize,
    /// Its simulation root, F frames.
    pub root: &'a RootTrack,
    /// Frames a second.
    pub rate: f64,
}

/// Appends the raw features of every frame of a clip to `out`, `schema.dims()` numbers a frame.
///
/// Samples beyond an end of the clip are those of its end frame; such rows are no candidates of a database.
///
/// # Errors
/// When the arrays do not fit together.
pub fn extract(schema: &Schema, clip: &Extraction<'_>, out: &mut Vec<f32>) -> Result<(), ShapeError> {
    let frames = clip.root.len();
    ShapeError::check("root headings", frames, clip.root.heading.len())?;
    ShapeError::check("positions", frames * clip.joint_count * 3, clip.positions.len())?;
    out.reserve(frames * schema.dims());
    for frame in 0..frames {
        for group in &schema.groups {
            for &ahead in &group.frames {
                let at = (frame as i64 + i64::from(ahead)).clamp(0, frames as i64 - 1) as usize;
                clip.measure(group.measure, frame, at, out);
            }
        }
    }
    Ok(())
}

impl Extraction<'_> {
    /// One sample at frame `at`, seen from the root of `frame`.
    fn measure(&self, measure: Measure, frame: usize, at: usize, out: &mut Vec<f32>) {
        let root = self.root.at(frame);
        let turned = |v: DVec3| {
            let ground = root.unrotate(DVec2::new(v.x, v.z)).as_vec2();
            [ground.x, v.y as f32, ground.y]
        };
        match measure {
            Measure::Position { joint } => {
                let origin = DVec3::new(root.position.x, 0.0, root.position.y);
                out.extend(turned(self.position(at, joint) - origin));
            }
            Measure::Velocity { joint } => out.extend(turned(self.velocity(at, joint))),
            Measure::RootPosition => {
                out.extend(root.unrotate(self.root.at(at).position - root.position).as_vec2().to_array());
            }
            Measure::RootFacing => {
                out.extend(direction(self.root.heading[at] - root.heading).as_vec2().to_array());
            }
        }
    }

    fn position(&self, frame: usize, joint: usize) -> DVec3 {
        let start = 3 * (frame * self.joint_count + joint);
        DVec3::from([0, 1, 2].map(|axis| f64::from(self.positions[start + axis])))
    }

    /// World velocity by central differences; at the clip's ends, of the one step there is.
    fn velocity(&self, frame: usize, joint: usize) -> DVec3 {
        let before = frame.saturating_sub(1);
        let after = (frame + 1).min(self.root.len() - 1);
        if before == after {
            return DVec3::ZERO;
        }
        (self.position(after, joint) - self.position(before, joint)) * (self.rate / (after - before) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::ground::Placement;

    /// Two joints (hips and a foot) on a circle walked at 1 m/s, seen in a world turned and moved by `world`.
    fn clip(frames: usize, turn: f64, shift: [f64; 2]) -> (Vec<f32>, RootTrack) {
        let mut positions = Vec::new();
        let mut root = RootTrack::default();
        for i in 0..frames {
            let t = i as f64 / 60.0;
            let heading = 0.8 * t + turn;
            let world = Placement { position: shift.into(), heading: turn };
            let center = DVec2::new(1.25 * (1.0 - (0.8 * t).cos()), 1.25 * (0.8 * t).sin());
            let here = Placement { position: world.position + world.rotate(center), heading };
            let foot = here.position + here.rotate(DVec2::new(0.1, 0.2 * (7.0 * t).sin()));
            positions.extend([here.position.x, 0.9, here.position.y, foot.x, 0.05, foot.y].map(|v| v as f32));
            root.ground.push(here.position.to_array());
            root.heading.push(heading);
        }
        (positions, root)
    }

    fn features_of(schema: &Schema, (positions, root): &(Vec<f32>, RootTrack)) -> Vec<f32> {
        let mut out = Vec::new();
        let clip = Extraction { positions, joint_count: 2, root, rate: 60.0 };
        extract(schema, &clip, &mut out).unwrap();
        out
    }

    #[test]
    fn the_default_schema_has_27_numbers_in_the_stated_order() {
        let schema = Schema::locomotion(1, 1, 0, 2).unwrap();
        assert_eq!((schema.dims(), schema.future(), schema.past()), (27, 60, 0));
        assert_eq!(schema.range(4), 12..15);
        let samples = schema.trajectory();
        assert_eq!(samples[0], TrajectorySample { dim: 15, frames: 20, is_facing: false });
        assert_eq!(samples[5], TrajectorySample { dim: 25, frames: 60, is_facing: true });
        assert_eq!(schema.is_trajectory().iter().position(|&t| t), Some(15));
    }

    #[test]
    fn turning_and_moving_the_world_leaves_features_unchanged() {
        let schema = Schema::locomotion(1, 1, 0, 2).unwrap();
        let here = features_of(&schema, &clip(150, 0.0, [0.0, 0.0]));
        let there = features_of(&schema, &clip(150, 2.1, [-3.0, 7.0]));
        for (a, b) in here.iter().zip(&there) {
            assert!((a - b).abs() < 2e-4, "{a} {b}");
        }
    }

    #[test]
    fn a_walk_forward_on_a_left_circle_looks_ahead_and_to_the_left() {
        let schema = Schema::locomotion(1, 1, 0, 2).unwrap();
        let features = features_of(&schema, &clip(150, 0.4, [1.0, 1.0]));
        let row = &features[..27];
        assert!((row[14] - 1.0).abs() < 1e-2, "hips go forward at 1 m/s, not {}", row[14]);
        let radius = 1.0 / 0.8;
        let (x, z) = (radius * (1.0 - 0.8_f32.cos()), radius * 0.8_f32.sin());
        assert!((row[19] - x).abs() < 1e-4 && (row[20] - z).abs() < 1e-4, "{row:?}");
        assert!((row[25] - 0.8_f32.sin()).abs() < 1e-5 && (row[26] - 0.8_f32.cos()).abs() < 1e-5);
    }

    #[test]
    fn what_is_no_schema_is_refused() {
        let group = |weight, joint| Group {
            name: "g".to_owned(),
            measure: Measure::Position { joint },
            frames: vec![0],
            weight,
        };
        assert!(matches!(Schema::new(vec![], 3), Err(SchemaError::Empty)));
        assert!(matches!(Schema::new(vec![group(-1.0, 0)], 3), Err(SchemaError::Weight { .. })));
        assert!(matches!(Schema::new(vec![group(f32::NAN, 0)], 3), Err(SchemaError::Weight { .. })));
        assert!(matches!(Schema::new(vec![group(1.0, 3)], 3), Err(SchemaError::Joint { joint: 3, .. })));
        assert_eq!(Schema::new(vec![group(0.0, 2)], 3).unwrap().dims(), 3);
    }
}
