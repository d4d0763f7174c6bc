//! Trials: a character sent along a reference path, every step logged; many trials at once.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::controller::Controller;
use super::database::Database;
use super::ground::Placement;
use super::index::IndexError;
use super::matcher::Choice;
use super::path::{PathError, ReferencePath, Segment};
use super::request::Tracking;
use super::settings::{Settings, SettingsError};
use super::start::Starts;
use crate::parallel::for_each_chunk;

/// What is asked of the character in one trial, from the origin with heading 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Speed and turn rate, piece by piece.
    pub segments: Vec<Segment>,
    /// Seconds after which the trial counts; what comes before (run-up, settling) is logged too.
    pub record_from: f64,
}

/// One step of a trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoggedStep {
    /// Where the root stood, as playback alone puts it; inertialisation only smooths what is drawn.
    pub placement: Placement,
    /// Where it should have stood.
    pub reference: Placement,
    /// The segment that was active.
    pub request: Segment,
    /// The row shown and how it was chosen.
    pub choice: Choice,
}

/// One trial, step by step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrialLog {
    /// One entry a step of the database's rate, from 0 s to the end of the last segment, both included.
    pub steps: Vec<LoggedStep>,
    /// The step at which recording begins: what counts are the ways from it to the next ones.
    pub recorded_from: usize,
}

/// Trials to be run.
#[derive(Debug, Clone)]
pub struct Trials<'a> {
    /// What is played.
    pub database: &'a Database,
    /// What is asked, one a trial.
    pub profiles: &'a [Profile],
    /// What queries aim at.
    pub tracking: Tracking,
    /// How it is searched.
    pub settings: &'a Settings,
    /// Threads to share the trials among; 0 means all cores. The logs do not depend on it.
    pub threads: usize,
}

/// How far trials have come, and whether to go on; shared with whoever watches.
#[derive(Debug, Default)]
pub struct Progress {
    done: AtomicUsize,
    cancelled: AtomicBool,
}

impl Progress {
    /// Trials that are finished.
    #[must_use]
    pub fn done(&self) -> usize {
        self.done.load(Ordering::Relaxed)
    }

    /// Asks all trials to stop at their next step.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

/// Runs every trial; the logs are in the order of the profiles.
///
/// # Errors
/// When a setting or a profile is out of bounds, no candidate carries the tags, or the trials were cancelled.
pub fn run_trials(trials: &Trials, progress: &Progress) -> Result<Vec<TrialLog>, TrialError> {
    trials.settings.check(trials.database.dims()).map_err(TrialError::Settings)?;
    let paths = trials.paths()?;
    let starts = Starts::new(trials.database, trials.settings);
    let mut logs: Vec<Result<TrialLog, TrialError>> = vec![Err(TrialError::Cancelled); paths.len()];
    for_each_chunk(&mut logs, 1, trials.threads, |number, log| {
        log[0] = trials.run(number, &paths[number], &starts, progress);
        progress.done.fetch_add(1, Ordering::Relaxed);
    });
    logs.into_iter().collect()
}

impl Trials<'_> {
    fn paths(&self) -> Result<Vec<ReferencePath>, TrialError> {
        let path = |(trial, profile): (usize, &Profile)| {
            let path = ReferencePath::new(Placement::default(), &profile.segments)
                .map_err(|error| TrialError::Path { trial, error })?;
            let recorded = profile.record_from >= 0.0 && profile.record_from < path.duration();
            let found = profile.record_from;
            if recorded { Ok(path) } else { Err(TrialError::RecordFrom { trial, found }) }
        };
        self.profiles.iter().enumerate().map(path).collect()
    }

    fn run(
        &self,
        trial: usize,
        path: &ReferencePath,
        starts: &Starts,
        progress: &Progress,
    ) -> Result<TrialLog, TrialError> {
        let steps_in = |seconds: f64| (seconds * self.database.rate()).round() as usize;
        let mut controller = Controller::new(self.database, self.tracking, self.settings, path, starts)
            .ok_or(TrialError::NoCandidates { tags: self.settings.tags })?;
        let last = steps_in(path.duration());
        let mut steps = Vec::with_capacity(last + 1);
        for _ in 0..=last {
            if progress.is_cancelled() {
                return Err(TrialError::Cancelled);
            }
            let (time, placement) = (controller.time(), controller.placement());
            let (reference, request) = (path.at(time), *path.segment(path.active(time)));
            let choice = controller.step().map_err(|error| TrialError::Search { trial, error })?;
            steps.push(LoggedStep { placement, reference, request, choice });
        }
        Ok(TrialLog { steps, recorded_from: steps_in(self.profiles[trial].record_from).min(last) })
    }
}

/// Why trials gave no logs.
#[derive(Debug, Clone, PartialEq)]
pub enum TrialError {
    /// A profile of which no path can be made.
    Path {
        /// Number of the trial.
        trial: usize,
        /// What is wrong.
        error: PathError,
    },
    /// Recording would begin before the trial or after its end.
    RecordFrom {
        /// Number of the trial.
        trial: usize,
        /// The second at which it should begin.
        found: f64,
    },
    /// Settings by which nothing can be searched.
    Settings(SettingsError),
    /// No row that may be jumped to carries all the tags.
    NoCandidates {
        /// The tag bits asked for.
        tags: u32,
    },
    /// A query that cannot be answered.
    Search {
        /// Number of the trial.
        trial: usize,
        /// What is wrong.
        error: IndexError,
    },
    /// Somebody called [`Progress::cancel`].
    Cancelled,
}

impl fmt::Display for TrialError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Path { trial, error } => write!(f, "trial {trial}: {error}"),
            Self::RecordFrom { trial, found } => write!(
                f,
                "trial {trial}: recording from {found} s is not within the trial; use 0 or more, and less than \
                 the sum of its segments' durations"
            ),
            Self::Settings(error) => error.fmt(f),
            Self::NoCandidates { tags } => {
                write!(f, "no frame that may be jumped to carries all of the tag bits {tags:#b}")
            }
            Self::Search { trial, error } => write!(f, "trial {trial}: {error}"),
            Self::Cancelled => write!(f, "the trials were cancelled"),
        }
    }
}

impl std::error::Error for TrialError {}
