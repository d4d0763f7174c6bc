//! Positions of roots are their translations: where nothing else is asked for, there is nothing to compute.

use std::ops::Range;

use super::plan::Plan;
use super::{ForwardKinematics, Pose, World};
use crate::lanes::Real;

/// The place of each asked joint among the translated ones, where all are roots that are translated per frame as
/// they stand in `translations`.
pub(super) fn translated_roots<T: Real>(
    job: &ForwardKinematics<'_, T>,
    plan: &Plan<T>,
) -> Option<Vec<usize>> {
    if !plan.slots_out.is_empty() || matches!(job.pose, Pose::Rows { .. }) {
        return None;
    }
    let place = |&bone: &usize| plan.bones[bone].translated.filter(|_| plan.bones[bone].parent.is_none());
    plan.joints_out.iter().map(place).collect::<Option<Vec<_>>>().filter(|places| !places.is_empty())
}

/// Copies the translations of these places in `frames`; `world` has room for these frames only.
pub(super) fn copy<T: Real>(
    job: &ForwardKinematics<'_, T>,
    places: &[usize],
    frames: Range<usize>,
    world: World<'_, T>,
) {
    let (Pose::Quaternions { translations, .. }, Some(positions)) = (job.pose, world.positions) else {
        return;
    };
    let count = job.translated.len();
    let translations = &translations[frames.start * count * 3..frames.end * count * 3];
    if places.iter().copied().eq(0..count) {
        positions.copy_from_slice(translations);
        return;
    }
    let from = translations.as_chunks::<3>().0.chunks_exact(count);
    let rows = positions.as_chunks_mut::<3>().0.chunks_exact_mut(places.len());
    for (row, frame) in rows.zip(from) {
        row.iter_mut().zip(places).for_each(|(position, &place)| *position = frame[place]);
    }
}
