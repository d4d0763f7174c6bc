"""Motion matching: which joints a body has, its simulation root, the features of its poses, their
database, trials of what it can follow, and a character that a program steps."""

from __future__ import annotations

from gmr.body.joints import Joints, find_joints
from gmr.matching.character import Character, Shown
from gmr.matching.database import Database
from gmr.matching.normalization import Normalization
from gmr.matching.schema import LOCOMOTION, Group, Schema
from gmr.matching.trial import Profile, Segment, Status, TrialLog, run_trials, trial_positions

__all__ = [
    "LOCOMOTION",
    "Character",
    "Database",
    "Group",
    "Joints",
    "Normalization",
    "Profile",
    "Schema",
    "Segment",
    "Shown",
    "Status",
    "TrialLog",
    "find_joints",
    "run_trials",
    "trial_positions",
]
