//! A character of a game: what it should do goes in, the pose to draw comes out, step after step.
//!
//! ```
//! # use gmr_core::matching::character::Character;
//! # use gmr_core::matching::database::Database;
//! # use gmr_core::matching::ground::Placement;
//! # use gmr_core::matching::settings::Settings;
//! # use gmr_core::matching::playback::HALF_LIFE;
//! # fn play(database: &Database) -> Result<(), Box<dyn std::error::Error>> {
//! let mut character = Character::new(database, &Settings::default(), HALF_LIFE, Placement::default())?;
//! let speed = 1.5; // metres a second, straight ahead, as a stick may ask
//! for _ in 0..600 {
//!     let here = character.placement();
//!     let wanted = |&ahead: &f64| Placement { position: here.position + here.direction() * speed * ahead, ..here };
//!     let wanted: Vec<Placement> = character.times().iter().map(wanted).collect();
//!     let pose = character.step(&wanted, 1.0 / 60.0)?;
//!     println!("joint 0 is at {:?}, its bone turned by {:?}", pose.position(0), pose.bone_rotation(0));
//! }
//! # Ok(())
//! # }
//! ```
//!
//! The clock of the database ticks inside: at each tick the next row is chosen ([`super::matcher`], as in a trial) and
//! the root takes the row's step. Between two ticks the pose is that between the row and the next one, so a character
//! shows the present at any rate of drawing. A step asks for no memory, if the schema has at most 64 numbers.

use std::collections::VecDeque;
use std::fmt;
use std::ops::Deref;

use glam::{Quat, Vec3};

use super::body::{Body, Moment};
use super::database::Database;
use super::features::TrajectorySample;
use super::ground::Placement;
use super::index::IndexError;
use super::matcher::{Choice, Matcher};
use super::request::Target;
use super::settings::{Settings, SettingsError};
use super::start::Starts;
use crate::error::{JobError, ShapeError, TopologyError};
use crate::kinematics::plan::Plan;
use crate::kinematics::scalar::solve;
use crate::kinematics::{ForwardKinematics, Pose};
use crate::skeleton::Topology;

/// The longest step in seconds: what takes longer was a halt.
pub const LONGEST_STEP: f64 = 10.0;

/// A step that lacks less than this share of a tick has reached it: the rest is rounding.
const ROUNDING: f64 = 1e-9;

/// A body that follows what it is asked for; `D` is a reference to the database, or an `Arc` of it.
#[derive(Debug, Clone)]
pub struct Character<D> {
    matcher: Matcher<D>,
    body: Body<D>,
    course: Course,
    choice: Choice,
    /// The share of a tick that has gone by since the last one.
    share: f64,
    shown: Shown,
}

/// Where a character has been at past ticks, and when it is asked for what.
#[derive(Debug, Clone)]
struct Course {
    /// The ticks ahead for which a place is asked, ascending.
    ahead: Vec<i32>,
    times: Vec<f64>,
    /// Where it was, the present last; as many as the features look back.
    history: VecDeque<Placement>,
    /// How many that are.
    longest: usize,
}

impl<D: Deref<Target = Database> + Clone> Character<D> {
    /// A character that stands at `placement` and wants to stay there, on the row that suits this best.
    ///
    /// `half_life` is that of the smoothing of jumps in seconds, such as [`super::playback::HALF_LIFE`].
    ///
    /// # Errors
    /// When a setting or the half-life is out of bounds, or no candidate carries the tags.
    pub fn new(
        database: D,
        settings: &Settings,
        half_life: f64,
        placement: Placement,
    ) -> Result<Self, CharacterError> {
        let wanted = vec![placement; Course::new(&database, placement).times.len()];
        Self::on_its_way(database, settings, half_life, placement, &wanted)
    }

