"""What a dataset is made of, decided for all its clips at once: one skeleton, its joints, up axis, units,
root."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from gmr.body.joints import Joints, find_joints
from gmr.body.measures import Poses, turned_upright, up_axis
from gmr.errors import DatasetError
from gmr.forest import home
from gmr.listing import quoted
from gmr.matching.oddities import axes_apart, oddities
from gmr.matching.prepare import in_metres_upright
from gmr.matching.root import RootJoint, find_root_joint, joints_left_behind
from gmr.matching.unit_guesses import middle, units_of
from gmr.motion import Motion
from gmr.skeleton import Skeleton
from gmr.tpose import leading_rest_frames

__all__ = ["Survey", "axis_note", "difference", "ground_note", "survey"]

_FARTHEST = 1e9
"""File units, or degrees, beyond which the bones of a body vanish in rounding."""

_SAMPLES = 12
"""Poses of each clip that decide on joints, up axis and unit."""


_PRINTED = 1e-4
"""Share by which a frame time may be off for being cut in print."""

_APART = "Clips of another skeleton can be evaluated by themselves: give them a folder of their own."

_ABOUT_GROUND = 0.1
"""Metres within which the lowest joints of a body that stands on the ground are expected."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The clips that can be used, and what holds for all of them."""

    motions: Mapping[str, Motion]
    """By name, without a converter's T-pose, else as read."""
    skipped: Mapping[str, int]
    """Frames left out at the beginning of a clip, where there are any."""
    samples: Mapping[str, Motion]
    """Some frames of each clip."""
    skeleton: Skeleton
    """That of the first clip; names, parents and slots are those of all."""
    joints: Joints
    up: str
    """The axis that is up in the files, such as ``"+Y"``."""
    units: Mapping[str, float]
    """Metres per file unit of each clip."""
    lowest: float
    """Height on which the lowest joints stand in the middle one of the clips, metres."""
    root: RootJoint | None
    """The joint that already is a simulation root, None where one is made."""
    left_behind: tuple[int, ...]
    """Joints above the hips that stay behind in the world when the body walks away, the uppermost first."""
    excluded: dict[str, str]
    """Clips left out, by name, and why; those that cannot be assembled join them."""
    tell: Callable[[Container[str]], Iterator[str]]
    """What was guessed or done, in sentences that speak of no clip that is left out."""

    @property
    def floor(self) -> float:
        """Height of the ground in the files, metres; 0 where it is near 0."""
        return self.lowest if abs(self.lowest) > _ABOUT_GROUND else 0.0

    @property
    def notes(self) -> tuple[str, ...]:
        """What was guessed or done with the clips that are not left out, in sentences."""
        return tuple(self.tell(self.excluded))


