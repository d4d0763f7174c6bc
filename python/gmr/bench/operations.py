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

Operation = Callable[[gmr.Motion], gmr.Motion]

ROOTS: Final = ("Hips", "LeftHand", "RightHand", "LeftFoot", "RightFoot", "Head")


def operations(frame_count: int) -> Iterator[Contest]:
    """Moves roots, selects joints and drops dummies in 36,000 frames of 38 joints."""
    read = cmu_like_motion(frame_count)
    joint_count = read.skeleton.joint_count
    work: dict[str, Operation] = {
        "shift_root": lambda motion: motion.shift_root("Neck"),
        "split": lambda motion: motion.split("LeftHand"),
        "with_roots, 6": lambda motion: motion.with_roots(ROOTS),
        "with_roots, all": lambda motion: motion.with_roots(range(joint_count)),
        "select, half": lambda motion: motion.select(range(0, joint_count, 2)),
        "drop_dummies": lambda motion: motion.drop_dummies(),
    }
    posed = _posed(read)
    for name, operation in work.items():
        yield _contest(f"{name}, from rows", read, operation)
        yield _contest(f"{name}, from a pose", posed, operation)
    yield _contest("join, from a pose", posed.split("LeftHand"), lambda motion: motion.join("LeftHand"))
    apart = posed.with_roots(range(joint_count))
    yield _contest("join, all, from a pose", apart, lambda motion: motion.with_roots(read.skeleton.roots))


def _contest(name: str, motion: gmr.Motion, operation: Operation) -> Contest:
    return Contest(
        work=f"{name}, {motion.skeleton.joint_count} joints",
        unit="M frames/s",
        amount=motion.frame_count / 1e6,
        # A motion of its own each time: none finds a pose that an earlier one has converted.
        ours=lambda: operation(replace(motion)),
    )


def _posed(motion: gmr.Motion) -> gmr.Motion:
    """The motion as quaternions alone, so that the way home must be computed too."""
    return replace(motion, source=replace(motion.pose, rows=None))
