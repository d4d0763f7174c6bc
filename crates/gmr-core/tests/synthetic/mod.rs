//! A body of hips, two legs and a toe that walks on arcs: databases whose trials have known answers.

#![allow(dead_code)]

use gmr_core::Topology;
use gmr_core::matching::builder::{ClipPoses, DatabaseBuilder};
use gmr_core::matching::database::Database;
use gmr_core::matching::features::{Group, Measure, Schema};
use gmr_core::matching::ground::Placement;
use gmr_core::matching::path::{Segment, arc};
use gmr_core::matching::root::RootTrack;

use glam::{DQuat, DVec3};

pub const RATE: f64 = 60.0;

/// A clip of the body walking steadily on an arc.
#[derive(Debug, Clone, Copy)]
pub struct Walk {
    pub frames: usize,
    pub speed: f64,
    pub turn_rate: f64,
    /// Steps of one leg a second.
    pub cadence: f64,
    /// Length of a leg in metres: performers differ.
    pub leg: f64,
    pub tags: u32,
}

impl Default for Walk {
    fn default() -> Self {
        Self { frames: 300, speed: 1.5, turn_rate: 0.0, cadence: 1.0, leg: 0.9, tags: 0 }
    }
}

/// What the body stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Skeleton {
    /// Hips; left foot; right foot; left toe. The feet hang on slots 0 and 1, the toe on slot 2 below the first.
    Plain,
    /// The same below a joint that stands at the origin of each clip's world, turned, and only carries the hips.
    Carried,
}

impl Skeleton {
    fn topology(self) -> Topology {
        match self {
            Self::Plain => Topology::new(&[-1, 0, 0, 1], &[-1, 0, 1, 2], 3).unwrap(),
            Self::Carried => Topology::new(&[-1, 0, 1, 1, 2], &[-1, 0, 1, 2, 3], 4).unwrap(),
        }
    }

    /// The joints with a translation in every frame: the last of them are the hips.
    fn translated(self) -> Vec<i32> {
        if self == Self::Plain { vec![0] } else { vec![0, 1] }
    }
}

/// How the carrier is turned.
fn carrier() -> DQuat {
    DQuat::from_rotation_y(0.7)
}

/// The database of these clips at [`RATE`].
pub fn database(clips: &[Walk]) -> Database {
    database_at(RATE, Skeleton::Plain, clips)
}

/// The database of these clips at any rate, on either skeleton.
pub fn database_at(rate: f64, skeleton: Skeleton, clips: &[Walk]) -> Database {
    let hips = skeleton.translated().len() - 1;
    let schema = Schema::locomotion(hips + 1, hips + 2, hips, skeleton.topology().joint_count()).unwrap();
    database_with(rate, skeleton, schema, clips)
}

/// The database of these clips at [`RATE`], its features looking back as well as ahead.
pub fn database_with_a_past(clips: &[Walk]) -> Database {
    let mut groups = Schema::locomotion(1, 2, 0, 4).unwrap().groups().to_vec();
    for (measure, frames) in [(Measure::RootPosition, [-20, -10]), (Measure::RootFacing, [-15, 0])] {
        groups.insert(2, Group { name: "past".to_owned(), measure, frames: frames.to_vec(), weight: 0.5 });
    }
    database_with(RATE, Skeleton::Plain, Schema::new(groups, 4).unwrap(), clips)
}

/// As [`database`], scaled as another one is.
pub fn database_scaled_as(other: &Database, clips: &[Walk]) -> Database {
    let plain = Skeleton::Plain;
    let schema = Schema::locomotion(1, 2, 0, 4).unwrap();
    let mut builder = DatabaseBuilder::new(plain.topology(), plain.translated(), schema, RATE).unwrap();
    clips.iter().for_each(|clip| clip.add_to(&mut builder, RATE, plain));
    builder.finish(Some(other.normalization().clone()), 1).unwrap()
}

fn database_with(rate: f64, skeleton: Skeleton, schema: Schema, clips: &[Walk]) -> Database {
    let (topology, translated) = (skeleton.topology(), skeleton.translated());
    let mut builder = DatabaseBuilder::new(topology, translated, schema, rate).unwrap();
    clips.iter().for_each(|clip| clip.add_to(&mut builder, rate, skeleton));
    builder.finish(None, 1).unwrap()
}

impl Walk {
    fn add_to(&self, builder: &mut DatabaseBuilder, rate: f64, skeleton: Skeleton) {
        let (mut positions, mut rotations, mut translations) = (Vec::new(), Vec::new(), Vec::new());
        let mut root = RootTrack::default();
        let mut offsets = vec![[0.0; 3], [0.1, -self.leg, 0.0], [-0.1, -self.leg, 0.0], [0.0, 0.0, 0.2]];
        for frame in 0..self.frames {
            let pose = self.pose(frame as f64 / rate, &offsets);
            if skeleton == Skeleton::Carried {
                positions.extend([0.0; 3]);
                translations.extend([0.0; 3]);
                rotations.extend(carrier().to_array());
            }
            let above = if skeleton == Skeleton::Carried { carrier().conjugate() } else { DQuat::IDENTITY };
            positions.extend(pose.joints.iter().flat_map(|joint| joint.to_array()).map(|x| x as f32));
            translations.extend((above * pose.joints[0]).to_array());
            rotations
                .extend([above * pose.left, above * pose.right, pose.toe].iter().flat_map(|q| q.to_array()));
            root.ground.push(pose.root.position.to_array());
            root.heading.push(pose.root.heading);
        }
        if skeleton == Skeleton::Carried {
            offsets.insert(0, [0.0; 3]);
        }
        let clip = ClipPoses {
            positions: &positions,
            rotations: &rotations,
            translations: &translations,
            offsets: offsets.as_flattened(),
            root: &root,
            tags: &vec![self.tags; self.frames],
        };
        builder.add_clip(&clip).unwrap();
    }

    /// The body in a world of its own that is no trial's.
    fn pose(&self, time: f64, offsets: &[[f64; 3]]) -> Pose {
        let segment = Segment { duration: 1.0, speed: self.speed, turn_rate: self.turn_rate, drift: 0.0 };
        let root = arc(Placement::new(4.0, -7.0, 1.0), &segment, time);
        let phase = std::f64::consts::TAU * self.cadence * time;
        let swing = 0.5 * phase.sin();
        let turn = DQuat::from_rotation_y(root.heading);
        let [left, right] = [swing, -swing].map(|angle| turn * DQuat::from_rotation_x(-angle));
        let toe = DQuat::from_rotation_x(0.3 * swing);
        // The hips rise and fall twice a cycle, as bodies do: a bone vector that moves.
        let height = self.leg + 0.04 * (2.0 * phase).cos();
        let hips = DVec3::new(root.position.x, height, root.position.y);
        let [left_foot, right_foot] =
            [(left, 1), (right, 2)].map(|(leg, joint)| hips + leg * DVec3::from(offsets[joint]));
        let left_toe = left_foot + left * (toe * DVec3::from(offsets[3]));
        Pose { root, left, right, toe, joints: [hips, left_foot, right_foot, left_toe] }
    }
}

/// World rotations of the legs, the toe's below its foot's, and the joints' places.
struct Pose {
    root: Placement,
    left: DQuat,
    right: DQuat,
    toe: DQuat,
    joints: [DVec3; 4],
}
