//! Every instruction set, blocking and thread count gives the bits of the scalar definition; the definition is held
//! against SciPy in the Python tests.

use proptest::prelude::*;

use super::*;
use crate::rotation::Axes;

/// A forest and poses for it, rows of Euler angles and quaternions alike.
#[derive(Debug, Clone)]
struct Case {
    topology: Topology,
    offsets: Vec<f64>,
    translated: Vec<i32>,
    frame_count: usize,
    column_count: usize,
    rows: Vec<f64>,
    columns: Vec<[i32; 3]>,
    axes: Vec<Axes>,
    translation_columns: Vec<[i32; 3]>,
    adds_offset: bool,
    joints: Option<Vec<i32>>,
    rotation_slots: Option<Vec<i32>>,
}

/// Mostly ordinary degrees, now and then what breaks things.
fn number() -> impl Strategy<Value = f64> {
    let odd =
        prop::sample::select(vec![f64::NAN, f64::INFINITY, 1e300, -1e17, 5e-324, -0.0, 1e-40, 180.0, 540.0]);
    prop_oneof![50 => -720.0_f64..720.0, 1 => odd]
}

prop_compose! {
    fn any_case()(joint_count in 1_usize..24, frame_count in 0_usize..70, column_count in 1_usize..40)(
        ups in prop::collection::vec(any::<prop::sample::Index>(), joint_count),
        root_marks in prop::collection::vec(0_u8..20, joint_count),
        // Few roots, or long runs of them with joints below some.
        roots_of_twenty in prop::sample::select(vec![1_u8, 10, 17]),
        is_all_translated in any::<bool>(),
        slot_marks in prop::collection::vec(0_u8..20, joint_count),
        is_pre in any::<bool>(),
        offsets in prop::collection::vec(-2.0_f64..2.0, 3 * joint_count),
        is_translated in prop::collection::vec(prop::bool::weighted(0.4), joint_count),
        rows in prop::collection::vec(number(), frame_count * column_count),
        columns in prop::collection::vec([-1..column_count as i32, -1..column_count as i32, -1..column_count as i32], joint_count),
        axes in prop::collection::vec([0_u8..3, 0_u8..3, 0_u8..3], joint_count),
        places in prop::collection::vec([-1..column_count as i32, -1..column_count as i32, -1..column_count as i32], joint_count),
        adds_offset in any::<bool>(),
        joints in prop::option::of(prop::collection::vec(0..joint_count as i32, 0..5)),
        wanted in prop::collection::vec(any::<prop::sample::Index>(), 0..5),
        frame_count in Just(frame_count),
        column_count in Just(column_count),
    ) -> Case {
        let parents: Vec<i32> =
            (0..ups.len()).map(|j| if j == 0 || root_marks[j] < roots_of_twenty { -1 } else { ups[j].index(j) as i32 }).collect();
        let joint_count = parents.len();
        let slots: Vec<i32> = (0..joint_count)
            .map(|j| if slot_marks[j] == 0 { -1 } else if is_pre { j as i32 } else { parents[j] })
            .collect();
        let topology = Topology::new(&parents, &slots, joint_count).unwrap();
        let turning = topology.slot_order();
        let slots = wanted.iter().map(|i| {
            let k = i.index(turning.len() + 1);
            turning.get(k).map_or(-1, |&slot| slot as i32)
        });
        let translated: Vec<i32> = (0..joint_count as i32).filter(|&j| is_all_translated || is_translated[j as usize]).collect();
        Case {
            rotation_slots: Some(slots.collect()),
            translation_columns: places[..translated.len()].to_vec(),
            topology, offsets, translated, frame_count, column_count, rows, columns, axes, adds_offset, joints,
        }
    }
}

