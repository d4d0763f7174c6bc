//! How each number of the answer comes out of the frames in their old configuration.

use std::collections::HashMap;

use super::Configure;
use crate::error::{JobError, ShapeError};
use crate::forest::{Forest, Span};
use crate::kinematics::ForwardKinematics;
use crate::kinematics::plan as solving;
use crate::lanes::Real;
use crate::skeleton::NONE;

/// A slot's rotation; turns are those of the solving plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    /// That of an old slot.
    Copy(usize),
    /// A world rotation.
    World(usize),
    /// The second world rotation in the frame of the first.
    Between(usize, usize),
    /// The world as seen from a world rotation.
    Back(usize),
}

/// A joint's translation; bones and turns are those of the solving plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Vector {
    /// That of the bone in its old configuration, the other way round where its ends have changed places.
    Copy { bone: usize, is_flipped: bool },
    /// A position.
    Place(usize),
    /// From one joint's position to another's, in the frame of a world rotation (`None`: the world's own).
    Between { turn: Option<usize>, from: usize, to: usize },
}

/// What must be solved for in the old configuration.
pub(super) struct Wanted {
    pub(super) joints: Vec<i32>,
    pub(super) slots: Vec<i32>,
}

/// The answer, number by number.
pub(super) struct Plan<T> {
    pub(super) solving: solving::Plan<T>,
    pub(super) turns: Vec<Turn>,
    pub(super) vectors: Vec<Vector>,
    /// The old slots that are copied.
    pub(super) copied: Vec<usize>,
}

/// Checks that the job is one of two configurations of one forest, and finds what it asks for.
pub(super) fn wanted<T: Real>(job: &Configure<'_, T>) -> Result<Wanted, JobError> {
    let count = job.from.home().joint_count();
    ShapeError::check("joints of the other configuration", count, job.to.home().joint_count())?;
    if job.from.home() != job.to.home() {
        return Err(JobError::OtherForest);
    }
    crate::rotation::check_indices("translated", job.translated, count)?;
    check_slots(job)?;
    let is_lacking = |joint: &i32| job.from.topology().parents()[*joint as usize] == NONE;
    if let Some(joint) = (0..count as i32).filter(is_lacking).find(|joint| !job.translated.contains(joint)) {
        return Err(JobError::RootAtRest { joint: joint as usize });
    }
    let slot_of = slots_by_world(job.from);
    let known = known(job.from);
    let mut slots = vec![];
    for span in spans(job).filter_map(|(_, span)| span).filter(|span| !known.contains_key(span)) {
        slots.extend([span.above, span.own].iter().filter_map(|world| slot_of.get(world)));
    }
    let mut joints = vec![];
    for joint in job.translated_after() {
        let bone = bone(job.to, joint as usize);
        joints.extend([joint, bone.parent].into_iter().filter(|&joint| joint != NONE));
        if !bone.is_root && !is_whole(job.from, bone.joint) {
            joints.push(bone.joint as i32);
            slots.extend(slot_of.get(&job.from.home().world_slots()[bone.joint]));
        }
    }
    Ok(Wanted { joints, slots })
}

impl<T: Real> Plan<T> {
    pub(super) fn new(
        solving: &ForwardKinematics<'_, T>,
        job: &Configure<'_, T>,
        wanted: &Wanted,
    ) -> Result<Self, JobError> {
        let found = solving::Plan::new(solving, true, true)?;
        let bones =
            wanted.joints.iter().zip(&found.joints_out).map(|(&joint, &bone)| (joint, bone)).collect();
        let turns =
            wanted.slots.iter().zip(&found.slots_out).filter_map(|(&slot, &turn)| Some((slot, turn?)));
        let solved = Solved { job, bones, turns: turns.collect(), slots: slots_by_world(job.from) };
        let turns = solved.turns();
        let copied =
            turns.iter().filter_map(|turn| if let Turn::Copy(slot) = turn { Some(*slot) } else { None });
        Ok(Self { copied: copied.collect(), turns, vectors: solved.vectors(), solving: found })
    }
}

/// Where what was asked for stands in the solving plan.
struct Solved<'a, 'b, T> {
    job: &'a Configure<'b, T>,
    bones: HashMap<i32, usize>,
    turns: HashMap<i32, usize>,
    slots: HashMap<i32, i32>,
}

impl<T: Real> Solved<'_, '_, T> {
    /// The turn that makes a world rotation; `None`: the world's own.
    fn turn(&self, world: i32) -> Option<usize> {
        self.slots.get(&world).map(|slot| self.turns[slot])
    }

