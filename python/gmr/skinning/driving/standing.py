"""A driven character's feet on the ground: each where the motion's foot is, its sole on it in contacts.

The ankle goes where the motion's goes, in the character's measure, corrected for a foot of another shape, so
that a ball that rests in the motion rests in the character. Whatever the sole lacks to the floor is added,
smoothly; hips sink where a leg is too short; thigh and shin reach by :func:`gmr.editing.two_bone`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gmr.editing.contacts import Contact, slide
from gmr.editing.easing import blend_weights, eased, smooth_above
from gmr.editing.two_bone import two_bone
from gmr.quaternions import about, multiply, rotated
from gmr.skinning.driving.puppet import Puppet, strung
from gmr.skinning.driving.soles import Sole, heights, sole_of

__all__ = ["FootReport", "Leg", "Steps", "measured_feet", "on_ground", "stood"]

Floats = NDArray[np.float64]

_UP = np.array([0.0, 1.0, 0.0])
_BLEND = 0.1
"""Seconds over which a foot comes to the ground and leaves it."""
_SINKING = 0.2
"""Seconds over which hips come down and rise again."""
_SMOOTH = 0.4
"""Seconds over which the height of the ground is averaged, before and after."""
_NEARLY_STRAIGHT = 0.998
"""Share of its length to which a leg may be straightened, unless it was straighter before."""
_GROUND = 0.06
"""Metres, in the motion, above the lowest place of either ball nearby beyond which a contact is none with the
ground: such as the height of the swing of someone who walks in place, where a foot is slow."""
_NEARBY = 0.6
"""Seconds before and after."""


@dataclass(frozen=True, eq=False)
class Steps:
    """How a foot of the motion goes, in the character's measure: metres, +Y up.

    Args:
        ankle: (F, 3)
        ball: (F, 3) the joint of the contacts.
        turn: (F, 4) turn of the foot from the motion's rest.
        vector: (3,) from the ankle to the ball at rest.
        contacts: when the foot is on the ground.
        metre: of the motion, in the character's measure.
    """

    ankle: Floats
    ball: Floats
    turn: Floats
    vector: Floats
    contacts: tuple[Contact, ...]
    metre: float


@dataclass(frozen=True, eq=False)
class Leg:
    """A leg of the character that follows one of the motion.

    Args:
        side: "left" or "right".
        hip, knee, ankle: joints of the character.
        toe: the ball; None where it has none.
        vector: (3,) from the ankle to the ball, at rest laid on the motion's rest.
        hinge: (3,) the knee's axis at rest: to the left of the character.
        steps: of the motion's foot.
    """

    side: str
    hip: int
    knee: int
    ankle: int
    toe: int | None
    vector: Floats | None
    hinge: Floats
    steps: Steps


@dataclass(frozen=True)
class FootReport:
    """How a foot stands, in millimetres.

    Args:
        side: "left" or "right".
        contacts: how many there are in the motion.
        source_slide_mm: mean way of the ball along the ground in a contact of the motion.
        slide_mm: the same of the character.
        height_mm: greatest distance of the lowest point of the sole from the ground in contacts.
        lowest_mm: of the sole in the whole clip, above the ground; negative: below it.
    """

    side: str
    contacts: int
    source_slide_mm: float
    slide_mm: float
    height_mm: float
    lowest_mm: float


def stood(
    puppet: Puppet, legs: Sequence[Leg], anchor: int, placed: Mapping[int, Floats], frame_time: float
) -> tuple[Puppet, Floats, Floats]:
    """The character with its feet on the ground.

    Args:
        puppet: driven.
        legs: at least one.
        anchor: the joint that the others hang on.
        placed: (F, 3) places of the anchor and of others.
        frame_time: seconds.

    Returns:
        The character, (F,) metres by which it was raised as a whole, and (F,) by which its hips sank.
    """
    soles = [sole_of(puppet.character, leg.ankle) for leg in legs]
    floor = floor_of(soles)
    fps = 1 / frame_time if frame_time else 0
    blend = max(round(_BLEND * fps), 1)
    targets = [_ankle(leg, blend) for leg in legs]
    above = [
        _heights_at(puppet, leg, sole, target) - floor
        for leg, sole, target in zip(legs, soles, targets, strict=True)
    ]
    raised = _raised(legs, above, max(round(_SMOOTH * fps), 1))
    for leg, target, height in zip(legs, targets, above, strict=True):
        target[:, 1] += raised + _lacking(leg, height + raised, blend)
    placed = {joint: place + raised[:, None] * _UP for joint, place in placed.items()}
    lifted = strung(puppet.character, puppet.turns, anchor, placed)
    sunk = _sinking(lifted, legs, targets, round(_SINKING * fps))
    placed[anchor] = placed[anchor] - sunk[:, None] * _UP
    lowered = strung(puppet.character, puppet.turns, anchor, placed)
    turns = lowered.turns.copy()
    for leg, target in zip(legs, targets, strict=True):
        _bend(lowered, leg, target, turns)
    return strung(puppet.character, turns, anchor, placed), raised, sunk


def floor_of(soles: Sequence[Sole]) -> float:
    """Height of the soles at rest."""
    return float(min(sole.rest[:, 1].min() for sole in soles))


def on_ground(legs: Sequence[Leg], frame_time: float) -> list[Leg]:
    """The legs with only those contacts that are with the ground."""
    around = round(_NEARBY / frame_time) if frame_time else 0
    lower = np.min([leg.steps.ball[:, 1] for leg in legs], axis=0)

    def is_low(steps: Steps, one: Contact) -> bool:
        lowest = lower[max(one.first - around, 0) : one.end + around].min()
        return bool(np.median(steps.ball[one.first : one.end, 1]) <= lowest + _GROUND * steps.metre)

    held = [tuple(one for one in leg.steps.contacts if is_low(leg.steps, one)) for leg in legs]
    steps = [replace(leg.steps, contacts=own) for leg, own in zip(legs, held, strict=True)]
    return [replace(leg, steps=own) for leg, own in zip(legs, steps, strict=True)]


def _ankle(leg: Leg, blend: int) -> Floats:
    """(F, 3) where the ankle is to be.

    A foot of another shape is turned about its ball rather than its ankle, in contacts: with ``d`` what the
    motion's vector to the ball has over the character's, the ankle is moved by ``F d`` less what that is
    while the foot is flat. The heading of that flat foot is held, so that the ball does not slide where it
    turns.
    """
    steps = leg.steps
    if leg.vector is None:
        return steps.ankle.copy()
    more = steps.vector - leg.vector
    heading = np.unwrap(2 * np.arctan2(steps.turn[:, 1], steps.turn[:, 3]))
    held = np.zeros((len(heading), 1))
    for one in steps.contacts:
        there = heading[one.first : one.end]
        held[one.first : one.end, 0] = np.median(there) - there
    held = eased(held, [(one.first, one.end) for one in steps.contacts], blend)
    moved = rotated(steps.turn, more) - rotated(about(_UP, heading + held[:, 0]), more)
    return steps.ankle + _contact_weights(leg, blend)[:, None] * moved


def _contact_weights(leg: Leg, blend: int) -> Floats:
    """(F,) 1 in contacts, 0 away from them."""
    count = len(leg.steps.ball)
    weights = [blend_weights(count, one.first, one.end, blend) for one in leg.steps.contacts]
    return np.asarray(np.max([np.zeros(count), *weights], axis=0), np.float64)


def _heights_at(puppet: Puppet, leg: Leg, sole: Sole, ankle: Floats) -> Floats:
    """(F,) height of the sole with the ankle there."""
    places = puppet.places + (ankle - puppet.places[:, leg.ankle])[:, None]
    return heights(sole, puppet.turns, places)


def _raised(legs: Sequence[Leg], above: Sequence[Floats], width: int) -> Floats:
    """(F,) by how much the whole is raised: what the contacts lack, each in the middle, and smoothly from one
    to the next, for the floor of a recording may slope by centimetres; without contacts, what the lowest
    frame lacks."""
    count = len(above[0])
    lacking = sorted(
        ((one.first + one.end - 1) / 2, -float(np.median(height[one.first : one.end])))
        for leg, height in zip(legs, above, strict=True)
        for one in leg.steps.contacts
    )
    if not lacking:
        return np.full(count, -float(min(height.min() for height in above)))
    frames, values = zip(*lacking, strict=True)
    window = np.hanning(2 * width + 3)[1:-1]
    padded = np.pad(np.interp(np.arange(count), frames, values), width, mode="edge")
    return np.convolve(padded, window / window.sum(), mode="valid")


def _lacking(leg: Leg, height: Floats, blend: int) -> Floats:
    """(F,) what the foot is raised by: to the ground in contacts, out of it elsewhere, smoothly between."""
    weight = _contact_weights(leg, blend)
    return weight * -height + (1 - weight) * np.maximum(-height, 0)


def _sinking(puppet: Puppet, legs: Sequence[Leg], targets: Sequence[Floats], width: int) -> Floats:
    """(F,) by how much the hips must sink for the legs to reach: ``h - sqrt(l^2 - r^2)``, smoothed."""
    lacking = np.zeros(len(puppet.places))
    for leg, target in zip(legs, targets, strict=True):
        longest = _longest(puppet, leg)
        apart = puppet.places[:, leg.hip] - target
        beside = apart[:, 0] ** 2 + apart[:, 2] ** 2
        needed = apart[:, 1] - np.sqrt(np.maximum(longest * longest - beside, 0))
        is_short = np.linalg.norm(apart, axis=1) > longest * (1 + 1e-9)
        lacking = np.maximum(lacking, np.where(is_short, np.clip(needed, 0, 0.25 * longest), 0))
    return smooth_above(lacking, width)


def _longest(puppet: Puppet, leg: Leg) -> Floats:
    """(F,) how far the ankle may be from the hip."""
    hip, knee, ankle = (puppet.places[:, joint] for joint in (leg.hip, leg.knee, leg.ankle))
    straight = np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(ankle - knee, axis=1)
    return np.asarray(
        np.maximum(np.linalg.norm(ankle - hip, axis=1), _NEARLY_STRAIGHT * straight), np.float64
    )


def _bend(puppet: Puppet, leg: Leg, target: Floats, turns: Floats) -> None:
    """Turns thigh and shin, and what hangs on them above the ankle, into ``turns``."""
    hip, knee, ankle = (puppet.places[:, joint] for joint in (leg.hip, leg.knee, leg.ankle))
    hinge = rotated(puppet.turns[:, leg.hip], leg.hinge)
    solved = two_bone(hip, knee, ankle, target, hinge)
    parents = puppet.character.joint_parents
    for joint in puppet.character.skeleton.parents_first:
        above = _ancestry(parents, joint)
        if leg.ankle in above:
            continue
        if leg.knee in above:
            turns[:, joint] = multiply(solved.lower, puppet.turns[:, joint])
        elif leg.hip in above:
            turns[:, joint] = multiply(solved.upper, puppet.turns[:, joint])


def _ancestry(parents: NDArray[np.int32], joint: int) -> set[int]:
    """The joint and all above it."""
    found = set()
    while joint >= 0:
        found.add(joint)
        joint = int(parents[joint])
    return found


def measured_feet(puppet: Puppet, legs: Sequence[Leg]) -> tuple[FootReport, ...]:
    """How the feet stand in the contacts of the motion."""
    soles = [sole_of(puppet.character, leg.ankle) for leg in legs]
    floor = floor_of(soles)
    found = []
    for leg, sole in zip(legs, soles, strict=True):
        height = heights(sole, puppet.turns, puppet.places) - floor
        ball = puppet.places[:, leg.ankle if leg.toe is None else leg.toe]
        contacts = leg.steps.contacts
        off = [np.abs(height)[one.first : one.end].max() for one in contacts]
        ways = [
            (slide(leg.steps.ball[one.first : one.end], _UP), slide(ball[one.first : one.end], _UP))
            for one in contacts
        ]
        theirs, mine = np.mean(ways, axis=0) if ways else (0.0, 0.0)
        found.append(
            FootReport(
                leg.side,
                len(contacts),
                1000 * float(theirs),
                1000 * float(mine),
                1000 * float(max(off, default=0.0)),
                1000 * float(height.min(initial=np.inf)) if len(height) else 0.0,
            )
        )
    return tuple(found)
