"""Operations of the General Motion Representation on a long motion: any within 30 ms on one core.

Each is measured twice: straight from the rows that reading gives, and from a pose that is there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import gmr
from gmr.bench.harness import Contest
from gmr.bench.inputs import cmu_like_motion

__all__ = ["operations"]

ROOTS: Final = ("Hips", "LeftHand", "RightHand", "LeftFoot", "RightFoot", "Head")


def operations(frame_count: int) -> Iterator[Contest]:
    """Moves roots, selects joints and drops dummies in 36,000 frames of 38 joints."""
    read = cmu_like_motion(frame_count)
    work: dict[str, Callable[[gmr.Motion], gmr.Motion]] = {
        "shift_root": lambda motion: motion.shift_root("Neck"),
        "split": lambda motion: motion.split("LeftHand"),
        "with_roots, 6": lambda motion: motion.with_roots(ROOTS),
        "with_roots, all": lambda motion: motion.with_roots(range(motion.skeleton.joint_count)),
        "select, half": lambda motion: motion.select(range(0, motion.skeleton.joint_count, 2)),
        "drop_dummies": lambda motion: motion.drop_dummies(),
    }
    for name, operation in work.items():
        yield _contest(f"{name}, from rows", read, operation)
        yield _contest(f"{name}, from a pose", _posed(read), operation)
    hand = _posed(read).split("LeftHand")
    yield _contest("join, from a pose", _forgetful(hand), lambda motion: motion.join("LeftHand"))


def _contest(
    name: str, motion: gmr.Motion, operation: Callable[[gmr.Motion], gmr.Motion]
) -> Contest:
    frames, joints = motion.frame_count, motion.skeleton.joint_count
    return Contest(
        work=f"{name}, {joints} joints",
        unit="M frames/s",
        amount=frames / 1e6,
        ours=lambda: operation(motion),
    )


def _posed(motion: gmr.Motion) -> gmr.Motion:
    """The motion as quaternions alone."""
    return replace(motion, source=replace(motion.pose, rows=None))


def _forgetful(motion: gmr.Motion) -> gmr.Motion:
    """The motion without the rows that it was read as, so that all must be computed."""
    return replace(motion, source=replace(motion.pose, rows=None))
