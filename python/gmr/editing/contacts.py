"""Contacts: when feet are on the ground, told by how high and how fast they are.

A joint is in contact while it is low and slow. Two pairs of thresholds make that steady: a contact holds a
frame that meets the strict pair, and reaches as far around it as the loose pair is met, as edges are found
in pictures. Source: Canny, "A Computational Approach to Edge Detection" (1986), hysteresis.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.editing.roles import body_roles
from gmr.editing.scene import Scene, scene_of
from gmr.errors import DatasetError, GmrError, SkeletonError
from gmr.motion import Motion
from gmr.tpose import leading_rest_frames

__all__ = ["Contact", "Contacts", "contacts", "resting", "slide"]

Joint = str | int | np.integer[Any]
Floats = NDArray[np.float64]

_SPEED_OVER = 1 / 30
"""Seconds over which a speed is measured: the noise of single frames is no movement."""

_RESTING = 0.1
"""Quantile of a joint's heights while it is slow that counts as its height on the ground."""

_STEP = 0.6
"""Seconds before and after a frame within which a foot that walks or runs has been on the ground."""


@dataclass(frozen=True, order=True, slots=True)
class Contact:
    """A joint rests on the ground from the frame ``first`` to before the frame ``end``."""

    joint: str
    first: int
    end: int

    def __len__(self) -> int:
        return self.end - self.first


@dataclass(frozen=True)
class Contacts:
    """All contacts of a motion, by joint and then in time; iterates over them.

    Args:
        intervals: the contacts.
        joints: the joints that were looked at.
        frame_count: F.
        scene: unit and up axis that were used.
    """

    intervals: tuple[Contact, ...]
    joints: tuple[str, ...]
    frame_count: int
    scene: Scene

    def __iter__(self) -> Iterator[Contact]:
        return iter(self.intervals)

    def __len__(self) -> int:
        return len(self.intervals)

    def of(self, joint: str) -> tuple[Contact, ...]:
        """The contacts of one joint, in time."""
        return tuple(contact for contact in self.intervals if contact.joint == joint)

    @property
    def mask(self) -> NDArray[np.bool_]:
        """(F, K) whether each of :attr:`joints` is in contact."""
        found = np.zeros((self.frame_count, len(self.joints)), bool)
        for contact in self.intervals:
            found[contact.first : contact.end, self.joints.index(contact.joint)] = True
        return found

    def __str__(self) -> str:
        lines = [f"{one.joint}: {one.first} to {one.end - 1}" for one in self.intervals]
        return "\n".join(lines) or f"no contacts of {', '.join(self.joints)}"


def contacts(
    motion: Motion,
    joints: Iterable[Joint] | None = None,
    *,
    height: tuple[float, float] = (0.03, 0.04),
    speed: tuple[float, float] = (0.3, 0.6),
    least: float = 0.08,
    ground: float | None = None,
    uneven: float = 0.06,
    names: Mapping[str, str | int] | None = None,
) -> Contacts:
    """When joints rest on the ground.

    Args:
        motion: any; there are no contacts in what a converter put before the recording, nor where the pose is
            not known (NaN).
        joints: names or indices; by default the ball of each foot (the toe joint), or the ankle where the
            skeleton has no toes. See :mod:`gmr.body.joints`.
        height: metres above the joint's height on the ground: below the first a contact may begin, above the
            second it is over.
        speed: metres a second, in the same way.
        least: seconds; shorter contacts are left out.
        ground: height in file units at which a joint counts as 0 m high; by default each joint's own height
            where it rests nearby, so that an ankle and a toe can have the same thresholds.
        uneven: metres by which the ground may be higher from step to step than where the joint rests lowest:
            errors of a few centimetres in recordings, more on stairs.
        names: joints by role, where the feet are not found by their names: ``{"left_foot": "foot_l", ...}``.

    Raises:
        SkeletonError: a joint does not exist.
        DatasetError: the feet are not found; the message says how to name them.
        GmrError: the unit is unknown and cannot be guessed, a frame lasts 0 s, or a threshold makes no sense.
    """
    _check(height, speed, least)
    if motion.frame_time == 0:
        raise GmrError(
            f"{motion.name or 'this motion'} has a frame time of 0, so its joints have no speed, which "
            "contacts are told by; give it one: dataclasses.replace(motion, frame_time=1 / 30)"
        )
    scene = scene_of(motion)
    unit = scene.unit.per_metre("telling contacts by metres and metres a second")
    chosen = _feet(motion, names) if joints is None else motion.skeleton.indices(joints).tolist()
    labels = tuple(motion.skeleton.names[joint] for joint in chosen)
    if len(set(chosen)) < len(chosen):
        raise SkeletonError(f"a joint is named twice: {', '.join(labels)}; name each once")
    lead = leading_rest_frames(motion)
    places = motion.positions(dtype=np.float64, joints=chosen)[lead:] / unit
    level = None if ground is None else ground / unit
    rests = resting(places, scene.up_vector, motion.frame_time, height, speed, least, level, uneven)
    found = [
        Contact(name, first + lead, end + lead)
        for name, runs in zip(labels, rests, strict=True)
        for first, end in runs
    ]
    return Contacts(tuple(found), labels, motion.frame_count, scene)


