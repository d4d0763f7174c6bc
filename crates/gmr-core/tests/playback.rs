//! The poses that trials show: the database's own where nothing jumps, continuous where something does.

mod synthetic;

use glam::{DQuat, DVec3, Vec3};
use gmr_core::matching::database::Database;
use gmr_core::matching::ground::Placement;
use gmr_core::matching::path::Segment;
use gmr_core::matching::playback::{HALF_LIFE, Playback, PlaybackError, shown_positions};
use gmr_core::matching::request::Tracking;
use gmr_core::matching::trial::{Profile, Progress, Trials, run_trials};
use synthetic::{RATE, Skeleton, Walk, database, database_at};

const JOINTS: usize = 4;

struct Shown {
    rows: Vec<u32>,
    placements: Vec<Placement>,
    positions: Vec<Vec3>,
}

fn show(database: &Database, rows: Vec<u32>, placements: Vec<Placement>, half_life: f64) -> Shown {
    let playback = Playback { database, rows: &rows, placements: &placements, half_life, joints: None };
    let mut positions = vec![0.0; rows.len() * JOINTS * 3];
    shown_positions(&playback, &mut positions).unwrap();
    let positions = positions.as_chunks::<3>().0.iter().map(|&p| Vec3::from(p)).collect();
    Shown { rows, placements, positions }
}

/// Plays runs of rows one after the other, the root going on where it is.
fn play(database: &Database, runs: &[std::ops::Range<u32>], half_life: f64) -> Shown {
    let rows: Vec<u32> = runs.iter().cloned().flatten().collect();
    let mut placement = Placement::new(1.0, 2.0, 2.5);
    let mut placements = Vec::new();
    for &row in &rows {
        placements.push(placement);
        let step = database.step(row);
        let [x, z] = step.displacement.map(f64::from);
        placement = placement.advanced(glam::DVec2::new(x, z), step.turn.into());
    }
    show(database, rows, placements, half_life)
}

/// The row's own positions, put where its root stood.
fn raw(database: &Database, row: u32, placement: &Placement) -> Vec<Vec3> {
    let place = DVec3::new(placement.position.x, 0.0, placement.position.y);
    let turn = DQuat::from_rotation_y(placement.heading);
    let points = database.position_row(row).as_chunks::<3>().0.iter();
    points.map(|&p| (place + turn * Vec3::from(p).as_dvec3()).as_vec3()).collect()
}

/// Two performers, 300 frames each.
const GAITS: [Walk; 2] = [
    Walk { frames: 300, speed: 1.5, turn_rate: 0.0, cadence: 1.0, leg: 0.9, tags: 0 },
    Walk { frames: 300, speed: 2.5, turn_rate: 1.0, cadence: 1.7, leg: 1.1, tags: 0 },
];

fn two_gaits() -> Database {
    database(&GAITS)
}

impl Shown {
    fn joints(&self, step: usize) -> &[Vec3] {
        &self.positions[step * JOINTS..][..JOINTS]
    }

    /// How far a joint's way of one step differs from its way of the step before, at most.
    fn kink(&self, step: usize) -> f32 {
        let [before, now, after] = [step - 1, step, step + 1].map(|step| self.joints(step));
        (0..JOINTS).map(|j| (after[j] - now[j] * 2.0 + before[j]).length()).fold(0.0, f32::max)
    }

    /// How far the shown pose is from the raw one.
    fn departure(&self, database: &Database, step: usize) -> f32 {
        let raw = raw(database, self.rows[step], &self.placements[step]);
        self.joints(step).iter().zip(&raw).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
    }
}

#[test]
fn without_jumps_the_poses_are_those_of_the_database() {
    let database = two_gaits();
    for clip in database.clips() {
        let shown = play(&database, std::slice::from_ref(&clip.rows), HALF_LIFE);
        let worst = (0..shown.rows.len()).map(|i| shown.departure(&database, i)).fold(0.0, f32::max);
        assert!(worst < 3e-6, "{worst}");
    }
}

