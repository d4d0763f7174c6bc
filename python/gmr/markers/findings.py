"""What is wrong with a recording: markers that flicker, jump, or exchange their labels; in words."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.markers.gaps import runs
from gmr.markers.relation import Relation, load_relation

if TYPE_CHECKING:
    from gmr.markers.recording import Markers

__all__ = ["Finding", "findings"]

_FLICKER: Final = 0.03
"""Seconds that a marker must be seen at a stretch, not to be a flicker."""
_ACCELERATION: Final = 1000.0
"""Metres a second squared that no marker on a body reaches: a thrower's hand comes to about 900."""
_NOISE: Final = 0.005
"""Metres by which a place may be wrong without that being a jump."""
_DOUBT: Final = "it may be a reflection, or another marker"


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is wrong with one or two markers.

    Args:
        kind: "flicker": seen for a few frames between gaps; "jump": a step that no body makes; "swap": two
            markers have each other's labels.
        markers: their labels.
        indices: their places among the markers.
        first: the first frame.
        length: how many frames.
        sentence: what it is.
    """

    kind: Literal["flicker", "jump", "swap"]
    markers: tuple[str, ...]
    indices: tuple[int, ...]
    first: int
    length: int
    sentence: str

    def __str__(self) -> str:
        return self.sentence


def findings(markers: Markers, wanted: Relation | str | Path | None = None) -> tuple[Finding, ...]:
    """Flickers, swaps and jumps of a recording, in time order.

    Args:
        markers: a recording with known unit and frame time.
        wanted: which marker is on which part; with it, swaps are told from the distances within parts too.

    Raises:
        GmrError: unit or frame time are not known, without which no speed is.
    """
    from gmr.markers.swaps import find_swaps

    if markers.unit is None or not markers.frame_time:
        lacking = "in what unit it is; declare it: markers.with_unit('mm')"
        if markers.unit is not None:
            lacking = "how long a frame lasts, so that no speed is known"
        raise GmrError(f"{markers.name or 'the recording'} does not say {lacking}")
    swaps = find_swaps(markers, load_relation(wanted) if wanted is not None else None)
    explained = {
        (index, frame + step)
        for swap in swaps
        for index in swap.indices
        for frame in (swap.first, swap.first + swap.length)
        for step in (-1, 0, 1, 2)
    }
    jumps = [jump for jump in _jumps(markers) if (jump.indices[0], jump.first) not in explained]
    return tuple(sorted((*_flickers(markers), *swaps, *jumps), key=lambda each: (each.first, each.indices)))


def _flickers(markers: Markers) -> list[Finding]:
    """Markers that are seen for a moment between two gaps."""
    longest = int(_FLICKER / markers.frame_time)
    found = []
    for index, label in enumerate(markers.labels):
        for first, length in runs(markers.visible[:, index]):
            inside = first > 0 and first + length < markers.frame_count
            if inside and length <= max(1, longest):
                said = f"'{label}' is seen for {_frames(first, length)} only, between two gaps: {_DOUBT}"
                found.append(Finding("flicker", (label,), (index,), first, length, said))
    return found


def _jumps(markers: Markers) -> list[Finding]:
    """Steps with an acceleration that no body has, one finding for those that touch."""
    assert markers.unit is not None
    metres = markers.positions * markers.unit
    limit = _NOISE + _ACCELERATION * markers.frame_time**2
    bend = np.linalg.norm(metres[2:] - 2 * metres[1:-1] + metres[:-2], axis=2)
    step = np.linalg.norm(np.diff(metres, axis=0), axis=2)
    bent = np.zeros(markers.visible.shape, bool)
    bent[2:] = np.nan_to_num(bend) > limit
    found = []
    for index in np.flatnonzero(bent.any(axis=0)).tolist():
        label = markers.labels[index]
        for first, length in runs(_widened(bent[:, index])):
            # A step bends the path before and after: the frame of the greatest step is where it jumps.
            steps = np.nan_to_num(step[first - 1 : first + length, index])
            at = first - 1 + int(steps.argmax()) + 1
            size = 1000 * float(steps.max())
            said = f"'{label}' jumps by {size:.0f} mm at frame {at}, faster than a body can"
            found.append(Finding("jump", (label,), (index,), at, 1, said))
    return found


def _widened(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The mask with holes of one frame closed."""
    closed = mask.copy()
    closed[1:-1] |= mask[:-2] & mask[2:]
    return closed


def _frames(first: int, length: int) -> str:
    return f"frame {first}" if length == 1 else f"frames {first} to {first + length - 1}"
