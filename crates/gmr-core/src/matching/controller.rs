//! The controller of a trial: it asks for a reference path, step by step, and says where its root stands.
//!
//! A step shows a row at a placement; the row's own root displacement and turn lead to the next placement. Which row,
//! [`super::matcher`] decides; a switch of the request is answered at once.

use super::database::Database;
use super::features::TrajectorySample;
use super::ground::Placement;
use super::index::IndexError;
use super::matcher::{Choice, Matcher};
use super::path::ReferencePath;
use super::request::{Target, Tracking};
use super::settings::Settings;
use super::start::Starts;

/// A character on its way through one trial.
#[derive(Debug)]
pub struct Controller<'a> {
    matcher: Matcher<&'a Database>,
    course: Course<'a>,
}

/// What is asked for, and where the character has been.
#[derive(Debug)]
struct Course<'a> {
    path: &'a ReferencePath,
    tracking: Tracking,
    rate: f64,
    history: Vec<Placement>,
}

impl<'a> Controller<'a> {
    /// A character at the start of `path`, on its starting row; `None` when no candidate carries the tags.
    #[must_use]
    pub fn new(
        database: &'a Database,
        tracking: Tracking,
        settings: &Settings,
        path: &'a ReferencePath,
        starts: &Starts,
    ) -> Option<Self> {
        let course = Course { path, tracking, rate: database.rate(), history: vec![path.at(0.0)] };
        let matcher = Matcher::new(database, settings, starts, |sample| course.aim(sample))?;
        Some(Self { matcher, course })
    }

    /// Number of the step that comes next.
    #[must_use]
    pub fn step_number(&self) -> usize {
        self.course.step_number()
    }

    /// Seconds since the start, at the step that comes next.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.course.time()
    }

    /// Where the root stands at the step that comes next.
    #[must_use]
    pub fn placement(&self) -> Placement {
        self.course.placement()
    }

    /// Chooses the row to show now, then moves on by one step.
    ///
    /// # Errors
    /// When the query cannot be answered: a number of it is not finite.
    pub fn step(&mut self) -> Result<Choice, IndexError> {
        if self.course.request_switches() {
            self.matcher.search_now();
        }
        let choice = self.matcher.step(|sample| self.course.aim(sample))?;
        let next = self.placement().moved(self.matcher.database().step(choice.row), 1.0);
        self.course.history.push(next);
        Ok(choice)
    }
}

impl Course<'_> {
    fn step_number(&self) -> usize {
        self.history.len() - 1
    }

    fn time(&self) -> f64 {
        self.step_number() as f64 / self.rate
    }

    fn placement(&self) -> Placement {
        self.history[self.step_number()]
    }

    fn request_switches(&self) -> bool {
        let request = |time| {
            let segment = self.path.segment(self.path.active(time));
            (segment.speed, segment.turn_rate, segment.drift)
        };
        request(self.time()) != request(self.time() - 1.0 / self.rate)
    }

    /// Samples of the past are where the character was; of those from before the trial nothing is known.
    fn aim(&self, sample: &TrajectorySample) -> Option<Target> {
        let here = self.placement();
        if sample.frames > 0 {
            let ahead = f64::from(sample.frames) / self.rate;
            return Some(self.tracking.target(self.path, self.time(), &here, ahead));
        }
        let then = usize::try_from(self.step_number() as i64 + i64::from(sample.frames)).ok()?;
        Some(Target::seen_from(&here, &self.history[then]))
    }
}
