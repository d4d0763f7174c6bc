"""A motion drives a character whose skeleton has other names, other proportions and another rest pose."""

from __future__ import annotations

from gmr.skinning.driving.drive_character import drive
from gmr.skinning.driving.driven import Driven, DrivingReport
from gmr.skinning.driving.other_skeleton import Retargeted, retarget

__all__ = ["Driven", "DrivingReport", "Retargeted", "drive", "retarget"]
