"""Editing through the forest: make what is to be moved a root, move it, and join it again with every bone as
long as it was.

Each edit gives back an :class:`Edited`: the motion, and a report of what the edit cost.
"""

from __future__ import annotations

from gmr.editing.contacts import Contact, Contacts, contacts
from gmr.editing.edited import Edited, Stretch
from gmr.editing.grip import Bar, GripReport, grip
from gmr.editing.ground_path import GroundPath, ground_path
from gmr.editing.limbs import Limb, limb_of
from gmr.editing.lock_feet import LockReport, lock_feet
from gmr.editing.reach import ReachReport, reach
from gmr.editing.rejoin import RejoinReport, cut_at, moved_roots, rejoin
from gmr.editing.scene import Scene, Unit
from gmr.editing.splice import SpliceReport, splice
from gmr.editing.two_bone import TwoBone, two_bone
from gmr.editing.warp_path import WarpReport, warp_path
from gmr.union import unite

__all__ = [
    "Bar",
    "Contact",
    "Contacts",
    "Edited",
    "GripReport",
    "GroundPath",
    "Limb",
    "LockReport",
    "ReachReport",
    "RejoinReport",
    "Scene",
    "SpliceReport",
    "Stretch",
    "TwoBone",
    "Unit",
    "WarpReport",
    "contacts",
    "cut_at",
    "grip",
    "ground_path",
    "limb_of",
    "lock_feet",
    "moved_roots",
    "reach",
    "rejoin",
    "splice",
    "two_bone",
    "unite",
    "warp_path",
]
