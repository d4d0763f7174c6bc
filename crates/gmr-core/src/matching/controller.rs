//! The controller: which row of the database is shown at each step, and where its root stands.
//!
//! A step shows a row at a placement; the row's own root displacement and turn lead to the next placement, and the
//! next row of the clip is the one that would be shown there: the *continuing* row. When a search is due the
//! continuing row's pose and the trajectory asked for make the query; a row that costs strictly less takes its place.
//!
//! - A search is due every so many steps, and at once when the request switches or the clip ends.
//! - Not candidates: rows too near a clip's end to have a future (the database says which), and those of the playing
//!   clip within a few frames of the continuing one.
//! - Playback may run on into rows that are no candidates, as far as the last but one of the clip. Their missing
//!   future reads as standing still, so that a search usually leaves them before. The last row has no step to a next
//!   one: it is never played on from, and the search there is forced to jump.
//!
//! Source: Clavet, "Motion Matching and the Road to Next-Gen Animation", GDC 2016; Holden et al., "Learned Motion
//! Matching" (2020), section 3.

use std::ops::Range;

use glam::{DVec2, Vec3};

use super::carriers::body;
use super::database::Database;
use super::features::TrajectorySample;
use super::ground::Placement;
use super::index::brute_force::cost;
use super::index::{Hit, IndexError, Query};
use super::path::ReferencePath;
use super::request::{Target, Tracking};
use super::start::Starts;

/// How the controller searches.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// What queries aim at.
    pub tracking: Tracking,
    /// Seconds from a search to the next; rounded to whole steps, at least one.
    pub search_every: f64,
    /// Rows of the playing clip at most this many frames from the continuing row are no candidates.
    pub exclude_within: u32,
    /// Added to the cost of every row but the continuing one; 0 or more.
    pub transition_penalty: f32,
    /// Tag bits that every candidate carries; 0 asks for none.
    pub tags: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tracking: Tracking::Time,
            search_every: 0.1,
            exclude_within: 20,
            transition_penalty: 0.0,
            tags: 0,
        }
    }
}

/// How a step came to show its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Status {
    /// The continuing row, without a search.
    PlayedOn = 0,
    /// The continuing row, which no other beat.
    Kept = 1,
    /// A row that cost less than the continuing one.
    Jumped = 2,
    /// The best of the other rows: the clip had ended.
    ForcedAtEnd = 3,
}

/// What a step shows, and what was found on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// The database row.
    pub row: u32,
    /// How it was chosen.
    pub status: Status,
    /// Cost of the row over the pose dimensions; NaN where nothing was searched.
    pub cost_pose: f32,
    /// Cost of the row over the trajectory dimensions; NaN where nothing was searched.
    pub cost_trajectory: f32,
    /// Mean distance in metres between the body's joints in the continuing row and in this one, each seen from its
    /// simulation root; NaN where there was no jump.
    pub discontinuity: f32,
}

/// A character on its way through one trial.
#[derive(Debug)]
pub struct Controller<'a> {
    database: &'a Database,
    settings: &'a Settings,
    path: &'a ReferencePath,
    samples: Vec<TrajectorySample>,
    is_trajectory: Vec<bool>,
    body: Vec<usize>,
    query: Vec<f32>,
    history: Vec<Placement>,
    continuing: u32,
    steps_to_search: u32,
}

impl<'a> Controller<'a> {
    /// A character at the start of `path`, on its starting row; `None` when no candidate carries the tags.
    #[must_use]
    pub fn new(
        database: &'a Database,
        settings: &'a Settings,
        path: &'a ReferencePath,
        starts: &Starts,
    ) -> Option<Self> {
        let mut controller = Self {
            database,
            settings,
            path,
            samples: database.schema().trajectory(),
            is_trajectory: database.schema().is_trajectory(),
            body: body(database.topology(), database.translated()),
            query: vec![0.0; database.dims()],
            history: vec![path.at(0.0)],
            continuing: 0,
            steps_to_search: 0,
        };
        controller.ask();
        controller.continuing = starts.row(&controller.query)?;
        Some(controller)
    }

    /// Number of the step that comes next.
    #[must_use]
    pub fn step_number(&self) -> usize {
        self.history.len() - 1
    }

