//! A body of hips, two legs and a toe that walks on arcs: databases whose trials have known answers.

#![allow(dead_code)]

use gmr_core::Topology;
use gmr_core::matching::builder::{ClipPoses, DatabaseBuilder};
use gmr_core::matching::database::Database;
use gmr_core::matching::features::Schema;
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

/// Hips; left foot; right foot; left toe. The feet hang on slots 0 and 1, the toe on slot 2 below the first.
fn topology() -> Topology {
    Topology::new(&[-1, 0, 0, 1], &[-1, 0, 1, 2], 3).unwrap()
}

/// The database of these clips at [`RATE`].
pub fn database(clips: &[Walk]) -> Database {
    database_at(RATE, clips)
}

/// The database of these clips at any rate.
pub fn database_at(rate: f64, clips: &[Walk]) -> Database {
    let schema = Schema::locomotion(1, 2, 0, 4).unwrap();
    let mut builder = DatabaseBuilder::new(topology(), vec![0], schema, rate).unwrap();
    clips.iter().for_each(|clip| clip.add_to(&mut builder, rate));
    builder.finish(None).unwrap()
}

impl Walk {
    fn add_to(&self, builder: &mut DatabaseBuilder, rate: f64) {
        let (mut positions, mut rotations, mut translations) = (Vec::new(), Vec::new(), Vec::new());
        let mut root = RootTrack::default();
        let offsets = [[0.0, 0.0, 0.0], [0.1, -self.leg, 0.0], [-0.1, -self.leg, 0.0], [0.0, 0.0, 0.2]];
        for frame in 0..self.frames {
            let time = frame as f64 / rate;
            let place = self.place(time);
            let turn = DQuat::from_rotation_y(place.heading);
            let swing = 0.5 * (std::f64::consts::TAU * self.cadence * time).sin();
            let [left, right] = [swing, -swing].map(|angle| turn * DQuat::from_rotation_x(-angle));
            let toe = DQuat::from_rotation_x(0.3 * swing);
            let hips = DVec3::new(place.position.x, self.leg, place.position.y);
            let foot = hips + left * DVec3::from(offsets[1]);
            let joints = [
                hips,
                foot,
                hips + right * DVec3::from(offsets[2]),
                foot + left * (toe * DVec3::from(offsets[3])),
            ];
            positions.extend(joints.iter().flat_map(|joint| joint.to_array()).map(|x| x as f32));
            rotations.extend([left, right, toe].iter().flat_map(|q| q.to_array()));
            translations.extend(hips.to_array());
            root.ground.push(place.position.to_array());
            root.heading.push(place.heading);
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

    /// Where its root is, in a world of its own that is no trial's.
    fn place(&self, time: f64) -> Placement {
        let segment = Segment { duration: 1.0, speed: self.speed, turn_rate: self.turn_rate };
        arc(Placement::new(4.0, -7.0, 1.0), &segment, time)
    }
}
