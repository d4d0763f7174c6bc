"""The upper body of one clip on the lower body of another: two partial motions, united at a seam."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.channels import ChannelLayout
from gmr.editing.edited import Edited
from gmr.editing.ground_path import ground_path
from gmr.editing.rejoin import moved_roots
from gmr.editing.roles import body_roles
from gmr.editing.scene import scene_of
from gmr.editing.world_turns import turned
from gmr.errors import GmrError, SkeletonError
from gmr.forest import home
from gmr.frames import Pose
from gmr.motion import Motion
from gmr.partial import below, select
from gmr.quaternions import IDENTITY, about, conjugate, multiply, part_of, rotated
from gmr.tpose import leading_rest_frames
from gmr.union import unite

__all__ = ["SpliceReport", "splice"]

Floats = NDArray[np.float64]
Keep = Literal["heading", "pelvis", "world"]


@dataclass(frozen=True, eq=False)
class SpliceReport:
    """How the two clips were put together.

    Args:
        at: the joint of the seam.
        frames: (F,) the frame of the upper clip that goes with each frame of the lower one.
        turned_deg: (F,) by how much the upper body was turned as a whole.
        seam_deg: (F,) angle between the first bone above the seam as the lower clip has it and as the upper
            one has it, before blending.
    """

    at: str
    frames: NDArray[np.intp]
    turned_deg: Floats
    seam_deg: Floats

    def __str__(self) -> str:
        if not len(self.frames):
            return f"no frames to splice at {self.at}"
        return (
            f"{len(self.frames)} frames spliced at {self.at}; the upper body turned by "
            f"{self.turned_deg.max():.1f} degrees at most; at the seam the clips differ by "
            f"{self.seam_deg.mean():.1f} degrees on average, {self.seam_deg.max():.1f} at most"
        )


def splice(
    lower: Motion,
    upper: Motion,
    at: str = "Spine",
    *,
    keep: Keep = "heading",
    blend: int = 2,
    frames: Sequence[int] | NDArray[np.integer] | None = None,
) -> Edited[SpliceReport]:
    """The motion of ``lower``, with all that hangs on a joint as ``upper`` has it.

    Both skeletons need the joint; below it the result has the joints and bones of ``upper``, elsewhere those
    of ``lower``, the bone that ends in the joint included.

    Args:
        lower: legs, hips, and the path through the world.
        upper: at the same rate and in the same unit.
        at: name of the joint on which the upper body hangs.
        keep: which rotation the upper body keeps: "heading": that to the heading of the body, so that an
            upright back stays upright and faces where the lower body goes; "pelvis": that to the pelvis;
            "world": that to the world.
        blend: bones above the seam over which the lower clip's own rotations go over into the upper's: with
            2, the first bone has a third of the upper's, the second two thirds. 0: none.
        frames: for each frame of ``lower`` the frame of ``upper`` that goes with it; by default both
            recordings begin together, without what a converter put before them, and the longer one is cut.

    Raises:
        SkeletonError: a skeleton has no such joint, nothing hangs on it, or a joint would be there twice.
        DatasetError: the joints of a body are not found, which "heading" and "pelvis" need.
        GmrError: rates, units or the axes that point up differ, or a frame does not exist.
    """
    _check(lower, upper, keep, blend)
    lower, upper, taken = _together(lower, upper, frames)
    hanging = _strictly_below(upper, at)
    staying = sorted(set(range(lower.skeleton.joint_count)) - set(_strictly_below(lower, at)))
    legs, part = select(lower, staying), select(upper, hanging)
    turn = _turn(lower, upper, keep)
    turns, seam = _blended(lower, upper, part, at, turn, blend)
    seated = _seated(
        replace(part, source=replace(part.pose, rotations=turned(part, turns))), lower, upper, at
    )

    names = lower.skeleton.names
    has_same_names = sorted(names) == sorted([*legs.skeleton.names, *part.skeleton.names])
    united = unite([legs, seated], dict.fromkeys(part.roots, at), order=names if has_same_names else None)
    report = SpliceReport(at, taken, _degrees(turn), seam)
    return Edited(_with_layout(united, lower), report)


def _together(
    lower: Motion, upper: Motion, frames: Sequence[int] | NDArray[np.integer] | None
) -> tuple[Motion, Motion, NDArray[np.intp]]:
    """Both at home with the same frames, and which of the upper's those are."""
    lower, upper = home(lower), home(upper)
    if frames is None:
        lead, other = leading_rest_frames(lower), leading_rest_frames(upper)
        count = max(min(lower.frame_count - lead, upper.frame_count - other), 0) + lead
        taken = np.maximum(np.arange(count) + other - lead, 0)
    else:
        taken = np.asarray(frames, np.intp)
        if taken.shape != (lower.frame_count,):
            raise GmrError(
                f"frames= has the shape {taken.shape}; give one for each of {lower.frame_count} frames"
            )
        wrong = np.flatnonzero((taken < 0) | (taken >= upper.frame_count))
        if len(wrong):
            raise GmrError(
                f"frames[{wrong[0]}] is {taken[wrong[0]]}, and the upper clip has frames 0 to "
                f"{upper.frame_count - 1}"
            )
    pose = upper.pose
    source = Pose(
        read_only(pose.rotations[taken]), pose.translated, read_only(pose.translations[taken]), pose.layout
    )
    return (
        lower[: len(taken)],
        replace(upper, source=source, dropped=None, frame_time=lower.frame_time, unit=lower.unit),
        taken,
    )


