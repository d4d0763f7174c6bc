//! Trials on synthetic databases: known answers, and the laws that every log obeys.

mod synthetic;

use gmr_core::matching::database::Database;
use gmr_core::matching::ground::{Placement, direction};
use gmr_core::matching::index::Query;
use gmr_core::matching::index::brute_force;
use gmr_core::matching::matcher::Status;
use gmr_core::matching::path::{ReferencePath, Segment};
use gmr_core::matching::request::Tracking;
use gmr_core::matching::settings::Settings;
use gmr_core::matching::trial::{LoggedStep, Profile, Progress, TrialError, TrialLog, Trials, run_trials};
use proptest::prelude::*;
use synthetic::{RATE, Walk, database, database_with_a_past};

fn segment(duration: f64, speed: f64, turn_rate: f64) -> Segment {
    Segment { duration, speed, turn_rate, drift: 0.0 }
}

fn constant(speed: f64, turn_rate: f64) -> Profile {
    Profile { segments: vec![segment(12.0, speed, turn_rate)], record_from: 2.0 }
}

fn run(database: &Database, profiles: &[Profile], settings: &Settings) -> Result<Vec<TrialLog>, TrialError> {
    run_tracking(Tracking::Time, database, profiles, settings)
}

fn run_tracking(
    tracking: Tracking,
    database: &Database,
    profiles: &[Profile],
    settings: &Settings,
) -> Result<Vec<TrialLog>, TrialError> {
    run_trials(&Trials { database, profiles, tracking, settings, threads: 1 }, &Progress::default())
}

fn run_one_tracking(tracking: Tracking, database: &Database, profile: Profile) -> TrialLog {
    run_tracking(tracking, database, &[profile], &Settings::default()).unwrap().remove(0)
}

fn run_one(database: &Database, profile: Profile, settings: &Settings) -> TrialLog {
    run(database, &[profile], settings).unwrap().remove(0)
}

fn worst_offset(log: &TrialLog) -> f64 {
    log.steps.iter().map(|s| s.placement.position.distance(s.reference.position)).fold(0.0, f64::max)
}

fn mean_speed(log: &TrialLog) -> f64 {
    let steps = log.steps.windows(2).map(|w| w[0].placement.position.distance(w[1].placement.position));
    steps.sum::<f64>() * RATE / (log.steps.len() - 1) as f64
}

/// The row that would be shown at each step if nothing were searched; the first step has none before it.
fn continuing(database: &Database, log: &TrialLog, step: usize) -> Option<u32> {
    let before = log.steps[step.checked_sub(1)?].choice.row;
    Some(database.next_row(before).unwrap_or(before))
}

fn is_jump(step: &LoggedStep) -> bool {
    matches!(step.choice.status, Status::Jumped | Status::ForcedAtEnd)
}

/// Walks of some speeds and turn rates, both ways.
fn various() -> Vec<Walk> {
    let mut walks = Vec::new();
    for (speed, cadence) in [(0.8, 0.7), (1.5, 1.0), (2.5, 1.4)] {
        for turn_rate in [-1.2, -0.4, 0.0, 0.5, 1.3] {
            walks.push(Walk { frames: 260, speed, turn_rate, cadence, ..Walk::default() });
        }
    }
    walks
}

#[test]
fn a_straight_clip_follows_a_straight_path_at_its_own_speed_without_error() {
    let database = database(&[Walk::default()]);
    for tracking in [Tracking::Time, Tracking::Velocity] {
        let log = run_one_tracking(tracking, &database, constant(1.5, 0.0));
        assert_eq!(log.steps.len(), 721);
        assert_eq!(log.recorded_from, 120);
        assert!(worst_offset(&log) < 1e-4, "{}", worst_offset(&log));
        assert!((mean_speed(&log) - 1.5).abs() < 1e-5);
        assert!(log.steps.iter().any(is_jump), "a clip of 5 s cannot last for 12 s");
    }
}

#[test]
fn a_clip_on_a_circle_follows_that_circle_without_error() {
    for turn_rate in [-1.5, 0.7] {
        let database = database(&[Walk { turn_rate, ..Walk::default() }]);
        for tracking in [Tracking::Time, Tracking::Velocity] {
            let log = run_one_tracking(tracking, &database, constant(1.5, turn_rate));
            assert!(worst_offset(&log) < 1e-3, "{}", worst_offset(&log));
            let turned = log.steps[720].placement.heading;
            assert!((turned - turn_rate * 12.0).abs() < 1e-4, "{turned}");
        }
    }
}

