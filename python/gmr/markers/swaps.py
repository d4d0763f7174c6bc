"""Two markers that exchange their labels: found by their paths and by the distances within parts, and undone.

By paths: at one frame each of two markers appears where the other was going. By distances: in some frames the
distances within a rigid part are wrong, and exchanging two labels makes them right. The first needs no
relation and sees exchanges in symmetrical parts; the second sees those that begin in a gap.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from gmr.markers.findings import Finding
from gmr.markers.relation import Relation
from gmr.markers.swapped_distances import refuted, shapes_of, swaps_by_distances
from gmr.markers.swapped_paths import swaps_by_paths

if TYPE_CHECKING:
    from gmr.markers.recording import Markers

__all__ = ["find_swaps", "undo_swaps"]

_NEARLY: Final = 5
"""Frames by which the ends of an exchange may differ between paths and distances."""


def find_swaps(markers: Markers, relation: Relation | None = None) -> list[Finding]:
    """The exchanges of a recording whose unit and frame time are known.

    Where the recording begins or ends within an exchange, and no part tells which labels are right, those
    that hold longer are taken to be.
    """
    assert markers.unit is not None
    metres = markers.positions * markers.unit
    by_path = [
        _finding(markers, pair, first, length, "each goes on where the other was")
        for pair, first, length in swaps_by_paths(metres, markers.visible, markers.frame_time)
    ]
    if relation is None:
        return by_path
    shapes = shapes_of(metres, markers.labels, relation)
    by_path = [
        swap
        for swap in by_path
        if not refuted(shapes, metres, (swap.indices[0], swap.indices[1]), swap.first, swap.length)
    ]
    paths = {swap.indices for swap in by_path}
    why = "the distances to the markers around them are wrong, and right when exchanged"
    by_distance = [
        _finding(markers, pair, first, length, why)
        for pair, first, length in swaps_by_distances(shapes, metres, paths)
    ]
    # Paths tell to the frame when labels change; distances tell which labels are right.
    precise = {distant: _same(distant, by_path) or distant for distant in by_distance}
    more = [swap for swap in by_path if not any(_touch(swap, distant) for distant in by_distance)]
    return [*precise.values(), *more]


def undo_swaps(markers: Markers, found: Iterable[Finding]) -> Markers:
    """The recording with the labels of every swap in ``found`` exchanged back; other findings are left."""
    swaps = [finding for finding in found if finding.kind == "swap"]
    if not swaps:
        return markers
    positions = markers.positions.copy()
    residuals = None if markers.residuals is None else markers.residuals.copy()
    for swap in swaps:
        there = slice(swap.first, swap.first + swap.length)
        back = list(swap.indices)[::-1]
        positions[there, list(swap.indices)] = positions[there, back]
        if residuals is not None:
            residuals[there, list(swap.indices)] = residuals[there, back]
    said = tuple(f"exchange undone: {swap.sentence}" for swap in swaps)
    return replace(markers, positions=positions, residuals=residuals, history=(*markers.history, *said))


def _touch(one: Finding, other: Finding) -> bool:
    """Whether two findings of one pair speak of the same frames, or of such that follow each other."""
    near = one.first <= other.first + other.length and other.first <= one.first + one.length
    return near and one.indices == other.indices


def _same(distant: Finding, by_path: list[Finding]) -> Finding | None:
    """The exchange that paths tell of in nearly the same frames."""
    for swap in by_path:
        edges = swap.first - distant.first, swap.first + swap.length - distant.first - distant.length
        if swap.indices == distant.indices and max(map(abs, edges)) <= _NEARLY:
            return replace(distant, first=swap.first, length=swap.length, sentence=swap.sentence)
    return None


def _finding(markers: Markers, pair: tuple[int, int], first: int, length: int, why: str) -> Finding:
    one, other = sorted(pair)
    labels = markers.labels[one], markers.labels[other]
    frames = f"frame {first}" if length == 1 else f"frames {first} to {first + length - 1}"
    said = f"'{labels[0]}' and '{labels[1]}' have each other's labels in {frames}: {why}"
    return Finding("swap", labels, (one, other), first, length, said)