#[test]
fn a_jump_shows_the_continuing_pose_first_and_the_new_ones_soon() {
    let database = two_gaits();
    let shown = play(&database, &[0..100, 350..500], HALF_LIFE);
    let continuing = raw(&database, 100, &shown.placements[100]);
    for (joint, expected) in shown.joints(100).iter().zip(&continuing) {
        assert!(joint.distance(*expected) < 3e-6, "{joint} {expected}");
    }
    assert!(shown.departure(&database, 100) > 0.1, "these poses differ much");
    assert!(shown.departure(&database, 100 + 60) < 2e-3, "after a second the offsets are gone");
}

/// The largest kink at the jumps, in a motion of six of them, some during others, `finer` times 60 Hz.
fn kink_at_jumps(finer: u32) -> f32 {
    let gaits = GAITS.map(|gait| Walk { frames: gait.frames * finer as usize, ..gait });
    let database = database_at(RATE * f64::from(finer), Skeleton::Plain, &gaits);
    let runs = [0..100, 350..420, 20..26, 430..470, 110..118, 330..340, 40..100];
    let shown = play(&database, &runs.clone().map(|run| run.start * finer..run.end * finer), HALF_LIFE);
    let mut step = 0;
    let mut worst = 0.0_f32;
    for run in &runs[..runs.len() - 1] {
        step += run.len() * finer as usize;
        for near in [step - 1, step, step + 1] {
            worst = worst.max(shown.kink(near));
        }
    }
    worst
}

/// Where value and velocity are continuous, second differences vanish with the square of the step; were only the
/// value continuous, with the step itself.
#[test]
fn jumps_keep_the_velocity_of_every_joint() {
    let (coarse, fine) = (kink_at_jumps(1), kink_at_jumps(8));
    assert!(fine < coarse / 40.0, "{coarse} at 60 Hz, {fine} at 480 Hz");
}

#[test]
fn a_clips_end_is_left_without_a_break() {
    let database = two_gaits();
    let shown = play(&database, &[250..300, 0..50], HALF_LIFE);
    let held = raw(&database, 299, &shown.placements[50]);
    for (joint, expected) in shown.joints(50).iter().zip(&held) {
        assert!(joint.distance(*expected) < 3e-6, "the last pose is held for the one step");
    }
    let played = play(&database, &[250..299, 0..50], HALF_LIFE);
    assert!(played.kink(49) < 0.02, "as trials do it, from the last row but one: {}", played.kink(49));
}

/// Nor in which rows trials play, nor in how far the poses at their jumps are apart.
#[test]
fn a_joint_that_only_carries_the_body_changes_nothing() {
    let [plain, carried] =
        [Skeleton::Plain, Skeleton::Carried].map(|skeleton| database_at(RATE, skeleton, &GAITS));
    let bare = play(&plain, &[0..100, 350..420, 20..60], HALF_LIFE);
    let playback = Playback {
        database: &carried,
        rows: &bare.rows,
        placements: &bare.placements,
        half_life: HALF_LIFE,
        joints: Some(&[1, 2, 3, 4]),
    };
    let mut positions = vec![0.0; 3 * bare.positions.len()];
    shown_positions(&playback, &mut positions).unwrap();
    for (&shown, expected) in positions.as_chunks::<3>().0.iter().zip(&bare.positions) {
        assert!(Vec3::from(shown).distance(*expected) < 1e-5, "{shown:?} {expected}");
    }

    let profiles = [Profile {
        segments: vec![Segment { duration: 8.0, speed: 2.0, turn_rate: 0.5, drift: 0.0 }],
        record_from: 0.0,
    }];
    let settings = Default::default();
    let [bare, carried] = [&plain, &carried].map(|database| {
        let tracking = Tracking::Time;
        let trials = Trials { database, profiles: &profiles, tracking, settings: &settings, threads: 1 };
        run_trials(&trials, &Progress::default()).unwrap().remove(0)
    });
    let mut jumps = 0;
    for (bare, carried) in bare.steps.iter().zip(&carried.steps) {
        assert_eq!(bare.choice.row, carried.choice.row);
        if bare.choice.discontinuity.is_finite() {
            jumps += 1;
            assert!((bare.choice.discontinuity - carried.choice.discontinuity).abs() < 1e-5);
        }
    }
    assert!(jumps > 2);
}