#[test]
fn of_several_clips_the_one_that_is_asked_for_is_played() {
    let walks = various();
    let database = database(&walks);
    for (number, walk) in walks.iter().enumerate() {
        let log = run_one(&database, constant(walk.speed, walk.turn_rate), &Settings::default());
        assert!(worst_offset(&log) < 0.05, "{walk:?}: {}", worst_offset(&log));
        let own = log.steps.iter().filter(|s| database.clip_of()[s.choice.row as usize] as usize == number);
        assert!(own.count() > 650, "{walk:?}");
    }
}

#[test]
fn closed_loop_catches_up_and_open_loop_forgets() {
    let database = database(&various());
    // Nobody walks at 1.9 m/s: a walk that falls behind asks for a run in closed loop, in open loop never.
    let [closed, open] = [Tracking::Time, Tracking::Velocity]
        .map(|tracking| worst_offset(&run_one_tracking(tracking, &database, constant(1.9, 0.0))));
    assert!(closed < 1.5 && open > 4.0, "closed {closed}, open {open}");
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let database = database(&various());
    let profiles: Vec<_> =
        (0..10).map(|i| constant(1.0 + 0.15 * f64::from(i), 0.2 * f64::from(i) - 1.0)).collect();
    let settings = Settings::default();
    let [one, two] = [1, 2].map(|threads| {
        let trials = Trials {
            database: &database,
            profiles: &profiles,
            tracking: Tracking::Time,
            settings: &settings,
            threads,
        };
        format!("{:?}", run_trials(&trials, &Progress::default()).unwrap())
    });
    assert_eq!(one, two);
}

#[test]
fn without_jumps_a_clip_plays_to_its_last_row_and_is_left_there() {
    let database = database(&[Walk::default(), Walk { speed: 1.4, ..Walk::default() }]);
    let settings = Settings { transition_penalty: 1e9, ..Settings::default() };
    let log = run_one(&database, constant(1.5, 0.0), &settings);
    let mut forced = 0;
    for (step, logged) in log.steps.iter().enumerate().skip(1) {
        let continuing = continuing(&database, &log, step).unwrap();
        let at_end = database.next_row(continuing).is_none();
        assert_eq!(logged.choice.status == Status::ForcedAtEnd, at_end);
        assert_eq!(logged.choice.row != continuing, at_end);
        forced += usize::from(at_end);
    }
    assert!(forced >= 2, "{forced}");
}

#[test]
fn the_only_candidate_left_is_played_again_though_it_is_near() {
    // 61 frames and a horizon of 60: row 0 is the one candidate there is.
    let database = database(&[Walk { frames: 61, ..Walk::default() }]);
    let log =
        run_one(&database, constant(1.5, 0.0), &Settings { exclude_within: 1000, ..Settings::default() });
    let jumps: Vec<_> = log.steps.iter().filter(|step| is_jump(step)).map(|step| step.choice).collect();
    assert!(jumps.len() > 8);
    assert!(jumps.iter().all(|choice| choice.row == 0 && choice.status == Status::ForcedAtEnd));
}

#[test]
fn a_switch_is_searched_at_once_and_a_mere_seam_is_not() {
    let database = database(&various());
    let segments = vec![segment(3.05, 1.5, 0.0), segment(1.0, 1.5, 0.0), segment(2.0, 2.5, 0.0)];
    let log = run_one(&database, Profile { segments, record_from: 0.0 }, &Settings::default());
    let searched: Vec<_> =
        (0..log.steps.len()).filter(|&i| log.steps[i].choice.status != Status::PlayedOn).collect();
    assert!(searched.contains(&243) && !searched.contains(&183), "{searched:?}");
    assert!(searched.contains(&180) && searched.contains(&240) && searched.contains(&249));
}

