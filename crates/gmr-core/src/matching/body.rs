//! A body whose jumps are inertialised: the slot rotations, the bone vectors and the root keep what they showed and how
//! fast it changed, and their differences to the new row die away ([`super::inertialization`]).
//!
//! Bone vectors are among them because performers differ in size.

use std::ops::Deref;

use glam::{DQuat, DVec2, DVec3};

use super::database::Database;
use super::ground::Placement;
use super::inertialization::{
    DecaySpring, Moving, Turning, inertialize_transition, inertialize_transition_rotation,
    inertialize_update_rotation,
};
use super::pose::PoseReader;
use crate::error::TopologyError;
use crate::skeleton::{NONE, Topology};

/// Half-life of the offsets in seconds.
pub const HALF_LIFE: f64 = 0.1;

/// What is played at a moment, before offsets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    /// The database row.
    pub(super) row: u32,
    /// The share of the way to the next row that has gone by, from 0 to below 1.
    pub(super) share: f64,
    /// Where the root stood at the row.
    pub(super) placement: Placement,
}

/// The offsets of everything that moves.
#[derive(Debug, Clone)]
pub(super) struct Body<D> {
    reader: PoseReader<D>,
    half_life: f64,
    spring: DecaySpring,
    /// `(x, heading, z)`.
    root: Moving<DVec3>,
    slots: Vec<Moving<DVec3>>,
    bones: Vec<Moving<DVec3>>,
}

impl<D: Deref<Target = Database>> Body<D> {
    /// A body without offsets; they halve in `half_life` seconds, above 0.
    pub(super) fn new(database: D, half_life: f64) -> Result<Self, TopologyError> {
        let (slots, joints) = (database.slot_count(), database.joint_count());
        Ok(Self {
            half_life,
            spring: DecaySpring::new(half_life, 1.0 / database.rate()),
            root: Moving::default(),
            slots: vec![Moving::default(); slots],
            bones: vec![Moving::default(); joints],
            reader: PoseReader::new(database)?,
        })
    }

    /// The skeleton that is shown: the database's, its carriers and what they carry being roots.
    pub(super) fn topology(&self) -> &Topology {
        self.reader.topology()
    }

    /// One step of the database later `row` is played at `placement`, after `before`.
    pub(super) fn step(&mut self, before: u32, row: u32, placement: &Placement) {
        for offset in self.slots.iter_mut().chain(&mut self.bones).chain([&mut self.root]) {
            *offset = self.spring.decay_spring_damper_exact(*offset);
        }
        let continuing = self.reader.database().next_row(before);
        if continuing != Some(row) {
            self.jump(continuing.unwrap_or(before), row, placement);
        }
    }

    /// The world is turned by `angle` about the character.
    pub(super) fn turn(&mut self, angle: f64) {
        let turn = Placement { position: DVec2::ZERO, heading: angle };
        for offset in [&mut self.root.value, &mut self.root.velocity] {
            let turned = turn.rotate(DVec2::new(offset.x, offset.z));
            (offset.x, offset.z) = (turned.x, turned.y);
        }
    }

    fn jump(&mut self, from: u32, to: u32, placement: &Placement) {
        let [leaving, entering] = [from, to].map(|row| self.root_on(row, placement));
        self.root = inertialize_transition(self.root, leaving, entering);
        for (slot, offset) in self.slots.iter_mut().enumerate() {
            let [from, to] = [from, to].map(|row| self.reader.turning(row, slot));
            *offset = inertialize_transition_rotation(*offset, from, to);
        }
        for (joint, offset) in self.bones.iter_mut().enumerate() {
            let [from, to] = [from, to].map(|row| self.reader.moving(row, joint));
            *offset = inertialize_transition(*offset, from, to);
        }
    }

    /// Writes what is shown: the slots' local rotations `(S, 4)` and the bones' vectors `(J, 3)`, a root's its place
    /// in the world; returns where the simulation root is shown.
    pub(super) fn show(&self, moment: &Moment, rotations: &mut [f32], vectors: &mut [f32]) -> Placement {
        let Moment { row, share, placement } = *moment;
        let later =
            (share > 0.0).then(|| DecaySpring::new(self.half_life, share / self.reader.database().rate()));
        let now = |offset: &Moving<DVec3>| {
            later.map_or(*offset, |spring| spring.decay_spring_damper_exact(*offset))
        };
        let placement =
            if share > 0.0 { placement.moved(self.reader.database().step(row), share) } else { placement };
        let root = now(&self.root).value + coordinates(&placement);
        let heading = DQuat::from_rotation_y(root.y);
        let topology = self.reader.topology();
        for (slot, (offset, out)) in self.slots.iter().zip(rotations.as_chunks_mut::<4>().0).enumerate() {
            let rotation = self.reader.rotation_between(row, share, slot);
            let animation = Turning { rotation, velocity: DVec3::ZERO };
            let local = inertialize_update_rotation(now(offset), animation).rotation;
            let under_world = topology.slot_parents()[slot] == NONE;
            let shown = if under_world { heading * local } else { local };
            *out = shown.normalize().as_quat().to_array();
        }
        for (joint, (offset, out)) in self.bones.iter().zip(vectors.as_chunks_mut::<3>().0).enumerate() {
            let local = now(offset).value + self.reader.vector_between(row, share, joint);
            let is_root = topology.parents()[joint] == NONE;
            let shown = if is_root { DVec3::new(root.x, 0.0, root.z) + heading * local } else { local };
            *out = shown.as_vec3().to_array();
        }
        Placement::new(root.x, root.z, root.y)
    }

    /// `(x, heading, z)` of the root as it is now on `row`, and how it would move on.
    fn root_on(&self, row: u32, placement: &Placement) -> Moving<DVec3> {
        let rate = self.reader.database().rate();
        let step = self.reader.database().step(row);
        let [x, z] = step.displacement.map(f64::from);
        let moved = placement.rotate(DVec2::new(x, z)) * rate;
        let velocity = DVec3::new(moved.x, f64::from(step.turn) * rate, moved.y);
        Moving { value: coordinates(placement), velocity }
    }
}

/// `(x, heading, z)`.
fn coordinates(placement: &Placement) -> DVec3 {
    DVec3::new(placement.position.x, placement.heading, placement.position.y)
}