#[test]
fn a_subset_of_the_joints_has_the_bits_of_the_whole() {
    let database = two_gaits();
    let shown = play(&database, &[0..100, 350..400], HALF_LIFE);
    let joints = [3, 0];
    let playback = Playback {
        database: &database,
        rows: &shown.rows,
        placements: &shown.placements,
        half_life: HALF_LIFE,
        joints: Some(&joints),
    };
    let mut positions = vec![0.0; shown.rows.len() * 2 * 3];
    shown_positions(&playback, &mut positions).unwrap();
    for (step, pair) in positions.as_chunks::<3>().0.as_chunks::<2>().0.iter().enumerate() {
        assert_eq!(pair.map(Vec3::from), [shown.joints(step)[3], shown.joints(step)[0]]);
    }
}

#[test]
fn the_poses_of_a_trial_walk_smoothly_beside_its_log() {
    let database = two_gaits();
    let segment = |duration, speed| Segment { duration, speed, turn_rate: 0.3, drift: 0.0 };
    let profiles = [Profile { segments: vec![segment(4.0, 1.5), segment(4.0, 2.5)], record_from: 0.0 }];
    let settings = Default::default();
    let tracking = Tracking::Time;
    let trials =
        Trials { database: &database, profiles: &profiles, tracking, settings: &settings, threads: 1 };
    let log = run_trials(&trials, &Progress::default()).unwrap().remove(0);
    let rows: Vec<u32> = log.steps.iter().map(|step| step.choice.row).collect();
    let placements: Vec<Placement> = log.steps.iter().map(|step| step.placement).collect();
    let jumps = log.steps.iter().filter(|step| step.choice.discontinuity.is_finite()).count();
    let shown = show(&database, rows, placements, HALF_LIFE);
    assert!(jumps > 2, "{jumps}");
    for step in 1..shown.rows.len() - 1 {
        assert!(shown.kink(step) < 0.03, "step {step}: {}", shown.kink(step));
        let hips = shown.joints(step)[0];
        let root = shown.placements[step].position;
        assert!((hips.x as f64 - root.x).hypot(hips.z as f64 - root.y) < 0.1);
    }
}

#[test]
fn what_cannot_be_shown_is_refused_by_name() {
    let database = two_gaits();
    let (rows, placements) = ([0, 600], [Placement::default(); 2]);
    let playback = Playback {
        database: &database,
        rows: &rows,
        placements: &placements,
        half_life: HALF_LIFE,
        joints: None,
    };
    let refused = |playback: Playback, room: usize| {
        shown_positions(&playback, &mut vec![0.0; room]).unwrap_err().to_string()
    };
    assert!(refused(playback, 24).contains("step 1 shows row 600, but the database has 600 rows"));
    let good = Playback { rows: &[0, 1], ..playback };
    assert_eq!(shown_positions(&good, &mut [0.0; 24]), Ok(()));
    assert!(matches!(shown_positions(&good, &mut [0.0; 23]), Err(PlaybackError::Job(_))));
    assert!(refused(Playback { half_life: 0.0, ..good }, 24).contains("half-life of 0 s"));
    assert!(refused(Playback { joints: Some(&[4]), ..good }, 6).contains('4'));
    assert!(refused(Playback { rows: &[0], ..good }, 24).contains("placements"));
    assert_eq!(RATE, database.rate());
}