    /// As [`Character::new`], already on its way to what is wanted, as in [`Character::step`].
    ///
    /// # Errors
    /// As there, and when a place is missing or not finite.
    pub fn on_its_way(
        database: D,
        settings: &Settings,
        half_life: f64,
        placement: Placement,
        wanted: &[Placement],
    ) -> Result<Self, CharacterError> {
        settings.check(database.dims())?;
        if !(half_life > 0.0 && half_life.is_finite()) {
            return Err(CharacterError::HalfLife { found: half_life });
        }
        let course = Course::new(&database, placement);
        course.check(wanted)?;
        check_place("the character's place", 0, &placement)?;
        let starts = Starts::new(&database, settings);
        let started = Matcher::new(database.clone(), settings, &starts, |sample| course.aim(sample, wanted));
        let mut matcher = started.ok_or(CharacterError::NoCandidates { tags: settings.tags })?;
        drop(starts);
        let choice = matcher.step(|sample| course.aim(sample, wanted))?;
        let body = Body::new(database, half_life)?;
        let shown = Shown::new(body.topology())?;
        let mut character = Self { matcher, body, course, choice, share: 0.0, shown };
        character.show();
        Ok(character)
    }

    /// Lets `dt` seconds pass, and returns what is shown then.
    ///
    /// `wanted` holds, for each of [`Character::times`], where the character should be and which way it should face so
    /// many seconds after the end of this step, in the world.
    ///
    /// # Errors
    /// When `dt` is below 0 or above [`LONGEST_STEP`], or there is not one finite place for each time; the character is
    /// then as it was. Also when a place lies so far away that no feature can say it.
    pub fn step(&mut self, wanted: &[Placement], dt: f64) -> Result<&Shown, CharacterError> {
        if !(0.0..=LONGEST_STEP).contains(&dt) {
            return Err(CharacterError::Step { found: dt });
        }
        self.course.check(wanted)?;
        self.share += dt * self.database().rate();
        while self.share >= 1.0 - ROUNDING {
            self.share = (self.share - 1.0).max(0.0);
            self.tick(wanted)?;
        }
        self.show();
        Ok(&self.shown)
    }

    fn tick(&mut self, wanted: &[Placement]) -> Result<(), IndexError> {
        let before = self.choice.row;
        let placement = self.course.here().moved(self.database().step(before), 1.0);
        self.course.advance(placement);
        self.choice = self.matcher.step(|sample| self.course.aim(sample, wanted))?;
        self.body.step(before, self.choice.row, &placement);
        Ok(())
    }

    fn show(&mut self) {
        let moment = Moment { row: self.choice.row, share: self.share, placement: *self.course.here() };
        let shown = &mut self.shown;
        shown.placement = self.body.show(&moment, &mut shown.rotations, &mut shown.vectors);
        shown.solve(self.body.topology());
    }

    /// The seconds ahead for which a step asks where to be, ascending.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.course.times
    }

    /// What is shown.
    #[must_use]
    pub fn shown(&self) -> &Shown {
        &self.shown
    }

    /// Where the simulation root is, without the smoothing of jumps: what a game moves its capsule by.
    #[must_use]
    pub fn placement(&self) -> Placement {
        self.course.here().moved(self.database().step(self.choice.row), self.share)
    }

    /// Takes the character, as it stands, to where a game wants it: off a wall, or anywhere. Nothing is smoothed.
    ///
    /// # Errors
    /// When the place is not finite.
    pub fn place(&mut self, placement: Placement) -> Result<(), CharacterError> {
        check_place("the character's place", 0, &placement)?;
        let here = self.placement();
        let turn = placement.heading - here.heading;
        for past in &mut self.course.history {
            let away = here.unrotate(past.position - here.position);
            past.position = placement.position + placement.rotate(away);
            past.heading += turn;
        }
        self.body.turn(turn);
        self.show();
        Ok(())
    }

    /// Has the next tick search, as is due where what is asked for changes at once.
    pub fn search_now(&mut self) {
        self.matcher.search_now();
    }

    /// The row that is played, and how the last tick chose it.
    #[must_use]
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// The database that is played.
    #[must_use]
    pub fn database(&self) -> &Database {
        self.matcher.database()
    }
}

