//! Where is the hand while the arm swings? Forward kinematics without Python:
//! `cargo run --release -p gmr-core --example forward_kinematics`

use glam::{DQuat, DVec3};
use gmr_core::kinematics::{ForwardKinematics, Pose, World, forward_kinematics};
use gmr_core::skeleton::Topology;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // shoulder (root) - elbow - hand. As in BVH, a joint's rotation turns what hangs below it: the bone that ends in
    // the elbow is turned by the shoulder's slot 0, the one that ends in the hand by the elbow's slot 1.
    let topology = Topology::new(&[-1, 0, 1], &[-1, 0, 1], 2)?;
    let offsets = [0.0, 1.4, 0.0, 0.0, -0.3, 0.0, 0.0, -0.25, 0.0];

    let frame_count = 5;
    let rotations: Vec<f64> = (0..frame_count)
        .flat_map(|frame| {
            let swing = -30.0 + 15.0 * frame as f64;
            [DQuat::from_rotation_x(swing.to_radians()), DQuat::from_rotation_x(-20_f64.to_radians())]
        })
        .flat_map(|q| q.to_array())
        .collect();

    let mut hand = vec![0.0; 3 * frame_count];
    let job = ForwardKinematics {
        topology: &topology,
        offsets: &offsets,
        translated: &[],
        pose: Pose::Quaternions { rotations: &rotations, normalize: false, translations: &[] },
        frame_count,
        joints: Some(&[2]),
        rotation_slots: None,
        threads: 1,
    };
    forward_kinematics(&job, World { positions: Some(&mut hand), rotations: None })?;

    for (frame, place) in hand.as_chunks::<3>().0.iter().enumerate() {
        println!("frame {frame}: the hand is at {:.3} m", DVec3::from(*place));
    }
    Ok(())
}
