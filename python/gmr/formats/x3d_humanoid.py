"""A motion as the motion of a humanoid of H-Anim.

With ``G(t)`` the world rotation of a bone, ``G_0`` that at rest, ``D`` and ``U`` the turns that bring the motion
upright at rest and while it plays, and ``L`` the turn that leads from H-Anim's default pose to the rest pose
(:mod:`gmr.formats.x3d_rest`), a joint is turned from the default pose by ``W(t) = U G(t) G_0^-1 D^-1 L``. With
``p`` its place, its vector from the joint above in the default pose is ``W_above^-1 (p - p_above)``: a constant
where a bone keeps its length, and nothing turns between the two; else the humanoid's joint is translated by
what differs. So every joint is where the motion's is, whatever ``L`` is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import UP_TURNS
from gmr.editing.scene import Scene, scene_of
from gmr.errors import FormatError, GmrError
from gmr.forest import home
from gmr.formats.hanim import articulations
from gmr.formats.x3d_parts import Stand, find_parts, named_stands, tree_of
from gmr.formats.x3d_rest import default_turns, rest_of
from gmr.motion import Motion
from gmr.quaternions import IDENTITY, conjugate, multiply, rotated
from gmr.skinning.driving.rest_poses import MotionRest
from gmr.world import motion_rotations

__all__ = ["Humanoid", "Moves", "humanoid_of"]

Floats = NDArray[np.float64]

_BLOCK = 1 << 12
"""Frames that are looked at together."""
_RIGID = 2e-6
"""Share of the stature by which a bone's vector may vary and still be a bone; ten in a row vary by less than the
law allows."""
_STILL = 1e-7
"""Length of the change of a quaternion below which a joint does not turn: what seven decimals can say."""
_NOMINAL_STATURE = 1.7504
"""Metres, of H-Anim's own body."""


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

    @cached_property
    def measured(self) -> Measured:
        """What all frames together tell, found once."""
        return _measured(self)

    @property
    def left_out(self) -> list[str]:
        """Names of the joints proper of the motion for which H-Anim has no name, or gmr does not know it."""
        used = {stand.joint for stand in self.stands.values()} | {
            stand.carrier for stand in self.stands.values() if stand.carrier is not None
        }
        skeleton = self.motion.skeleton
        return [name for j, name in enumerate(skeleton.names) if j not in used and not skeleton.ends[j]]

    def standing_above(self, name: str) -> str:
        """The nearest joint above with a place in the motion; "" for the root."""
        name = self.above[name]
        while name and name not in self.stands:
            name = self.above[name]
        return name

    def turning(self, name: str) -> str:
        """The joint, or the nearest above it, that has turns of its own: those of a bone; "" for the world."""
        while name and name not in self.after:
            name = self.above[name]
        return name

    def blocks(self, names: list[str]) -> Iterator[tuple[slice, dict[str, Moves]]]:
        """How joints with places in the motion move, a few frames at a time."""
        up = np.array(UP_TURNS[self.scene.up])
        over = {name: self.standing_above(name) for name in names}
        wanted = sorted({*names, *over.values()} - {""})
        carriers = sorted({self.turning(name) for name in wanted} - {""})
        slots = self.motion.skeleton.bone_slots[[self.stands[name].carrier for name in carriers]]
        joints = [self.stands[name].joint for name in wanted]
        for start in range(0, self.motion.frame_count, _BLOCK):
            part = self.motion[start : start + _BLOCK]
            world = motion_rotations(part, slots, np.float64, None)
            turns = {
                name: multiply(up, multiply(world[:, k], self.after[name])) for k, name in enumerate(carriers)
            } | {"": np.tile(IDENTITY, (len(part), 1))}
            ways = self.metres * rotated(up, part.positions(dtype=np.float64, joints=joints))
            places = {name: ways[:, k] for k, name in enumerate(wanted)} | {"": np.zeros((len(part), 3))}
            yield slice(start, start + len(part)), {
                name: self._moves(turns, places, name, over[name]) for name in names
            }

    def _moves(self, turns: Mapping[str, Floats], places: Mapping[str, Floats], name: str, over: str) -> Moves:
        before = conjugate(turns[self.turning(over)])
        return Moves(
            multiply(before, turns[self.turning(name)]), rotated(before, places[name] - places[over])
        )


@dataclass(frozen=True, eq=False)
class Measured:
    """A humanoid in its default pose, and which of its joints do what.

    Args:
        centres: (3,) metres by name: the default pose, the origin on the ground below the root.
        tips: (3,) metres by name: where the bone of the outermost joints ends, as far as the motion says.
        turning: names of the joints that turn.
        moving: names of the joints that are translated.
        stature: metres, from sole to crown as far as the motion has them.
        box: (2, 3) metres: between which places its root goes.
        floor: metres: the lowest place of an ankle or a toe.
        still: (4,) by name: the turn of joints that keep it.
    """

    centres: Mapping[str, Floats]
    tips: Mapping[str, Floats]
    turning: frozenset[str]
    moving: frozenset[str]
    stature: float
    box: Floats
    floor: float
    still: Mapping[str, Floats]


