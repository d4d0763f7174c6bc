//! Which row of the database is shown next: the one that goes on, or one that suits better what is asked for.
//!
//! A step shows a row; the next row of its clip is the one that would be shown then: the *continuing* row. When a search
//! is due the continuing row's pose and the trajectory asked for make the query; a row that costs strictly less takes
//! its place.
//!
//! - A search is due every so many steps, at once when that is asked for, and when the clip ends.
//! - Not candidates: rows too near a clip's end to have a future (the database says which), and those of the playing
//!   clip within a few frames of the continuing one.
//! - Playback may run on into rows that are no candidates, as far as the last but one of the clip. Their missing
//!   future reads as standing still, so that a search usually leaves them before. The last row has no step to a next
//!   one: it is never played on from, and the search there is forced to jump.
//!
//! Source: Clavet, "Motion Matching and the Road to Next-Gen Animation", GDC 2016; Holden et al., "Learned Motion
//! Matching" (2020), section 3.

use std::ops::{Deref, Range};

use glam::{DVec2, Vec3};

use super::carriers::body;
use super::database::Database;
use super::features::TrajectorySample;
use super::index::{Hit, IndexError, Query};
use super::request::Target;
use super::settings::Settings;
use super::start::Starts;

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

/// Chooses row after row of a database.
#[derive(Debug, Clone)]
pub struct Matcher<D> {
    database: D,
    settings: Settings,
    samples: Vec<TrajectorySample>,
    is_trajectory: Vec<bool>,
    body: Vec<usize>,
    query: Vec<f32>,
    continuing: u32,
    steps_to_search: u32,
}

impl<D: Deref<Target = Database>> Matcher<D> {
    /// Starts on the row whose future is nearest to what `aim` says; `None` when no candidate carries the tags.
    ///
    /// `aim` tells where the character should be, or was, at a sample's time, seen from where it is now; what it does
    /// not tell of the past is the continuing row's.
    #[must_use]
    pub fn new(
        database: D,
        settings: &Settings,
        starts: &Starts,
        aim: impl FnMut(&TrajectorySample) -> Option<Target>,
    ) -> Option<Self> {
        let mut matcher = Self {
            samples: database.schema().trajectory(),
            is_trajectory: database.schema().is_trajectory(),
            body: body(database.topology(), database.translated()),
            query: vec![0.0; database.dims()],
            continuing: 0,
            steps_to_search: 0,
            settings: settings.clone(),
            database,
        };
        matcher.ask(aim);
        matcher.continuing = starts.row(&matcher.query)?;
        Some(matcher)
    }

    /// The database that is searched.
    #[must_use]
    pub fn database(&self) -> &Database {
        &self.database
    }

    /// What is asked of the next step: it searches.
    pub fn search_now(&mut self) {
        self.steps_to_search = 0;
    }

    /// Chooses the row to show now; `aim` is asked where a search is due, as in [`Matcher::new`].
    ///
    /// # Errors
    /// When the query cannot be answered: a number of it is not finite.
    pub fn step(
        &mut self,
        aim: impl FnMut(&TrajectorySample) -> Option<Target>,
    ) -> Result<Choice, IndexError> {
        let ended = self.database.next_row(self.continuing).is_none();
        let choice = if ended || self.steps_to_search == 0 {
            self.steps_to_search = self.search_interval();
            self.search(ended, aim)?
        } else {
            self.play_on()
        };
        self.steps_to_search -= 1;
        // A clip's last row can only be shown where the schema has no future; the search is forced there again.
        self.continuing = self.database.next_row(choice.row).unwrap_or(choice.row);
        Ok(choice)
    }

    fn search_interval(&self) -> u32 {
        (self.settings.search_every * self.database.rate()).round().max(1.0) as u32
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

    fn search(
        &mut self,
        forced: bool,
        aim: impl FnMut(&TrajectorySample) -> Option<Target>,
    ) -> Result<Choice, IndexError> {
        self.query.copy_from_slice(self.database.feature_row(self.continuing));
        self.ask(aim);
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
        let query = self.ask_index(self.neighbourhood());
        let stay = query.cost_of(self.database.feature_row(self.continuing));
        let max_cost = stay - self.settings.transition_penalty;
        self.database.index().search(&Query { max_cost, ..query })
    }

    /// The best candidate; the neighbourhood is admitted only when there is no other.
    fn best_other(&self) -> Result<Option<Hit>, IndexError> {
        match self.database.index().search(&self.ask_index(self.neighbourhood()))? {
            None => self.database.index().search(&self.ask_index(0..0)),
            hit => Ok(hit),
        }
    }

    fn ask_index(&self, exclude: Range<u32>) -> Query<'_> {
        let weights = self.settings.weights.as_deref();
        Query { weights, tags: self.settings.tags, exclude, ..Query::new(&self.query) }
    }

    fn neighbourhood(&self) -> Range<u32> {
        near(self.continuing, self.settings.exclude_within, &self.database.clip_rows(self.continuing))
    }

    /// Puts what is asked for into the trajectory dimensions of the query.
    fn ask(&mut self, mut aim: impl FnMut(&TrajectorySample) -> Option<Target>) {
        let normalization = self.database.normalization();
        for sample in &self.samples {
            let Some(target) = aim(sample) else { continue };
            let DVec2 { x, y } = if sample.is_facing { target.facing } else { target.position };
            self.query[sample.dim] = normalization.feature(sample.dim, x as f32);
            self.query[sample.dim + 1] = normalization.feature(sample.dim + 1, y as f32);
        }
    }

    /// What `row` costs over the pose and over the trajectory dimensions, each summed in their order.
    fn costs(&self, row: u32) -> (f32, f32) {
        let mut costs = [0.0, 0.0];
        let dims = self.query.iter().zip(self.database.feature_row(row)).zip(&self.is_trajectory);
        for (dim, ((q, x), &is_trajectory)) in dims.enumerate() {
            let weight = self.settings.weights.as_ref().map_or(1.0, |weights| weights[dim]);
            if weight > 0.0 {
                costs[usize::from(is_trajectory)] += weight * ((q - x) * (q - x));
            }
        }
        (costs[0], costs[1])
    }

    fn discontinuity(&self, row: u32) -> f32 {
        let [from, to] = [self.continuing, row].map(|row| self.database.position_row(row).as_chunks::<3>().0);
        let distance = |&joint: &usize| f64::from(Vec3::from(from[joint]).distance(Vec3::from(to[joint])));
        (self.body.iter().map(distance).sum::<f64>() / self.body.len() as f64) as f32
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
