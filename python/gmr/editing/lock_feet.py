"""Feet that stay where they stand: each held in place as long as it touches the ground.

The foot is made a root, its place is kept over each contact and led back smoothly before and after, and it is
joined again by bending the leg, bones as long as they were. Cf. Kovar, Schreiner and Gleicher, "Footskate
Cleanup for Motion Capture Editing" (2002), which stretches bones where we say how far they do not reach.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from gmr.editing.contacts import Contact, Contacts, slide
from gmr.editing.contacts import contacts as find_contacts
from gmr.editing.easing import eased
from gmr.editing.edited import Edited, Stretch
from gmr.editing.giving_way import HeldFoot, lifted_heel, lowered_hips
from gmr.editing.limbs import Limb, limb_that_moves
from gmr.editing.rejoin import cut_at, moved_roots, rejoin
from gmr.editing.roles import known_roles
from gmr.editing.world_turns import world_of
from gmr.errors import GmrError, SkeletonError
from gmr.forest import home
from gmr.listing import quoted
from gmr.motion import Motion
from gmr.quaternions import about, conjugate, multiply, rotated
from gmr.tpose import leading_rest_frames

__all__ = ["LockReport", "lock_feet", "slides"]

Floats = NDArray[np.float64]
GivesWay = Literal["both", "heel", "hips", "nothing"]


@dataclass(frozen=True, eq=False)
class LockReport:
    """What locking feet changed.

    Args:
        contacts: in which feet were held.
        slide_before: (C,) way that the joint of each contact went along the ground, file units.
        slide_after: (C,) what is left of it.
        stretch: for each foot that was held, how far the leg was too short.
        heel_lift_deg: (F,) by how much a foot was turned up about its ball, in each frame the greater of all.
        hips_lowered: (F,) by how much the hips were lowered, file units.
    """

    contacts: Contacts
    slide_before: Floats
    slide_after: Floats
    stretch: tuple[Stretch, ...]
    heel_lift_deg: Floats
    hips_lowered: Floats

    @property
    def slide_before_mm(self) -> Floats:
        """(C,) millimetres."""
        return self.slide_before * self._mm

    @property
    def slide_after_mm(self) -> Floats:
        """(C,) millimetres."""
        return self.slide_after * self._mm

    @property
    def hips_lowered_mm(self) -> Floats:
        """(F,) millimetres."""
        return self.hips_lowered * self._mm

    @property
    def _mm(self) -> float:
        return 1000 / self.contacts.scene.unit.per_metre("a report in millimetres")

    def __str__(self) -> str:
        unit = self.contacts.scene.unit
        if not len(self.contacts):
            return (
                f"no contact of {', '.join(self.contacts.joints)} was found, so nothing was locked{unit.note}"
            )
        before, after = (unit.said(float(values.mean())) for values in (self.slide_before, self.slide_after))
        said = [f"{len(self.contacts)} contacts", f"a foot slid {before} in each on average, now {after}"]
        if self.heel_lift_deg.any():
            said.append(f"heels lifted by {self.heel_lift_deg.max():.1f} degrees at most")
        if self.hips_lowered.any():
            said.append(f"hips lowered by {unit.said(float(self.hips_lowered.max()))} at most")
        return "; ".join([*said, *(str(one) for one in self.stretch)]) + unit.note


def lock_feet(
    motion: Motion,
    contacts: Contacts | None = None,
    *,
    blend: float = 0.1,
    hold_heading: bool = True,
    too_short: GivesWay = "both",
) -> Edited[LockReport]:
    """The motion with each foot held in one place over each of its contacts.

    A contact's joint stays at the median of its places, and the foot turns about it as it did; the knee bends
    in its plane. Before and after the contact the foot is led back to its own path.

    Args:
        motion: any.
        contacts: when which joints rest; found by :func:`gmr.editing.contacts` where not given. One joint for
            each leg: its ankle, or a joint of the foot below it.
        blend: seconds before and after a contact over which the foot is led back to its own path; where the
            next contact is nearer than two of them, it is led straight there.
        hold_heading: keeps the foot from turning about the vertical too.
        too_short: what gives way where a leg does not reach, smoothly and no more than that takes.
            "heel": the foot turns up about the joint that is held, as it does when one steps off, by 25
            degrees at most; this needs a joint below the ankle. "hips": they are lowered, by a quarter of
            the leg at most.
            "both": the heel, then the hips. "nothing": the foot stays short of its place. What is lacking
            after all is in the report.

    Returns:
        The motion, equal to the bit in all frames that are farther than two blends from a contact, and all
        but the legs equal in all frames unless the hips are lowered.

    Raises:
        DatasetError: no feet are found.
        SkeletonError: two contacts' joints are moved by the same leg.
        GmrError: the unit is unknown; or the contacts are of a motion of another length, or overlap.
    """
    held = find_contacts(motion) if contacts is None else contacts
    _check(motion, held, blend, too_short)
    up = held.scene.up_vector
    frames = round(blend * motion.fps) if motion.frame_time else 0
    lift = sunk = np.zeros(motion.frame_count)
    feet = []
    for name, limb in _limbs(motion, held).items():
        foot = _held(motion, limb, held.of(name), up, frames, hold_heading)
        if too_short in ("heel", "both"):
            foot, turned = lifted_heel(motion, foot, frames)
            lift = np.maximum(lift, turned)
        feet.append(foot)
    places = {foot.limb.end: foot.end for foot in feet}
    cut = cut_at(motion, places)
    loose = moved_roots(
        cut, places, {k: turn for foot in feet for k, turn in foot.turns(cut.skeleton).items()}
    )
    if too_short in ("hips", "both"):
        loose, sunk = lowered_hips(loose, motion, feet, up)
    edited = rejoin(loose, motion, limbs=[foot.limb for foot in feet], unit=held.scene.unit)
    sliding = slides(motion, held), slides(edited.motion, held)
    report = LockReport(held, *sliding, edited.report.stretch, np.degrees(lift), sunk)
    return Edited(edited.motion, report)


def _held(
    motion: Motion, limb: Limb, resting: Sequence[Contact], up: Floats, blend: int, hold_heading: bool
) -> HeldFoot:
    """The foot with the joint of its contacts held in each of them."""
    joints = [motion.skeleton.index(resting[0].joint), limb.end]
    at, end = np.moveaxis(motion.positions(dtype=np.float64, joints=joints), 1, 0)
    headings = _headings(motion, limb.end, up) if hold_heading else np.zeros(len(at))
    moves = np.zeros((len(at), 4))
    for one in resting:
        there = np.column_stack([at, headings])[one.first : one.end]
        there[:, 3] = np.unwrap(there[:, 3])
        moves[one.first : one.end] = np.median(there, axis=0) - there
    lead = min(leading_rest_frames(motion), resting[0].first)
    intervals = [(one.first - lead, one.end - lead) for one in resting]
    moves[lead:] = eased(moves[lead:], intervals, blend)
    turn = about(up, moves[:, 3])
    pivot = at + moves[:, :3]
    return HeldFoot(limb, joints[0], pivot, pivot + rotated(turn, end - at), turn, turn)


def _headings(motion: Motion, end: int, up: Floats) -> Floats:
    """(F,) angle about the vertical by which what hangs on a joint has turned since the first frame."""
    at_home = home(motion)
    slots = [int(at_home.skeleton.slots[child]) for child in at_home.skeleton.children[end]]
    if not slots or not motion.frame_count:
        return np.zeros(motion.frame_count)
    frame = world_of(at_home, slots[0])
    since = multiply(frame, conjugate(frame[:1]))
    return np.asarray(2 * np.arctan2(since[:, :3] @ up, since[:, 3]), np.float64)


def _limbs(motion: Motion, held: Contacts) -> dict[str, Limb]:
    """The limb that moves each joint that has a contact."""
    roles = known_roles(motion)
    limbs: dict[str, Limb] = {}
    for name in held.joints:
        if not held.of(name):
            continue
        limb = limb_that_moves(motion.skeleton, name, roles)
        other = next((known for known, one in limbs.items() if one.end == limb.end), None)
        if other is not None:
            raise SkeletonError(
                f"'{other}' and '{name}' are both moved by the limb that ends in "
                f"'{motion.skeleton.names[limb.end]}', and it can hold one of them; give contacts of one"
            )
        limbs[name] = limb
    return limbs


def slides(motion: Motion, held: Contacts) -> Floats:
    """(C,) way along the ground in each contact."""
    found = [
        slide(
            motion[one.first : one.end].positions(dtype=np.float64, joints=[one.joint])[:, 0],
            held.scene.up_vector,
        )
        for one in held
    ]
    return np.array(found, np.float64)


def _check(motion: Motion, held: Contacts, blend: float, too_short: str) -> None:
    if too_short not in get_args(GivesWay):
        raise GmrError(f"too_short={too_short!r}: say what gives way, one of {quoted(get_args(GivesWay), 9)}")
    if held.frame_count != motion.frame_count:
        raise GmrError(
            f"the contacts are of {held.frame_count} frames, the motion has {motion.frame_count}; find them "
            "in this motion, or in one of the same frames"
        )
    if not (np.isfinite(blend) and blend >= 0):
        raise GmrError(f"blend={blend}: give the seconds of blending, 0 or more")
    for name in held.joints:
        own = held.of(name)
        for one, following in pairwise(own):
            if following.first < one.end:
                raise GmrError(
                    f"two contacts of '{name}' overlap: frames {one.first} to {one.end - 1} and "
                    f"{following.first} to {following.end - 1}; make them one"
                )
        for one in own:
            if not 0 <= one.first < one.end <= motion.frame_count:
                raise GmrError(
                    f"the contact of '{name}' from frame {one.first} to before {one.end} is not within the "
                    f"{motion.frame_count} frames of the motion; cut it"
                )