    /// Seconds since the start, at the step that comes next.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.step_number() as f64 / self.database.rate()
    }

    /// Where the root stands at the step that comes next.
    #[must_use]
    pub fn placement(&self) -> Placement {
        self.history[self.step_number()]
    }

    /// Chooses the row to show now, then moves on by one step.
    ///
    /// # Errors
    /// When the query cannot be answered: a number of it is not finite.
    pub fn step(&mut self) -> Result<Choice, IndexError> {
        let ended = self.database.next_row(self.continuing).is_none();
        let choice = if ended || self.steps_to_search == 0 || self.request_switches() {
            self.steps_to_search = self.search_interval();
            self.search(ended)?
        } else {
            self.play_on()
        };
        self.steps_to_search -= 1;
        self.advance(choice.row);
        Ok(choice)
    }

    fn search_interval(&self) -> u32 {
        (self.settings.search_every * self.database.rate()).round().max(1.0) as u32
    }

    fn request_switches(&self) -> bool {
        let request = |time| {
            let segment = self.path.segment(self.path.active(time));
            (segment.speed, segment.turn_rate)
        };
        request(self.time()) != request(self.time() - 1.0 / self.database.rate())
    }

    fn play_on(&self) -> Choice {
        Choice {
            row: self.continuing,
            status: Status::PlayedOn,
            cost_pose: f32::NAN,
            cost_trajectory: f32::NAN,
            discontinuity: f32::NAN,
        }
    }

    fn search(&mut self, forced: bool) -> Result<Choice, IndexError> {
        self.query.copy_from_slice(self.database.feature_row(self.continuing));
        self.ask();
        let hit = if forced { self.best_other()? } else { self.better_than_continuing()? };
        let row = hit.map_or(self.continuing, |hit| hit.frame);
        let (cost_pose, cost_trajectory) = self.costs(row);
        let (status, discontinuity) = match hit {
            None => (Status::Kept, f32::NAN),
            Some(_) if forced => (Status::ForcedAtEnd, self.discontinuity(row)),
            Some(_) => (Status::Jumped, self.discontinuity(row)),
        };
        Ok(Choice { row, status, cost_pose, cost_trajectory, discontinuity })
    }

    /// The best candidate that costs less than the continuing row, penalty included.
    fn better_than_continuing(&self) -> Result<Option<Hit>, IndexError> {
        let stay = cost(&self.query, self.database.feature_row(self.continuing));
        let max_cost = stay - self.settings.transition_penalty;
        self.database.index().search(&Query { max_cost, ..self.ask_index(self.neighbourhood()) })
    }

    /// The best candidate; the neighbourhood is admitted only when there is no other.
    fn best_other(&self) -> Result<Option<Hit>, IndexError> {
        match self.database.index().search(&self.ask_index(self.neighbourhood()))? {
            None => self.database.index().search(&self.ask_index(0..0)),
            hit => Ok(hit),
        }
    }

    fn ask_index(&self, exclude: Range<u32>) -> Query<'_> {
        Query { tags: self.settings.tags, exclude, ..Query::new(&self.query) }
    }

    fn neighbourhood(&self) -> Range<u32> {
        near(self.continuing, self.settings.exclude_within, &self.database.clip_rows(self.continuing))
    }

    /// Puts what is asked for into the trajectory dimensions of the query.
    ///
    /// Samples of the past are where the character was; those from before the trial stay the continuing row's.
    fn ask(&mut self) {
        let (now, time, here) = (self.step_number() as i64, self.time(), self.placement());
        for sample in &self.samples {
            let target = if sample.frames > 0 {
                let ahead = f64::from(sample.frames) / self.database.rate();
                self.settings.tracking.target(self.path, time, &here, ahead)
            } else {
                let Ok(then) = usize::try_from(now + i64::from(sample.frames)) else { continue };
                Target::seen_from(&here, &self.history[then])
            };
            let DVec2 { x, y } = if sample.is_facing { target.facing } else { target.position };
            let normalization = self.database.normalization();
            self.query[sample.dim] = normalization.feature(sample.dim, x as f32);
            self.query[sample.dim + 1] = normalization.feature(sample.dim + 1, y as f32);
        }
    }

    /// What `row` costs over the pose and over the trajectory dimensions, each summed in their order.
    fn costs(&self, row: u32) -> (f32, f32) {
        let mut costs = [0.0, 0.0];
        let dims = self.query.iter().zip(self.database.feature_row(row)).zip(&self.is_trajectory);
        for ((q, x), &is_trajectory) in dims {
            costs[usize::from(is_trajectory)] += (q - x) * (q - x);
        }
        (costs[0], costs[1])
    }

    fn discontinuity(&self, row: u32) -> f32 {
        let [from, to] = [self.continuing, row].map(|row| self.database.position_row(row).as_chunks::<3>().0);
        let distance = |&joint: &usize| f64::from(Vec3::from(from[joint]).distance(Vec3::from(to[joint])));
        (self.body.iter().map(distance).sum::<f64>() / self.body.len() as f64) as f32
    }

    fn advance(&mut self, shown: u32) {
        let step = self.database.step(shown);
        let displacement = DVec2::new(step.displacement[0].into(), step.displacement[1].into());
        self.history.push(self.placement().advanced(displacement, step.turn.into()));
        // A clip's last row can only be shown where the schema has no future; the search is forced there again.
        self.continuing = self.database.next_row(shown).unwrap_or(shown);
    }
}

/// The rows of `clip` that are at most `within` frames from `row`.
fn near(row: u32, within: u32, clip: &Range<u32>) -> Range<u32> {
    let end = row.saturating_add(within).saturating_add(1);
    row.saturating_sub(within).max(clip.start)..end.min(clip.end)
}

#[cfg(test)]
mod tests {
    use super::near;

    #[test]
    fn the_neighbourhood_includes_both_its_ends_and_keeps_to_the_clip() {
        assert_eq!(near(150, 20, &(100..300)), 130..171);
        assert_eq!(near(110, 20, &(100..300)), 100..131);
        assert_eq!(near(295, 20, &(100..300)), 275..300);
        assert_eq!(near(7, 0, &(0..300)), 7..8);
        assert_eq!(near(7, u32::MAX, &(0..300)), 0..300);
    }
}
