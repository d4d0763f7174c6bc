"""Bones as viewers draw them: segments from each joint, the head, to a tail that a rule chooses.

A joint is a point, a bone a segment; a joint with several children has several candidates for the tail of
its bone, and viewers differ. The rules are those of Blender's importer (``centroid``, compared with
recordings of Blender 3.4.1), of viewers that follow the first child (``first_child``), and of those that join
every joint to its parent (``per_child``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.errors import GmrError
from gmr.listing import quoted
from gmr.quaternions import matrices
from gmr.skeleton import End, Skeleton
from gmr.world import motion_rotations

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["FALLBACK", "SHORTEST", "Bones", "bones"]

Floats = NDArray[np.float64]

SHORTEST = 0.001
"""File units: a tail nearer to its head than this counts as lying on it. Measured with Blender 3.4.1, where
it does not depend on the skeleton's size."""

FALLBACK = (0.0, 0.1, 0.0)
"""File units: what a tail on its head is moved by at rest; in a frame it turns with the joint. Measured like
:data:`SHORTEST`."""


@dataclass(frozen=True, eq=False, slots=True)
class Bones:
    """B segments; ``heads, tails = bones`` takes them apart. All arrays are read-only."""

    joints: NDArray[np.int32]
    """(B,) the joint that each segment begins at; ascending, and each joint once where a rule gives one bone
    a joint."""
    heads: Floats
    """(B, 3) file units; (F, B, 3) for a slice of frames."""
    tails: Floats
    """(B, 3) file units; (F, B, 3) for a slice of frames."""

    def __iter__(self) -> Iterator[Floats]:
        return iter((self.heads, self.tails))


def bones(motion: Motion, rule: str = "centroid", frame: int | slice | None = None) -> Bones:
    """Heads and tails of all bones, at rest or in frames.

    The tail of a bone is the mean of some of the joint's children, by ``rule``:

    - ``"centroid"``, Blender's: all children; where an End Site is among them, that alone (the last, if
      several).
    - ``"first_child"``: the first child in file order.
    - ``"per_child"``: one child, in a bone of its own for each.

    A tail that lies on its head, and that of a leaf without End Site, is moved by :data:`FALLBACK`;
    ``centroid`` moves it as Blender does, which at a joint with several children looks at the parent's bone
    (docs/bones.md has the rule). An End Site is a tail and has no bone: ``per_child`` leaves it out; the
    other rules, which give J bones so that they are indexed as joints are, let its tail lie on its head.

    In a frame heads are where the joints are. ``centroid`` carries the tail of the rest pose rigidly with the
    joint, as Blender does, also where position channels move the children away from it; where the children
    turn independently, so that the joint has no one frame, the tail is the mean of their places. The other
    rules draw lines between joints: the tail is the child's place.

    Args:
        motion: J joints. The bones are those that it has at home, wherever its roots are.
        rule: "centroid", "first_child" or "per_child".
        frame: None: the rest pose, each root at its OFFSET; an index, from the end where negative; or a slice
            of F frames.

    Returns:
        B bones in float64; B = J except by ``per_child``.

    Raises:
        GmrError: there is no such rule, or no such frame.

    Source: a post on bone offsets in Blender's and other renderings of the CMU data set; Blender 3.4.1,
    measured.
    """
    skeleton = motion.skeleton.home or motion.skeleton
    segments = _segments(skeleton, rule)
    heads, tails = _at_rest(skeleton, segments, rule)
    if isinstance(frame, slice):
        heads, tails = _in_frames(motion[frame], segments, tails - heads, rule)
    elif frame is not None:
        one = _slice_of_one(frame, motion.frame_count)
        heads, tails = (places[0] for places in _in_frames(motion[one], segments, tails - heads, rule))
    return Bones(read_only(segments.joints), read_only(heads), read_only(tails))


@dataclass(frozen=True, eq=False)
class _Segments:
    """B bones whose tails are means of one or more joints."""

    joints: NDArray[np.int32]
    """(B,) the heads."""
    targets: NDArray[np.int32]
    """(K,) the joints at whose mean the tails lie, bone by bone."""
    counts: NDArray[np.intp]
    """(B,) how many of ``targets`` each bone has; a leaf has one, itself."""
    drawn: NDArray[np.bool_]
    """(B,) False for a bone that stays without length, since it is an End Site's."""

    def means(self, places: Floats) -> Floats:
        """(..., B, 3) the mean of each bone's targets among (..., J, 3)."""
        sums = np.add.reduceat(places[..., self.targets, :], self._starts, axis=-2)
        return np.asarray(sums / self.counts[:, None], np.float64)

    def vectors(self, offsets: Floats) -> Floats:
        """(B, 3) from head to tail when nothing turns; 0 for a leaf."""
        is_leaf = self.targets[self._starts] == self.joints
        return np.where(is_leaf[:, None], 0.0, self.means(offsets))

    def lacking(self, vectors: Floats) -> NDArray[np.bool_]:
        """(..., B, 1) which of the vectors from head to tail (..., B, 3) are too short to be drawn."""
        short: NDArray[np.bool_] = self.drawn & (np.linalg.norm(vectors, axis=-1) < SHORTEST)
        return short[..., None]

    @property
    def _starts(self) -> NDArray[np.intp]:
        return np.cumsum(self.counts) - self.counts


