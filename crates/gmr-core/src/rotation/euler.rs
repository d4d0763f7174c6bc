//! The twelve Euler orders: rows of degrees to quaternions, and back.
//!
//! Angles compose in the written order: axes (2, 0, 1) mean `R = Rz Rx Ry`.
//! The way back is the one formula of Bernardes and Viollet, "Quaternion to Euler angles conversion: A direct, general
//! and computationally efficient method" (2022): an order of three different axes is one whose first and last are
//! equal, seen through a quarter turn about the middle axis.

use super::euler_block::{EulerBlock, compose};
use super::euler_columns::{Axes, EulerColumns};
use super::half_angle::half_angle_of;
use super::quaternion::{multiply_axis, normalize, rotate};
use crate::Isa;
use crate::error::{JobError, ShapeError};
use crate::lanes::rows::{SourceRows, TargetRows, blocks};
use crate::lanes::{Kernel, Lanes, Real, cache};

impl EulerColumns<'_> {
    /// The rotation of one slot in one row of degrees.
    pub(crate) fn quaternion<T: Real>(&self, slot: usize, row: &[f64]) -> [T; 4] {
        compose(self.turns(slot).map(|(column, axis)| (half_angle_of::<T>(row[column]), axis)))
    }
}

/// The rotations of all slots: `rows` (F, C) in degrees to `out` (F, S, 4).
///
/// # Errors
/// When a length does not fit or a column or axis does not exist.
pub fn euler_to_quaternions<T: Real>(
    rows: &[f64],
    column_count: usize,
    angles: EulerColumns<'_>,
    out: &mut [T],
) -> Result<(), JobError> {
    convert(rows, column_count, angles, vec![None; angles.columns.len()], out)
}

/// [`euler_to_quaternions`] about axes of each slot's own: with `C` its frame in `frames` (S, 4) and `A` the rotation
/// that its angles compose, the slot's rotation is `C A C^-1`.
///
/// That is `A` with its axis turned by `C`, so it costs one rotation of a vector.
///
/// # Errors
/// As [`euler_to_quaternions`].
pub fn turned_euler_to_quaternions<T: Real>(
    rows: &[f64],
    column_count: usize,
    angles: EulerColumns<'_>,
    frames: &[[f64; 4]],
    out: &mut [T],
) -> Result<(), JobError> {
    ShapeError::check("frames", 4 * angles.columns.len(), 4 * frames.len())?;
    let turned = |frame: &[f64; 4]| frame[..3].iter().any(|&component| component != 0.0);
    let turns = frames.iter().map(|frame| turned(frame).then(|| columns_of(*frame))).collect();
    convert(rows, column_count, angles, turns, out)
}

/// The x, y and z axis as the rotation `q` turns them.
fn columns_of<T: Real>(q: [f64; 4]) -> [[T; 3]; 3] {
    let axis = |axis: usize| rotate(q, std::array::from_fn(|k| f64::from(u8::from(k == axis))));
    std::array::from_fn(|k| axis(k).map(T::from_f64))
}

fn convert<T: Real>(
    rows: &[f64],
    column_count: usize,
    angles: EulerColumns<'_>,
    turns: Vec<Option<[[T; 3]; 3]>>,
    out: &mut [T],
) -> Result<(), JobError> {
    angles.check(column_count)?;
    let slot_count = angles.columns.len();
    let frame_count = rows.len().checked_div(column_count).unwrap_or(0);
    ShapeError::check("rows", frame_count * column_count, rows.len())?;
    if column_count > 0 {
        ShapeError::check("out", frame_count * slot_count * 4, out.len())?;
    }
    T::dispatch(Isa::current(), Conversion { rows, column_count, angles, turns, out });
    Ok(())
}

/// Rows of degrees to quaternions, as many frames at once as a register holds.
struct Conversion<'a, T> {
    rows: &'a [f64],
    column_count: usize,
    angles: EulerColumns<'a>,
    /// For each slot that turns about axes of its own, those axes.
    turns: Vec<Option<[[T; 3]; 3]>>,
    out: &'a mut [T],
}

