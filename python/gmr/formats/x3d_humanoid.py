"""A motion as the motion of a humanoid of H-Anim.

With ``G(t)`` the world rotation of a bone, ``G_0`` that at rest, ``D`` and ``U`` the turns that bring the
motion upright at rest and while it plays, and ``L`` the turn that leads from H-Anim's default pose to the
rest pose (:mod:`gmr.formats.x3d_rest`), a joint is turned from the default pose by
``W(t) = U G(t) G_0^-1 D^-1 L``. With ``p`` its place, its vector from the joint above in the default pose is
``W_above^-1 (p - p_above)``: a constant where a bone keeps its length, and nothing turns between the two;
else the humanoid's joint is translated by what differs. So every joint is where the motion's is, whatever
``L`` is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import UP_TURNS
from gmr.editing.scene import Scene, scene_of
from gmr.errors import FormatError, GmrError
from gmr.forest import home
from gmr.formats.x3d_parts import Stand, find_parts, named_stands, tree_of
from gmr.formats.x3d_rest import default_turns, rest_of
from gmr.motion import Motion
from gmr.quaternions import IDENTITY, conjugate, multiply, rotated
from gmr.skinning.driving.rest_poses import MotionRest
from gmr.world import motion_rotations

__all__ = ["BLOCK", "Humanoid", "Moves", "check_size", "humanoid_of"]

Floats = NDArray[np.float64]

BLOCK = 1 << 12
"""Frames that are looked at together, so that a long motion needs no memory for all of its rotations; the
body is looked for in as many at the beginning."""
_SIZES = (0.02, 1e30)
"""Metres: in a smaller body the micrometres of a file move joints by more than a ten-thousandth of it, and
shapes come to nothing; a larger one comes to the end of single precision, which X3D's fields hold."""


@dataclass(frozen=True, eq=False)
class Moves:
    """How a joint moves from the default pose, in a block of frames.

    Args:
        turns: (n, 4) in the frame of the joint above.
        vectors: (n, 3) metres: from the joint above, in its default frame; the root: its place in the world.
    """

    turns: Floats
    vectors: Floats


@dataclass(frozen=True, eq=False)
class Humanoid:
    """What is written of a motion.

    Args:
        motion: F frames, at home.
        scene: its unit and axes.
        metres: per unit.
        stands: joints of the motion in the places of H-Anim's, by H-Anim's names.
        above: the joint above each joint of the humanoid, "" for the root; none before its parent.
        after: (4,) by name of those that turn: what follows ``G(t)``, ``G_0^-1 D^-1 L``.
        rest: the rest pose of the motion.
        odd: why that is no rest pose of its own; "" where it is.
    """

    motion: Motion
    scene: Scene
    metres: float
    stands: Mapping[str, Stand]
    above: Mapping[str, str]
    after: Mapping[str, Floats]
    rest: MotionRest
    odd: str

    @property
    def left_out(self) -> list[str]:
        """Names of the joints proper of the motion for which H-Anim has no name, or gmr does not know it."""
        used = {stand.named for stand in self.stands.values()}
        skeleton = self.motion.skeleton
        return [name for j, name in enumerate(skeleton.names) if j not in used and not skeleton.ends[j]]

    def standing_above(self, name: str) -> str:
        """The nearest joint above with a place in the motion; "" for the root."""
        name = self.above[name]
        while name and name not in self.stands:
            name = self.above[name]
        return name

    def turning(self, name: str) -> str:
        """The joint, or the nearest above it, that has the turns of a bone; "" for the world."""
        while name and name not in self.after:
            name = self.above[name]
        return name

    def blocks(self, names: list[str]) -> Iterator[dict[str, Moves]]:
        """How joints with places in the motion move, a few frames at a time."""
        up = np.array(UP_TURNS[self.scene.up])
        over = {name: self.standing_above(name) for name in names}
        wanted = sorted({*names, *over.values()} - {""})
        carriers = sorted({self.turning(name) for name in wanted} - {""})
        turned = np.array([self.stands[name].carrier for name in carriers], np.int32)
        slots = self.motion.skeleton.bone_slots[turned]
        joints = [self.stands[name].joint for name in wanted]
        for start in range(0, self.motion.frame_count, BLOCK):
            part = self.motion[start : start + BLOCK]
            world = motion_rotations(part, slots, np.float64, None)
            turns = {
                name: multiply(up, multiply(world[:, k], self.after[name])) for k, name in enumerate(carriers)
            } | {"": np.tile(IDENTITY, (len(part), 1))}
            ways = self.metres * rotated(up, part.positions(dtype=np.float64, joints=joints))
            places = {name: ways[:, k] for k, name in enumerate(wanted)} | {"": np.zeros((len(part), 3))}
            yield {name: self._moves(turns, places, name, over[name]) for name in names}

    def _moves(
        self, turns: Mapping[str, Floats], places: Mapping[str, Floats], name: str, over: str
    ) -> Moves:
        before = conjugate(turns[self.turning(over)])
        return Moves(
            multiply(before, turns[self.turning(name)]), rotated(before, places[name] - places[over])
        )


def humanoid_of(motion: Motion, names: Mapping[str, str] | None, rest: int | None) -> Humanoid:
    """A motion as a humanoid's.

    Args:
        motion: in any unit and configuration, with any axis up.
        names: joints by part of the body, which go before any guess.
        rest: the frame in which it rests; None: find it.

    Raises:
        SkeletonError: hips, legs or feet are not known.
        GmrError: there are no frames, the unit is not known, the body is smaller or larger than a file can
            say, or no such frame.
        FormatError: a place is no finite number.
    """
    if not motion.frame_count:
        raise GmrError(f"{motion.name or 'the motion'} has no frames, so there is no posture to write as X3D")
    at_home = home(motion)
    _check_finite(at_home)
    scene = scene_of(at_home)
    metres = 1 / scene.unit.per_metre("X3D, whose unit is the metre,")
    parts = find_parts(at_home[:BLOCK], scene, names or {})
    begins = {part: stands[0].joint for part, stands in parts.items()}
    resting, odd = rest_of(at_home, scene, begins, rest)
    check_size(metres * float(np.ptp(resting.places, axis=0).max()), at_home)
    stands = named_stands(parts, resting.places[:, 1])
    lead = default_turns(at_home, resting, stands)
    to_rest = conjugate(multiply(resting.upright, resting.rotations))
    after = {
        name: multiply(to_rest[stand.carrier], lead[name])
        for name, stand in stands.items()
        if stand.carrier is not None
    }
    return Humanoid(at_home, scene, metres, stands, tree_of(stands), after, resting, odd)


def _check_finite(motion: Motion) -> None:
    for start in range(0, motion.frame_count, BLOCK):
        finite = np.isfinite(motion[start : start + BLOCK].positions()).all(axis=2)
        if not finite.all():
            frame, joint = np.argwhere(~finite)[0].tolist()
            raise FormatError(
                f"joint '{motion.skeleton.names[joint]}' has no place in frame {start + frame}, which X3D "
                "cannot say. Fill the gap, or cut the frame out.",
                file=motion.name,
            )


def check_size(metres: float, motion: Motion) -> None:
    """Refuses a body that is smaller or larger than a file can say."""
    least, most = _SIZES
    if not least <= metres <= most:
        raise GmrError(
            f"the body of {motion.name or 'the motion'} would be {metres:.3g} m tall, and X3D, whose unit is "
            f"the metre, is written for {least:g} to {most:g} m; state how long a unit is: "
            "motion.with_unit('cm')"
        )
