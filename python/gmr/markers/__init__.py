"""From optical markers to a motion: gaps, exchanged labels, rigid fits, joint centres, a skeleton.

Start with :class:`Markers`, which ``gmr.read("walk.c3d")`` gives, and its ``fit``.
"""

from __future__ import annotations

from gmr.markers.filling import Filled, FillReport
from gmr.markers.findings import Finding
from gmr.markers.fit import MarkerFit
from gmr.markers.gaps import Gap
from gmr.markers.labels import Match, best_relation, match_labels
from gmr.markers.recording import Event, Markers, Up
from gmr.markers.relation import Relation, load_relation, shipped_relations
from gmr.markers.relation_text import read_relation
from gmr.markers.report import FitReport
from gmr.markers.worn import wear

__all__ = [
    "Event",
    "FillReport",
    "Filled",
    "Finding",
    "FitReport",
    "Gap",
    "MarkerFit",
    "Markers",
    "Match",
    "Relation",
    "Up",
    "best_relation",
    "load_relation",
    "match_labels",
    "read_relation",
    "shipped_relations",
    "wear",
]
