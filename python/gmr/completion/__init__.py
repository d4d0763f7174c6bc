"""Completion: what a dataset cannot do is made, and the dataset is evaluated again with it."""

from __future__ import annotations

from gmr.completion.complete import Completion, Filler, complete
from gmr.completion.from_folder import complete_from
from gmr.completion.holes import Ask, holes
from gmr.completion.section import completion_section
from gmr.completion.synthesised import synthesised
from gmr.completion.writing import write_added, write_completion

__all__ = [
    "Ask",
    "Completion",
    "Filler",
    "complete",
    "complete_from",
    "completion_section",
    "holes",
    "synthesised",
    "write_added",
    "write_completion",
]
