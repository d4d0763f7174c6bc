//! The laws of the representation on random forests; the Python tests hold it against SciPy and real files.

use proptest::prelude::*;

use super::*;
use crate::Isa;
use crate::kinematics::{ForwardKinematics, Pose, World, forward_kinematics};
use crate::rotation::{EulerColumns, normalize};

/// A motion at home, and a walk through its configurations.
#[derive(Debug, Clone)]
struct Case {
    home: Topology,
    frame_count: usize,
    offsets: Vec<f64>,
    translated: Vec<i32>,
    rotations: Vec<f64>,
    translations: Vec<f64>,
    /// What to do next: an operation and a joint.
    moves: Vec<(u8, usize)>,
}

prop_compose! {
    fn any_case()(joint_count in 1_usize..16, frame_count in 0_usize..40)(
        ups in prop::collection::vec(prop::option::weighted(0.95, any::<prop::sample::Index>()), joint_count),
        slot_marks in prop::collection::vec(0_u8..10, joint_count),
        is_pre in any::<bool>(),
        offsets in prop::collection::vec(-2.0_f64..2.0, 3 * joint_count),
        is_translated in prop::collection::vec(prop::bool::weighted(0.3), joint_count),
        quaternions in prop::collection::vec(prop::array::uniform4(-1.0_f64..1.0), frame_count * joint_count),
        places in prop::collection::vec(-3.0_f64..3.0, frame_count * joint_count * 3),
        moves in prop::collection::vec((0_u8..3, 0..joint_count), 0..8),
        frame_count in Just(frame_count),
    ) -> Case {
        let parents: Vec<i32> = ups
            .iter()
            .enumerate()
            .map(|(j, up)| if j == 0 { -1 } else { up.map_or(-1, |up| up.index(j) as i32) })
            .collect();
        let slots: Vec<i32> = parents
            .iter()
            .enumerate()
            .map(|(j, &parent)| if slot_marks[j] == 0 { -1 } else if is_pre { j as i32 } else { parent })
            .collect();
        let home = Topology::new(&parents, &slots, parents.len()).unwrap();
        let translated: Vec<i32> =
            (0..parents.len()).filter(|&j| parents[j] == -1 || is_translated[j]).map(|j| j as i32).collect();
        let unit = |q: [f64; 4]| if q.iter().all(|c| c.abs() < 0.05) { [0.0, 0.0, 0.0, 1.0] } else { normalize(q) };
        Case {
            home,
            frame_count,
            offsets,
            rotations: quaternions.into_iter().flat_map(unit).collect(),
            translations: places[..frame_count * translated.len() * 3].to_vec(),
            translated,
            moves,
        }
    }
}

/// A motion in some configuration.
#[derive(Debug, Clone, PartialEq)]
struct Motion {
    forest: Forest,
    translated: Vec<i32>,
    rotations: Vec<f64>,
    translations: Vec<f64>,
}

impl Case {
    fn motion(&self) -> Motion {
        Motion {
            forest: Forest::new(&self.home),
            translated: self.translated.clone(),
            rotations: self.rotations.clone(),
            translations: self.translations.clone(),
        }
    }

    /// The bones' vectors at rest in a configuration.
    fn offsets(&self, forest: &Forest) -> Vec<f64> {
        let parents = forest.topology().parents();
        let at = |joint: usize| &self.offsets[3 * joint..][..3];
        let vector = |joint: usize| match (parents[joint], forest.bones()[joint] as usize) {
            (_, bone) if bone == joint => at(joint).to_vec(),
            (NONE, _) => vec![0.0; 3],
            (_, bone) => at(bone).iter().map(|x| -x).collect(),
        };
        (0..parents.len()).flat_map(vector).collect()
    }

