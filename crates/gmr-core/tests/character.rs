//! A character that a program steps: a trial where it is asked for the same, smooth at every rate of drawing.

mod synthetic;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use glam::{DVec2, Quat, Vec3};
use gmr_core::matching::character::{Character, CharacterError, LONGEST_STEP};
use gmr_core::matching::database::Database;
use gmr_core::matching::ground::Placement;
use gmr_core::matching::path::{ReferencePath, Segment};
use gmr_core::matching::playback::{HALF_LIFE, Playback, shown_positions};
use gmr_core::matching::request::Tracking;
use gmr_core::matching::settings::Settings;
use gmr_core::matching::trial::{Profile, Progress, TrialLog, Trials, run_trials};
use synthetic::{RATE, Skeleton, Walk, database, database_at, database_with_a_past};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, which counts what each thread asks of it.
struct Counting;

// SAFETY: all is handed on to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promises are handed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are handed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn walks() -> Vec<Walk> {
    let mut walks = Vec::new();
    for (speed, cadence) in [(0.8, 0.7), (1.5, 1.0), (2.5, 1.4)] {
        for turn_rate in [-1.2, 0.0, 1.3] {
            walks.push(Walk { frames: 260, speed, turn_rate, cadence, ..Walk::default() });
        }
    }
    walks
}

/// Its whole length at one speed and turn rate, which no walk has.
const ASKED: Segment = Segment { duration: 8.0, speed: 1.9, turn_rate: 0.4, drift: 0.0 };

fn trial(database: &Database) -> TrialLog {
    let profiles = [Profile { segments: vec![ASKED], record_from: 0.0 }];
    let (tracking, settings) = (Tracking::Time, Settings::default());
    let trials = Trials { database, profiles: &profiles, tracking, settings: &settings, threads: 1 };
    run_trials(&trials, &Progress::default()).unwrap().remove(0)
}

fn path() -> ReferencePath {
    ReferencePath::new(Placement::default(), &[ASKED]).unwrap()
}

/// Where the path leads from `time` on.
fn wanted(times: &[f64], time: f64) -> Vec<Placement> {
    times.iter().map(|ahead| path().at(time + ahead)).collect()
}

fn on_the_path(database: &Database) -> Character<&Database> {
    let times = Character::new(database, &Settings::default(), HALF_LIFE, Placement::default());
    let wanted = wanted(times.unwrap().times(), 0.0);
    Character::on_its_way(database, &Settings::default(), HALF_LIFE, Placement::default(), &wanted).unwrap()
}

#[test]
fn tick_by_tick_a_character_is_a_trial() {
    let carried = database_at(RATE, Skeleton::Carried, &walks());
    for database in [database(&walks()), carried, database_with_a_past(&walks())] {
        let log = trial(&database);
        let rows: Vec<u32> = log.steps.iter().map(|step| step.choice.row).collect();
        let placements: Vec<Placement> = log.steps.iter().map(|step| step.placement).collect();
        let playback = Playback {
            database: &database,
            rows: &rows,
            placements: &placements,
            half_life: HALF_LIFE,
            joints: None,
        };
        let width = 3 * database.joint_count();
        let mut positions = vec![0.0; rows.len() * width];
        shown_positions(&playback, &mut positions).unwrap();
        let jumps = rows.windows(2).filter(|pair| pair[1] != pair[0] + 1).count();
        assert!(jumps > 5, "{jumps}");

        let mut character = on_the_path(&database);
        for step in 0..rows.len() {
            if step > 0 {
                let time = step as f64 / RATE;
                character.step(&wanted(character.times(), time), 1.0 / RATE).unwrap();
            }
            assert_eq!((character.choice().row, character.placement()), (rows[step], placements[step]));
            assert_eq!(character.shown().positions(), &positions[step * width..][..width], "step {step}");
        }
    }
}

#[test]
fn where_nothing_jumps_a_character_shows_its_rows_and_what_lies_between_them() {
    let database = database(&[Walk { turn_rate: 0.5, ..Walk::default() }]);
    let settings = Settings { transition_penalty: 1e9, ..Settings::default() };
    let place = Placement::new(3.0, -1.0, 2.0);
    let mut character = Character::new(&database, &settings, HALF_LIFE, place).unwrap();
    let first = character.choice().row;
    let quarter = 0.25 / RATE;
    let mut heights = Vec::new();
    for _ in 0..40 {
        let shown = character.step(&[place; 3], quarter).unwrap();
        heights.push(shown.position(1).y);
    }
    assert_eq!(character.choice().row, first + 10);
    for row in 0..9 {
        let [low, high] = [0, 1].map(|next| database.position_row(first + row + 1 + next)[4]);
        let shown = &heights[3 + 4 * row as usize..][..5];
        assert!((shown[0] - low).abs() < 1e-5 && (shown[4] - high).abs() < 1e-5);
        let middle = 0.5 * (low + high);
        assert!((shown[2] - middle).abs() < 2e-3, "{shown:?}");
    }
}

