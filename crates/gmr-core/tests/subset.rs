//! Trials on a part of a database: what is gone is not shown, and what is left does as if it had been alone.

mod synthetic;

use gmr_core::matching::database::Database;
use gmr_core::matching::database_error::DatabaseError;
use gmr_core::matching::matcher::Status;
use gmr_core::matching::path::Segment;
use gmr_core::matching::request::Tracking;
use gmr_core::matching::settings::Settings;
use gmr_core::matching::trial::{Profile, Progress, TrialLog, Trials, run_trials};
use proptest::prelude::*;
use synthetic::{Walk, database, database_scaled_as, database_with_a_past};

fn various() -> Vec<Walk> {
    let mut walks = Vec::new();
    for (speed, cadence) in [(0.8, 0.7), (1.5, 1.0), (2.5, 1.4)] {
        for turn_rate in [-1.2, 0.0, 0.5] {
            walks.push(Walk { frames: 260, speed, turn_rate, cadence, ..Walk::default() });
        }
    }
    walks
}

fn log_of(database: &Database, speed: f64, turn_rate: f64) -> TrialLog {
    let profiles = [Profile {
        segments: vec![Segment { duration: 8.0, speed, turn_rate, drift: 0.0 }],
        record_from: 0.0,
    }];
    let settings = Settings::default();
    let tracking = Tracking::Time;
    let trials = Trials { database, profiles: &profiles, tracking, settings: &settings, threads: 1 };
    run_trials(&trials, &Progress::default()).unwrap().remove(0)
}

/// A log whose rows are named by clip and frame; NaN is like itself.
fn named(database: &Database, log: &TrialLog, clips: &[usize]) -> Vec<String> {
    let name = |row: u32| {
        let clip = database.clip_of()[row as usize] as usize;
        (clips[clip], row - database.clip_rows(row).start)
    };
    let step = |step: &gmr_core::matching::trial::LoggedStep| {
        let choice = step.choice;
        let costs = [choice.cost_pose, choice.cost_trajectory, choice.discontinuity].map(f32::to_bits);
        let place = [step.placement.position.x, step.placement.position.y, step.placement.heading];
        format!("{:?} {:?} {costs:?} {:?}", name(choice.row), choice.status, place.map(f64::to_bits))
    };
    log.steps.iter().map(step).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn clips_that_are_left_do_as_a_database_built_of_them(
        left in prop::collection::vec(any::<bool>(), 9).prop_filter("no clip", |left| left.contains(&true)),
        speed in 0.5..3.0_f64, turn_rate in -1.5..1.5_f64,
    ) {
        let walks = various();
        let whole = database(&walks);
        let clips: Vec<usize> = (0..walks.len()).filter(|&clip| left[clip]).collect();
        let built = database_scaled_as(&whole, &clips.iter().map(|&clip| walks[clip]).collect::<Vec<_>>());
        let rows: Vec<bool> = whole.clip_of().iter().map(|&clip| left[clip as usize]).collect();
        let part = whole.subset(&rows, 1).unwrap();
        let every: Vec<usize> = (0..walks.len()).collect();
        let [expected, found] = [(&built, &clips), (&part, &every)]
            .map(|(database, clips)| named(database, &log_of(database, speed, turn_rate), clips));
        prop_assert_eq!(expected, found);
    }

    #[test]
    fn what_is_gone_is_not_shown_and_ends_what_leads_to_it(
        cuts in prop::collection::vec((0..9_usize, 0..260_usize, 1..120_usize), 1..12),
        speed in 0.5..3.0_f64, turn_rate in -1.5..1.5_f64, looks_back in any::<bool>(),
    ) {
        let walks = various();
        let whole = if looks_back { database_with_a_past(&walks) } else { database(&walks) };
        let mut left = vec![true; whole.row_count()];
        for (clip, first, length) in cuts {
            left[clip * 260 + first..clip * 260 + (first + length).min(260)].fill(false);
        }
        let part = match whole.subset(&left, 1) {
            Err(DatabaseError::NoCandidates { .. }) => return Ok(()),
            part => part.unwrap(),
        };
        let log = log_of(&part, speed, turn_rate);
        for step in &log.steps {
            let (row, status) = (step.choice.row, step.choice.status);
            prop_assert!(left[row as usize]);
            if matches!(status, Status::Jumped | Status::ForcedAtEnd) {
                let past = if looks_back { 20 } else { 0 };
                let looks_at = row as usize - past..=row as usize + 60;
                prop_assert!(looks_at.clone().all(|row| left[row]), "{looks_at:?}");
                prop_assert!(whole.candidates()[row as usize]);
            }
        }
        for steps in log.steps.windows(2) {
            let (before, now) = (steps[0].choice.row, steps[1].choice);
            if !left.get(before as usize + 2).copied().unwrap_or(false) {
                prop_assert_eq!(now.status, Status::ForcedAtEnd, "row {} has none to lead on to", before + 1);
            }
        }
    }

    #[test]
    fn what_no_trial_shows_or_needs_can_go_without_a_bit_changing(
        speed in 0.5..3.0_f64, turn_rate in -1.5..1.5_f64,
    ) {
        let whole = database(&various());
        let log = log_of(&whole, speed, turn_rate);
        let mut left = vec![false; whole.row_count()];
        for step in &log.steps {
            let row = step.choice.row as usize;
            let end = whole.clip_rows(step.choice.row).end as usize;
            // Itself, the row that continues it with the one after, and what the features of these look at.
            left[row..(row + 63).min(end)].fill(true);
        }
        let part = whole.subset(&left, 1).unwrap();
        let every: Vec<usize> = (0..9).collect();
        let [before, after] = [&whole, &part].map(|database| named(database, &log_of(database, speed, turn_rate), &every));
        prop_assert_eq!(before, after);
        prop_assert!(left.contains(&false));
    }
}

#[test]
fn a_part_of_a_part_lacks_what_both_lack() {
    let whole = database(&various());
    let without = |clip: u32| whole.clip_of().iter().map(|&c| c != clip).collect::<Vec<_>>();
    let part = whole.subset(&without(0), 1).unwrap().subset(&without(3), 1).unwrap();
    assert!(!part.has_row(5) && !part.has_row(3 * 260) && part.has_row(260));
    assert_eq!(part.index().candidate_count(), 7 * 200);
}

#[test]
fn nothing_left_to_jump_to_is_refused() {
    let whole = database(&various());
    let mut left = vec![false; whole.row_count()];
    left[..60].fill(true);
    assert_eq!(whole.subset(&left, 1).unwrap_err(), DatabaseError::NoCandidates { needed: 61 });
    left[60] = true;
    assert_eq!(whole.subset(&left, 1).unwrap().index().candidate_count(), 1);
    assert!(matches!(whole.subset(&left[1..], 1), Err(DatabaseError::Shape(_))));
}
