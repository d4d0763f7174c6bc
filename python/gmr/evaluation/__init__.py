"""What a set of locomotion clips can do: trials on planned paths, and what they show.

Source: Abichequer Sangalli, Hoyet, Christie, Pettré, "A new framework for the evaluation of locomotive motion
datasets through motion matching techniques", MIG 2022.
"""

from __future__ import annotations

from gmr.evaluation.comparison import Comparison, comparison_of
from gmr.evaluation.result import Evaluation, Replay, Summary, Tables, Verdict
from gmr.evaluation.scenario import Segment, Trial
from gmr.evaluation.scenarios import PathPoints, Scenario, Slalom, Splines, StartStop, Strafe
from gmr.evaluation.tuning import Tuning, tune
from gmr.table import Table

__all__ = [
    "Comparison",
    "Evaluation",
    "PathPoints",
    "Replay",
    "Scenario",
    "Segment",
    "Slalom",
    "Splines",
    "StartStop",
    "Strafe",
    "Summary",
    "Table",
    "Tables",
    "Trial",
    "Tuning",
    "Verdict",
    "comparison_of",
    "tune",
]