def resting(
    places: Floats,
    up: Floats,
    frame_time: float,
    height: tuple[float, float] = (0.03, 0.04),
    speed: tuple[float, float] = (0.3, 0.6),
    least: float = 0.08,
    ground: float | None = None,
    uneven: float = 0.06,
) -> list[list[tuple[int, int]]]:
    """When joints rest on the ground, from their places alone; see :func:`contacts`.

    Args:
        places: (F, K, 3) metres.
        up: (3,) the vertical.
        frame_time: seconds from a frame to the next.
        height, speed, least, uneven: as of :func:`contacts`.
        ground: metres, likewise.

    Returns:
        For each of the K joints its stretches on the ground, first frame and frame after the last, in time.
    """
    if len(places) == 0:
        return [[] for _ in range(places.shape[1])]
    speeds = _speeds(places, frame_time)
    heights = places @ up
    if ground is None:
        around = min(round(_STEP / frame_time), len(heights))
        heights -= _levels(heights, speeds, speed[0], uneven, around)
    else:
        heights -= ground
    strict = (heights <= height[0]) & (speeds <= speed[0])
    loose = (heights <= height[1]) & (speeds <= speed[1])
    frames = max(round(least / frame_time), 1)
    return [
        [run for run in _runs_with(loose[:, k], strict[:, k]) if run[1] - run[0] >= frames]
        for k in range(places.shape[1])
    ]


def slide(places: Floats, up: Floats) -> float:
    """Length of the way that a joint goes along the ground, in the unit of its (F, 3) places."""
    steps = np.diff(places, axis=0)
    level = steps - (steps @ up)[:, None] * up
    return float(np.linalg.norm(level, axis=1).sum())


def _feet(motion: Motion, names: Mapping[str, str | int] | None) -> list[int]:
    """The toe of each foot, or the foot."""
    try:
        roles = body_roles(motion, names)
    except DatasetError as error:
        raise DatasetError(f"no feet found: {error}") from None
    return [roles.get(f"{side}_toe", roles[f"{side}_foot"]) for side in ("left", "right")]


def _speeds(places: Floats, frame_time: float) -> Floats:
    """(F, K) speeds by central differences, one-sided at the ends."""
    frames = np.arange(len(places))
    half = max(round(_SPEED_OVER / frame_time / 2), 1)
    after, before = np.minimum(frames + half, len(frames) - 1), np.maximum(frames - half, 0)
    seconds = (after - before) * frame_time
    ways = np.linalg.norm(places[after] - places[before], axis=2)
    return np.asarray(ways / np.where(seconds > 0, seconds, 1.0)[:, None], np.float64)


def _levels(heights: Floats, speeds: Floats, slow: float, uneven: float, around: int) -> Floats:
    """(F, K) height of the ground under each joint, as its heights while it is slow show it.

    It is the lowest of those within ``around`` frames, but at most ``uneven`` above where it rests in the
    whole motion: a foot that is held up for long stands on nothing.
    """
    resting = np.where(speeds <= slow, heights, np.inf)
    slowest = np.where(np.isinf(resting).all(axis=0), heights, resting)
    usual = np.quantile(slowest, _RESTING, axis=0, method="lower")
    padded = np.pad(resting, ((around, around), (0, 0)), constant_values=np.inf)
    lowest = np.lib.stride_tricks.sliding_window_view(padded, 2 * around + 1, axis=0).min(axis=-1)
    return np.asarray(np.minimum(lowest, usual + uneven), np.float64)


def _runs_with(loose: NDArray[np.bool_], strict: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The runs of ``loose`` frames in which at least one is ``strict`` too."""
    edges = np.diff(np.concatenate([[False], loose, [False]]).astype(np.int8))
    begins, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    counts = np.concatenate([[0], np.cumsum(strict & loose)])
    held = counts[ends] > counts[begins]
    return list(zip(begins[held].tolist(), ends[held].tolist(), strict=True))


def _check(height: tuple[float, float], speed: tuple[float, float], least: float) -> None:
    for what, (strict, loose) in (("height", height), ("speed", speed)):
        if not 0 < strict <= loose:
            raise GmrError(
                f"{what}={(strict, loose)}: the first threshold must be above 0 and not above the second: a "
                "contact begins below the first and ends above the second"
            )
    if not least >= 0:
        raise GmrError(f"least={least}: a contact cannot be shorter than 0 seconds")
