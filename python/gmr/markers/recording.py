"""A recording of optical markers, immutable: what a C3D file holds before anybody knows of a skeleton."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import frozen, read_only
from gmr.clip import Clip, check_frame_time
from gmr.errors import GmrError
from gmr.listing import quoted
from gmr.markers.gaps import seen
from gmr.units import metres_per_unit

if TYPE_CHECKING:
    from gmr.markers.filling import FillReport
    from gmr.markers.findings import Finding
    from gmr.markers.fit import MarkerFit
    from gmr.markers.gaps import Gap
    from gmr.markers.relation import Relation

__all__ = ["Event", "Markers", "Up"]

_SHOWN = 8
"""Labels that an error lists; the others it counts."""

Label = str | int | np.integer[Any]


@dataclass(frozen=True, slots=True)
class Event:
    """Something that the file marks in time, such as a heel strike.

    Args:
        label: what it is, as the file has it.
        context: of which side or kind, "" where the file does not say.
        seconds: when, since the first frame of the recording.
    """

    label: str
    context: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Up:
    """The axis that points up.

    Args:
        axis: "+Y", "-Z", ...
        by: what told it, in words.
    """

    axis: str
    by: str


@dataclass(frozen=True, eq=False, repr=False)
class Markers(Clip):
    """M markers over F frames; immutable. Operations return a new recording that says what was done.

    Args:
        labels: (M,) as the file has them; they may repeat.
        positions: (F, M, 3) float64, file units, in the axes of the laboratory; NaN where a marker is not
            seen, in all three or in none.
        frame_time: seconds from a frame to the next; 0 if unknown.
        unit: metres per file unit, None if unknown.
        residuals: (F, M) float64 what the cameras disagreed by, file units; NaN where not seen, None where
            the file has none.
        up: the axis that points up, None if unknown.
        name: of the file.
        events: what the file marks in time.
        ignored: what else is in the file and was not read, in words.
        history: what was done to the recording since it was read, a sentence each.

    Raises:
        GmrError: the arrays do not fit each other.
    """

    labels: tuple[str, ...]
    positions: NDArray[np.float64]
    frame_time: float
    unit: float | None = None
    residuals: NDArray[np.float64] | None = None
    up: Up | None = None
    name: str | None = None
    events: tuple[Event, ...] = ()
    ignored: tuple[str, ...] = ()
    history: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "labels", tuple(self.labels))
        positions = frozen(self.positions, np.float64)
        object.__setattr__(self, "positions", positions)
        if positions.ndim != 3 or positions.shape[1:] != (len(self.labels), 3):
            raise GmrError(
                f"positions have the shape {positions.shape}; {len(self.labels)} labels need "
                f"(frames, {len(self.labels)}, 3)"
            )
        check_frame_time(self.frame_time)
        if self.residuals is not None:
            residuals = frozen(self.residuals, np.float64)
            if residuals.shape != positions.shape[:2]:
                raise GmrError(f"residuals have the shape {residuals.shape}, not {positions.shape[:2]}")
            object.__setattr__(self, "residuals", residuals)
        if self.unit is not None:
            object.__setattr__(self, "unit", metres_per_unit(self.unit))

    @property
    def frame_count(self) -> int:
        """F."""
        return len(self.positions)

    @cached_property
    def visible(self) -> NDArray[np.bool_]:
        """(F, M) whether each marker is seen."""
        return read_only(seen(self.positions))

    def index(self, label: Label) -> int:
        """Index of a marker given by label or by index.

        Raises:
            GmrError: no marker has the label (the nearest are given), or several have it.
        """
        if not isinstance(label, str):
            if 0 <= label < len(self.labels):
                return int(label)
            raise GmrError(
                f"there is no marker {label}; the recording has markers 0 to {len(self.labels) - 1}"
            )
        found = [place for place, known in enumerate(self.labels) if known == label]
        if len(found) == 1:
            return found[0]
        if found:
            places = ", ".join(map(str, found[:_SHOWN]))
            raise GmrError(f"{len(found)} markers are labelled '{label}': say which by index, {places}")
        near = difflib.get_close_matches(label, self.labels, n=3)
        hint = f"did you mean {quoted(near, 3)}?" if near else f"there are {quoted(self.labels, _SHOWN)}."
        raise GmrError(f"there is no marker '{label}'; {hint}")

    def select(self, labels: Iterable[Label]) -> Markers:
        """The recording of some of the markers, in the order given."""
        chosen = [self.index(label) for label in labels]
        return replace(
            self,
            labels=tuple(self.labels[place] for place in chosen),
            positions=self.positions[:, chosen],
            residuals=None if self.residuals is None else self.residuals[:, chosen],
        )

    def __getitem__(self, part: slice) -> Markers:
        """Frames ``markers[10:50]``; ``markers[::2]`` has every second one, each twice as long.

        Events stay at their frames: those nearest to a frame before ``stop`` and not before ``start``, their
        times counted from the new first frame. Where the frame time is unknown they stay as they are.
        """
        if not isinstance(part, slice):
            raise TypeError(
                f"a recording is cut by a slice: markers[{part}:{part} + 1] is the frame {part!r}"
            )
        start, stop, step = part.indices(self.frame_count)
        if step < 0:
            raise GmrError(f"markers[::{step}] would run backwards; give a step above 0")
        note = f"frames {start} to {max(stop, start) - 1} taken" + (f", one in {step}" if step > 1 else "")
        whole = (start, stop, step) == (0, self.frame_count, 1)
        return replace(
            self,
            positions=self.positions[part],
            residuals=None if self.residuals is None else self.residuals[part],
            frame_time=self.frame_time * step,
            events=self.events if whole else self._events_within(start, stop),
            history=self.history if whole else (*self.history, note),
        )

    def _events_within(self, start: int, stop: int) -> tuple[Event, ...]:
        if not self.frame_time:
            return self.events
        frames = [round(event.seconds / self.frame_time) for event in self.events]
        return tuple(
            replace(event, seconds=event.seconds - start * self.frame_time)
            for event, frame in zip(self.events, frames, strict=True)
            if start <= frame < stop
        )

    def crop(self, start: float, stop: float) -> Markers:
        """What was recorded from ``start`` to before ``stop``, in seconds since the first frame."""
        if not self.frame_time:
            raise GmrError(
                "the recording does not say how long a frame lasts; cut it by frames: markers[a:b]"
            )
        first, last = (max(0, math.ceil(edge / self.frame_time - 1e-6)) for edge in (start, stop))
        return self[first:last]

    def to_unit(self, unit: float | str) -> Markers:
        """The same recording measured in another unit: "m", "mm" or metres per unit.

        Raises:
            GmrError: the recording does not say in what unit it is.
        """
        wanted = metres_per_unit(unit)
        if self.unit is None:
            raise GmrError(
                f"{self.name or 'this recording'} does not say in what unit it is, so it cannot be "
                "converted; declare it first: markers.with_unit('mm')"
            )
        factor = self.unit / wanted
        return replace(
            self,
            positions=self.positions * factor,
            residuals=None if self.residuals is None else self.residuals * factor,
            unit=wanted,
        )

    def with_unit(self, unit: float | str | None) -> Markers:
        """The same numbers, declared to be in this unit ("m", "mm", ... or metres per unit)."""
        return replace(self, unit=None if unit is None else metres_per_unit(unit))

    def with_name(self, name: str | None) -> Markers:
        """The same recording under another name."""
        return replace(self, name=name)

    def with_up(self, axis: str = "+Y", *, was: str | None = None) -> Markers:
        """The recording turned so that up is along ``axis``; see :func:`gmr.markers.axes.turned_up`."""
        from gmr.markers.axes import turned_up

        return turned_up(self, axis, was)

    def gaps(self) -> tuple[Gap, ...]:
        """Every run of frames in which a marker is not seen; see :func:`gmr.markers.gaps.gaps`."""
        from gmr.markers.gaps import gaps

        return gaps(self)

    def fill_gaps(
        self, relation: Relation | str | None = None, *, max_gap: float = 0.1, max_cluster_gap: float = 1.0
    ) -> tuple[Markers, FillReport]:
        """The recording with its short gaps closed, and what was done; see
        :func:`gmr.markers.filling.fill_gaps`."""
        from gmr.markers.filling import fill_gaps

        return fill_gaps(self, relation, max_gap=max_gap, max_cluster_gap=max_cluster_gap)

    def findings(self, relation: Relation | str | None = None) -> tuple[Finding, ...]:
        """Flickering, jumping and exchanged markers; see :func:`gmr.markers.findings.findings`."""
        from gmr.markers.findings import findings

        return findings(self, relation)

    def undo_swaps(self, found: Iterable[Finding]) -> Markers:
        """The recording with exchanged labels put right; see :func:`gmr.markers.swaps.undo_swaps`."""
        from gmr.markers.swaps import undo_swaps

        return undo_swaps(self, found)

    def fit(self, relation: Relation | str | None = None, **options: Any) -> MarkerFit:
        """The motion of the body that wears the markers; see :func:`gmr.markers.fit.fit`."""
        from gmr.markers.fit import fit

        return fit(self, relation, **options)

    def __repr__(self) -> str:
        unit = "unit unknown" if self.unit is None else f"unit {self.unit:g} m"
        up = "up unknown" if self.up is None else f"up {self.up.axis}"
        return (
            f"Markers({self.name!r}, {self.frame_count} frames at {self.fps:.6g} fps = "
            f"{self.duration:.3f} s, {len(self.labels)} markers, {unit}, {up})"
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Markers):
            return NotImplemented
        return (self.labels, self.frame_time, self.unit) == (
            other.labels,
            other.frame_time,
            other.unit,
        ) and np.array_equal(self.positions, other.positions, equal_nan=True)

    def __hash__(self) -> int:
        return hash((self.labels, self.frame_time, self.unit, self.frame_count))