    fn job<'a>(&self, motion: &'a Motion, to: &'a Forest, offsets: &'a [f64]) -> Configure<'a, f64> {
        Configure {
            from: &motion.forest,
            to,
            offsets,
            translated: &motion.translated,
            pose: Pose::Quaternions {
                rotations: &motion.rotations,
                normalize: false,
                translations: &motion.translations,
            },
            frame_count: self.frame_count,
            slots: None,
            joints: None,
            threads: 1,
        }
    }

    fn carried(&self, isa: Isa, threads: usize, motion: &Motion, to: &Forest) -> Motion {
        let offsets = self.offsets(&motion.forest);
        let job = Configure { threads, ..self.job(motion, to, &offsets) };
        let translated = job.translated_after();
        let mut rotations = vec![f64::NAN; self.frame_count * to.topology().slot_count() * 4];
        let mut translations = vec![f64::NAN; self.frame_count * translated.len() * 3];
        let out = Configured { rotations: &mut rotations, translations: &mut translations };
        configure_on(isa, &job, out).unwrap();
        Motion { forest: to.clone(), translated, rotations, translations }
    }

    /// World positions of all joints, and world rotations of all bones at home.
    fn world(&self, motion: &Motion) -> (Vec<f64>, Vec<f64>) {
        let topology = motion.forest.topology();
        let mut slots = vec![NONE; topology.joint_count()];
        for (joint, &bone) in motion.forest.bones().iter().enumerate() {
            slots[bone as usize] = topology.world_slots()[joint];
        }
        let job = ForwardKinematics {
            topology,
            offsets: &self.offsets(&motion.forest),
            translated: &motion.translated,
            pose: Pose::Quaternions {
                rotations: &motion.rotations,
                normalize: false,
                translations: &motion.translations,
            },
            frame_count: self.frame_count,
            joints: None,
            rotation_slots: Some(&slots),
            threads: 1,
        };
        let mut positions = vec![f64::NAN; self.frame_count * slots.len() * 3];
        let mut rotations = vec![f64::NAN; self.frame_count * slots.len() * 4];
        let world = World { positions: Some(&mut positions), rotations: Some(&mut rotations) };
        forward_kinematics(&job, world).unwrap();
        (positions, rotations)
    }
}

fn moved(forest: &Forest, (operation, joint): (u8, usize)) -> Option<Forest> {
    match operation {
        0 => forest.shift_root(joint),
        1 => forest.split(joint),
        _ => forest.join(joint),
    }
    .ok()
}

fn is_near(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-12 * 64.0)
}

