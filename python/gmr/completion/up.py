"""Which way is up in a dataset and in the clips that may join it: a folder has one up axis for all files."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gmr.body.measures import turned_from_upright, up_axis
from gmr.channels import ChannelLayout
from gmr.forest import home
from gmr.matching.prepare import turned
from gmr.matching.survey import Survey
from gmr.motion import Motion
from gmr.tpose import leading_rest_frames

__all__ = ["mirrored_upright", "own_axes", "raised", "standing", "turned_up"]


def turned_up(motion: Motion, up: str, to: str) -> Motion:
    """A clip whose up axis is ``up`` as one whose up axis is ``to``, in the channels that it has.

    A converter's T-pose is left out: what is turned has no whole-number angles by which it could be told.
    """
    recorded = home(motion)[leading_rest_frames(motion) :]
    return turned(recorded, up, to, layout=_whole_layout(recorded))


def raised(motion: Motion, up: str, by: float) -> Motion:
    """A clip moved along the axis ``up`` by some of its units, in the channels that it has.

    A converter's T-pose is left out, as from a clip that is turned.
    """
    recorded = home(motion)[leading_rest_frames(motion) :]
    translations = recorded.translations.copy()
    roots = np.isin(recorded.translated, recorded.skeleton.roots)
    translations[:, roots] += turned_from_upright(np.array([0.0, by, 0.0]), up)
    return Motion.from_pose(
        recorded.skeleton,
        recorded.rotations,
        translations,
        recorded.frame_time,
        translated=recorded.translated,
        layout=_whole_layout(recorded),
        unit=recorded.unit,
        name=recorded.name,
    )


def mirrored_upright(motion: Motion, up: str) -> Motion:
    """The mirror image across an upright plane: :meth:`gmr.Motion.mirror` has x = 0, which lies level where x
    is up."""
    if up not in ("+X", "-X"):
        return motion.mirror()
    return turned_up(turned_up(motion, up, "+Y").mirror(), "+Y", up)


def standing(seen: Survey) -> str:
    """The first clip that stands along the up axis of all of them, by name; the first one where none does."""
    return next((name for name, axis in _axes(seen) if axis == seen.up), next(iter(seen.samples)))


def own_axes(seen: Survey) -> dict[str, str]:
    """The axis along which each clip stands by itself, by name."""
    return dict(_axes(seen))


def _axes(seen: Survey) -> Iterator[tuple[str, str]]:
    for name, some in seen.samples.items():
        yield name, up_axis(np.asarray(some.positions(dtype=np.float64)), seen.joints.roles)


def _whole_layout(motion: Motion) -> ChannelLayout | None:
    """The channels of a motion, if whatever the motion is turned by can be written with them."""
    layout = motion.layout
    if layout is None or len(layout.slot_joints) != motion.skeleton.slot_count or layout.adds_offset:
        return None
    moving = np.isin(layout.translated, motion.skeleton.roots)
    turning = np.asarray(motion.skeleton.topology.slot_parents) < 0
    whole = (layout.rotation_columns[turning] >= 0).all() and (layout.translation_columns[moving] >= 0).all()
    return layout if whole else None
