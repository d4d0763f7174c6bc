"""What is drawn of one motion or one character: plain arrays in metres, Y up, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.body.measures import turned_upright
from gmr.body.naming import HANDS, side_and_part
from gmr.bone_tails import bones
from gmr.errors import GmrError
from gmr.guesses import guess_body
from gmr.skinning import drive
from gmr.tpose import leading_rest_frames
from gmr.view.fitting import fitted_poses, misfit

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skeleton import Skeleton
    from gmr.skinning.character import Character

__all__ = ["Figure", "Trail", "Worn", "finite_poses", "motion_figure", "posed_figure"]

Floats = NDArray[np.float32]

_SAMPLES = 40
"""Frames in which the extent of a skin is measured."""
_RATE = 30.0
"""Frames a second of a pose sequence that says nothing of time."""


@dataclass(frozen=True, eq=False)
class Trail:
    """The way of one joint."""

    joint: str
    places: Floats
    """(F, 3); NaN where it is not known."""


@dataclass(frozen=True, eq=False)
class Worn:
    """A character and how its joints stand in every frame."""

    character: Character
    poses: NDArray[np.float64]
    """(F, J, 4, 4) world matrices of the character's joints; NaN where a pose is not known."""


@dataclass(frozen=True, eq=False)
class Figure:
    """Something that moves: B bones over F frames, their trails, and what is worn over them.

    Raises:
        GmrError: there are no frames, or nothing in them can be drawn.
    """

    name: str
    frame_time: float
    """Seconds; above 0."""
    heads: Floats
    """(F, B, 3) metres, Y up; NaN where a pose is not known."""
    tails: Floats
    """(F, B, 3)"""
    sides: tuple[str, ...]
    """(B,) "left", "right" or "" by the name of each bone's joint."""
    trails: tuple[Trail, ...] = ()
    worn: Worn | None = None
    notes: tuple[str, ...] = ()
    """What was guessed or left out on the way here, as sentences."""

    def __post_init__(self) -> None:
        if not self.frame_count:
            raise GmrError(f"{self.name} has no frames, so there is nothing to show")
        if not self.known.any():
            raise GmrError(f"{self.name}: no pose is known (all hold NaN), so there is nothing to show")
        if not self.heads.shape[1] and self.worn is None:
            raise GmrError(f"{self.name} has no bones and no skin, so there is nothing to draw")

    @property
    def frame_count(self) -> int:
        """F."""
        return len(self.heads)

    @cached_property
    def known(self) -> NDArray[np.bool_]:
        """(F,) whether anything of a frame can be drawn."""
        drawn = np.asarray(_finite(self.heads, self.tails).any(axis=1), np.bool_)
        if self.worn is None:
            return drawn
        return drawn | finite_poses(self.worn.poses)

    @cached_property
    def box(self) -> tuple[Floats, Floats]:
        """(3,) lowest and highest corner of everything that is known, over all frames."""
        places = [
            self.heads[np.isfinite(self.heads).all(axis=-1)],
            self.tails[np.isfinite(self.tails).all(axis=-1)],
        ]
        if self.worn is not None:
            places.append(self._skin_places())
        found = np.concatenate(places)
        return found.min(axis=0), found.max(axis=0)

    def _skin_places(self) -> Floats:
        """(n, 3) the skin in some known frames from all over."""
        assert self.worn is not None
        known = np.flatnonzero(finite_poses(self.worn.poses))
        chosen = known[np.unique(np.linspace(0, len(known) - 1, min(len(known), _SAMPLES)).astype(int))]
        return np.asarray(self.worn.character.skin(self.worn.poses[chosen]).reshape(-1, 3), np.float32)