/// Equal as rotations: q and -q are one.
fn is_same_rotation(a: &[f64], b: &[f64]) -> bool {
    let pairs = a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0);
    a.len() == b.len()
        && pairs.into_iter().all(|(p, q)| (crate::rotation::dot(*p, *q).abs() - 1.0).abs() <= 1e-12)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn operations_keep_every_position_and_every_bones_rotation(case in any_case()) {
        let mut motion = case.motion();
        let before = case.world(&motion);
        for step in case.moves.iter() {
            if let Some(forest) = moved(&motion.forest, *step) {
                motion = case.carried(Isa::current(), 1, &motion, &forest);
                let after = case.world(&motion);
                prop_assert!(is_near(&before.0, &after.0));
                prop_assert!(is_same_rotation(&before.1, &after.1));
            }
        }
    }

    #[test]
    fn lengths_of_rotations_do_not_drift_however_often_roots_move(case in any_case()) {
        let mut motion = case.motion();
        for step in case.moves.iter().cycle().take(10 * case.moves.len()) {
            if let Some(forest) = moved(&motion.forest, *step) {
                motion = case.carried(Isa::current(), 1, &motion, &forest);
            }
        }
        for q in motion.rotations.as_chunks::<4>().0 {
            prop_assert!((crate::rotation::dot(*q, *q) - 1.0).abs() <= 1e-14, "{q:?}");
        }
    }

    #[test]
    fn the_configuration_alone_determines_the_motion(case in any_case()) {
        let home = case.motion();
        let mut motion = home.clone();
        for step in case.moves.iter() {
            if let Some(forest) = moved(&motion.forest, *step) {
                motion = case.carried(Isa::current(), 1, &motion, &forest);
            }
        }
        let straight = case.carried(Isa::current(), 1, &home, &motion.forest);
        prop_assert!(is_near(&straight.rotations, &motion.rotations));
        let back = case.carried(Isa::current(), 1, &motion, &home.forest);
        prop_assert_eq!(&back.forest, &home.forest);
        // Bones that were cut come back as vectors that do not change.
        for (place, &joint) in back.translated.iter().enumerate() {
            let was = home.translated.iter().position(|&other| other == joint);
            for frame in 0..case.frame_count {
                let found = &back.translations[(frame * back.translated.len() + place) * 3..][..3];
                let wanted = match was {
                    Some(was) => &home.translations[(frame * home.translated.len() + was) * 3..][..3],
                    None => &case.offsets[3 * joint as usize..][..3],
                };
                prop_assert!(is_near(wanted, found));
            }
        }
    }

    #[test]
    fn every_instruction_set_and_thread_count_gives_the_bits_of_the_definition(case in any_case()) {
        let mut motion = case.motion();
        for step in case.moves.iter() {
            let Some(forest) = moved(&motion.forest, *step) else { continue };
            let defined = case.carried(Isa::Scalar, 1, &motion, &forest);
            for isa in Isa::available() {
                for threads in [1, 2] {
                    prop_assert_eq!(&case.carried(isa, threads, &motion, &forest), &defined);
                }
            }
            motion = defined;
        }
    }

    #[test]
    fn some_of_the_answer_is_that_part_of_all_of_it(case in any_case(), picks in any::<u64>()) {
        let home = case.motion();
        let forest = case.moves.iter().fold(home.forest.clone(), |forest, step| moved(&forest, *step).unwrap_or(forest));
        let all = case.carried(Isa::current(), 1, &home, &forest);
        let picked = |count: usize| (0..count as i32).filter(|k| picks >> (k % 64) & 1 == 1).collect::<Vec<_>>();
        let (slots, joints) = (picked(forest.topology().slot_count()), picked(case.home.joint_count()));
        let offsets = case.offsets(&home.forest);
        let job = Configure { slots: Some(&slots), joints: Some(&joints), ..case.job(&home, &forest, &offsets) };
        let translated = job.translated_after();
        let mut rotations = vec![f64::NAN; case.frame_count * slots.len() * 4];
        let mut translations = vec![f64::NAN; case.frame_count * translated.len() * 3];
        configure(&job, Configured { rotations: &mut rotations, translations: &mut translations }).unwrap();
        let columns = |wanted: &[i32], of: &[i32]| -> Vec<usize> {
            of.iter().enumerate().filter(|(_, item)| wanted.contains(item)).map(|(k, _)| k).collect()
        };
        let part = |numbers: &[f64], width: usize, size: usize, columns: &[usize]| -> Vec<f64> {
            let rows = (0..case.frame_count).map(|frame| &numbers[frame * width * size..]);
            rows.flat_map(|row| columns.iter().flat_map(|c| row[c * size..(c + 1) * size].to_vec())).collect()
        };
        let every: Vec<i32> = (0..forest.topology().slot_count() as i32).collect();
        prop_assert_eq!(rotations, part(&all.rotations, every.len(), 4, &columns(&slots, &every)));
        let moving = columns(&joints, &all.translated);
        prop_assert_eq!(translations, part(&all.translations, all.translated.len(), 3, &moving));
    }

    #[test]
    fn shifts_undo_themselves_and_joins_undo_splits(case in any_case(), joint in any::<prop::sample::Index>()) {
        let joint = joint.index(case.home.joint_count());
        let mut forest = Forest::new(&case.home);
        for step in case.moves.iter() {
            forest = moved(&forest, *step).unwrap_or(forest);
        }
        let root = forest.root_of(joint);
        prop_assert_eq!(&forest.shift_root(joint).unwrap().shift_root(root).unwrap(), &forest);
        let split = forest.split(joint);
        prop_assert_eq!(split.is_ok(), root != joint);
        // A bone that a shift had turned over comes back as it was at home.
        if let Ok(split) = split && forest.bones()[joint] as usize == joint {
            prop_assert_eq!(&split.join(joint).unwrap(), &forest);
        }
    }

    #[test]
    fn any_set_with_a_root_for_each_tree_is_reached_from_anywhere(case in any_case(), picks in any::<u16>()) {
        let mut forest = Forest::new(&case.home);
        for step in case.moves.iter() {
            forest = moved(&forest, *step).unwrap_or(forest);
        }
        let roots: Vec<usize> = (0..case.home.joint_count()).filter(|joint| picks >> joint & 1 == 1).collect();
        if let Ok(found) = forest.with_roots(&roots) {
            let is_root = |joint: &usize| found.topology().parents()[*joint] == NONE;
            prop_assert_eq!((0..case.home.joint_count()).filter(is_root).collect::<Vec<_>>(), roots.clone());
            prop_assert_eq!(&Forest::new(&case.home).with_roots(&roots).unwrap(), &found);
        }
    }
}

/// hips(0) - spine(1) - neck(2), left(3), right(4), in post-rotation form: the children of a joint share a slot.
fn body() -> Forest {
    Forest::new(&Topology::new(&[-1, 0, 1, 0, 0], &[-1, 0, 1, 0, 0], 2).unwrap())
}

