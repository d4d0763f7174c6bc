"""Motion matching: which joints a body has, its simulation root, the features of its poses, their
database."""

from __future__ import annotations

from gmr.matching.database import Database, Normalization
from gmr.matching.joints import Joints, find_joints
from gmr.matching.schema import LOCOMOTION, Group, Schema

__all__ = ["LOCOMOTION", "Database", "Group", "Joints", "Normalization", "Schema", "find_joints"]