impl<T: Real> Kernel<T> for Conversion<'_, T> {
    #[inline(always)]
    fn run<L: Lanes<Real = T>>(self) {
        let slot_count = self.angles.columns.len();
        let mut block = EulerBlock::<L>::new(self.angles, 0..slot_count, &[], self.column_count);
        let mut rows = SourceRows::new(self.rows, self.column_count);
        let is_large = cache::is_large(self.out);
        let mut out = TargetRows::new(self.out, 4 * slot_count, is_large);
        let line = cache::LINE / size_of::<f64>();
        let share = (L::WIDTH * self.column_count).div_ceil(slot_count.max(1)).next_multiple_of(line);
        for frames in blocks::<L>(out.row_count()) {
            block.load(&mut rows, frames.clone());
            let next = (frames.start + L::WIDTH) * self.column_count;
            let (target, stride) = out.block::<L>(&frames);
            for (slot, axes) in self.turns.iter().enumerate() {
                cache::prefetch(self.rows, next + slot * share, share);
                let q = block.quaternion(slot);
                let q = axes.as_ref().map_or(q, |axes| about(axes, q));
                L::store_columns(q, &mut target[4 * slot..], stride);
            }
            out.finish::<L>(&frames);
        }
    }
}

/// The rotation `q` about its axis as seen by `axes`.
#[inline(always)]
fn about<L: Lanes>(axes: &[[L::Real; 3]; 3], [x, y, z, w]: [L; 4]) -> [L; 4] {
    let n = L::splat;
    let along = |k: usize| n(axes[0][k]) * x + n(axes[1][k]) * y + n(axes[2][k]) * z;
    [along(0), along(1), along(2), w]
}

/// Angles in degrees (F, S, 3) about the axes (S, 3) of each slot, from `quaternions` (F, S, 4), which need no unit
/// length.
///
/// Of all the angles that name a rotation, each frame takes those nearest to the frame before, so that curves are
/// continuous; the first frame's middle angle is between -90 and 90 (0 and 180 where first and last axis are
/// equal). Where first and last angle turn about the same line, the last keeps its value.
///
/// # Errors
/// When a length does not fit, or two neighbouring axes are the same.
pub fn quaternions_to_euler<T: Real>(
    quaternions: &[T],
    axes: &[Axes],
    degrees: &mut [f64],
) -> Result<(), JobError> {
    if let Some(slot) = axes.iter().position(|&a| a[0] == a[1] || a[1] == a[2] || a.iter().any(|&a| a > 2)) {
        return Err(JobError::Axes { slot, axes: axes[slot] });
    }
    let slot_count = axes.len();
    let frame_count = degrees.len() / (3 * slot_count).max(1);
    ShapeError::check("degrees", frame_count * slot_count * 3, degrees.len())?;
    ShapeError::check("quaternions", frame_count * slot_count * 4, quaternions.len())?;

    let poses = quaternions.as_chunks::<4>().0;
    let angles = degrees.as_chunks_mut::<3>().0;
    for (index, q) in poses.iter().enumerate() {
        let before = index.checked_sub(slot_count).map(|i| angles[i]);
        angles[index] = decompose(q.map(Real::to_f64), axes[index % slot_count], before);
    }
    Ok(())
}

/// Below this sine of half the middle angle the outer angles cannot be told apart: taking them for one line turns
/// the rotation by less than this, which is next to rounding. Just above it rounding moves the outer angles against
/// each other, by 0.1 degrees at most, and the rotation not at all.
const LOCK: f64 = 1e-13;

fn decompose(q: [f64; 4], axes: Axes, before: Option<[f64; 3]>) -> [f64; 3] {
    let [i, j, k] = axes.map(usize::from);
    let is_proper = i == k;
    let third = 3 - i - j;
    // +1 where i, j, third are in the order of x, y, z.
    let parity = if (j + 3 - i) % 3 == 1 { 1.0 } else { -1.0 };

    let q = normalize(q);
    let quarter = std::f64::consts::FRAC_1_SQRT_2;
    let q = if is_proper { q } else { multiply_axis(q, axes[1], quarter, quarter) };
    let length = |a: f64, b: f64| (a * a + b * b).sqrt();
    let (along, across) = (length(q[3], q[i]), length(q[j], q[third]));
    let sum = 2.0 * q[i].atan2(q[3]);
    let difference = 2.0 * (parity * q[third]).atan2(q[j]);

    let mirror = if is_proper { 1.0 } else { -parity };
    let middle = 2.0 * across.atan2(along).to_degrees() - if is_proper { 0.0 } else { 90.0 };
    let kept = before.map_or(0.0, |angles| mirror * angles[2]);
    let (first, last) = if across < LOCK {
        (sum.to_degrees() - kept, kept)
    } else if along < LOCK {
        (difference.to_degrees() + kept, kept)
    } else {
        ((0.5 * (sum + difference)).to_degrees(), (0.5 * (sum - difference)).to_degrees())
    };
    nearest([first, middle, mirror * last], is_proper, before)
}