impl Case {
    fn angles(&self) -> EulerColumns<'_> {
        EulerColumns { columns: &self.columns, axes: &self.axes }
    }

    /// The bits of positions and rotations.
    fn solve<T: Real>(&self, isa: Isa, pose: Pose<'_, T>, threads: usize) -> [Vec<u64>; 2] {
        let job = ForwardKinematics {
            topology: &self.topology,
            offsets: &self.offsets,
            translated: &self.translated,
            pose,
            frame_count: self.frame_count,
            joints: self.joints.as_deref(),
            rotation_slots: self.rotation_slots.as_deref(),
            threads,
        };
        let joint_count = self.joints.as_ref().map_or(self.topology.joint_count(), Vec::len);
        let slot_count = self.rotation_slots.as_ref().map_or(self.topology.slot_count(), Vec::len);
        let mut positions = vec![T::ONE; self.frame_count * joint_count * 3];
        let mut rotations = vec![T::ONE; self.frame_count * slot_count * 4];
        let world = World { positions: Some(&mut positions), rotations: Some(&mut rotations) };
        forward_kinematics_on(isa, &job, world).unwrap();
        [positions, rotations].map(bits)
    }

    fn rows_pose<T: Real>(&self) -> Pose<'_, T> {
        Pose::Rows {
            rows: &self.rows,
            column_count: self.column_count,
            angles: self.angles(),
            translation_columns: &self.translation_columns,
            adds_offset: self.adds_offset,
        }
    }

    /// Quaternions and translations that say the same as the rows.
    fn converted<T: Real>(&self) -> (Vec<T>, Vec<T>) {
        let mut rotations = vec![T::ZERO; self.frame_count * self.topology.slot_count() * 4];
        crate::rotation::euler_to_quaternions(&self.rows, self.column_count, self.angles(), &mut rotations)
            .unwrap();
        let place = |row: &[f64], k: usize, axis: usize| {
            let offset = T::from_f64(self.offsets[3 * self.translated[k] as usize + axis]);
            let channel = usize::try_from(self.translation_columns[k][axis]).map(|c| T::from_f64(row[c]));
            channel.map_or(offset, |channel| if self.adds_offset { offset + channel } else { channel })
        };
        let translations = self.rows.chunks_exact(self.column_count).flat_map(|row| {
            (0..self.translated.len()).flat_map(move |k| (0..3).map(move |axis| (row, k, axis)))
        });
        (rotations, translations.map(|(row, k, axis)| place(row, k, axis)).collect())
    }

    fn agrees<T: Real>(&self) -> Result<(), TestCaseError> {
        let expected = self.solve::<T>(Isa::Scalar, self.rows_pose(), 1);
        let (rotations, translations) = self.converted::<T>();
        for isa in Isa::available() {
            for threads in [1, 2] {
                prop_assert_eq!(&self.solve::<T>(isa, self.rows_pose(), threads), &expected, "rows, {}", isa);
                let pose = Pose::Quaternions {
                    rotations: &rotations,
                    normalize: false,
                    translations: &translations,
                };
                prop_assert_eq!(&self.solve(isa, pose, threads), &expected, "quaternions, {}", isa);
            }
        }
        let normalized = |isa| {
            let pose =
                Pose::Quaternions { rotations: &rotations, normalize: true, translations: &translations };
            self.solve(isa, pose, 1)
        };
        let expected = normalized(Isa::Scalar);
        for isa in Isa::available() {
            prop_assert_eq!(&normalized(isa), &expected, "normalised, {}", isa);
        }
        Ok(())
    }
}

/// Bits in which all NaN are one: their payload is the processor's affair.
fn bits<T: Real>(numbers: Vec<T>) -> Vec<u64> {
    numbers.into_iter().map(|x| if x.to_f64().is_nan() { u64::MAX } else { x.to_f64().to_bits() }).collect()
}

proptest! {
    #[test]
    fn every_instruction_set_gives_the_bits_of_the_definition_in_f32(case in any_case()) {
        case.agrees::<f32>()?;
    }

    #[test]
    fn every_instruction_set_gives_the_bits_of_the_definition_in_f64(case in any_case()) {
        case.agrees::<f64>()?;
    }

    #[test]
    fn a_frame_does_not_depend_on_its_neighbours(case in any_case(), frame in any::<prop::sample::Index>()) {
        prop_assume!(case.frame_count > 0);
        let frame = frame.index(case.frame_count);
        let row = case.rows[frame * case.column_count..][..case.column_count].to_vec();
        let alone = Case { frame_count: 1, rows: row, ..case.clone() };
        let all = case.solve::<f32>(Isa::best(), case.rows_pose(), 1);
        for (all, one) in all.iter().zip(alone.solve::<f32>(Isa::best(), alone.rows_pose(), 1)) {
            prop_assert_eq!(&all[frame * one.len()..][..one.len()], &one[..]);
        }
    }
}

#[test]
fn many_pieces_and_large_answers_give_the_same_bits() {
    let frame_count = 18_001;
    let rows: Vec<f64> = (0..frame_count as i32 * 6).map(|k| f64::from(k % 719) - 300.0).collect();
    let case = Case {
        topology: Topology::new(&[-1, 0], &[-1, 0], 1).unwrap(),
        offsets: vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        translated: vec![0],
        frame_count,
        column_count: 6,
        rows,
        columns: vec![[3, 4, 5]],
        axes: vec![[2, 0, 1]],
        translation_columns: vec![[0, 1, 2]],
        adds_offset: false,
        joints: Some([0, 1].repeat(10)),
        rotation_slots: None,
    };
    let alone = case.solve::<f32>(Isa::Scalar, case.rows_pose(), 1);
    assert!(cache::is_large(&vec![0.0_f32; frame_count * 60]));
    for threads in [0, 1, 2, 7] {
        assert!(case.solve::<f32>(Isa::best(), case.rows_pose(), threads) == alone);
    }
}