def _at_rest(skeleton: Skeleton, segments: _Segments, rule: str) -> tuple[Floats, Floats]:
    """(B, 3) heads and tails when nothing turns and each root is at its offset."""
    places = skeleton.offsets.copy()
    for joint in skeleton.parents_first:
        if skeleton.parents[joint] >= 0:
            places[joint] += places[skeleton.parents[joint]]
    heads = places[segments.joints]
    vectors = segments.vectors(skeleton.offsets)
    if rule == "centroid":
        return heads, heads + _as_blender_moves(skeleton, segments, vectors)
    return heads, heads + np.where(segments.lacking(vectors), vectors + FALLBACK, vectors)


def _as_blender_moves(skeleton: Skeleton, segments: _Segments, vectors: Floats) -> Floats:
    """(J, 3) from head to tail as Blender 3.4.1 has it, for ``vectors`` (J, 3) to the means of the children.

    Measured: Blender first moves what it takes for short, but compares the mean of several children's offsets
    with the joint's own OFFSET instead of with 0 (``compared``, by design or not). What is short after that
    continues the bone of its parent, in the same reckoning; a root's gets the mean length of all bones.
    """
    several = (segments.counts > 1)[:, None]
    compared = np.where(several, vectors - skeleton.offsets, vectors)
    moved = np.where(segments.lacking(compared), FALLBACK, 0.0)
    vectors, compared = vectors + moved, compared + moved
    lengths = np.linalg.norm(compared, axis=1)
    upward = np.array([0.0, lengths[segments.drawn].sum() / max(1, segments.drawn.sum()), 0.0])
    continued = np.where(skeleton.parents[:, None] >= 0, compared[skeleton.parents], upward)
    return np.where(segments.lacking(vectors), vectors + continued, vectors)


def _in_frames(motion: Motion, segments: _Segments, at_rest: Floats, rule: str) -> tuple[Floats, Floats]:
    """(F, B, 3) heads and tails; ``at_rest`` (B, 3) leads from head to tail in the rest pose."""
    positions = motion.positions(dtype=np.float64)
    slots, has_frame = _frames_of(motion.skeleton)
    turns = matrices(motion_rotations(motion, slots[segments.joints], np.float64, None))
    heads = positions[:, segments.joints]
    tails = segments.means(positions)
    tails = np.where(segments.lacking(tails - heads), tails + turns @ np.array(FALLBACK), tails)
    if rule == "centroid":
        carried = heads + np.einsum("fbij,bj->fbi", turns, at_rest)
        tails = np.where(has_frame[segments.joints, None], carried, tails)
    return heads, tails


def _frames_of(skeleton: Skeleton) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """(J,) slot whose world rotation is each joint's frame, and whether it has one: its children share it.

    A joint without one frame is given that of the bone that ends in it.
    """
    at_home = skeleton.home or skeleton
    world, turned_by = np.asarray(at_home.topology.world_slots), skeleton.bone_slots
    slots, has_frame = turned_by.copy(), np.ones(len(world), bool)
    for joint, children in enumerate(at_home.children):
        has_frame[joint] = len({int(world[child]) for child in children}) <= 1
        if children and has_frame[joint]:
            slots[joint] = turned_by[children[0]]
    return slots, has_frame


def _slice_of_one(frame: int, count: int) -> slice:
    if not -count <= frame < count:
        raise GmrError(f"there is no frame {frame}; the motion has {count}, counted from 0")
    start = frame % count
    return slice(start, start + 1)


_Chosen = list[tuple[int, ...]]
"""For each of a joint's bones, the children at whose mean its tail lies."""


def _centroid(children: tuple[int, ...], sites: list[int]) -> _Chosen:
    return [(sites[-1],) if sites else children]


def _first_child(children: tuple[int, ...], sites: list[int]) -> _Chosen:
    return [children[:1]]


def _per_child(children: tuple[int, ...], sites: list[int]) -> _Chosen:
    return [(child,) for child in children] or [()]


_RULES: Mapping[str, Callable[[tuple[int, ...], list[int]], _Chosen]] = {
    "centroid": _centroid,
    "first_child": _first_child,
    "per_child": _per_child,
}
"""What each rule makes of a joint's children (tips left out) and the End Sites among them."""


def _segments(skeleton: Skeleton, rule: str) -> _Segments:
    if rule not in _RULES:
        raise GmrError(f"there is no rule {rule!r} for the tails of bones; take one of {quoted(_RULES, 3)}")
    ends = skeleton.ends.tolist()
    joints: list[int] = []
    targets: list[tuple[int, ...]] = []
    drawn: list[bool] = []
    for joint, below in enumerate(skeleton.children):
        children = tuple(child for child in below if ends[child] != End.TIP)
        is_bone = bool(children) or ends[joint] == End.JOINT
        if not is_bone and rule == "per_child":
            continue
        for chosen in _RULES[rule](children, [child for child in children if ends[child] == End.SITE]):
            joints.append(joint)
            targets.append(chosen or (joint,))
            drawn.append(is_bone)
    return _Segments(
        np.array(joints, np.int32),
        np.array([child for chosen in targets for child in chosen], np.int32),
        np.array([len(chosen) for chosen in targets], np.intp),
        np.array(drawn, bool),
    )
