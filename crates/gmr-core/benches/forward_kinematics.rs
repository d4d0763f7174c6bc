//! Frames a second of forward kinematics, for each instruction set of this machine, on one core:
//! `cargo bench -p gmr-core --bench forward_kinematics [frames] [isa]`
//!
//! The skeleton is that of the CMU recordings as BVH: 38 nodes, 31 rotation slots, one root. Medians of 21 runs; in brackets the fastest.

use std::time::Instant;

use gmr_core::Isa;
use gmr_core::kinematics::{ForwardKinematics, Pose, World, forward_kinematics_on};
use gmr_core::lanes::Real;
use gmr_core::rotation::{EulerColumns, euler_to_quaternions};
use gmr_core::skeleton::Topology;

const PARENTS: [i32; 38] = [
    -1, 0, 1, 2, 3, 4, 5, 0, 7, 8, 9, 10, 11, 0, 13, 14, 15, 16, 17, 18, 15, 20, 21, 22, 23, 24, 25, 23, 27,
    15, 29, 30, 31, 32, 33, 34, 32, 36,
];
const SLOT_COUNT: usize = 31;
const COLUMN_COUNT: usize = 3 + 3 * SLOT_COUNT;

/// Rows as CMU's files hold them: the root's position, then Z, X, Y of each joint that turns.
struct Motion {
    topology: Topology,
    offsets: Vec<f64>,
    rows: Vec<f64>,
    columns: Vec<[i32; 3]>,
    axes: Vec<[u8; 3]>,
}

impl Motion {
    fn new(frame_count: usize) -> Self {
        let mut slot_of = [-1; 38];
        for parent in PARENTS.into_iter().filter(|&parent| parent >= 0) {
            slot_of[parent as usize] = 0;
        }
        let turning = slot_of.iter_mut().filter(|slot| **slot == 0);
        turning.enumerate().for_each(|(number, slot)| *slot = number as i32);
        let slots = PARENTS.map(|parent| if parent < 0 { -1 } else { slot_of[parent as usize] });
        let wave = |k: usize| (0.37 * k as f64).sin();
        Self {
            topology: Topology::new(&PARENTS, &slots, SLOT_COUNT).expect("the skeleton is a tree"),
            offsets: (0..3 * PARENTS.len()).map(|k| 3.0 * wave(k)).collect(),
            rows: (0..frame_count * COLUMN_COUNT).map(|k| 60.0 * wave(k)).collect(),
            columns: (0..SLOT_COUNT as i32).map(|slot| [3, 4, 5].map(|c| c + 3 * slot)).collect(),
            axes: vec![[2, 0, 1]; SLOT_COUNT],
        }
    }

    fn angles(&self) -> EulerColumns<'_> {
        EulerColumns { columns: &self.columns, axes: &self.axes }
    }

    /// Million frames a second on one instruction set, from quaternions and from rows, without and with rotations.
    fn speeds<T: Real>(&self, isa: Isa) -> [[f64; 2]; 4] {
        let frame_count = self.rows.len() / COLUMN_COUNT;
        let mut rotations = vec![T::ZERO; frame_count * SLOT_COUNT * 4];
        euler_to_quaternions(&self.rows, COLUMN_COUNT, self.angles(), &mut rotations).expect("shapes fit");
        let translations: Vec<T> = self
            .rows
            .chunks_exact(COLUMN_COUNT)
            .flat_map(|row| [row[0], row[1], row[2]].map(T::from_f64))
            .collect();
        let quaternions =
            Pose::Quaternions { rotations: &rotations, normalize: false, translations: &translations };
        let rows = Pose::Rows {
            rows: &self.rows,
            column_count: COLUMN_COUNT,
            angles: self.angles(),
            translation_columns: &[[0, 1, 2]],
            adds_offset: false,
        };
        let mut positions = vec![T::ZERO; frame_count * PARENTS.len() * 3];
        let mut turned = vec![T::ZERO; frame_count * SLOT_COUNT * 4];
        [(quaternions, false), (quaternions, true), (rows, false), (rows, true)].map(
            |(pose, has_rotations)| {
                let job = ForwardKinematics {
                    topology: &self.topology,
                    offsets: &self.offsets,
                    translated: &[0],
                    pose,
                    frame_count,
                    joints: None,
                    rotation_slots: None,
                    threads: 1,
                };
                let seconds = seconds(|| {
                    let rotations = has_rotations.then_some(&mut turned[..]);
                    let world = World { positions: Some(&mut positions), rotations };
                    forward_kinematics_on(isa, &job, world).expect("shapes fit");
                });
                seconds.map(|seconds| frame_count as f64 / seconds / 1e6)
            },
        )
    }
}

/// Median and fastest of 21 runs.
fn seconds(mut work: impl FnMut()) -> [f64; 2] {
    work();
    let mut seconds: Vec<f64> = (0..21)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    [seconds[seconds.len() / 2], seconds[0]]
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let is_asked = |isa: &Isa| {
        Isa::ALL.iter().all(|i| !asked.iter().any(|a| a == i.name())) || asked.iter().any(|a| a == isa.name())
    };
    let frame_count = asked.iter().find_map(|argument| argument.parse().ok()).unwrap_or(36_000);
    let motion = Motion::new(frame_count);
    println!("million frames a second, {frame_count} frames");
    println!("                from quaternions               from Euler rows");
    println!("                positions      + rotations     positions      + rotations");
    for isa in Isa::available().filter(is_asked) {
        for (width, speeds) in [("f32", motion.speeds::<f32>(isa)), ("f64", motion.speeds::<f64>(isa))] {
            let cells = speeds.map(|[median, best]| format!("{median:5.2} ({best:5.2})"));
            println!("{:<8} {width}    {}", isa.name(), cells.join("  "));
        }
    }
}
