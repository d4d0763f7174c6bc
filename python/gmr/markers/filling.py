"""Gaps filled: from the other markers of the part where three of them are seen, else by a cubic where short.

What is left open is named; nothing is filled beyond the limits that the caller gives.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.markers.gaps import Gap, gaps, seen
from gmr.markers.labels import match_labels
from gmr.markers.relation import Relation, load_relation
from gmr.markers.rigid import FEWEST, Template, find_template, fit_poses

if TYPE_CHECKING:
    from gmr.markers.recording import Markers

__all__ = ["FillReport", "Filled", "fill_gaps"]

Array = NDArray[np.float64]
How = Literal["cluster", "cubic", "linear", "open"]


@dataclass(frozen=True, slots=True)
class Filled:
    """What became of a gap.

    Args:
        gap: which.
        how: "cluster": carried by the other markers of its part; "cubic" or "linear": interpolated; "open":
            left as it was.
        why: why it was not filled better, "" where it was filled by its cluster.
    """

    gap: Gap
    how: How
    why: str


@dataclass(frozen=True, slots=True)
class FillReport:
    """What became of every gap of a recording."""

    gaps: tuple[Filled, ...]

    @property
    def filled(self) -> tuple[Filled, ...]:
        """The gaps that were closed."""
        return tuple(each for each in self.gaps if each.how != "open")

    @property
    def open(self) -> tuple[Filled, ...]:
        """The gaps that were not."""
        return tuple(each for each in self.gaps if each.how == "open")

    def __str__(self) -> str:
        if not self.gaps:
            return "no gaps"
        lines = [f"{len(self.filled)} of {len(self.gaps)} gaps filled"]
        for each in self.gaps:
            last = each.gap.first + each.gap.length - 1
            what = "left open" if each.how == "open" else f"filled, {each.how}"
            why = f": {each.why}" if each.why else ""
            lines.append(f"{each.gap.marker}: frames {each.gap.first} to {last}: {what}{why}")
        return "\n".join(lines)


def fill_gaps(
    markers: Markers,
    wanted: Relation | str | Path | None = None,
    *,
    max_gap: float = 0.1,
    max_cluster_gap: float = 1.0,
) -> tuple[Markers, FillReport]:
    """The recording with its gaps filled, and what became of each.

    Args:
        markers: any recording; with a relation its unit must be known.
        wanted: which marker is on which part. A marker is carried through its gap by the rigid fit of the
            other markers of its part, if three of them are seen in all of it, and brought to where it is seen
            before and after. Without a relation no marker has a part.
        max_gap: seconds that are interpolated by a cubic through places before and after; linear where only
            one place is seen on a side.
        max_cluster_gap: seconds that are filled from the part.

    Raises:
        GmrError: a relation is given, but the unit of the recording is not known.
    """
    clusters = _clusters(markers, load_relation(wanted)) if wanted is not None else {}
    positions = markers.positions.copy()
    done = [_close(gap, markers, clusters, positions, max_gap, max_cluster_gap) for gap in gaps(markers)]
    report = FillReport(tuple(done))
    if not report.filled:
        return markers, report
    counted = f"{len(report.filled)} of {len(done)} gaps filled"
    return replace(markers, positions=positions, history=(*markers.history, counted)), report


@dataclass(frozen=True, slots=True)
class _Cluster:
    """The markers of a part, and its shape in metres; None where too few are ever seen at once."""

    columns: tuple[int, ...]
    template: Template | None


def _clusters(markers: Markers, wanted: Relation) -> dict[int, _Cluster]:
    """The part that each marker is on."""
    if markers.unit is None:
        raise GmrError(
            f"{markers.name or 'the recording'} does not say in what unit it is, so that parts cannot be "
            "fitted; declare it first: markers.with_unit('mm')"
        )
    found = match_labels(wanted, markers.labels).found
    clusters: dict[int, _Cluster] = {}
    for part in wanted.parts:
        columns = tuple(found[label] for label in part.markers if label in found)
        if not markers.visible[:, columns].all():
            template = find_template(markers.positions[:, columns] * markers.unit)
            clusters |= dict.fromkeys(columns, _Cluster(columns, template))
    return clusters


def _close(
    gap: Gap,
    markers: Markers,
    clusters: dict[int, _Cluster],
    positions: Array,
    max_gap: float,
    max_cluster_gap: float,
) -> Filled:
    """Fills one gap in ``positions``, if it may be; what was seen is only read from ``markers``."""
    span = slice(gap.first, gap.first + gap.length)
    seconds = gap.seconds * (1 - 1e-9)
    why = f"longer than {max_cluster_gap:g} s"
    if seconds <= max_cluster_gap:
        filled, why = _carried(gap, markers, clusters.get(gap.index))
        if filled is not None:
            positions[span, gap.index] = filled
            return Filled(gap, "cluster", "")
    if gap.at_edge:
        return Filled(gap, "open", f"{why}, and nothing is seen on its other side")
    if seconds > max_gap:
        return Filled(gap, "open", f"{why}, and it is longer than the {max_gap:g} s that are interpolated")
    path = markers.positions[:, gap.index]
    nodes = _nodes(markers.visible[:, gap.index], gap)
    positions[span, gap.index] = _polynomial(nodes, path[nodes], np.arange(span.start, span.stop))
    return Filled(gap, "cubic" if len(nodes) == 4 else "linear", why)


def _carried(gap: Gap, markers: Markers, cluster: _Cluster | None) -> tuple[Array | None, str]:
    """(length, 3) file units: the gap as the part carries the marker, or why it cannot."""
    if cluster is None:
        return None, "its part is not known"
    assert markers.unit is not None
    columns, template = list(cluster.columns), cluster.template
    others = [column for column in columns if column != gap.index]
    span = slice(gap.first, gap.first + gap.length)
    if len(others) < FEWEST or (markers.visible[span, others].sum(axis=1) < FEWEST).any():
        return None, f"fewer than {FEWEST} other markers of its part are seen all through"
    own = columns.index(gap.index)
    if template is None or not seen(template.points[own]):
        return None, f"it is never seen with {FEWEST} others of its part"
    first, last = max(gap.first - 1, 0), min(gap.first + gap.length + 1, markers.frame_count)
    around = markers.positions[first:last][:, columns] * markers.unit
    before_and_after = around[:, own].copy()
    around[:, own] = np.nan
    fit = fit_poses(template.points, around)
    inside = slice(gap.first - first, gap.first - first + gap.length)
    if not fit.known[inside].all():
        return None, "the other markers of its part are nearly on one line"
    slid = fit.seen_from(before_and_after) - template.points[own]
    carried = fit.place(template.points[own]) + (fit.rotations @ _blended(slid)[..., None])[..., 0]
    return carried[inside] / markers.unit, ""


def _blended(slid: Array) -> Array:
    """(n, 3) how far the marker has slid on its part: known at the ends that are seen, linear between; 0
    where neither is."""
    known = np.flatnonzero(seen(slid))
    if not len(known):
        return np.zeros_like(slid)
    steps = np.arange(len(slid))
    return np.stack([np.interp(steps, known, slid[known, axis]) for axis in range(3)], axis=1)


def _nodes(there: NDArray[np.bool_], gap: Gap) -> NDArray[np.int_]:
    """Frames that the interpolation goes through: the last and first seen, and one beyond each, if seen all
    the way, about half the gap's length away, for a slope over less would be that of the noise."""
    before, after = gap.first - 1, gap.first + gap.length
    reach = max(1, gap.length // 2)
    earlier = before - _run(there[before::-1][: reach + 1])
    later = after + _run(there[after:][: reach + 1])
    if earlier == before or later == after:
        return np.array([before, after])
    return np.array([earlier, before, after, later])


def _run(there: NDArray[np.bool_]) -> int:
    """How many frames after the first are seen without a break."""
    hidden = np.flatnonzero(~there)
    return int(hidden[0] if len(hidden) else len(there)) - 1


def _polynomial(nodes: NDArray[np.int_], values: Array, at: NDArray[np.int_]) -> Array:
    """(n, 3) the polynomial through the nodes (Lagrange)."""
    return np.asarray(
        sum(weight[:, None] * value for weight, value in _weights(nodes, values, at)), np.float64
    )


def _weights(nodes: NDArray[np.int_], values: Array, at: NDArray[np.int_]) -> Iterator[tuple[Array, Array]]:
    for k, value in enumerate(values):
        others = np.delete(nodes, k)
        yield np.prod((at[:, None] - others) / (nodes[k] - others), axis=1), value
