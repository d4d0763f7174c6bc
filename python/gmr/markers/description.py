"""What is in a recording of markers, and what is odd about it, as plain values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from gmr.markers.findings import Finding, findings
from gmr.markers.gaps import Gap, gaps
from gmr.markers.labels import best_relation, match_labels
from gmr.markers.recording import Event, Up
from gmr.markers.relation import Relation, load_relation

if TYPE_CHECKING:
    from gmr.markers.recording import Markers

__all__ = ["MarkerDescription", "RelationFit", "describe_markers"]


@dataclass(frozen=True)
class RelationFit:
    """How a relation fits the labels.

    Args:
        name: of the relation.
        found: how many of its markers are in the recording.
        missing: the others, each with the nearest labels that are.
        left_over: labels that it does not name.
    """

    name: str
    found: int
    missing: dict[str, tuple[str, ...]]
    left_over: tuple[str, ...]


@dataclass(frozen=True)
class MarkerDescription:
    """A recording in words and numbers; times in seconds."""

    frames: int
    frame_time: float
    fps: float
    seconds: float
    labels: tuple[str, ...]
    unit: float | None
    up: Up | None
    events: tuple[Event, ...]
    ignored: tuple[str, ...]
    gaps: tuple[Gap, ...]
    never_seen: tuple[str, ...]
    findings: tuple[Finding, ...]
    relation: RelationFit | None
    oddities: tuple[str, ...]
    """One sentence for each thing that is unusual."""


def describe_markers(
    markers: Markers, warnings: Sequence[str] = (), wanted: Relation | str | Path | None = None
) -> MarkerDescription:
    """What is in a recording and what is odd about it.

    Args:
        markers: any.
        warnings: what reading it warned of; these come first among the oddities.
        wanted: which marker is on which part; the relation that ships with gmr and fits best where left out.
    """
    relation = load_relation(wanted) if wanted is not None else best_relation(markers.labels)
    known = markers.unit is not None and markers.frame_time > 0
    found = findings(markers, relation) if known else ()
    unseen = [markers.labels[k] for k in range(len(markers.labels)) if not markers.visible[:, k].any()]
    oddities = [*warnings, *_sentences(found)]
    if not known and markers.labels:
        oddities.append(
            "unit or rate are unknown, so that nothing is said of flickering and exchanged markers"
        )
    return MarkerDescription(
        frames=markers.frame_count,
        frame_time=markers.frame_time,
        fps=markers.fps if markers.frame_time else 0.0,
        seconds=markers.duration,
        labels=markers.labels,
        unit=markers.unit,
        up=markers.up,
        events=markers.events,
        ignored=markers.ignored,
        gaps=gaps(markers),
        never_seen=tuple(unseen),
        findings=found,
        relation=_fit(relation, markers) if relation else None,
        oddities=tuple(oddities),
    )


def _sentences(found: Sequence[Finding]) -> list[str]:
    """The findings in words; of those of one kind and marker the first, and how many more there are."""
    alike: dict[tuple[str, tuple[int, ...]], list[Finding]] = {}
    for finding in found:
        alike.setdefault((finding.kind, finding.indices), []).append(finding)
    return [
        same[0].sentence + (f" (and {len(same) - 1} times more)" if len(same) > 1 else "")
        for same in alike.values()
    ]


def _fit(relation: Relation, markers: Markers) -> RelationFit:
    match = match_labels(relation, markers.labels)
    return RelationFit(
        name=relation.name,
        found=len(match.found),
        missing=dict(match.missing),
        left_over=tuple(markers.labels[place] for place in match.left_over),
    )
