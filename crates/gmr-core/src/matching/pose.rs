//! A database row's pose as inertialisation wants it: rotations about pivots that lie in the body.
//!
//! Blending a rotation sweeps all that hangs on it: that of a carrier ([`super::carriers`]) would swing the body through
//! the room. So carriers, and the joints that they carry, are roots here, placed in the character's frame; the bones
//! below keep their lengths.

use std::ops::Deref;

use glam::{DQuat, DVec3, Quat, Vec3};

use super::carriers::carried;
use super::database::Database;
use super::inertialization::{Moving, Turning, log};
use crate::error::TopologyError;
use crate::skeleton::{NONE, Topology};

/// Reads local poses of rows on a skeleton whose carriers are roots.
#[derive(Debug, Clone)]
pub(super) struct PoseReader<D> {
    database: D,
    topology: Topology,
    /// Per joint, its number among the translated ones.
    translated: Vec<Option<usize>>,
    /// Per slot, the slots that turned what it now turns alone, the topmost first.
    carriers: Vec<Vec<usize>>,
}

impl<D: Deref<Target = Database>> PoseReader<D> {
    pub(super) fn new(database: D) -> Result<Self, TopologyError> {
        let whole = database.topology();
        let mut translated = vec![None; whole.joint_count()];
        for (number, &joint) in database.translated().iter().enumerate() {
            translated[joint as usize] = Some(number);
        }
        let (mut parents, mut slots) = (whole.parents().to_vec(), whole.slots().to_vec());
        for joint in carried(whole, database.translated()) {
            (parents[joint], slots[joint]) = (NONE, NONE);
        }
        let topology = Topology::new(&parents, &slots, whole.slot_count())?;
        let carriers = (0..whole.slot_count()).map(|slot| carriers(whole, &topology, slot)).collect();
        Ok(Self { topology, translated, carriers, database })
    }

    pub(super) fn database(&self) -> &Database {
        &self.database
    }

    /// The skeleton that the rotations and vectors are of: the database's, its carriers and what they carry being
    /// roots.
    pub(super) fn topology(&self) -> &Topology {
        &self.topology
    }

    pub(super) fn rotation(&self, row: u32, slot: usize) -> DQuat {
        let own = |slot: usize| Quat::from_slice(&self.database.rotation_row(row)[4 * slot..]).as_dquat();
        let above = self.carriers[slot].iter().fold(DQuat::IDENTITY, |above, &slot| above * own(slot));
        (above * own(slot)).normalize()
    }

    /// The vector of a joint's bone; of a root, its position in the character's frame.
    pub(super) fn vector(&self, row: u32, joint: usize) -> DVec3 {
        let (vectors, number) = match self.translated[joint] {
            _ if self.topology.parents()[joint] == NONE => (self.database.position_row(row), joint),
            Some(number) => (self.database.translation_row(row), number),
            None => (self.database.offsets(row), joint),
        };
        Vec3::from_slice(&vectors[3 * number..]).as_dvec3()
    }

    /// As [`PoseReader::rotation`], a share of the way to the next row later.
    pub(super) fn rotation_between(&self, row: u32, share: f64, slot: usize) -> DQuat {
        let here = self.rotation(row, slot);
        match self.database.next_row(row) {
            Some(next) if share > 0.0 => here.lerp(self.rotation(next, slot), share),
            _ => here,
        }
    }

    /// As [`PoseReader::vector`], a share of the way to the next row later.
    pub(super) fn vector_between(&self, row: u32, share: f64, joint: usize) -> DVec3 {
        let here = self.vector(row, joint);
        match self.database.next_row(row) {
            Some(next) if share > 0.0 => here.lerp(self.vector(next, joint), share),
            _ => here,
        }
    }

    pub(super) fn turning(&self, row: u32, slot: usize) -> Turning {
        let (before, after, seconds) = self.neighbours(row);
        let [from, to] = [before, after].map(|row| self.rotation(row, slot));
        Turning { rotation: self.rotation(row, slot), velocity: log(to * from.conjugate()) / seconds }
    }

    pub(super) fn moving(&self, row: u32, joint: usize) -> Moving<DVec3> {
        let (before, after, seconds) = self.neighbours(row);
        let [from, to] = [before, after].map(|row| self.vector(row, joint));
        Moving { value: self.vector(row, joint), velocity: (to - from) / seconds }
    }

    /// The rows before and after `row` in its clip (itself at an end), and the seconds between them, above 0.
    fn neighbours(&self, row: u32) -> (u32, u32, f64) {
        let clip = self.database.clip_rows(row);
        let (before, after) = (row.saturating_sub(1).max(clip.start), (row + 1).min(clip.end - 1));
        (before, after, f64::from((after - before).max(1)) / self.database.rate())
    }
}

/// The slots above `slot` in the whole skeleton, where it has none above it in the one with carriers as roots.
fn carriers(whole: &Topology, lifted: &Topology, slot: usize) -> Vec<usize> {
    let above = |slot: usize| usize::try_from(whole.slot_parents()[slot]).ok();
    if lifted.slot_parents()[slot] != NONE {
        return Vec::new();
    }
    let mut slots: Vec<usize> = std::iter::successors(above(slot), |&slot| above(slot)).collect();
    slots.reverse();
    slots
}