impl Course {
    fn new(database: &Database, placement: Placement) -> Self {
        let samples = database.schema().trajectory();
        let mut ahead: Vec<i32> = samples.iter().map(|sample| sample.frames).filter(|&f| f > 0).collect();
        ahead.sort_unstable();
        ahead.dedup();
        let times = ahead.iter().map(|&frames| f64::from(frames) / database.rate()).collect();
        let longest = database.schema().past() + 1;
        let mut history = VecDeque::with_capacity(longest + 1);
        history.push_back(placement);
        Self { ahead, times, history, longest }
    }

    fn check(&self, wanted: &[Placement]) -> Result<(), CharacterError> {
        ShapeError::check("wanted places", self.times.len(), wanted.len())?;
        wanted.iter().enumerate().try_for_each(|(number, place)| check_place("wanted place", number, place))
    }

    fn here(&self) -> &Placement {
        &self.history[self.history.len() - 1]
    }

    fn advance(&mut self, placement: Placement) {
        self.history.push_back(placement);
        if self.history.len() > self.longest {
            self.history.pop_front();
        }
    }

    /// What is wanted at a sample's time; where it was, as far as that is known.
    fn aim(&self, sample: &TrajectorySample, wanted: &[Placement]) -> Option<Target> {
        let there = match self.ahead.binary_search(&sample.frames) {
            Ok(number) => wanted.get(number)?,
            Err(_) => {
                let back = usize::try_from(-i64::from(sample.frames)).ok()?;
                self.history.get(self.history.len().checked_sub(back + 1)?)?
            }
        };
        Some(Target::seen_from(self.here(), there))
    }
}

fn check_place(what: &'static str, number: usize, place: &Placement) -> Result<(), CharacterError> {
    let is_finite = place.position.is_finite() && place.heading.is_finite();
    if is_finite { Ok(()) } else { Err(CharacterError::NotFinite { what, number }) }
}

/// A pose in the world: metres, Y up, every jump smoothed.
#[derive(Debug, Clone)]
pub struct Shown {
    placement: Placement,
    positions: Vec<f32>,
    bone_rotations: Vec<f32>,
    /// Local: slots `(S, 4)` and bones `(J, 3)`.
    rotations: Vec<f32>,
    vectors: Vec<f32>,
    all_joints: Vec<i32>,
    no_offsets: Vec<f64>,
    plan: Plan<f32>,
    turned: Vec<[f32; 4]>,
    ends: Vec<[f32; 3]>,
}

impl Shown {
    /// Where the simulation root is shown.
    #[must_use]
    pub fn placement(&self) -> Placement {
        self.placement
    }

    /// World positions of all joints `(J, 3)`.
    #[must_use]
    pub fn positions(&self) -> &[f32] {
        &self.positions
    }

    /// World rotations of all bones `(J, 4)`, xyzw: that of the bone which ends in each joint, the identity where
    /// nothing turns it, as above a root. A joint's own frame, as BVH means it, is that of the bones that begin there.
    #[must_use]
    pub fn bone_rotations(&self) -> &[f32] {
        &self.bone_rotations
    }

    /// The world position of one joint.
    ///
    /// # Panics
    /// When there is no such joint.
    #[must_use]
    pub fn position(&self, joint: usize) -> Vec3 {
        Vec3::from_slice(&self.positions[3 * joint..])
    }

    /// The world rotation of the bone that ends in a joint.
    ///
    /// # Panics
    /// When there is no such joint.
    #[must_use]
    pub fn bone_rotation(&self, joint: usize) -> Quat {
        Quat::from_slice(&self.bone_rotations[4 * joint..])
    }

