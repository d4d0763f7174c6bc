//! Interpolation between rotations, the short way round.

use super::quaternion::{dot, normalize};
use crate::error::ShapeError;
use crate::lanes::Real;

/// The rotation a share `t` of the way from `a` to `b` (unit quaternions), the short way round.
#[must_use]
pub fn slerp<T: Real>(a: impl Into<[T; 4]>, b: impl Into<[T; 4]>, t: T) -> [T; 4] {
    let a = a.into().map(Real::to_f64);
    let b = b.into().map(Real::to_f64);
    slerp_f64(a, b, t.to_f64()).map(T::from_f64)
}

/// Rotations of `slot_count` slots at `times` (in frames, clamped to the motion's ends) between those of the frames
/// in `quaternions` (F, S, 4).
///
/// `out` is (G, S, 4), a row for each time. A time that is a whole number gives the frame itself. Of the two
/// quaternions of each rotation the one nearer to the row before is written, so that signs never jump.
///
/// # Errors
/// When an array's length does not fit, or there are times but no frames.
pub fn slerp_frames<T: Real>(
    quaternions: &[T],
    slot_count: usize,
    times: &[f64],
    out: &mut [T],
) -> Result<(), ShapeError> {
    let width = 4 * slot_count;
    ShapeError::check("out", times.len() * width, out.len())?;
    if out.is_empty() {
        return Ok(());
    }
    let frame_count = quaternions.len() / width;
    ShapeError::check("quaternions", frame_count.max(1) * width, quaternions.len())?;

    let frame = |index: usize| quaternions[index * width..][..width].as_chunks::<4>().0;
    for (row, &time) in times.iter().enumerate() {
        let time = time.clamp(0.0, (frame_count - 1) as f64);
        let before = time as usize;
        let after = (before + 1).min(frame_count - 1);
        let share = time - before as f64;
        let (done, rest) = out.split_at_mut(row * width);
        let previous = done.rchunks_exact(width).next().map(|p| p.as_chunks::<4>().0);
        let row_out = rest[..width].as_chunks_mut::<4>().0;
        for (slot, q) in row_out.iter_mut().enumerate() {
            let a = frame(before)[slot];
            *q = if share == 0.0 { a } else { slerp(a, frame(after)[slot], T::from_f64(share)) };
            if previous.is_some_and(|p| dot(p[slot], *q) < T::ZERO) {
                *q = q.map(|c| -c);
            }
        }
    }
    Ok(())
}

fn slerp_f64(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    let cosine = dot(a, b);
    let b = if cosine < 0.0 { b.map(|c| -c) } else { b };
    // The angle from the chord: exact where the cosine no longer tells angles apart.
    let difference: [f64; 4] = std::array::from_fn(|i| b[i] - a[i]);
    let sum: [f64; 4] = std::array::from_fn(|i| b[i] + a[i]);
    let angle = 2.0 * dot(difference, difference).sqrt().atan2(dot(sum, sum).sqrt());
    let (from, to) = if angle < 1e-9 {
        (1.0 - t, t)
    } else {
        (((1.0 - t) * angle).sin() / angle.sin(), (t * angle).sin() / angle.sin())
    };
    normalize(std::array::from_fn(|i| from * a[i] + to * b[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn about_y(degrees: f64) -> [f64; 4] {
        DQuat::from_rotation_y(degrees.to_radians()).to_array()
    }

    fn close(a: [f64; 4], b: [f64; 4]) -> bool {
        DQuat::from_array(a).abs_diff_eq(DQuat::from_array(b), 1e-14)
    }

    #[test]
    fn the_short_way_is_taken_whatever_the_signs() {
        assert!(close(slerp(about_y(10.0), about_y(50.0), 0.25), about_y(20.0)));
        assert!(close(slerp(about_y(10.0), about_y(50.0).map(|c| -c), 0.25), about_y(20.0)));
        assert!(close(slerp(about_y(10.0), about_y(350.0), 0.5), about_y(0.0)));
    }

    #[test]
    fn whole_times_give_the_frames_themselves_and_signs_never_jump() {
        let frames: Vec<f64> = (0..8)
            .flat_map(|k| about_y(100.0 * f64::from(k) % 360.0).map(|c| if k == 3 { -c } else { c }))
            .collect();
        let times: Vec<f64> = (0..71).map(|k| 0.1 * f64::from(k)).collect();
        let mut out = vec![0.0; 4 * times.len()];
        slerp_frames(&frames, 1, &times, &mut out).unwrap();
        let rows = out.as_chunks::<4>().0;
        assert!(rows.windows(2).all(|w| dot(w[0], w[1]) > 0.99));
        assert_eq!(rows[0], frames[..4]);
        assert!(rows[10] == frames[4..8] || rows[10].map(|c| -c) == frames[4..8]);
    }

    #[test]
    fn times_beyond_the_ends_hold_the_ends() {
        let frames = [about_y(0.0), about_y(90.0)].concat();
        let mut out = [0.0; 8];
        slerp_frames(&frames, 1, &[-3.0, 7.0], &mut out).unwrap();
        assert_eq!(out[..4], about_y(0.0));
        assert_eq!(out[4..], about_y(90.0));
    }

    #[test]
    fn no_frames_and_odd_lengths_are_refused() {
        assert!(slerp_frames::<f64>(&[], 1, &[0.0], &mut [0.0; 4]).is_err());
        assert!(slerp_frames(&[0.0; 7], 1, &[0.0], &mut [0.0; 4]).is_err());
        assert!(slerp_frames(&[0.0; 8], 1, &[0.0], &mut [0.0; 5]).is_err());
        assert!(slerp_frames(&[0.0; 8], 1, &[f64::NAN], &mut [0.0; 4]).is_ok());
    }
}