#[test]
fn after_a_shift_the_old_roots_other_children_need_no_slot() {
    let shifted = body().shift_root(1).unwrap();
    assert_eq!(shifted.topology().parents(), [1, -1, 1, 0, 0]);
    assert_eq!(shifted.topology().slots(), [0, -1, 1, -1, -1]);
    assert_eq!(shifted.bones(), [1, 0, 2, 3, 4]);
}

#[test]
fn siblings_share_a_slot_again_when_they_are_joined() {
    let split = body().split(3).unwrap();
    assert_eq!(split.topology().slots(), [-1, 0, 1, 2, 0]);
    assert_eq!(split.links(), [-1, -1, -1, 0, -1]);
    assert_eq!(split.join(3).unwrap(), body());
}

#[test]
fn a_tree_that_was_turned_over_is_turned_back_before_it_is_joined() {
    let moved = body().split(1).unwrap().shift_root(2).unwrap();
    assert_eq!(moved.topology().parents(), [-1, 2, -1, 0, 0]);
    assert_eq!(moved.join(2).unwrap(), body());
}

#[test]
fn what_cannot_be_done_is_refused_in_words() {
    let body = body();
    let name = |joint: usize| ["hips", "spine", "neck", "left", "right"][joint].to_string();
    let says = |result: Result<Forest, ForestError>| result.unwrap_err().describe(name);
    assert!(says(body.join(0)).contains("hips is the last root"));
    assert!(says(body.join(2)).contains("the root of its tree is hips"));
    assert!(says(body.split(0)).contains("hips is a root already"));
    assert!(says(body.split(1).unwrap().join(0)).contains("hips has no soft link"));
    assert!(says(body.with_roots(&[])).contains("the tree of hips would have no root"));
    assert!(says(body.with_roots(&[2, 2])).contains("neck is named twice"));
    assert!(says(body.with_parents(&[-1, 0, 0, 0, 0])).contains("neck cannot hang on hips"));
    assert!(says(body.shift_root(9)).contains("no joint 9"));
}

#[test]
fn frames_come_straight_from_rows_of_a_file() {
    let forest = body();
    let rows: Vec<f64> = (0..9 * 40).map(|k| f64::from(k * 37 % 101) - 50.0).collect();
    let angles = EulerColumns { columns: &[[3, 4, 5], [6, 7, 8]], axes: &[[2, 0, 1], [0, 1, 2]] };
    let offsets = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.0, -0.5, 0.0, 0.0];
    let to = forest.with_roots(&[2, 3]).unwrap();
    let mut quaternions = vec![0.0; 40 * 2 * 4];
    crate::rotation::euler_to_quaternions(&rows, 9, angles, &mut quaternions).unwrap();
    let places: Vec<f64> = rows.chunks(9).flat_map(|row| row[..3].to_vec()).collect();
    let pose = |is_rows: bool| {
        if is_rows {
            Pose::Rows {
                rows: &rows,
                column_count: 9,
                angles,
                translation_columns: &[[0, 1, 2]],
                adds_offset: false,
            }
        } else {
            Pose::Quaternions { rotations: &quaternions, normalize: false, translations: &places }
        }
    };
    let answer = |is_rows: bool| {
        let job = Configure {
            from: &forest,
            to: &to,
            offsets: &offsets,
            translated: &[0],
            pose: pose(is_rows),
            frame_count: 40,
            slots: None,
            joints: None,
            threads: 1,
        };
        let mut rotations = vec![0.0; 40 * to.topology().slot_count() * 4];
        let mut translations = vec![0.0; 40 * job.translated_after().len() * 3];
        configure(&job, Configured { rotations: &mut rotations, translations: &mut translations }).unwrap();
        (rotations, translations)
    };
    assert_eq!(answer(true), answer(false));
}

#[test]
fn forests_of_different_skeletons_are_not_confused() {
    let other = Forest::new(&Topology::new(&[-1, 0, 1, 0, 0], &[-1, 0, 1, 0, 3], 4).unwrap());
    let job = Configure {
        from: &body(),
        to: &other,
        offsets: &[0.0; 15],
        translated: &[0],
        pose: Pose::Quaternions { rotations: &[], normalize: false, translations: &[] },
        frame_count: 0,
        slots: None,
        joints: None,
        threads: 1,
    };
    let out = Configured::<f64> { rotations: &mut [], translations: &mut [] };
    assert_eq!(configure(&job, out), Err(crate::JobError::OtherForest));
}
