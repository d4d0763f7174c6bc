"""Clips put end to end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.dof_rows import DofRows
from gmr.dummies import Dropped
from gmr.errors import GmrError, SkeletonError
from gmr.frames import Pose, Rows
from gmr.motion import Motion

__all__ = ["concatenate"]


def concatenate(motions: Sequence[Motion]) -> Motion:
    """One motion of the frames of all, in this order; poses are not blended where they meet.

    Args:
        motions: at least one; all on the same skeleton, at the same rate, in the same unit.

    Returns:
        The frames as rows where all hold rows of the same channels, else as poses. The name is kept where all
        agree.

    Raises:
        GmrError: nothing to concatenate, or rate or unit differ.
        SkeletonError: the skeletons differ, or a different joint moves.
        TypeError: one of them is no motion.
    """
    if isinstance(motions, Motion):
        raise TypeError("several motions are concatenated: put this one into a list, [motion]")
    motions = list(motions)
    if not motions:
        raise GmrError("there is nothing to concatenate; give at least one motion")
    for motion in motions:
        if not isinstance(motion, Motion):
            raise TypeError(f"motions are needed here, not {motion!r:.60}; read files with gmr.read")
    first, *others = motions
    if not others:
        return first
    for other in others:
        _check_alike(first, other)
    name = first.name if all(other.name == first.name for other in others) else None
    dropped = _joined_records([motion.dropped for motion in motions])
    return replace(first, source=_joined(motions), name=name, dropped=dropped)


def _joined_records(records: Sequence[Dropped | None]) -> Dropped | None:
    """What was dropped from all of them; None where that differs."""
    first = records[0]
    if first is None or any(record != first for record in records[1:]):
        return None
    rows = [record.rows for record in records if record is not None and record.rows is not None]
    if len(rows) < len(records) or any(part.layout != rows[0].layout for part in rows):
        return first.without_rows()
    return replace(
        first,
        before=_joined_records([record.before for record in records if record is not None]),
        rows=Rows(read_only(np.concatenate([part.values for part in rows])), rows[0].layout),
    )


def _joined(motions: Sequence[Motion]) -> Rows | DofRows | Pose:
    """The frames of motions that are alike."""
    first = motions[0]
    sources = [motion.source for motion in motions]
    one_layout = all(source.layout == first.layout for source in sources)
    rows = [source.values for source in sources if isinstance(source, Rows)]
    if one_layout and len(rows) == len(sources) and first.layout is not None:
        return Rows(read_only(np.concatenate(rows)), first.layout)
    dofs = [source for source in sources if isinstance(source, DofRows)]
    if len(dofs) == len(sources) and all(
        (part.acclaim, part.radians) == (dofs[0].acclaim, dofs[0].radians) for part in dofs
    ):
        return replace(dofs[0], values=read_only(np.concatenate([part.values for part in dofs])))
    translated = np.unique(np.concatenate([motion.translated for motion in motions]))
    return Pose(
        read_only(np.concatenate([motion.rotations for motion in motions])),
        translated,
        read_only(np.concatenate([translations_of(motion, translated) for motion in motions])),
        first.layout if one_layout else None,
    )


def translations_of(motion: Motion, joints: NDArray[np.integer[Any]]) -> NDArray[np.float64]:
    """(F, K, 3) translations of ``joints``: the offset for those that stay at rest."""
    found = np.empty((motion.frame_count, len(joints), 3))
    found[:] = motion.skeleton.offsets[joints]
    place = {joint: k for k, joint in enumerate(joints.tolist())}
    chosen = [k for k, joint in enumerate(motion.translated.tolist()) if joint in place]
    found[:, [place[joint] for joint in motion.translated[chosen].tolist()]] = motion.translations[:, chosen]
    return found


def _check_alike(first: Motion, other: Motion) -> None:
    """Raises unless the two can follow each other."""
    if first.skeleton != other.skeleton:
        raise SkeletonError(
            f"{_named(other)} has another skeleton than {_named(first)}: {_difference(first, other)}"
        )
    if abs(first.frame_time - other.frame_time) > 1e-9 * first.frame_time:
        raise GmrError(
            f"{_named(other)} runs at {other.fps:.6g} fps, {_named(first)} at {first.fps:.6g}; "
            f"resample one of them first: motion.resample({first.fps:.6g})"
        )
    if first.unit != other.unit:
        raise GmrError(
            f"{_named(other)} is in units of {other.unit} m, {_named(first)} of {first.unit} m; "
            "convert one of them first: motion.to_unit(...), or declare it with motion.with_unit(...)"
        )


def _difference(first: Motion, other: Motion) -> str:
    """The first thing in which two skeletons differ, in words."""
    one, two = first.skeleton, other.skeleton
    if one.joint_count != two.joint_count:
        return f"{two.joint_count} joints where {one.joint_count} are needed"
    differs: tuple[tuple[str, Callable[[int], bool]], ...] = (
        ("name", lambda j: one.names[j] != two.names[j]),
        ("parent", lambda j: one.parents[j] != two.parents[j]),
        ("offset", lambda j: bool((one.offsets[j] != two.offsets[j]).any())),
        ("rotation slot", lambda j: one.slots[j] != two.slots[j]),
    )
    for joint, name in enumerate(one.names):
        for what, test in differs:
            if test(joint):
                return f"the {what} of joint {joint} ('{name}', '{two.names[joint]}') differs"
    return "their end sites, or what their roots were before they were moved, differ"


def _named(motion: Motion) -> str:
    return "an unnamed motion" if motion.name is None else f"'{motion.name}'"
