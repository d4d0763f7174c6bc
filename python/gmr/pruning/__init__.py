"""A dataset made smaller: what can go without a bit changing, what each clip is worth, quality for size."""

from __future__ import annotations

from gmr.pruning.curve import Curve, Point
from gmr.pruning.lossless import lossless
from gmr.pruning.outcomes import Score
from gmr.pruning.part import Part
from gmr.pruning.prune import Pruning, prune
from gmr.pruning.writing import Written, write_pruned

__all__ = ["Curve", "Part", "Point", "Pruning", "Score", "Written", "lossless", "prune", "write_pruned"]
