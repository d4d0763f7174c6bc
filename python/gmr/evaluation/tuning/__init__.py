"""Weights of the feature groups, tuned on some cells of the grid and proved on the others."""

from __future__ import annotations

from gmr.evaluation.tuning.weights import Tuning, tune

__all__ = ["Tuning", "tune"]