/// The length of the second difference of the shown positions, at most.
fn worst_kink(database: &Database, steps_a_second: f64) -> f32 {
    let mut character = on_the_path(database);
    let mut before: Vec<Vec<Vec3>> = Vec::new();
    let mut worst = 0.0_f32;
    for step in 1..(7.0 * steps_a_second) as usize {
        let time = step as f64 / steps_a_second;
        let shown = character.step(&wanted(character.times(), time), 1.0 / steps_a_second).unwrap();
        before.push((0..database.joint_count()).map(|joint| shown.position(joint)).collect());
        if let [.., a, b, c] = &before[..] {
            let kinks = a.iter().zip(b).zip(c).map(|((a, b), c)| (*a - *b * 2.0 + *c).length());
            worst = kinks.fold(worst, f32::max);
        }
    }
    worst
}

#[test]
fn drawn_at_any_rate_a_jump_is_smooth() {
    let database = database(&walks());
    for rate in [144.0, 240.0] {
        let kink = worst_kink(&database, rate);
        // At its own rate a joint of these walks bends by up to 2 cm a frame; between frames it goes straight.
        assert!(kink < 0.03, "at {rate} per second: {kink}");
    }
}

#[test]
fn bones_lead_to_the_joints_that_are_shown() {
    let database = database(&walks());
    let mut character = on_the_path(&database);
    for step in 1..200 {
        let time = step as f64 / 90.0;
        character.step(&wanted(character.times(), time), 1.0 / 90.0).unwrap();
        let shown = character.shown();
        for joint in 1..database.joint_count() {
            let parent = database.topology().parents()[joint] as usize;
            let bone = shown.position(joint) - shown.position(parent);
            let rest = Vec3::from_slice(&database.offsets(0)[3 * joint..]);
            let turned: Quat = shown.bone_rotation(joint);
            assert!((turned.length() - 1.0).abs() < 1e-5);
            assert!((bone - turned * rest).length() < 1e-4, "joint {joint}: {bone} {}", turned * rest);
        }
    }
}

#[test]
fn a_step_asks_for_no_memory() {
    let database = database_with_a_past(&walks());
    for weights in [None, Some(vec![0.5; database.dims()])] {
        let settings = Settings { weights, ..Settings::default() };
        let mut character = Character::new(&database, &settings, HALF_LIFE, Placement::default()).unwrap();
        let wanted = wanted(character.times(), 0.0);
        let before = ALLOCATIONS.with(Cell::get);
        for _ in 0..300 {
            character.step(&wanted, 1.0 / 45.0).unwrap();
        }
        assert_eq!(ALLOCATIONS.with(Cell::get) - before, 0);
    }
}

#[test]
fn a_character_put_elsewhere_goes_on_from_there_in_the_same_way() {
    let database = database_with_a_past(&walks());
    let [mut stays, mut goes] = [0, 1].map(|_| on_the_path(&database));
    let away = Placement::new(5.0, -2.0, 1.0);
    let moved = |place: &Placement| Placement {
        position: away.position + away.rotate(place.position),
        heading: away.heading + place.heading,
    };
    for step in 1..300 {
        let asked = wanted(stays.times(), step as f64 / RATE);
        let asked_there: Vec<Placement> = asked.iter().map(moved).collect();
        if step == 100 {
            goes.place(moved(&goes.placement())).unwrap();
        }
        stays.step(&asked, 1.0 / RATE).unwrap();
        goes.step(if step < 100 { &asked } else { &asked_there }, 1.0 / RATE).unwrap();
        let there = if step < 100 { stays.placement() } else { moved(&stays.placement()) };
        assert!((goes.placement().position - there.position).length() < 1e-3);
        assert!((goes.placement().heading - there.heading).abs() < 1e-3);
        let foot = |character: &Character<&Database>| {
            let [x, _, z] = character.shown().position(1).as_dvec3().to_array();
            DVec2::new(x, z)
        };
        let expected = Placement { position: foot(&stays), heading: 0.0 };
        let expected = if step < 100 { expected } else { moved(&expected) };
        assert!((foot(&goes) - expected.position).length() < 1e-3, "step {step}");
    }
}

#[test]
fn what_cannot_be_stepped_is_refused_and_leaves_the_character_as_it_was() {
    let database = database(&walks());
    let mut character = on_the_path(&database);
    let good = wanted(character.times(), 0.0);
    let mut bad = good.clone();
    bad[1].position = DVec2::new(f64::NAN, 0.0);
    let before = (character.placement(), character.shown().positions().to_vec());
    for (places, dt, words) in [
        (&good, -0.1, "a step of -0.1 s"),
        (&good, f64::NAN, "a step of NaN s"),
        (&good, LONGEST_STEP + 0.1, "use 0 to 10 s"),
        (&bad, 0.1, "wanted place 1 is not finite"),
        (&good[..2].to_vec(), 0.1, "wanted places holds 2 elements where 3 are needed"),
    ] {
        let message = character.step(places, dt).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
    assert_eq!(before, (character.placement(), character.shown().positions().to_vec()));
    let made = |settings: Settings, half_life| {
        Character::new(&database, &settings, half_life, Placement::default()).unwrap_err()
    };
    assert_eq!(
        made(Settings { tags: 8, ..Settings::default() }, 0.1),
        CharacterError::NoCandidates { tags: 8 }
    );
    assert!(made(Settings::default(), 0.0).to_string().contains("a half-life of 0 s"));
    let short = Settings { weights: Some(vec![1.0; 3]), ..Settings::default() };
    assert!(made(short, 0.1).to_string().contains("weights holds 3 elements where 27"));
}
