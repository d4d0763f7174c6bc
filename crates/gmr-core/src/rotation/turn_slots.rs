//! Rotations of slots turned by those of others, in place.

use super::{conjugate, multiply};
use crate::error::{JobError, ShapeError};
use crate::lanes::Real;
use crate::parallel::for_each_chunk;

/// What a thread takes at a time.
const FRAMES_PER_PIECE: usize = 256;

/// Turns slots of (F, S, 4) `rotations` by other slots of the same frame, one after the other in the order given:
/// `R_slot <- R_by R_slot`, or by the inverse of `R_by`.
///
/// # Errors
/// When an index points outside the slots, or the rotations are no whole number of frames.
pub fn turn_slots<T: Real>(
    rotations: &mut [T],
    slot_count: usize,
    pairs: &[(i32, i32)],
    is_inverse: bool,
    threads: usize,
) -> Result<(), JobError> {
    for (at, found) in pairs.iter().flat_map(|&(slot, by)| [slot, by]).enumerate() {
        if usize::try_from(found).map_or(true, |slot| slot >= slot_count) {
            let found = found.into();
            return Err(JobError::Index { what: "slots and by", at: at / 2, found, count: slot_count });
        }
    }
    let width = 4 * slot_count;
    let frame_count = rotations.len().checked_div(width).unwrap_or(0);
    ShapeError::check("rotations", frame_count * width, rotations.len())?;
    for_each_chunk(rotations, FRAMES_PER_PIECE * width, threads, |_, piece| {
        for frame in piece.chunks_exact_mut(width) {
            let slots = frame.as_chunks_mut::<4>().0;
            for &(slot, by) in pairs {
                let by = slots[by as usize];
                let by = if is_inverse { conjugate(by) } else { by };
                slots[slot as usize] = multiply(by, slots[slot as usize]);
            }
        }
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_back_in_the_opposite_order_undoes_it() {
        let unit = |k: usize| {
            let q = [0, 1, 2, 3].map(|c| (0.7 * (4 * k + c) as f64).sin() + 0.1);
            crate::rotation::normalize(q)
        };
        let before: Vec<f64> = (0..5 * 600).flat_map(unit).collect();
        let pairs = [(1, 0), (2, 1), (2, 4)];
        let mut turned = before.clone();
        turn_slots(&mut turned, 5, &pairs, false, 2).unwrap();
        let frames = before.as_chunks::<20>().0.iter().zip(turned.as_chunks::<20>().0);
        for (was, is) in frames {
            let slot = |k: usize| -> [f64; 4] { was[4 * k..][..4].try_into().unwrap() };
            let first = multiply(slot(0), slot(1));
            assert_eq!(is[4..8], first);
            assert_eq!(is[8..12], multiply(slot(4), multiply(first, slot(2))));
        }
        let back: Vec<_> = pairs.iter().rev().copied().collect();
        turn_slots(&mut turned, 5, &back, true, 1).unwrap();
        assert!(before.iter().zip(&turned).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    #[test]
    fn slots_that_do_not_exist_are_refused() {
        let mut rotations = [0.0_f32; 8];
        let error = turn_slots(&mut rotations, 2, &[(0, 1), (2, 0)], false, 1).unwrap_err();
        assert!(error.to_string().contains("2 at place 1"), "{error}");
        assert!(turn_slots(&mut rotations[..7], 2, &[(0, 1)], false, 1).is_err());
    }
}
