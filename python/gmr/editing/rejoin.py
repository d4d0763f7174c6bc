"""Trees joined again after an edit, with every bone as long as it was.

Cut a limb at its end, move the end as a root wherever it shall go, and join it again: the two bones above are
bent so that the limb ends where its root was put, as far as they reach. Every edit of a limb in this
package is made so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.editing.edited import Edited, Stretch
from gmr.editing.keeping import ROUNDING, restored
from gmr.editing.limbs import Limb, limb_of, path_down
from gmr.editing.roles import known_roles
from gmr.editing.scene import Unit, scene_of
from gmr.editing.two_bone import TwoBone, two_bone
from gmr.editing.world_turns import turned, world_of
from gmr.errors import GmrError, SkeletonError
from gmr.forest import home
from gmr.frames import Pose
from gmr.motion import Motion
from gmr.quaternions import IDENTITY, conjugate, multiply, rotated
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.dummies import Dropped

__all__ = ["RejoinReport", "cut_at", "moved_roots", "rejoin"]

Joint = str | int | np.integer[Any]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RejoinReport:
    """How far each limb was too short."""

    stretch: tuple[Stretch, ...]

    def __str__(self) -> str:
        return "; ".join(str(one) for one in self.stretch) or "no limb was cut"


def cut_at(motion: Motion, ends: Iterable[Joint]) -> Motion:
    """The motion with these joints as further roots, all others where they are at home.

    Raises:
        SkeletonError: a joint does not exist, or is a root at home.
    """
    loose = home(motion)
    for end in ends:
        loose = loose.split(end)
    return loose


def moved_roots(
    loose: Motion, places: Mapping[int, Floats], turns: Mapping[int, Floats] | None = None
) -> Motion:
    """The motion with some of its roots put elsewhere, and some of its bones turned in the world.

    Args:
        loose: any.
        places: for each root, by index, (F, 3) its new place in the world, file units.
        turns: for joints, by index, (F, 4) what comes after the rotation that the bone ending in each has; a
            root turns all that hangs on it, as every bone does but for those that have a turn of their own.

    Raises:
        SkeletonError: a bone that is to turn has no rotation of its own.
    """
    columns = {joint: k for k, joint in enumerate(loose.translated.tolist())}
    translations = loose.translations.copy()
    for root, place in places.items():
        translations[:, columns[root]] = place
    slots = loose.skeleton.slots
    for joint in turns or {}:
        if slots[joint] < 0:
            raise SkeletonError(
                f"the bone that ends in '{loose.skeleton.names[joint]}' has no rotation of its own, so it "
                "cannot be turned; turn the bone above it"
            )
    rotations = turned(loose, {int(slots[joint]): turn for joint, turn in (turns or {}).items()})
    pose = Pose(read_only(rotations), loose.translated, read_only(translations), loose.layout)
    return replace(loose, source=pose, dropped=_without_rows(loose))


def rejoin(
    loose: Motion,
    before: Motion,
    *,
    limbs: Iterable[Limb] = (),
    hold_rotation: bool = True,
    unit: Unit | None = None,
) -> Edited[RejoinReport]:
    """The motion with all roots joined that ``before`` did not have, by bones as long as in ``before``.

    Args:
        loose: ``before`` with the ends of limbs cut off (``with_roots``, ``split``) and their roots moved or
            turned; other roots may have been moved too.
        before: the motion before the edit.
        limbs: of the joints that were cut off, where :func:`gmr.editing.limbs.limb_of` does not find them.
        hold_rotation: what hangs on an end keeps the rotation in the world that its root has, as a foot on
            the ground does; else it turns along with the bone above, as a hand does with its forearm.
        unit: what the report measures in; that of ``before``, or guessed, where not given.

    Returns:
        A motion in the configuration and with the channels of ``before``. In frames in which nothing was
        moved it has the same numbers, to the bit.

    Raises:
        SkeletonError: the two are not of the same skeleton, or two limbs share a bone, or a bone of a limb
            cannot turn by itself.
    """
    # The bones of limbs are bent anew, so a turn of their ends need not be kept here.
    joined, kept = home(loose, looks_for_turns=False), home(before)
    _check_alike(joined, kept)
    ends = np.flatnonzero(loose.skeleton.links >= 0).tolist()
    ends = [end for end in ends if before.skeleton.links[end] < 0]
    stated = {limb.end: limb for limb in limbs}
    roles = None if stated.keys() >= set(ends) else known_roles(before)
    chosen = [stated.get(end) or limb_of(kept.skeleton, end, roles) for end in ends]
    _check_apart(kept.skeleton, chosen)

    whole = _with_bones_of(joined, kept, ends)
    targets = loose.positions(dtype=np.float64, joints=ends)
    turns: dict[int, Floats] = {}
    stretch = []
    measured = unit or scene_of(before).unit
    for limb, target in zip(chosen, np.moveaxis(targets, 1, 0), strict=True):
        solved = _solved(whole, limb, target)
        turns |= _turns_of(whole.skeleton, limb, solved)
        if hold_rotation:
            turns |= _held_below(whole.skeleton, limb.end)
        stretch.append(Stretch(kept.skeleton.names[limb.end], read_only(solved.missed), measured))
    bent = replace(whole, source=replace(whole.pose, rotations=read_only(turned(whole, turns))))
    return Edited(restored(bent, before), RejoinReport(tuple(stretch)))


def _with_bones_of(joined: Motion, kept: Motion, ends: list[int]) -> Motion:
    """``joined`` with the bones above ``ends`` as ``kept`` has them; all below keeps its world rotation."""
    skeleton = joined.skeleton
    turns: dict[int, Floats] = {}
    for end in ends:
        slot = int(skeleton.slots[end])
        if slot >= 0:
            above = world_of(joined, int(np.asarray(skeleton.topology.slot_parents)[slot]))
            wanted = multiply(above, kept.rotations[:, slot])
            turns[slot] = multiply(wanted, conjugate(world_of(joined, slot)))
            turns |= _held_below(skeleton, end)
    source = Pose(
        read_only(turned(joined, turns)),
        kept.translated,
        read_only(_translations(joined, kept, ends)),
        kept.layout,
    )
    return replace(joined, source=source, dropped=_without_rows(joined))


def _translations(joined: Motion, kept: Motion, ends: list[int]) -> Floats:
    """(F, T, 3) of the joints that ``kept`` translates: its own for ``ends``, else those of ``joined``."""
    columns = {joint: k for k, joint in enumerate(joined.translated.tolist())}
    found = kept.translations.copy()
    for k, joint in enumerate(kept.translated.tolist()):
        if joint not in ends:
            found[:, k] = (
                joined.translations[:, columns[joint]] if joint in columns else joined.skeleton.offsets[joint]
            )
    return found


def _solved(motion: Motion, limb: Limb, target: Floats) -> TwoBone:
    """The limb's turns; where it is straight it bends as it does in the other frames."""
    joints = motion.positions(dtype=np.float64, joints=[limb.top, limb.middle, limb.end])
    top, middle, end = np.moveaxis(joints, 1, 0)
    rounding = ROUNDING * np.abs(joints).max(initial=0)
    target = np.where(np.abs(target - end).max(axis=1, keepdims=True) <= rounding, end, target)
    bend = np.cross(middle - top, end - middle)
    slot = int(motion.skeleton.slots[path_down(motion.skeleton, limb.top, limb.middle)[0]])
    frame = world_of(motion, slot)
    hinge = rotated(conjugate(frame), bend).sum(axis=0)
    return two_bone(top, middle, end, target, rotated(frame, np.broadcast_to(hinge, bend.shape)))