def motion_figure(
    motion: Motion,
    character: Character | None = None,
    *,
    rule: str = "per_child",
    unit: float | None = None,
    name: str | None = None,
) -> Figure:
    """The figure of a motion.

    A motion that does not say its unit, or whose Y is not up, is guessed at as ``gmr info`` does, and
    :attr:`Figure.notes` tell; so are frames that hold NaN.

    Args:
        motion: at least one frame.
        character: a skin for it. Where the motion is of the character's own skeleton, it is put over that;
            else the motion drives the character (:func:`gmr.skinning.drive`), whose own bones are drawn then.
        rule: how bones are drawn, as :func:`gmr.bones` has it.
        unit: metres per file unit, which goes before what the motion says.
        name: what to call it; the name of its file by default.

    Raises:
        GmrError: there are no frames, no pose is known, no rule is called so, or the motion cannot
            drive the character.
    """
    called = name or Path(motion.name or "motion").name
    if not motion.frame_count:
        raise GmrError(f"{called} has no frames, so there is nothing to show")
    scale, up, notes = _scale_and_up(motion, unit)
    if character is not None and misfit(character, motion, scale, up) is not None:
        driven = drive(motion.with_unit(scale), character)
        figure = posed_figure(character, driven.poses, driven.frame_time, rule=rule, name=called)
        follow = (
            f"{len(driven.report.follows)} of {len(character.joints)} joints of '{character.name}' follow it"
        )
        return replace(figure, notes=(*notes, follow, *figure.notes))
    home = motion.skeleton.home or motion.skeleton
    segments = bones(motion, rule, slice(None))
    wanted = _trailed(home)
    paths = motion.positions(joints=wanted, dtype=np.float64)
    paths[: leading_rest_frames(motion)] = np.nan  # nobody moved there from a pose that a converter added

    def placed(places: NDArray[np.float64]) -> Floats:
        return (turned_upright(places, up) * scale).astype(np.float32)

    ends = _ends(home, rule, segments.joints)
    figure = Figure(
        name=called,
        frame_time=motion.frame_time or 1 / _RATE,
        heads=placed(segments.heads),
        tails=placed(segments.tails),
        sides=tuple(side_and_part(home.names[end])[0] for end in ends),
        trails=tuple(Trail(home.names[joint], placed(paths[:, k])) for k, joint in enumerate(wanted)),
        notes=(
            *notes,
            *([] if motion.frame_time else [f"it has no rate; it is shown at {_RATE:g} a second"]),
        ),
    )
    if character is not None:
        figure = replace(figure, worn=Worn(character, fitted_poses(character, motion, scale, up)))
    return replace(figure, notes=(*figure.notes, *_unknown(figure)))


def posed_figure(
    character: Character,
    poses: ArrayLike | None = None,
    frame_time: float | None = None,
    *,
    animation: str | int = 0,
    rule: str = "per_child",
    name: str | None = None,
) -> Figure:
    """The figure of a character, in given poses or as its own animation moves it.

    Args:
        character: of J joints.
        poses: (F, J, 4, 4) world matrices of its joints, metres, Y up; left out: the animation, or the pose
            at rest where the character has none.
        frame_time: seconds, for ``poses``; a thirtieth where left out.
        animation: name or index, where no poses are given.
        rule: how bones are drawn.
        name: what to call it.

    Raises:
        GmrError: the poses have another shape or are none, or there is no such animation.
    """
    from gmr.skinning.as_motion import joint_motion

    called = name or character.name or "character"
    seconds = 1 / _RATE if frame_time is None else float(frame_time)
    notes: list[str] = []
    if poses is not None:
        found = np.asarray(poses, np.float64)
    elif character.animations:
        clip = character.find_animation(animation)
        found, seconds = character.animation(character.animations.index(clip)), 1 / clip.fps
        if len(character.animations) > 1:
            notes.append(f"of {len(character.animations)} animations '{clip.name}' is shown")
    else:
        found = character.rest_pose()[None]
        notes.append("it has no animation; it is shown at rest")
    if found.ndim != 4 or found.shape[1:] != (len(character.joints), 4, 4):
        raise GmrError(
            f"{called}: poses have the shape {found.shape}; "
            f"they must be (frames, {len(character.joints)}, 4, 4)"
        )
    if not seconds > 0:
        raise GmrError(f"{called}: a frame cannot last {seconds:g} seconds; give more than 0")
    known = finite_poses(found)
    if not known.any():
        what = "has no frames" if not len(found) else "has no pose that is known (all hold NaN)"
        raise GmrError(f"{called} {what}, so there is nothing to show")
    whole = np.where(known[:, None, None, None], found, found[known][0])
    moved = motion_figure(joint_motion(character, whole, seconds).motion, rule=rule, unit=1.0, name=called)
    gaps = np.where(known, 0.0, np.nan).astype(np.float32)[:, None, None]
    figure = replace(
        moved,
        heads=moved.heads + gaps,
        tails=moved.tails + gaps,
        trails=tuple(replace(trail, places=trail.places + gaps[:, 0]) for trail in moved.trails),
        worn=Worn(character, found) if character.skinned_parts else None,
        notes=tuple(notes),
    )
    return replace(figure, notes=(*figure.notes, *_unknown(figure)))