def _turn(lower: Motion, upper: Motion, keep: Keep) -> Floats:
    """(F, 4) turn in the world of the upper body as a whole."""
    if keep == "world":
        return np.tile(IDENTITY, (lower.frame_count, 1))
    if keep == "heading":
        headings = [ground_path(motion).heading for motion in (lower, upper)]
        return about(scene_of(lower).up_vector, headings[0] - headings[1])
    pelves = [
        motion.bone_rotations(dtype=np.float64)[:, body_roles(motion)["left_up_leg"]]
        for motion in (lower, upper)
    ]
    return multiply(pelves[0], conjugate(pelves[1]))


def _blended(
    lower: Motion, upper: Motion, part: Motion, at: str, turn: Floats, blend: int
) -> tuple[dict[int, Floats], Floats]:
    """Turns of the part's slots, the first ones going over from the lower clip's rotations, and (F,) how far
    apart the two are at the seam, in degrees."""
    skeleton = part.skeleton
    theirs = lower.bone_rotations(dtype=np.float64)
    ours = upper.bone_rotations(dtype=np.float64)
    turns: dict[int, Floats] = {}
    seam = np.zeros(lower.frame_count)
    layer, depth = list(skeleton.roots), 1
    while layer and depth <= blend + 1:
        for joint in layer:
            slot, name = int(skeleton.slots[joint]), skeleton.names[joint]
            if slot < 0 and skeleton.parents[joint] < 0:
                raise SkeletonError(f"the bone that ends in '{name}' does not turn; splice at another joint")
            if slot < 0 or slot in turns:
                continue
            turns[slot] = turn
            if name in lower.skeleton.names:
                ends = theirs[:, lower.skeleton.index(name)], ours[:, upper.skeleton.index(name)]
                way = multiply(multiply(turn, ends[1]), conjugate(ends[0]))
                if depth == 1:
                    seam = np.maximum(seam, _degrees(way))
                if depth <= blend:
                    share = part_of(way, depth / (blend + 1))
                    turns[slot] = multiply(multiply(share, ends[0]), conjugate(ends[1]))
        layer, depth = [child for joint in layer for child in skeleton.children[joint]], depth + 1
    return turns, seam


def _seated(part: Motion, lower: Motion, upper: Motion, at: str) -> Motion:
    """The part with its roots as far from the lower clip's joint as they are from the upper's."""
    places = lower.positions(dtype=np.float64, joints=[at])[:, 0]
    columns = {joint: k for k, joint in enumerate(upper.translated.tolist())}
    world = part.bone_rotations(dtype=np.float64)
    found = {}
    for root in part.skeleton.roots:
        joint = upper.skeleton.index(part.skeleton.names[root])
        moves = joint in columns
        vector = upper.translations[:, columns[joint]] if moves else upper.skeleton.offsets[joint]
        found[root] = places + rotated(world[:, root], np.broadcast_to(vector, places.shape))
    return moved_roots(part, found)


def _strictly_below(motion: Motion, at: str) -> list[int]:
    """The joints that hang on ``at``."""
    joint = motion.skeleton.index(at)
    found = [one for one in below(motion.skeleton, joint) if one != joint]
    if not found:
        raise SkeletonError(
            f"nothing hangs on '{at}' in {motion.name or 'one of the motions'}; splice at a joint of the back"
        )
    return found


def _with_layout(united: Motion, lower: Motion) -> Motion:
    """The motion with the channels of ``lower`` where they fit."""
    layout, skeleton = lower.layout, united.skeleton
    if layout is None or skeleton.names != lower.skeleton.names:
        return united
    candidate = ChannelLayout.of(skeleton, layout.names, adds_offset=layout.adds_offset)
    if not candidate.fits(skeleton) or not set(united.translated.tolist()) <= set(
        candidate.translated.tolist()
    ):
        return united
    return replace(united, source=replace(united.pose, layout=candidate.completed()))


def _degrees(turns: Floats) -> Floats:
    """(F,) how far each turns, the short way round."""
    size = np.linalg.norm(turns[..., :3], axis=-1)
    return np.asarray(np.degrees(2 * np.arctan2(size, np.abs(turns[..., 3]))), np.float64)


def _check(lower: Motion, upper: Motion, keep: str, blend: int) -> None:
    """Raises where the clips cannot be put together."""
    if keep not in ("heading", "pelvis", "world"):
        raise GmrError(
            f"keep={keep!r}: say to what the upper body keeps its rotation, 'heading', 'pelvis' or 'world'"
        )
    if blend < 0:
        raise GmrError(f"blend={blend}: give a number of bones, 0 or more")
    if not np.isclose(lower.frame_time, upper.frame_time, rtol=1e-3):
        raise GmrError(
            f"the lower clip has {lower.fps:g} frames a second, the upper one {upper.fps:g}; resample one of "
            "them first: upper.resample(lower.fps)"
        )
    ups = scene_of(lower).up, scene_of(upper).up
    if ups[0] != ups[1]:
        raise GmrError(
            f"up is {ups[0]} in the lower clip and {ups[1]} in the upper one; turn one of them first: export "
            "it with the other's axes"
        )
    if lower.unit != upper.unit:
        raise GmrError(
            f"the lower clip has a unit of {lower.unit} metres, the upper one of {upper.unit}; declare or "
            "convert one of them first: upper.to_unit(...)"
        )