/// Of the two families of angles that name the same rotation, and their whole turns, the one nearest to `before`.
fn nearest(angles: [f64; 3], is_proper: bool, before: Option<[f64; 3]>) -> [f64; 3] {
    let Some(before) = before.filter(|b| b.iter().all(|a| a.is_finite())) else {
        return [unwind(angles[0], 0.0), angles[1], unwind(angles[2], 0.0)];
    };
    let flipped_middle = if is_proper { -angles[1] } else { 180.0 - angles[1] };
    let flipped = [angles[0] + 180.0, flipped_middle, angles[2] + 180.0];
    let near = |angles: [f64; 3]| std::array::from_fn(|n| unwind(angles[n], before[n]));
    let distance =
        |angles: &[f64; 3]| angles.iter().zip(&before).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    let (direct, other): ([f64; 3], [f64; 3]) = (near(angles), near(flipped));
    if distance(&other) < distance(&direct) { other } else { direct }
}

/// `angle` moved by whole turns to within half a turn of `target`; of two as near, the greater.
fn unwind(angle: f64, target: f64) -> f64 {
    angle - 360.0 * ((angle - target) / 360.0 - 0.5).ceil()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::dot;
    use glam::{DQuat, DVec3};
    use proptest::prelude::*;

    pub(crate) const ORDERS: [Axes; 12] = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
        [0, 1, 0],
        [0, 2, 0],
        [1, 0, 1],
        [1, 2, 1],
        [2, 0, 2],
        [2, 1, 2],
    ];

    fn compose(degrees: [f64; 3], axes: Axes) -> DQuat {
        (0..3).fold(DQuat::IDENTITY, |q, n| {
            q * DQuat::from_axis_angle(DVec3::AXES[axes[n] as usize], degrees[n].to_radians())
        })
    }

    fn same_rotation(a: [f64; 4], b: DQuat) -> bool {
        dot(a, b.to_array()).abs() > 1.0 - 1e-14
    }

    fn any_degrees() -> impl Strategy<Value = [f64; 3]> {
        let special = prop::sample::select(vec![-180.0, -90.0, -45.0, 0.0, 1e-9, 90.0, 90.0 + 1e-8, 180.0]);
        prop::array::uniform3(prop_oneof![3 => -400.0..400.0, 1 => special])
    }

    proptest! {
        #[test]
        fn every_order_composes_as_written(degrees in any_degrees(), order in 0_usize..12) {
            let axes = ORDERS[order];
            let mut out = [0.0; 4];
            let angles = EulerColumns { columns: &[[2, 0, 1]], axes: &[axes] };
            euler_to_quaternions(&[degrees[1], degrees[2], degrees[0]], 3, angles, &mut out).unwrap();
            prop_assert!(same_rotation(out, compose(degrees, axes)));
        }

        #[test]
        fn angles_come_back_as_the_same_rotation(degrees in any_degrees(), order in 0_usize..12) {
            let axes = ORDERS[order];
            let q = compose(degrees, axes);
            let mut back = [0.0; 3];
            quaternions_to_euler(&q.to_array(), &[axes], &mut back).unwrap();
            prop_assert!(same_rotation(compose(back, axes).to_array(), q), "{back:?}");
            let middle = if axes[0] == axes[2] { 0.0..=180.0 } else { -90.0..=90.0 };
            prop_assert!(middle.contains(&back[1]), "{back:?}");
        }

        #[test]
        fn a_slow_motion_has_no_jumps(
            start in prop::array::uniform3(-400.0_f64..400.0),
            speed in prop::array::uniform3(-3.0_f64..3.0),
            order in 0_usize..12,
        ) {
            let axes = ORDERS[order];
            let frames: Vec<f64> = (0..300)
                .flat_map(|f| compose(std::array::from_fn(|n| start[n] + speed[n] * f64::from(f)), axes).to_array())
                .collect();
            let mut back = vec![0.0; 900];
            quaternions_to_euler(&frames, &[axes], &mut back).unwrap();
            let angles = back.as_chunks::<3>().0;
            for (q, &angles) in frames.as_chunks::<4>().0.iter().zip(angles) {
                prop_assert!(same_rotation(*q, compose(angles, axes)));
            }
            // A frame exactly in the lock keeps its last angle, and the next catches up.
            let steps = angles.windows(2).flat_map(|w| (0..3).map(move |n| (w[1][n] - w[0][n]).abs()));
            prop_assert!(steps.fold(0.0, f64::max) < 10.0);
        }
    }

    proptest! {
        #[test]
        fn a_slot_turns_about_axes_of_its_own(
            degrees in any_degrees(),
            frame in any_degrees(),
            order in 0_usize..12,
        ) {
            let axes = ORDERS[order];
            let c = compose(frame, axes);
            let angles = EulerColumns { columns: &[[0, 1, 2], [0, 1, 2]], axes: &[axes, axes] };
            let frames = [c.to_array(), DQuat::IDENTITY.to_array()];
            let (mut out, mut single) = ([0.0_f64; 8], [0.0_f32; 8]);
            turned_euler_to_quaternions(&degrees, 3, angles, &frames, &mut out).unwrap();
            turned_euler_to_quaternions(&degrees, 3, angles, &frames, &mut single).unwrap();
            let a = compose(degrees, axes);
            let [turned, plain] = [0, 4].map(|k| std::array::from_fn(|n| out[k + n]));
            prop_assert!(same_rotation(turned, c * a * c.inverse()));
            prop_assert!(same_rotation(plain, a));
            prop_assert!(out.iter().zip(single).all(|(a, b)| (a - f64::from(b)).abs() < 1e-6));
        }
    }

    #[test]
    fn a_frame_is_needed_for_every_slot() {
        let angles = EulerColumns { columns: &[[0, 1, 2]], axes: &[[0, 1, 2]] };
        assert!(turned_euler_to_quaternions(&[0.0; 3], 3, angles, &[], &mut [0.0; 4]).is_err());
    }

    #[test]
    fn a_block_gives_each_row_what_it_has_alone() {
        let angles = EulerColumns { columns: &[[0, 1, 2], [3, 4, -1]], axes: &[[2, 0, 1], [1, 0, 2]] };
        let ordinary: Vec<f64> = (0..5 * 40).map(|k| 400.0 * (0.7 * f64::from(k)).sin()).collect();
        for special in [1e300, -3e15, f64::INFINITY, f64::NAN] {
            let mut rows = ordinary.clone();
            (rows[31], rows[88], rows[93]) = (special, f64::NAN, 7e20);
            let mut found = [0.0_f64; 8 * 40];
            euler_to_quaternions(&rows, 5, angles, &mut found).unwrap();
            for (row, found) in rows.chunks(5).zip(found.as_chunks::<8>().0) {
                let alone = [angles.quaternion(0, row), angles.quaternion(1, row)];
                assert_eq!(
                    found.map(f64::to_bits),
                    *alone.as_flattened().iter().map(|c: &f64| c.to_bits()).collect::<Vec<_>>()
                );
            }
        }
    }

    #[test]
    fn missing_columns_are_angles_of_zero() {
        let mut out = [0.0_f64; 8];
        let angles = EulerColumns { columns: &[[-1, 0, -1], [-1, -1, -1]], axes: &[[2, 0, 1], [0, 1, 2]] };
        euler_to_quaternions(&[90.0], 1, angles, &mut out).unwrap();
        assert!(same_rotation([out[0], out[1], out[2], out[3]], compose([90.0, 0.0, 0.0], [0, 1, 2])));
        assert_eq!(out[4..], [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn what_names_no_rotation_is_refused_or_is_nan() {
        let axes = [[0, 1, 2]];
        let angles = |columns| EulerColumns { columns, axes: &axes };
        let mut out = [0.0_f64; 4];
        assert!(euler_to_quaternions(&[0.0; 3], 3, angles(&[[0, 1, 3]]), &mut out).is_err());
        assert!(euler_to_quaternions(&[0.0; 3], 3, angles(&[[0, 1, -2]]), &mut out).is_err());
        assert!(euler_to_quaternions(&[0.0; 4], 3, angles(&[[0, 1, 2]]), &mut out).is_err());
        euler_to_quaternions(&[f64::NAN, f64::INFINITY, 0.0], 3, angles(&[[0, 1, 2]]), &mut out).unwrap();
        assert!(out.iter().all(|c| c.is_nan()));

        assert!(quaternions_to_euler(&[0.0; 4], &[[0, 0, 1]], &mut [0.0; 3]).is_err());
        let mut degrees = [0.0; 6];
        quaternions_to_euler(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &axes, &mut degrees).unwrap();
        assert!(degrees[0].is_nan());
        assert_eq!(degrees[3..], [0.0; 3]);
    }
}