    fn turns(&self) -> Vec<Turn> {
        let known = known(self.job.from);
        let turn = |(slot, span): (usize, Option<Span>)| {
            let Some(span) = span else { return Turn::Copy(slot) };
            if let Some(&slot) = known.get(&span) {
                return Turn::Copy(slot);
            }
            match (self.turn(span.above), self.turn(span.own)) {
                (None, Some(own)) => Turn::World(own),
                (Some(above), Some(own)) => Turn::Between(above, own),
                (Some(above), None) => Turn::Back(above),
                (None, None) => unreachable!("a slot that leads from the world to the world is none"),
            }
        };
        spans(self.job).map(turn).collect()
    }

    fn vectors(&self) -> Vec<Vector> {
        self.job.translated_after().into_iter().map(|joint| self.vector(joint)).collect()
    }

    fn vector(&self, joint: i32) -> Vector {
        let (from, to) = (self.job.from, self.job.to);
        let bone = bone(to, joint as usize);
        if bone.is_root {
            return Vector::Place(self.bones[&joint]);
        }
        if is_whole(from, bone.joint) {
            let is_flipped = from.topology().parents()[joint as usize] != bone.parent;
            let end = if is_flipped { bone.parent } else { joint };
            return Vector::Copy { bone: self.bones[&end], is_flipped };
        }
        let turn = self.turn(from.home().world_slots()[bone.joint]);
        Vector::Between { turn, from: self.bones[&bone.parent], to: self.bones[&joint] }
    }
}

/// The slots of `to` that are wanted, and what they lead from and to.
fn spans<T>(job: &Configure<'_, T>) -> impl Iterator<Item = (usize, Option<Span>)> {
    let all = job.to.spans();
    let count = job.slots.map_or(all.len(), <[i32]>::len);
    let slots = job.slots;
    (0..count).map(move |k| {
        let slot = slots.map_or(k, |slots| slots[k] as usize);
        (slot, all[slot])
    })
}

fn check_slots<T>(job: &Configure<'_, T>) -> Result<(), JobError> {
    let count = job.to.topology().slot_count();
    let slots = job.slots.unwrap_or_default();
    match slots.iter().position(|slot| !(0..count as i32).contains(slot)) {
        Some(at) => Err(JobError::Index { what: "slots", at, found: slots[at].into(), count }),
        None => Ok(()),
    }
}

/// The bone above a joint.
struct Bone {
    /// The joint in which it ends at home.
    joint: usize,
    parent: i32,
    is_root: bool,
}

fn bone(forest: &Forest, joint: usize) -> Bone {
    let parent = forest.topology().parents()[joint];
    Bone { joint: forest.bones()[joint] as usize, parent, is_root: parent == NONE }
}

/// Whether the bone that ends in `joint` at home is not cut.
fn is_whole(forest: &Forest, joint: usize) -> bool {
    let parents = forest.topology().parents();
    usize::try_from(forest.home().parents()[joint])
        .is_ok_and(|above| parents[joint] == above as i32 || parents[above] == joint as i32)
}

/// The joints that are translated per frame in `to`; see [`Configure::translated_after`].
pub(super) fn translated_after(from: &Forest, to: &Forest, translated: &[i32]) -> Vec<i32> {
    let count = from.home().joint_count();
    let mut is_moving = vec![false; count];
    for joint in translated.iter().filter_map(|&joint| usize::try_from(joint).ok()).filter(|&j| j < count) {
        if from.topology().parents()[joint] != NONE {
            is_moving[from.bones()[joint] as usize] = true;
        }
    }
    let is_translated = |joint: &usize| {
        let bone = bone(to, *joint);
        bone.is_root || is_moving[bone.joint] || !is_whole(from, bone.joint)
    };
    (0..count).filter(is_translated).map(|joint| joint as i32).collect()
}

/// The slots by what they lead from and to.
fn known(forest: &Forest) -> HashMap<Span, usize> {
    let spans = forest.spans().iter().enumerate().rev();
    spans.filter_map(|(slot, span)| span.map(|span| (span, slot))).collect()
}

/// A slot that makes each world rotation, one with as few slots above it as there are.
fn slots_by_world(forest: &Forest) -> HashMap<i32, i32> {
    let topology = forest.topology();
    let mut depth = vec![0_usize; topology.slot_count()];
    let mut found: HashMap<i32, i32> = HashMap::new();
    for &slot in topology.slot_order() {
        let above = usize::try_from(topology.slot_parents()[slot as usize]);
        depth[slot as usize] = above.map_or(0, |above| depth[above] + 1);
        let Some(span) = forest.spans()[slot as usize] else { continue };
        let best = found.entry(span.own).or_insert(slot as i32);
        if depth[slot as usize] < depth[*best as usize] {
            *best = slot as i32;
        }
    }
    // The world's own rotation is known without any slot.
    found.remove(&NONE);
    found
}