def survey(
    motions: Mapping[str, Motion],
    shortest: float,
    names: Mapping[str, str | int] | None = None,
    unit: float | str | None = None,
) -> Survey:
    """Looks through the clips of a dataset.

    Args:
        motions: clips by name.
        shortest: seconds that a clip must last for a frame of it to be matched.
        names: joints by role, where the caller knows them; see :func:`gmr.body.joints.find_joints`.
        unit: metres per file unit (or "cm", ...) of clips that do not say; guessed from the body by default.

    Raises:
        DatasetError: no clip is usable or long enough, the clips have different skeletons, or the skeleton
        has no known body.
    """
    usable, excluded = _usable({name: home(motion) for name, motion in motions.items()})
    usable, skipped = _without_tposes(usable)
    usable, skeleton_notes = _on_one_skeleton(usable, excluded)
    _check_lengths(usable, shortest)
    sampled = {name: motion[:: max(1, motion.frame_count // _SAMPLES)] for name, motion in usable.items()}
    poses = {name: np.asarray(motion.positions(dtype=np.float64)) for name, motion in sampled.items()}
    skeleton = next(iter(usable.values())).skeleton
    pooled = _pooled(skeleton, poses.values())
    joints = _joints(skeleton, pooled, poses, names)
    up = up_axis(pooled, joints.roles)
    units, unit_notes = units_of(usable, poses, joints, unit, excluded)
    usable, sampled = ({name: of[name] for name in units} for of in (usable, sampled))
    poses = {name: poses[name] for name in units}
    skeleton = next(iter(usable.values())).skeleton
    upright = [turned_upright(clip * units[name], up) for name, clip in poses.items()]
    clips = (in_metres_upright(motion, units[name], up) for name, motion in sampled.items())
    root = find_root_joint(skeleton, joints, upright, clips)
    lowest = _lowest(upright)

    def tell(left_out: Container[str]) -> Iterator[str]:
        left = {name: motion for name, motion in usable.items() if name not in left_out}
        yield from _tpose_notes(left, skipped)
        yield from skeleton_notes
        yield from _short_notes(left, shortest)
        yield from oddities(left, {name: poses[name] for name in left}, joints.roles, up)
        yield from _joint_notes(skeleton, joints, root)
        yield from unit_notes
        if up != "+Y":
            yield axis_note(up)
        if seen.floor:
            yield ground_note(seen.floor)

    seen = Survey(
        motions=usable,
        skipped=skipped,
        samples=sampled,
        skeleton=skeleton,
        joints=joints,
        up=up,
        units=units,
        lowest=lowest,
        root=root,
        left_behind=joints_left_behind(skeleton, joints, upright),
        excluded=excluded,
        tell=tell,
    )
    return seen


def axis_note(up: str) -> str:
    """That files with another up axis than +Y are read as if they had it."""
    return f"The files have {up} up; they were turned to +Y."


def ground_note(floor: float) -> str:
    """That files whose ground lies elsewhere than at 0 are read as if it lay there."""
    return f"The ground of the files lies at {floor:.2f} m; they were moved to have it at 0."


def _usable(motions: Mapping[str, Motion]) -> tuple[dict[str, Motion], dict[str, str]]:
    """The clips that move and hold finite numbers, and why the others are left out."""
    excluded: dict[str, str] = {}
    for name, motion in motions.items():
        reason = _unusable(motion)
        if reason is not None:
            excluded[name] = reason
    usable = {name: motion for name, motion in motions.items() if name not in excluded}
    if not usable:
        why = "; ".join(f"'{name}': {reason}" for name, reason in list(excluded.items())[:5])
        raise DatasetError(f"there is no clip to evaluate ({why})" if why else "there is no motion at all")
    return usable, excluded


def _unusable(motion: Motion) -> str | None:
    if motion.frame_time <= 0:
        return "its frame time is 0; say how long a frame lasts"
    if motion.frame_count == 0:
        return "it holds no frames; export it again, with the movement"
    if motion.frame_count < 2:
        return "it is a pose, not a movement: a clip has at least 2 frames"
    if not all(np.isfinite(values).all() for values in motion.source.numbers):
        return "it holds numbers that are not finite"
    largest = max(float(np.abs(values).max(initial=0.0)) for values in motion.source.numbers)
    if largest > _FARTHEST:
        return f"it holds a number as large as {largest:.3g}, where no body can be; mend the file"
    return None


def _check_lengths(motions: Mapping[str, Motion], shortest: float) -> None:
    """Raises :class:`gmr.DatasetError` where all clips are too short to be matched."""
    if len(_short(motions, shortest)) == len(motions):
        longest = max(motions, key=lambda name: _seconds(motions[name]))
        raise DatasetError(
            f"no clip lasts the {shortest:.2f} s of a pose and the path ahead of it, so no frame can be "
            f"matched; the longest, '{longest}', lasts {_seconds(motions[longest]):.2f} s. Give longer takes"
        )


def _short_notes(motions: Mapping[str, Motion], shortest: float) -> Iterator[str]:
    """Names the clips that are too short to be matched; their frames count for coverage all the same."""
    short = _short(motions, shortest)
    if short:
        yield (
            f"Shorter than the {shortest:.2f} s of a pose and the path ahead of it, and so counted for "
            f"coverage but never matched: {len(short)} of {len(motions)} clips ({quoted(short, 3)})."
        )


def _short(motions: Mapping[str, Motion], shortest: float) -> list[str]:
    return [name for name, motion in motions.items() if _seconds(motion) < shortest * (1 - _PRINTED)]


def _seconds(motion: Motion) -> float:
    return (motion.frame_count - 1) * motion.frame_time


def _without_tposes(motions: dict[str, Motion]) -> tuple[dict[str, Motion], dict[str, int]]:
    """The clips from where the recording begins, and how many frames that skips."""
    skipped = {name: leading_rest_frames(motion) for name, motion in motions.items()}
    skipped = {name: frames for name, frames in skipped.items() if frames}
    return {name: motion[skipped.get(name, 0) :] for name, motion in motions.items()}, skipped


def _tpose_notes(motions: Mapping[str, Motion], skipped: Mapping[str, int]) -> Iterator[str]:
    begun = [name for name in skipped if name in motions]
    if begun:
        clips = "The one clip" if len(motions) == 1 else f"{len(begun)} of {len(motions)} clips"
        yield (
            f"{clips} {'begins' if len(begun) == 1 else 'begin'} with a T-pose that a converter added "
            f"(whole-number angles, then a jump of the whole body); it was left out ({quoted(begun, 3)})."
        )


def _on_one_skeleton(
    motions: dict[str, Motion], excluded: dict[str, str]
) -> tuple[dict[str, Motion], list[str]]:
    """The clips of the skeleton that most of the recorded time has, and a note on the others.

    Skeletons are alike that have the same joints on the same parents; bones may differ in length. The others
    join ``excluded``.

    Raises:
        DatasetError: no skeleton has more than half of the time.
    """
    kinds: dict[tuple[object, ...], list[str]] = {}
    for name, motion in motions.items():
        skeleton = motion.skeleton
        kind = (skeleton.names, skeleton.parents.tobytes(), skeleton.slots.tobytes())
        kinds.setdefault(kind, []).append(name)
    if len(kinds) == 1:
        return motions, []
    seconds = {kind: sum(motions[name].duration for name in clips) for kind, clips in kinds.items()}
    main = max(seconds, key=lambda kind: seconds[kind])
    usual = motions[kinds[main][0]].skeleton
    others = [name for kind, clips in kinds.items() if kind != main for name in clips]
    if seconds[main] <= 0.5 * sum(seconds.values()):
        groups = "; ".join(f"{quoted(clips, 3)}" for clips in kinds.values())
        raise DatasetError(
            f"the clips have {len(kinds)} different skeletons ({groups}), none with more than half of the "
            f"time. {_APART}"
        )
    for name in others:
        other = difference(usual, motions[name].skeleton)
        excluded[name] = f"another skeleton than that of the clips evaluated, {other}"
    note = (
        f"The clips have {len(kinds)} skeletons that differ in their joints (bones may differ in length); "
        f"{len(kinds[main])} of {len(motions)} clips have the one of most of the time, and only these were "
        f"evaluated. {_APART}"
    )
    return {name: motions[name] for name in kinds[main]}, [note]


def difference(usual: Skeleton, odd: Skeleton) -> str:
    """What joints a skeleton has otherwise than the usual one: "without 'Toe' and with 'Finger' besides"."""
    lacking = [name for name in usual.names if name not in odd.names]
    added = [name for name in odd.names if name not in usual.names]
    parts = [f"without {quoted(lacking, 3)}"] if lacking else []
    parts += [f"with {quoted(added, 3)} besides"] if added else []
    return " and ".join(parts) or "with the joints in another order or on other parents"


def _pooled(skeleton: Skeleton, poses: Iterable[Poses]) -> Poses:
    """Poses of all clips together, each clip scaled by its mean bone, for files may differ in unit."""
    inner = np.flatnonzero(skeleton.parents >= 0)
    scaled = []
    for clip in poses:
        bones = np.linalg.norm(clip[:, inner] - clip[:, skeleton.parents[inner]], axis=2).mean(axis=0)
        scaled.append(clip / max(bones.mean(), 1e-12))
    return np.concatenate(scaled)


def _joints(
    skeleton: Skeleton, pooled: Poses, poses: Mapping[str, Poses], names: Mapping[str, str | int] | None
) -> Joints:
    """The joints of the body, from the poses of all clips together.

    Raises:
        DatasetError: they are not found; where the clips stand along different axes, because of that.
    """
    try:
        return find_joints(skeleton, pooled, names)
    except DatasetError as error:
        apart = axes_apart(skeleton, poses, names)
        raise (DatasetError(apart) if apart else error) from error


def _lowest(upright: Iterable[Poses]) -> float:
    """Height on which the lowest joints stand in the middle one of the clips."""
    return middle([float(np.sort(clip[:, :, 1].min(axis=1))[len(clip) // 10]) for clip in upright])


def _joint_notes(skeleton: Skeleton, joints: Joints, root: RootJoint | None) -> list[str]:
    notes = []
    if joints.found_by == "shape":
        named = ", ".join(f"{role} '{name}'" for role, name in joints.described(skeleton).items())
        notes.append(f"The joints' names are not known; the body's shape gave {named}.")
    if root is not None:
        name = skeleton.names[root.joint]
        notes.append(
            f"Joint '{name}' lies on the ground and goes with the body: it is used as the simulation root."
        )
    return notes