    /// Room for poses on this skeleton.
    fn new(topology: &Topology) -> Result<Self, JobError> {
        let joints = topology.joint_count();
        let mut shown = Self {
            placement: Placement::default(),
            positions: vec![0.0; 3 * joints],
            bone_rotations: vec![0.0; 4 * joints],
            rotations: vec![0.0; 4 * topology.slot_count()],
            vectors: vec![0.0; 3 * joints],
            all_joints: (0..joints as i32).collect(),
            no_offsets: vec![0.0; 3 * joints],
            plan: Plan { turns: vec![], bones: vec![], joints_out: vec![], slots_out: vec![] },
            turned: Vec::new(),
            ends: Vec::new(),
        };
        shown.plan = Plan::new(&shown.job(topology), true, true)?;
        shown.turned = vec![[0.0; 4]; shown.plan.turns.len()];
        shown.ends = vec![[0.0; 3]; shown.plan.bones.len()];
        Ok(shown)
    }

    fn job<'a>(&'a self, topology: &'a Topology) -> ForwardKinematics<'a, f32> {
        let (rotations, translations) = (&self.rotations, &self.vectors);
        ForwardKinematics {
            topology,
            offsets: &self.no_offsets,
            translated: &self.all_joints,
            pose: Pose::Quaternions { rotations, normalize: false, translations },
            frame_count: 1,
            joints: None,
            rotation_slots: Some(topology.world_slots()),
            threads: 1,
        }
    }

    /// Forward kinematics of the one frame.
    fn solve(&mut self, topology: &Topology) {
        let (mut turned, mut ends) = (std::mem::take(&mut self.turned), std::mem::take(&mut self.ends));
        solve(&self.job(topology), &self.plan, 0, &mut turned, &mut ends);
        (self.turned, self.ends) = (turned, ends);
        let positions = self.positions.as_chunks_mut::<3>().0;
        positions.iter_mut().zip(&self.plan.joints_out).for_each(|(out, &bone)| *out = self.ends[bone]);
        let rotations = self.bone_rotations.as_chunks_mut::<4>().0;
        rotations.iter_mut().zip(&self.plan.slots_out).for_each(|(out, turn)| {
            *out = turn.map_or([0.0, 0.0, 0.0, 1.0], |turn| self.turned[turn]);
        });
    }
}

/// Why a character cannot be made or cannot step.
#[derive(Debug, Clone, PartialEq)]
pub enum CharacterError {
    /// Settings by which nothing can be searched.
    Settings(SettingsError),
    /// No row that may be jumped to carries all the tags.
    NoCandidates {
        /// The tag bits asked for.
        tags: u32,
    },
    /// A half-life that is no time.
    HalfLife {
        /// The seconds asked for.
        found: f64,
    },
    /// A step that is no time, or too long.
    Step {
        /// The seconds asked for.
        found: f64,
    },
    /// Not one place for each time.
    Count(ShapeError),
    /// A place that is not finite.
    NotFinite {
        /// Which.
        what: &'static str,
        /// Its number.
        number: usize,
    },
    /// A query that cannot be answered.
    Search(IndexError),
    /// A skeleton that is no forest once its carriers are roots.
    Topology(TopologyError),
    /// A skeleton that cannot be posed.
    Job(JobError),
}

impl fmt::Display for CharacterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Settings(error) => error.fmt(f),
            Self::NoCandidates { tags } => {
                write!(f, "no frame that may be jumped to carries all of the tag bits {tags:#b}")
            }
            Self::HalfLife { found } => {
                write!(f, "a half-life of {found} s is not possible; use a finite time above 0 s")
            }
            Self::Step { found } => {
                write!(f, "a step of {found} s is not possible; use 0 to {LONGEST_STEP} s")
            }
            Self::Count(error) => error.fmt(f),
            Self::NotFinite { what, number } => {
                write!(f, "{what} {number} is not finite; give x, z and heading as finite numbers")
            }
            Self::Search(error) => error.fmt(f),
            Self::Topology(error) => error.fmt(f),
            Self::Job(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for CharacterError {}

macro_rules! from {
    ($($error:ty => $variant:ident),*) => {$(
        impl From<$error> for CharacterError {
            fn from(error: $error) -> Self {
                Self::$variant(error)
            }
        }
    )*};
}
from!(SettingsError => Settings, ShapeError => Count, IndexError => Search, TopologyError => Topology, JobError => Job);
