"""Exchanged labels told by distances: those within a part are wrong, and right when two are exchanged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.markers.gaps import runs, seen
from gmr.markers.labels import match_labels
from gmr.markers.relation import Relation
from gmr.markers.rigid import FEWEST

__all__ = ["Shape", "refuted", "shapes_of", "swaps_by_distances"]

Array = NDArray[np.float64]

_WRONG: Final = 0.015
"""Metres by which a distance within a part may differ from its usual, at least ..."""
_TIMES: Final = 6.0
"""... and in standard deviations of that distance."""


@dataclass(frozen=True, slots=True)
class Shape:
    """A part: its markers, their usual distances, how far each may be off, and the frames in which one is
    further."""

    columns: tuple[int, ...]
    usual: Array
    allowed: Array
    wrong: NDArray[np.bool_]


def shapes_of(metres: Array, labels: Sequence[str], relation: Relation) -> list[Shape]:
    """The parts of which three markers are ever seen at once.

    Args:
        metres: (F, M, 3), NaN where not seen.
        labels: of the M markers.
        relation: which of them are on one part.
    """
    found = match_labels(relation, labels).found
    shapes = []
    for part in relation.parts:
        columns = tuple(found[label] for label in part.markers if label in found)
        if len(columns) < FEWEST or seen(metres[:, columns]).sum(axis=1).max(initial=0) < FEWEST:
            continue
        distances = _distances(metres[:, columns])
        there = np.isfinite(distances)
        usual = np.zeros(distances.shape[1:])
        allowed = np.full(distances.shape[1:], np.inf)
        for i, j in combinations(range(len(columns)), 2):
            held = distances[there[:, i, j], i, j]
            if len(held):
                usual[i, j] = usual[j, i] = np.median(held)
                spread = 1.4826 * float(np.median(np.abs(held - usual[i, j])))
                allowed[i, j] = allowed[j, i] = max(_WRONG, _TIMES * spread)
        shapes.append(Shape(columns, usual, allowed, _excess(distances, usual, allowed) > 1))
    return shapes


def refuted(shapes: Sequence[Shape], metres: Array, pair: tuple[int, int], first: int, length: int) -> bool:
    """Whether in most of these frames the distances are right, and wrong were the two exchanged."""
    concerned = {k: shape for k, shape in enumerate(shapes) if set(pair) & set(shape.columns)}
    frames = metres[first : first + length]
    before, after = _exchanged(pair, concerned, frames)
    return bool(concerned) and float(np.median(before)) <= 1 < float(np.median(after))


def swaps_by_distances(
    shapes: list[Shape], metres: Array, paths: set[tuple[int, ...]]
) -> Iterator[tuple[tuple[int, int], int, int]]:
    """Exchanges as pairs of markers, the first frame, and how many.

    Args:
        shapes: of the parts.
        metres: (F, M, 3), NaN where not seen.
        paths: pairs of which the paths tell an exchange, which decides where distances allow two.
    """
    repairs = [repair for repair in _repairs(shapes, metres) if repair.frames.any()]
    for one, other in combinations(repairs, 2):
        if one.shapes & other.shapes:
            _decide(one, other, paths)
    for repair in repairs:
        there = np.asarray(seen(metres[:, repair.pair]).any(axis=1), np.bool_)
        for first, length in runs(_joined(repair.frames, there)):
            yield repair.pair, first, length


@dataclass(frozen=True, slots=True)
class _Repair:
    """An exchange that makes distances right.

    Args:
        pair: the two markers.
        shapes: which parts they are on, by their place in the list of shapes.
        frames: (F,) in which it does so.
        left: (F,) the excess that is left then.
    """

    pair: tuple[int, int]
    shapes: frozenset[int]
    frames: NDArray[np.bool_]
    left: Array


def _repairs(shapes: list[Shape], metres: Array) -> Iterator[_Repair]:
    """What every exchange does, within each part and between every two."""
    for k, shape in enumerate(shapes):
        for pair in combinations(sorted(shape.columns), 2):
            yield _repair(pair, {k: shape}, shape.wrong, metres)
    for (k, one), (n, other) in combinations(enumerate(shapes), 2):
        both = one.wrong & other.wrong
        if both.any():
            for a in one.columns:
                for b in other.columns:
                    yield _repair((min(a, b), max(a, b)), {k: one, n: other}, both, metres)


def _repair(
    pair: tuple[int, int], shapes: dict[int, Shape], frames: NDArray[np.bool_], metres: Array
) -> _Repair:
    """What exchanging two markers does in the frames whose distances are wrong."""
    at = np.flatnonzero(frames)
    mask, left = np.zeros(len(frames), bool), np.zeros(len(frames))
    before, after = _exchanged(pair, shapes, metres[at])
    right = np.asarray(seen(metres[at][:, pair]).any(axis=1)) & (after <= 1) & (after < before / 2)
    left[at] = after
    mask[at] = right
    return _Repair(pair, frozenset(shapes), mask, left)


def _exchanged(pair: tuple[int, int], shapes: dict[int, Shape], metres: Array) -> tuple[Array, Array]:
    """(n,) the greatest excess in the parts of two markers, as they are labelled and when exchanged.

    That of the part that is helped least counts.
    """
    other = dict(zip(pair, pair[::-1], strict=True))
    before, after = np.full(len(metres), np.inf), np.zeros(len(metres))
    for shape in shapes.values():
        turned = [other.get(column, column) for column in shape.columns]
        excesses = [
            _excess(_distances(metres[:, columns]), shape.usual, shape.allowed)
            for columns in (list(shape.columns), turned)
        ]
        before, after = np.minimum(before, excesses[0]), np.maximum(after, excesses[1])
    return before, after


def _decide(one: _Repair, other: _Repair, paths: set[tuple[int, ...]]) -> None:
    """Of two exchanges that both make a part right, as in a rectangle, one is kept: that of which the paths
    tell too, else that which leaves less."""
    both = one.frames & other.frames
    if not both.any():
        return
    told = [repair.pair in paths for repair in (one, other)]
    worse = other if one.left[both].mean() <= other.left[both].mean() else one
    if told[0] != told[1]:
        worse = other if told[0] else one
    worse.frames[both] = False


def _distances(metres: Array) -> Array:
    """(F, m, m) distances of m markers from each other."""
    return np.asarray(np.linalg.norm(metres[:, :, None] - metres[:, None], axis=3), np.float64)


def _excess(distances: Array, usual: Array, allowed: Array) -> Array:
    """(F,) the greatest deviation of a distance in what is allowed of it; 0 where none is seen."""
    return np.asarray(np.nan_to_num(np.abs(distances - usual) / allowed).max(axis=(1, 2)), np.float64)


def _joined(mask: NDArray[np.bool_], there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The mask with those holes closed in which neither marker is seen, or that last three frames at most."""
    closed = mask.copy()
    for first, length in runs(~mask):
        inside = first > 0 and first + length < len(mask)
        if inside and (length <= 3 or not there[first : first + length].any()):
            closed[first : first + length] = True
    return closed
