//! What hangs on what is a matter of choice: an arm, seen from the hand.
//! `cargo run --release -p gmr-core --example forest`

use glam::{DQuat, DVec3};
use gmr_core::forest::{Configure, Configured, Forest, configure};
use gmr_core::kinematics::Pose;
use gmr_core::skeleton::Topology;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // shoulder (root) - elbow - hand, as in BVH: a joint's rotation turns what hangs below it.
    let home = Forest::new(&Topology::new(&[-1, 0, 1], &[-1, 0, 1], 2)?);
    let offsets = [0.0, 0.0, 0.0, 0.0, -0.3, 0.0, 0.0, -0.25, 0.0];
    let frame_count = 5;
    let swing = |frame: usize| DQuat::from_rotation_x((-30.0 + 15.0 * frame as f64).to_radians());
    let bend = DQuat::from_rotation_x(-20_f64.to_radians());
    let rotations: Vec<f64> =
        (0..frame_count).flat_map(|frame| [swing(frame), bend]).flat_map(|q| q.to_array()).collect();
    let shoulder: Vec<f64> = [0.0, 1.4, 0.0].repeat(frame_count);

    // The hand becomes the root: what is stored of it is its place in the world, frame by frame.
    let from_hand = home.shift_root(2)?;
    let job = Configure {
        from: &home,
        to: &from_hand,
        offsets: &offsets,
        translated: &[0],
        pose: Pose::Quaternions { rotations: &rotations, normalize: false, translations: &shoulder },
        frame_count,
        slots: None,
        joints: None,
        threads: 1,
    };
    assert_eq!(job.translated_after(), [2]);
    let mut turns = vec![0.0; frame_count * from_hand.topology().slot_count() * 4];
    let mut hand = vec![0.0; frame_count * 3];
    configure(&job, Configured { rotations: &mut turns, translations: &mut hand })?;

    for (frame, place) in hand.as_chunks::<3>().0.iter().enumerate() {
        println!("frame {frame}: the hand is at {:.3} m", DVec3::from(*place));
    }
    Ok(())
}
