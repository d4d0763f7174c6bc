"""Random skeletons and motions for property tests; they shrink to one joint at rest.

``motions()`` are what a post-rotation file may hold: any tree (or several), any of the twelve rotation orders
or fewer angles, position channels anywhere, dummies, leaves with and without end sites.
``symmetric_motions()`` have limbs in pairs. ``poses()`` hold quaternions instead of rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from gmr.channels import ChannelLayout
from gmr.motion import Motion
from gmr.skeleton import End, Skeleton

ORDERS = ("ZXY", "ZYX", "XYZ", "XZY", "YXZ", "YZX", "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ")
FEWER = ("X", "Y", "Z", "XY", "ZX", "YZ", "")
SIDES = (
    ("Left{}", "Right{}"),
    ("L{}", "R{}"),
    ("{}_l", "{}_r"),
    ("mixamorig:Left{}", "mixamorig:Right{}"),
    ("l{}", "r{}"),
)

lengths = st.one_of(
    st.just(0.0),
    st.integers(-9, 9).map(float),
    st.floats(-50, 50, allow_nan=False, allow_subnormal=False),
)
angles_deg = st.one_of(
    st.integers(-180, 180).map(float),
    st.floats(-180, 180, allow_nan=False, allow_subnormal=False),
)
offsets = st.one_of(st.just((0.0, 0.0, 0.0)), st.tuples(lengths, lengths, lengths))


@dataclass
class Joint:
    """A joint of a tree that is being drawn."""

    name: str
    offset: tuple[float, float, float]
    channels: tuple[str, ...]
    end_site: tuple[float, float, float] | None = None
    children: list[Joint] = field(default_factory=list)


def channels(root: bool = False) -> st.SearchStrategy[tuple[str, ...]]:
    """Channels of one joint: rotations in any order, positions before, after or absent."""
    turns = st.sampled_from(ORDERS if root else ORDERS + FEWER)
    moves = st.sampled_from(["XYZ", "ZYX"] if root else ["", "", "", "XYZ", "Y", "ZX"])

    def named(turn: str, move: str, turns_first: bool) -> tuple[str, ...]:
        rotations = tuple(f"{axis}rotation" for axis in turn)
        positions = tuple(f"{axis}position" for axis in move)
        return rotations + positions if turns_first else positions + rotations

    return st.builds(named, turns, moves, st.booleans())


@st.composite
def trees(draw: st.DrawFn, names: Sequence[str], roots: bool = True) -> list[Joint]:
    """One or more trees of joints with these names, in file order."""
    top: list[Joint] = []
    path: list[Joint] = []
    for name in names:
        kept = len(path) - draw(st.integers(0, len(path))) if path else 0
        if not roots and top:
            kept = max(kept, 1)
        path = path[:kept]
        joint = Joint(name, draw(offsets), draw(channels(root=not path)), draw(st.none() | offsets))
        (path[-1].children if path else top).append(joint)
        path.append(joint)
    return top


def flattened(top: Sequence[Joint], adds_offset: bool = False) -> tuple[Skeleton, ChannelLayout]:
    """The skeleton and layout that reading a file of these trees gives."""
    names: list[str] = []
    parents: list[int] = []
    places: list[tuple[float, float, float]] = []
    ends: list[End] = []
    layout: list[tuple[str, ...]] = []

    def add(
        name: str, parent: int, offset: tuple[float, float, float], own: tuple[str, ...], end: End
    ) -> int:
        for column, entry in zip(
            (names, parents, places, layout, ends), (name, parent, offset, own, end), strict=True
        ):
            column.append(entry)  # type: ignore[attr-defined]
        return len(names) - 1

    def walk(joint: Joint, parent: int) -> None:
        index = add(joint.name, parent, joint.offset, joint.channels, End.JOINT)
        for child in joint.children:
            walk(child, index)
        if joint.children:
            return
        if joint.end_site is not None:
            add(f"{joint.name}_end", index, joint.end_site, (), End.SITE)
        elif any(name.endswith("rotation") for name in joint.channels):
            add(f"{joint.name}_end", index, (0.0, 0.0, 0.0), (), End.TIP)

    for root in top:
        walk(root, -1)
    turning = [joint for joint, own in enumerate(layout) if own]
    skeleton = Skeleton.post_rotation(names, parents, places, ends=ends, turning=turning)
    return skeleton, ChannelLayout.of(skeleton, layout, adds_offset=adds_offset)


@st.composite
def rows_on(draw: st.DrawFn, skeleton: Skeleton, layout: ChannelLayout, frames: int) -> Motion:
    """A motion of random rows."""
    shape = (frames, layout.column_count)
    turns = draw(arrays(np.float64, shape, elements=angles_deg, fill=st.just(0.0)))
    moves = draw(arrays(np.float64, shape, elements=lengths, fill=st.just(0.0)))
    rows = np.where(layout.column_turns, turns, moves)
    fps = draw(st.sampled_from([60, 120, 30, 24, 25.5]))
    return Motion.from_rows(skeleton, layout, rows, 1 / fps, unit=draw(st.none() | st.just(0.01)))


@st.composite
def motions(draw: st.DrawFn, max_joints: int = 6, max_frames: int = 5, min_frames: int = 1) -> Motion:
    """A motion as read from a post-rotation file."""
    count = draw(st.integers(1, max_joints))
    top = draw(trees([f"joint{k}" for k in range(count)]))
    skeleton, layout = flattened(top, draw(st.booleans()))
    return draw(rows_on(skeleton, layout, draw(st.integers(min_frames, max_frames))))


@st.composite
def symmetric_motions(draw: st.DrawFn, max_frames: int = 4) -> Motion:
    """A motion of a body with limbs in pairs; the two of a pair differ in all but names and hierarchy."""
    left, right = draw(st.sampled_from(SIDES))
    top = draw(trees([f"middle{k}" for k in range(draw(st.integers(1, 3)))], roots=False))
    middle = top[0]
    while draw(st.booleans()) and middle.children:
        middle = middle.children[0]
    limb = draw(trees([f"Limb{k}" for k in range(draw(st.integers(1, 3)))], roots=False))
    middle.children += [_sided(draw, limb[0], left), _sided(draw, limb[0], right)]
    skeleton, layout = flattened(top, draw(st.booleans()))
    return draw(rows_on(skeleton, layout, draw(st.integers(1, max_frames))))


@st.composite
def poses(draw: st.DrawFn, max_joints: int = 6, max_frames: int = 5, min_frames: int = 1) -> Motion:
    """A motion that holds quaternions."""
    motion = draw(motions(max_joints, max_frames, min_frames))
    return replace(motion, source=motion.pose)


def _sided(draw: st.DrawFn, joint: Joint, style: str) -> Joint:
    """A copy of the limb on one side, with offsets and channels of its own."""
    end_site = None if joint.end_site is None else draw(offsets)
    children = [_sided(draw, child, style) for child in joint.children]
    own = draw(channels()) if children or end_site else joint.channels
    return Joint(style.format(joint.name), draw(offsets), own, end_site, children)


def times(motion: Motion) -> NDArray[np.float64]:
    """(F,) seconds of each frame from the first."""
    return np.arange(float(motion.frame_count)) * motion.frame_time
