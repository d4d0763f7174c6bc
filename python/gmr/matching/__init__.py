"""Motion matching: which joints a body has, its simulation root, the features of its poses, their
database, and trials of what it can follow."""

from __future__ import annotations

from gmr.body.joints import Joints, find_joints
from gmr.matching.database import Database, Normalization
from gmr.matching.schema import LOCOMOTION, Group, Schema
from gmr.matching.trial import Profile, Segment, Status, TrialLog, run_trials, trial_positions

__all__ = [
    "LOCOMOTION",
    "Database",
    "Group",
    "Joints",
    "Normalization",
    "Profile",
    "Schema",
    "Segment",
    "Status",
    "TrialLog",
    "find_joints",
    "run_trials",
    "trial_positions",
]