def _scale_and_up(motion: Motion, unit: float | None) -> tuple[float, str, list[str]]:
    """Metres per file unit, the axis that is up, and what was guessed."""
    notes = []
    guess = guess_body(motion)
    scale = unit or motion.unit
    if scale is None and guess.unit is not None:
        scale = guess.unit.metres
        notes.append(
            f"its unit is not said; taken for {guess.unit.name} ({scale:.4g} m), "
            f"a guess from the {guess.unit.by}"
        )
    elif scale is None:
        scale = 1.0
        notes.append("its unit is not said, and none makes it a human: it is drawn as if in metres")
    up = "+Y"
    if guess.up is not None and guess.up.sure and guess.up.axis != "+Y":
        up = guess.up.axis
        notes.append(f"{up} is up in it; it is turned so that Y is")
    return scale, up, notes


def _unknown(figure: Figure) -> list[str]:
    missing = int((~figure.known).sum())
    return [f"{missing} of {figure.frame_count} frames hold NaN; nothing is drawn in them"] if missing else []


def _trailed(skeleton: Skeleton) -> list[int]:
    """The joints whose ways are drawn: the roots, and a hand of each side where one is named so."""
    found = list(skeleton.roots)
    parts = [
        ("", "") if end else side_and_part(name)
        for name, end in zip(skeleton.names, skeleton.ends, strict=True)
    ]
    for side in ("left", "right"):
        hands = (parts.index((side, word)) for word in HANDS if (side, word) in parts)
        found += [hand for hand in (next(hands, -1),) if hand >= 0 and hand not in found]
    return found


def _ends(skeleton: Skeleton, rule: str, joints: NDArray[np.int32]) -> Sequence[int]:
    """(B,) the joint that tells the side of each bone: its tail by ``per_child``, else its head."""
    if rule != "per_child":
        return [int(joint) for joint in joints]
    taken = dict.fromkeys(range(skeleton.joint_count), 0)
    found = []
    for joint in joints.tolist():
        children = [child for child in skeleton.children[joint] if _has_bone(skeleton, child)]
        found.append(children[taken[joint]] if taken[joint] < len(children) else joint)
        taken[joint] += 1
    return found


def _has_bone(skeleton: Skeleton, child: int) -> bool:
    """Whether ``per_child`` draws a bone to this child: tips have none."""
    from gmr.skeleton import End

    return int(skeleton.ends[child]) != End.TIP


def _finite(*arrays: Floats) -> NDArray[np.bool_]:
    """(F, B) whether all are numbers."""
    return np.asarray(np.isfinite(np.concatenate(arrays, axis=-1)).all(axis=-1), np.bool_)


def finite_poses(poses: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(F,) whether a pose (J, 4, 4) is known."""
    return np.asarray(np.isfinite(poses).all(axis=(1, 2, 3)), np.bool_)
