"""A body sent along another path: each frame is moved and turned as one rigid whole, so no bone changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.arrays import read_only
from gmr.body.measures import UP_TURNS
from gmr.editing.contacts import Contacts, contacts
from gmr.editing.edited import Edited
from gmr.editing.ground_path import GroundPath, ground_path
from gmr.editing.keeping import restored
from gmr.editing.lock_feet import LockReport, lock_feet, slides
from gmr.editing.scene import Scene, scene_of
from gmr.editing.world_turns import turned
from gmr.errors import GmrError, SkeletonError
from gmr.forest import home
from gmr.frames import Pose
from gmr.motion import Motion
from gmr.quaternions import about, conjugate, rotated

__all__ = ["WarpReport", "warp_path"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class WarpReport:
    """What another path changed.

    Args:
        before: the path that the motion had.
        path: the one that it has.
        scene: unit and up axis.
        contacts: of the feet, found in the motion before; None where none can be told.
        slide: (C,) way that the feet slide in their contacts after the warp, file units.
        lock: what locking the feet afterwards changed; None where that was not asked for.
    """

    before: GroundPath
    path: GroundPath
    scene: Scene
    contacts: Contacts | None
    slide: Floats
    lock: LockReport | None

    @property
    def slide_mm(self) -> Floats:
        """(C,) millimetres."""
        return self.slide * 1000 / self.scene.unit.per_metre("a report in millimetres")

    def __str__(self) -> str:
        unit = self.scene.unit
        lengths = [
            float(np.linalg.norm(np.diff(one.ground, axis=0), axis=1).sum())
            for one in (self.before, self.path)
        ]
        turn = np.degrees((self.path.heading - self.before.heading)[-1])
        said = [
            f"path {unit.said(lengths[0])}, now {unit.said(lengths[1])}",
            f"turned by {turn:.1f} degrees at its end",
        ]
        if self.lock is not None:
            return "; ".join([*said, str(self.lock)])
        if len(self.slide):
            said.append(f"a foot slides {unit.said(float(self.slide.mean()))} in each contact on average")
        return "; ".join(said) + unit.note


def warp_path(
    motion: Motion,
    path: GroundPath | None = None,
    *,
    via: Mapping[int, ArrayLike] | None = None,
    turn_deg: float = 0.0,
    scale: float = 1.0,
    lock: bool = False,
) -> Edited[WarpReport]:
    """The motion along another path on the ground.

    Each frame is turned about the vertical and moved along the ground as a rigid whole, from where the
    path before has it to where the new one has it. Feet slide where that stretches or turns steps; ``lock``
    holds them, in the contacts of the motion before.

    Args:
        motion: any; what a converter put before the recording goes with the first frame.
        path: the new path; made of the motion's own by the other arguments where not given.
        via: for frames x and z to pass through, file units; see :meth:`GroundPath.through`.
        turn_deg: to turn by until the end, positive to the left; see :meth:`GroundPath.bent`.
        scale: to lengthen or shorten all steps by.
        lock: locks the feet afterwards; see :func:`gmr.editing.lock_feet`.

    Raises:
        DatasetError: the joints of a body are not found.
        GmrError: the path has another number of frames, or is given together with how to make one.
        SkeletonError: a bone has no rotation that could turn with the body.
    """
    before = ground_path(motion)
    if path is None:
        path = before.bent(turn_deg, scale)
        path = path if via is None else path.through(via)
    elif via is not None or turn_deg != 0 or scale != 1:
        raise GmrError("give either a path, or via, turn_deg and scale to make one")
    if len(path) != motion.frame_count:
        raise GmrError(f"the path has {len(path)} frames, the motion {motion.frame_count}; give as many")
    scene = scene_of(motion)
    warped = _moved(motion, before, path, scene)
    can_tell = scene.unit.metres is not None and motion.frame_time > 0
    held = contacts(motion) if lock or can_tell else None
    sliding = slides(warped, held) if held is not None else np.zeros(0)
    if not lock or held is None:
        return Edited(warped, WarpReport(before, path, scene, held, sliding, None))
    locked = lock_feet(warped, held)
    return Edited(locked.motion, WarpReport(before, path, scene, held, sliding, locked.report))


def _moved(motion: Motion, before: GroundPath, path: GroundPath, scene: Scene) -> Motion:
    """``T(new) R(turn) T(-old)`` of every tree: of its place, and of all that turns in the world."""
    at_home = home(motion)
    skeleton, pose = at_home.skeleton, at_home.pose
    turn = about(scene.up_vector, path.heading - before.heading)
    old, new = (_in_world(one.ground, scene.up) for one in (before, path))
    translations = pose.translations.copy()
    for k, joint in enumerate(pose.translated.tolist()):
        if skeleton.parents[joint] < 0:
            translations[:, k] = new + rotated(turn, translations[:, k] - old)
    still = np.flatnonzero((np.asarray(skeleton.topology.world_slots) < 0) & (skeleton.parents >= 0))
    if len(still):
        raise SkeletonError(
            f"the bone that ends in '{skeleton.names[still[0]]}' has no rotation, so it cannot be turned "
            "with the body; leave the joint out: motion.select([...])"
        )
    above = np.asarray(skeleton.topology.slot_parents)
    first = [slot for slot in np.unique(skeleton.slots).tolist() if slot >= 0 and above[slot] < 0]
    rotations = turned(at_home, dict.fromkeys(first, turn))
    source = Pose(read_only(rotations), pose.translated, read_only(translations), pose.layout)
    return restored(replace(at_home, source=source), motion)


def _in_world(ground: Floats, up: str) -> Floats:
    """(F, 3) points on the ground of a world whose up axis is ``up``."""
    upright = np.stack([ground[:, 0], np.zeros(len(ground)), ground[:, 1]], axis=1)
    back = conjugate(np.array(UP_TURNS[up]))
    return rotated(np.broadcast_to(back, (len(ground), 4)), upright)