#[test]
fn only_rows_with_all_the_tags_are_jumped_to() {
    let tagged = |tags| Walk { tags, ..Walk::default() };
    let database = database(&[tagged(1), tagged(3), tagged(2)]);
    let settings = Settings { tags: 3, ..Settings::default() };
    let log = run_one(&database, constant(1.5, 0.0), &settings);
    assert!(log.steps.iter().all(|step| database.clip_of()[step.choice.row as usize] == 1));
    let refused = run(&database, &[constant(1.5, 0.0)], &Settings { tags: 4, ..settings });
    assert_eq!(refused, Err(TrialError::NoCandidates { tags: 4 }));
}

#[test]
fn a_cancelled_run_says_so_and_a_finished_one_counts() {
    let database = database(&[Walk::default()]);
    let (settings, profiles) = (Settings::default(), [constant(1.5, 0.0), constant(1.0, 0.0)]);
    let trials = Trials {
        database: &database,
        profiles: &profiles,
        tracking: Tracking::Time,
        settings: &settings,
        threads: 1,
    };
    let progress = Progress::default();
    run_trials(&trials, &progress).unwrap();
    assert_eq!(progress.done(), 2);
    progress.cancel();
    assert_eq!(run_trials(&trials, &progress), Err(TrialError::Cancelled));
}

#[test]
fn what_cannot_be_run_is_refused_by_name() {
    let database = database(&[Walk::default()]);
    let refused =
        |profile: Profile, settings: Settings| run(&database, &[profile], &settings).unwrap_err().to_string();
    let good = || constant(1.0, 0.0);
    let default = Settings::default();
    for (profile, settings, words) in [
        (Profile { segments: vec![], ..good() }, default.clone(), "trial 0: a path needs"),
        (constant(f64::NAN, 0.0), default.clone(), "trial 0: segment 0 of the path has speed NaN"),
        (Profile { record_from: 12.0, ..good() }, default.clone(), "recording from 12 s"),
        (Profile { record_from: f64::NAN, ..good() }, default.clone(), "recording from NaN s"),
        (good(), Settings { search_every: 0.0, ..default.clone() }, "a search every 0 s"),
        (good(), Settings { search_every: f64::NAN, ..default.clone() }, "a search every NaN s"),
        (good(), Settings { transition_penalty: -1.0, ..default.clone() }, "a transition penalty of -1"),
        (
            good(),
            Settings { weights: Some(vec![1.0]), ..default.clone() },
            "weights holds 1 elements where 27",
        ),
        (good(), Settings { weights: Some(vec![-1.0; 27]), ..default.clone() }, "weight 0 of query 0 is -1"),
        (
            good(),
            Settings { transition_penalty: f32::INFINITY, ..default.clone() },
            "a transition penalty of inf",
        ),
    ] {
        let message = refused(profile, settings);
        assert!(message.contains(words), "{message}");
    }
}

/// The query that a step should have asked, with the platform's own trigonometry and in f64.
fn expected_query(
    database: &Database,
    log: &TrialLog,
    path: &ReferencePath,
    step: usize,
    from: u32,
) -> Vec<f32> {
    let here = log.steps[step].placement;
    let mut query = database.feature_row(from).to_vec();
    for sample in database.schema().trajectory() {
        let there = match usize::try_from(step as i64 + i64::from(sample.frames)) {
            Ok(then) if sample.frames <= 0 => log.steps[then].placement,
            Err(_) => continue,
            _ => path.at((step as f64 + f64::from(sample.frames)) / RATE),
        };
        let turn = there.heading - here.heading;
        let away = there.position - here.position;
        let (sin, cos) = here.heading.sin_cos();
        let wanted = if sample.is_facing {
            [turn.sin(), turn.cos()]
        } else {
            [away.x * cos - away.y * sin, away.x * sin + away.y * cos]
        };
        for axis in 0..2 {
            query[sample.dim + axis] =
                database.normalization().feature(sample.dim + axis, wanted[axis] as f32);
        }
    }
    query
}

fn profiles() -> impl Strategy<Value = Profile> {
    let segment = (0.3..3.0_f64, 0.0..3.0_f64, -1.5..1.5_f64).prop_map(|(d, v, w)| segment(d, v, w));
    prop::collection::vec(segment, 1..4).prop_map(|segments| Profile { segments, record_from: 0.0 })
}

fn settings() -> impl Strategy<Value = Settings> {
    (prop_oneof![Just(0.1), 0.01..0.4], 0..60_u32, prop_oneof![Just(0.0), 0.0..5.0_f32]).prop_map(
        |(search_every, exclude_within, transition_penalty)| Settings {
            search_every,
            exclude_within,
            transition_penalty,
            ..Settings::default()
        },
    )
}