#[test]
fn a_quarter_turn_of_the_hip_lifts_the_toe_forward() {
    // hip - knee - toe hang down; the hip turns -90 degrees about +X (left), so the leg points to +Z (forward).
    let topology = Topology::new(&[-1, 0, 1], &[-1, 0, 1], 2).unwrap();
    let turn = std::f64::consts::FRAC_1_SQRT_2;
    let job = ForwardKinematics {
        topology: &topology,
        offsets: &[0.0, 0.0, 0.0, 0.0, -0.4, 0.0, 0.0, -0.5, 0.0],
        translated: &[0],
        pose: Pose::Quaternions {
            rotations: &[-turn, 0.0, 0.0, turn, 0.0, 0.0, 0.0, 1.0],
            normalize: false,
            translations: &[1.0, 0.9, 2.0],
        },
        frame_count: 1,
        joints: Some(&[2]),
        rotation_slots: None,
        threads: 1,
    };
    let mut toe = [0.0; 3];
    forward_kinematics(&job, World { positions: Some(&mut toe), rotations: None }).unwrap();
    assert!(toe.iter().zip([1.0, 0.9, 2.9]).all(|(a, b)| (a - b).abs() < 1e-15), "{toe:?}");
}

#[test]
fn positions_of_translated_roots_are_their_translations() {
    let topology = Topology::new(&[-1, -1, 0, -1], &[-1, -1, -1, -1], 0).unwrap();
    let translations: Vec<f32> = (0..3 * 3 * 2000).map(|k| k as f32).collect();
    let job = ForwardKinematics {
        topology: &topology,
        offsets: &[7.0; 12],
        translated: &[3, 0, 1],
        pose: Pose::Quaternions { rotations: &[], normalize: false, translations: &translations },
        frame_count: 2000,
        joints: None,
        rotation_slots: None,
        threads: 2,
    };
    for (joints, places) in
        [(vec![3, 0, 1], vec![0, 1, 2]), (vec![0, 0, 3], vec![1, 1, 0]), (vec![1], vec![2])]
    {
        let job = ForwardKinematics { joints: Some(&joints), ..job };
        let mut found = vec![0.0; 2000 * joints.len() * 3];
        forward_kinematics(&job, World { positions: Some(&mut found), rotations: None }).unwrap();
        let frames = translations.as_chunks::<9>().0;
        let expected: Vec<f32> = frames
            .iter()
            .flat_map(|frame| places.iter().flat_map(|&place| frame[3 * place..3 * place + 3].to_vec()))
            .collect();
        assert!(found == expected, "{joints:?}");
    }
}

#[test]
fn a_million_joints_in_one_chain_are_solved() {
    let count = 1_000_000;
    let parents: Vec<i32> = (-1..count - 1).collect();
    let topology = Topology::new(&parents, &parents, count as usize).unwrap();
    let offsets = [0.0, 1.0, 0.0].repeat(count as usize);
    let rotations = [0.0_f32, 0.0, 0.0, 1.0].repeat(count as usize);
    let pose = Pose::Quaternions { rotations: &rotations, normalize: false, translations: &[] };
    let job = ForwardKinematics {
        topology: &topology,
        offsets: &offsets,
        translated: &[],
        pose,
        frame_count: 1,
        joints: Some(&[count - 1]),
        rotation_slots: None,
        threads: 1,
    };
    let mut tip = [0.0; 3];
    forward_kinematics(&job, World { positions: Some(&mut tip), rotations: None }).unwrap();
    assert_eq!(tip, [0.0, 1e6, 0.0]);
}

#[test]
fn what_does_not_fit_is_refused_in_words() {
    let topology = Topology::new(&[-1, 0], &[-1, 0], 2).unwrap();
    let rotations = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let good = ForwardKinematics {
        topology: &topology,
        offsets: &[0.0; 6],
        translated: &[0],
        pose: Pose::Quaternions { rotations: &rotations, normalize: false, translations: &[0.0; 3] },
        frame_count: 1,
        joints: None,
        rotation_slots: None,
        threads: 1,
    };
    let refusal = |job: ForwardKinematics<'_, f32>, room: usize, turns: usize| {
        let (mut positions, mut rotations) = (vec![0.0; room], vec![0.0; turns]);
        let rotations = (turns > 0).then_some(&mut rotations[..]);
        let world = World { positions: Some(&mut positions), rotations };
        forward_kinematics(&job, world).map_err(|error| error.to_string()).unwrap_err()
    };
    let zeros = [0.0_f32; 3];
    let pose = |rotations| Pose::Quaternions { rotations, normalize: false, translations: &zeros };
    assert_eq!(refusal(good, 5, 0), "positions holds 5 elements where 6 are needed");
    assert_eq!(
        refusal(ForwardKinematics { pose: pose(&rotations[..7]), ..good }, 6, 0),
        "rotations holds 7 elements where 8 are needed"
    );
    assert_eq!(
        refusal(ForwardKinematics { offsets: &[0.0; 3], ..good }, 6, 0),
        "offsets holds 3 elements where 6 are needed"
    );
    assert_eq!(
        refusal(ForwardKinematics { joints: Some(&[2]), ..good }, 3, 0),
        "joints holds 2 at place 0, but there are 2 to choose from"
    );
    assert_eq!(
        refusal(ForwardKinematics { translated: &[-1], ..good }, 6, 0),
        "translated holds -1 at place 0, but there are 2 to choose from"
    );
    assert_eq!(
        refusal(good, 6, 8),
        "slot 1 turns no bone, so it has no world rotation; ask for slots that turn one"
    );
}