def _turns_of(skeleton: Skeleton, limb: Limb, solved: TwoBone) -> dict[int, Floats]:
    """The solved turns by slot."""
    upper = path_down(skeleton, limb.top, limb.middle)
    lower = path_down(skeleton, limb.middle, limb.end)
    turns = {}
    for part, turn in ((upper, solved.upper), (lower, solved.lower)):
        slot = int(skeleton.slots[part[0]])
        if slot < 0:
            raise SkeletonError(
                f"the bone that ends in '{skeleton.names[part[0]]}' has no rotation of its own, so the limb "
                f"of '{skeleton.names[limb.end]}' cannot be bent there; name other joints: Limb.of(...)"
            )
        turns[slot] = turn
    return turns


def _held_below(skeleton: Skeleton, end: int) -> dict[int, Floats]:
    """Identity turns for what hangs on a joint."""
    slots = {int(skeleton.slots[child]) for child in skeleton.children[end]}
    return {slot: IDENTITY for slot in sorted(slots) if slot >= 0}


def _without_rows(motion: Motion) -> Dropped | None:
    return None if motion.dropped is None else motion.dropped.without_rows()


def _check_alike(joined: Motion, kept: Motion) -> None:
    if joined.skeleton != kept.skeleton:
        raise SkeletonError(
            "the motion to be joined and the one before the edit are not of the same skeleton; give the "
            "motion that was cut"
        )
    if joined.frame_count != kept.frame_count:
        raise GmrError(
            f"the motion to be joined has {joined.frame_count} frames, the one before the edit "
            f"{kept.frame_count}; give the motion that was cut"
        )


def _check_apart(skeleton: Skeleton, limbs: list[Limb]) -> None:
    """Raises where a bone is of two limbs, or has no length."""
    owners: dict[int, int] = {}
    for limb in limbs:
        parts = [path_down(skeleton, limb.top, limb.middle), path_down(skeleton, limb.middle, limb.end)]
        for part in parts:
            if not np.any(skeleton.offsets[part] != 0):
                raise SkeletonError(
                    f"the limb that ends in '{skeleton.names[limb.end]}' has no length above "
                    f"'{skeleton.names[part[-1]]}'; name other joints: Limb.of(...)"
                )
        for joint in [*parts[0], *parts[1]]:
            if owners.setdefault(joint, limb.end) != limb.end:
                raise SkeletonError(
                    f"the limbs that end in '{skeleton.names[limb.end]}' and "
                    f"'{skeleton.names[owners[joint]]}' share the bone of '{skeleton.names[joint]}'; "
                    "move one of them at a time"
                )
