"""A humanoid in its default pose: where its joints are, which of them move, how large it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import UP_TURNS
from gmr.formats.hanim import articulations
from gmr.formats.x3d_humanoid import BLOCK, Humanoid, Moves, check_size
from gmr.quaternions import conjugate, multiply, rotated

__all__ = ["Figure", "figure_of"]

Floats = NDArray[np.float64]

_RIGID = 2e-6
"""Share of the stature by which a bone's vector may vary and still be a bone: ten in a row stay within the
ten-thousandth that the file keeps."""
_STILL = 1e-7
"""Length of the change of a quaternion below which a joint does not turn: what seven decimals can say."""
_SHARES = {"skullbase": 0.45, "metatarsophalangeal_2": 0.7}
"""How far along neck and head, or along a foot, a joint is that the motion has not; as H-Anim has it."""
_LOW = ("talocrural", "metatarsophalangeal_2")
"""Joints that are near the ground, without the letter of their side."""


@dataclass(frozen=True, eq=False)
class Figure:
    """A humanoid in its default pose, and which of its joints do what in all frames together.

    Args:
        body: the humanoid.
        centres: (3,) metres by name: the default pose, the origin on the ground below the root.
        tips: (3,) metres by name: where the bone of the outermost joints ends, as far as the motion says.
        turning: names of the joints that turn.
        moving: names of the joints that are translated.
        stature: metres, from sole to crown as far as the motion has them.
        box: (2, 3) metres: between which places its root goes.
        floor: metres: the lowest place of an ankle or a toe.
        still: (4,) by name: the turn of joints that keep it.
    """

    body: Humanoid
    centres: Mapping[str, Floats]
    tips: Mapping[str, Floats]
    turning: frozenset[str]
    moving: frozenset[str]
    stature: float
    box: Floats
    floor: float
    still: Mapping[str, Floats]

    def translation(self, name: str, vectors: Floats) -> Floats:
        """(n, 3) metres: by how much a joint is translated.

        Args:
            name: of the joint.
            vectors: (n, 3) metres, from the joint above in its default frame; the root: places in the world.
        """
        above = self.body.standing_above(name)
        return vectors - (self.centres[name] - (self.centres[above] if above else 0.0))


def figure_of(body: Humanoid) -> Figure:
    """Looks at all frames of a humanoid, a few at a time.

    Raises:
        GmrError: it is smaller or larger than a file can say.
    """
    names = list(body.stands)
    first: dict[str, Moves] = {}
    low, high = ({name: np.full(3, sign * np.inf) for name in names} for sign in (1, -1))
    changed = dict.fromkeys(names, 0.0)
    for moves in body.blocks(names):
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
    check_size(stature, body.motion)
    shift = -np.array([centres["humanoid_root"][0], ends[:, 1].min(), centres["humanoid_root"][2]])
    placed = {name: centre + shift for name, centre in centres.items()}
    root = names[0]
    return Figure(
        body,
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


def _centres(body: Humanoid, vectors: Mapping[str, Floats], tips: dict[str, Floats]) -> dict[str, Floats]:
    """Default places of all joints, the root's at 0; those that the motion has not are put between those that
    it has, on the bone above, which then ends in them (``tips`` is changed), or where H-Anim's own body has
    them."""
    found = {"humanoid_root": np.zeros(3)}
    for name in body.stands:
        if body.above[name]:
            found[name] = found[body.standing_above(name)] + vectors[name]
    scale = _scale(found)
    for name, above in body.above.items():
        if name in found:
            continue
        over = body.standing_above(name)
        hanging = [one for one in body.stands if body.standing_above(one) == over and _hangs(body, one, name)]
        below = [found[one] for one in hanging]
        if below:
            share = 1.0 if name == "sacroiliac" else 0.5
            found[name] = found[above] + share * (np.mean(below, axis=0) - found[above])
        elif above in tips:
            share = _SHARES.get(name if name in _SHARES else name[2:], 1.0)
            tips[name] = (1 - share) * tips[above]
            found[name] = found[above] + share * tips.pop(above)
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
    hip, ankle = (np.array(articulations()[name].centre) for name in ("l_hip", "l_talocrural"))
    apart = float(np.linalg.norm(found["l_hip"] - found["l_talocrural"]))
    return apart / float(np.linalg.norm(hip - ankle))


def _tip_vectors(body: Humanoid) -> dict[str, Floats]:
    """(3,) metres by name of the outermost joints: the default vector to the end of their bone."""
    skeleton, bone_slots = body.motion.skeleton, body.motion.skeleton.bone_slots
    inner = {body.standing_above(name) for name in body.stands}
    found = {}
    for name in (name for name in body.after if name not in inner):
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
    feet = [stand.joint for name, stand in body.stands.items() if name[2:] in _LOW]
    up = np.array(UP_TURNS[body.scene.up])
    lowest = np.inf
    for start in range(0, body.motion.frame_count, BLOCK):
        places = body.motion[start : start + BLOCK].positions(dtype=np.float64, joints=feet)
        lowest = min(lowest, float(rotated(up, places)[..., 1].min()))
    return body.metres * lowest