#[test]
fn weights_of_one_change_no_bit_of_a_log_and_others_do() {
    let database = database(&various());
    let profile = || constant(1.9, 0.3);
    let weighted = |weights: Vec<f32>| {
        let settings = Settings { weights: Some(weights), ..Settings::default() };
        format!("{:?}", run_one(&database, profile(), &settings))
    };
    let even = format!("{:?}", run_one(&database, profile(), &Settings::default()));
    assert_eq!(even, weighted(vec![1.0; 27]));
    assert_ne!(even, weighted((0..27).map(|dim| if dim < 15 { 0.1 } else { 1.0 }).collect()));
}

#[test]
fn a_start_without_a_past_is_kept_by_the_first_search() {
    let database = database_with_a_past(&various());
    for turn_rate in [-0.909_654_263_857_218_7, -0.4, 0.0, 0.7] {
        let profile = Profile { segments: vec![segment(0.3, 0.0, turn_rate)], record_from: 0.0 };
        let log = run_one(&database, profile, &Settings { exclude_within: 0, ..Settings::default() });
        assert_eq!(log.steps[0].choice.status, Status::Kept, "turning at {turn_rate}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn every_log_obeys_the_laws_of_the_controller(
        profile in profiles(), settings in settings(), looks_back in any::<bool>(),
    ) {
        let database = if looks_back { database_with_a_past(&various()) } else { database(&various()) };
        let log = run_one(&database, profile.clone(), &settings);
        let path = ReferencePath::new(Placement::default(), &profile.segments).unwrap();
        let interval = (settings.search_every * RATE).round().max(1.0) as usize;
        let mut last_search = 0;
        for step in 0..log.steps.len() {
            let LoggedStep { placement, reference, request, choice } = log.steps[step];
            prop_assert_eq!(reference, path.at(step as f64 / RATE));
            prop_assert_eq!(request, *path.segment(path.active(step as f64 / RATE)));

            if let Some(before) = step.checked_sub(1).map(|i| log.steps[i]) {
                let [x, z] = database.step(before.choice.row).displacement.map(f64::from);
                let forward = direction(before.placement.heading);
                let moved = before.placement.position + forward * z + glam::DVec2::new(forward.y, -forward.x) * x;
                prop_assert!((moved - placement.position).length() < 1e-12);
            }

            let from = continuing(&database, &log, step).unwrap_or(choice.row);
            let played_on = choice.status == Status::PlayedOn;
            prop_assert_eq!(choice.row == from, matches!(choice.status, Status::PlayedOn | Status::Kept));
            prop_assert_eq!(played_on, choice.cost_pose.is_nan() && choice.cost_trajectory.is_nan());
            prop_assert_eq!(choice.discontinuity.is_nan(), choice.row == from);
            if played_on {
                prop_assert!(step - last_search < interval);
                continue;
            }
            last_search = step;

            // What was found is what brute force finds, and costs what it says.
            let query = expected_query(&database, &log, &path, step, from);
            let within = settings.exclude_within;
            let clip = database.clip_rows(from);
            let exclude = from.saturating_sub(within).max(clip.start)..(from + within + 1).min(clip.end);
            let wide = Query { exclude: exclude.clone(), ..Query::new(&query) };
            let best = brute_force::search(database.features(), database.candidates(), None, &wide).unwrap();
            let stay = brute_force::cost(&query, database.feature_row(from));
            let total = choice.cost_pose + choice.cost_trajectory;
            let slack = 1e-4 * (1.0 + total);
            match choice.status {
                Status::Kept => prop_assert!(stay - settings.transition_penalty <= best.cost + slack),
                Status::Jumped => prop_assert!(best.cost + settings.transition_penalty < stay + slack),
                _ => prop_assert!(database.next_row(from).is_none()),
            }
            if is_jump(&log.steps[step]) {
                prop_assert!((total - best.cost).abs() < slack, "{total} {best:?}");
                prop_assert!(!exclude.contains(&choice.row) && database.candidates()[choice.row as usize]);
            } else {
                prop_assert!(choice.cost_pose == 0.0 && (total - stay).abs() < slack);
            }
        }
    }
}
