"""Completion: what a dataset cannot do is made, and the dataset is evaluated again with it."""

from __future__ import annotations

from gmr.completion.complete import Completion, Filler, complete
from gmr.completion.from_folder import complete_from
from gmr.completion.holes import Ask, holes
from gmr.completion.synthesised import synthesised
from gmr.completion.writing import write_completion

__all__ = [
    "Ask",
    "Completion",
    "Filler",
    "complete",
    "complete_from",
    "holes",
    "synthesised",
    "write_completion",
]
