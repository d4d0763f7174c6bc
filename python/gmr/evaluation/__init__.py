"""What a set of locomotion clips can do: trials on planned paths, and what they show.

Source: Abichequer Sangalli, Hoyet, Christie, Pettré, "A new framework for the evaluation of locomotive motion
datasets through motion matching techniques", MIG 2022.
"""

from __future__ import annotations

from gmr.evaluation.result import Evaluation, Replay, Summary, Tables, Verdict
from gmr.table import Table

__all__ = ["Evaluation", "Replay", "Summary", "Table", "Tables", "Verdict"]