def humanoid_of(motion: Motion, names: Mapping[str, str] | None, rest: int | None) -> Humanoid:
    """A motion as a humanoid's.

    Args:
        motion: in any unit and configuration, with any axis up.
        names: joints by part of the body, which go before any guess.
        rest: the frame in which it rests; None: find it.

    Raises:
        SkeletonError: hips, legs or feet are not known.
        GmrError: there are no frames, the unit is not known, or no such frame.
        FormatError: a place is no finite number.
    """
    if not motion.frame_count:
        raise GmrError(f"{motion.name or 'the motion'} has no frames, so there is no posture to write as X3D")
    at_home = home(motion)
    _check_finite(at_home)
    scene = scene_of(at_home)
    metres = 1 / scene.unit.per_metre("X3D, whose unit is the metre,")
    parts = find_parts(at_home, scene, names or {})
    begins = {part: stands[0].joint for part, stands in parts.items()}
    resting, odd = rest_of(at_home, scene, begins, rest)
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
    for start in range(0, motion.frame_count, _BLOCK):
        finite = np.isfinite(motion[start : start + _BLOCK].positions()).all(axis=2)
        if not finite.all():
            frame, joint = np.argwhere(~finite)[0].tolist()
            raise FormatError(
                f"joint '{motion.skeleton.names[joint]}' has no place in frame {start + frame}, which X3D cannot "
                "say. Fill the gap, or cut the frame out.",
                file=motion.name,
            )


def _measured(body: Humanoid) -> Measured:
    names = list(body.stands)
    first: dict[str, Moves] = {}
    low, high = ({name: np.full(3, sign * np.inf) for name in names} for sign in (1, -1))
    changed = dict.fromkeys(names, 0.0)
    for _, moves in body.blocks(names):
        for name, move in moves.items():
            start = first.setdefault(name, Moves(move.turns[0].copy(), move.vectors[0].copy()))
            low[name] = np.minimum(low[name], move.vectors.min(axis=0))
            high[name] = np.maximum(high[name], move.vectors.max(axis=0))
            sign = np.where(move.turns @ start.turns < 0, -1.0, 1.0)[:, None]
            far = np.linalg.norm(sign * move.turns - start.turns, axis=1).max()
            changed[name] = max(changed[name], float(far))
    middle = {name: (low[name] + high[name]) / 2 for name in names}
    tips = _tip_vectors(body)
    centres = _centres(body, middle, tips)
    ends = np.array([*centres.values(), *(centres[name] + tip for name, tip in tips.items())])
    stature = float(np.ptp(ends[:, 1]))
    shift = -np.array([centres["humanoid_root"][0], ends[:, 1].min(), centres["humanoid_root"][2]])
    placed = {name: centre + shift for name, centre in centres.items()}
    root = names[0]
    return Measured(
        centres=placed,
        tips={name: placed[name] + tip for name, tip in tips.items()},
        turning=frozenset(name for name in names if changed[name] > _STILL),
        moving=frozenset(
            name
            for name in names
            if np.ptp([low[name], high[name]], axis=0).max() > (_RIGID * stature if name != root else 0)
        ),
        stature=stature,
        box=np.array([low[root], high[root]]),
        floor=_floor(body),
        still={name: first[name].turns for name in names},
    )


def _centres(body: Humanoid, vectors: Mapping[str, Floats], tips: Mapping[str, Floats]) -> dict[str, Floats]:
    """Default places of all joints, the root's at 0; those that the motion has not are put between those that
    it has, at the end of the bone above, or where H-Anim's own body has them."""
    found = {"humanoid_root": np.zeros(3)}
    for name in body.stands:
        if body.above[name]:
            found[name] = found[body.standing_above(name)] + vectors[name]
    scale = _scale(found)
    for name, above in body.above.items():
        if name in found:
            continue
        below = [found[other] for other in body.stands if body.standing_above(other) == body.standing_above(name) and _hangs(body, other, name)]
        if below:
            share = 1.0 if name == "sacroiliac" else 0.5
            found[name] = found[above] + share * (np.mean(below, axis=0) - found[above])
        elif above in tips:
            found[name] = found[above] + tips[above]
        else:
            own, its = articulations()[name].centre, articulations()[above].centre
            assert own is not None
            assert its is not None
            found[name] = found[above] + scale * (np.array(own) - np.array(its))
    return {name: found[name] for name in body.above}


def _hangs(body: Humanoid, name: str, top: str) -> bool:
    while name and name != top:
        name = body.above[name]
    return name == top


def _scale(found: Mapping[str, Floats]) -> float:
    """How much larger the body is than H-Anim's own, by how far hips and ankles are apart."""
    own = [articulations()[name].centre for name in ("l_hip", "l_talocrural")]
    nominal = float(np.linalg.norm(np.subtract(*own)))
    return float(np.linalg.norm(found["l_hip"] - found["l_talocrural"])) / nominal


def _tip_vectors(body: Humanoid) -> dict[str, Floats]:
    """(3,) metres by name of the outermost joints: the vector to the farthest end of their bone, in the default
    pose."""
    skeleton, bone_slots = body.motion.skeleton, body.motion.skeleton.bone_slots
    outermost = [name for name in body.stands if name not in {body.standing_above(other) for other in body.stands}]
    found = {}
    for name in (name for name in outermost if name in body.after):
        stand = body.stands[name]
        ways = [
            body.rest.places[child] - body.rest.places[stand.joint]
            for child in skeleton.children[stand.joint]
            if bone_slots[child] == bone_slots[stand.carrier]
        ]
        way = max(ways, key=np.linalg.norm, default=np.zeros(3))
        if np.any(way):
            lead = multiply(multiply(body.rest.upright, body.rest.rotations[stand.carrier]), body.after[name])
            found[name] = body.metres * rotated(conjugate(lead), way)
    return found


def _floor(body: Humanoid) -> float:
    """Metres: the lowest that an ankle or a toe gets."""
    feet = [stand.joint for name, stand in body.stands.items() if name[2:] in ("talocrural", "metatarsophalangeal_2")]
    up = np.array(UP_TURNS[body.scene.up])
    lowest = np.inf
    for start in range(0, body.motion.frame_count, _BLOCK):
        places = body.motion[start : start + _BLOCK].positions(dtype=np.float64, joints=feet)
        lowest = min(lowest, float(rotated(up, places)[..., 1].min()))
    return body.metres * lowest
