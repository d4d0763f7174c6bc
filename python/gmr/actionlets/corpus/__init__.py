"""Corpora: labelled takes of many variations of actions, written in parallel, read as training wants them."""

from __future__ import annotations

from gmr.actionlets.corpus.asking import FORMATS, planned
from gmr.actionlets.corpus.plan import Order, Plan
from gmr.actionlets.corpus.reading import Corpus, LabelledTake
from gmr.actionlets.corpus.windows import Windows
from gmr.actionlets.corpus.writing import Written, write_corpus

__all__ = [
    "FORMATS",
    "Corpus",
    "LabelledTake",
    "Order",
    "Plan",
    "Windows",
    "Written",
    "planned",
    "write_corpus",
]
