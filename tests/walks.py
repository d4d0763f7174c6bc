"""Random walks among the configurations of a motion."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from hypothesis import strategies as st

from gmr.motion import Motion


@st.composite
def walks_of(draw: st.DrawFn, motions: st.SearchStrategy[Motion]) -> tuple[Motion, Motion]:
    """A motion, and the same after some operations."""
    motion = moved = draw(motions)
    for _ in range(draw(st.integers(0, 5))):
        moved = draw(st.sampled_from(choices(moved)))()
    return motion, moved


def choices(motion: Motion) -> list[Callable[[], Motion]]:
    """All operations that can be done next."""
    joints = range(motion.skeleton.joint_count)
    roots = set(motion.skeleton.roots)
    found: list[Callable[[], Motion]] = [partial(motion.shift_root, joint) for joint in joints]
    found += [partial(motion.split, joint) for joint in joints if joint not in roots]
    links = motion.skeleton.links
    joinable = [root for root in roots if links[motion.skeleton.forest.top_of(root)] >= 0]
    return [*found, *(partial(motion.join, root) for root in joinable)]
