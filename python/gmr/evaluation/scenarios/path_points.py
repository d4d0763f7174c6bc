"""A path of one's own as a list of points, which becomes arcs of constant speed and turn rate."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Final, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.errors import FormatError
from gmr.evaluation.scenario import RUN_UP, Segment, Trial
from gmr.evaluation.scenarios.arcs_through import ArcsThrough, arcs_through, timed_by_speed
from gmr.evaluation.scenarios.points_file import read_points
from gmr.evaluation.words import count

__all__ = ["PathPoints"]

SHORTEST_WAY: Final = 0.1
"""Metres: who is asked to go less than that, without being told when, stands."""


@dataclass(frozen=True, eq=False)
class PathPoints:
    """The path through points on the ground, entered in the direction in which it begins.

    It is planned as arcs that follow each other without a kink, over as many points at a time as
    ``tolerance`` allows: at each point's time the planned place is no farther from it.

    Attributes:
        name: in tables and sentences.
        points: (N, 2) x and z in metres, N at least 2; where the path lies does not matter, only its shape.
        seconds: (N,) when it is at each point, rising; None where ``speeds`` tells, or nothing does.
        point_speeds: (N,) speed at each point, metres per second; None where ``seconds`` tells, or nothing
            does.
        speeds: at which it is gone where the points say nothing of time, a trial each, metres per second.
        tolerance: metres between a point and the planned place at its time, at most.
        lines: (N,) what errors call the points: the lines of the file.
        file: where the points were read; None where they were not.
    """

    name: str
    points: NDArray[np.float64]
    seconds: NDArray[np.float64] | None = None
    point_speeds: NDArray[np.float64] | None = None
    speeds: tuple[float, ...] = (1.0, 2.0, 3.0)
    tolerance: float = 0.05
    lines: tuple[int, ...] | None = None
    file: str | None = None

    @classmethod
    def of(
        cls,
        name: str,
        points: ArrayLike,
        *,
        seconds: ArrayLike | None = None,
        point_speeds: ArrayLike | None = None,
        speeds: Sequence[float] = (1.0, 2.0, 3.0),
        tolerance: float = 0.05,
    ) -> Self:
        """The path through points in memory; the arguments are those of the class."""
        times, paces = (
            None if given is None else np.asarray(given, np.float64) for given in (seconds, point_speeds)
        )
        return cls(name, np.asarray(points, np.float64), times, paces, tuple(speeds), tolerance)

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        *,
        speeds: Sequence[float] = (1.0, 2.0, 3.0),
        tolerance: float = 0.05,
    ) -> Self:
        """The path of a CSV file: a header "x,z", "x,z,t" or "x,z,speed", then a line a point.

        Two columns need no header. Empty lines, and those that begin with #, are passed over.

        Args:
            path: the file; its name without the suffix is the scenario's.
            speeds: where the file says nothing of time.
            tolerance: metres.

        Raises:
            FormatError: the file cannot be read, or a line of it cannot be what it is to be.
        """
        found = read_points(path)
        return cls(
            name=Path(path).stem,
            points=found.points,
            seconds=found.seconds,
            point_speeds=found.speeds,
            speeds=tuple(speeds),
            tolerance=tolerance,
            lines=found.lines,
            file=os.fspath(path),
        )

    def trials(self) -> tuple[Trial, ...]:
        """One; without time one a speed. A straight run-up leads to the first point."""
        return tuple(
            Trial.along(
                self.name, label, (Segment(RUN_UP, planned.segments[0].speed, 0.0), *planned.segments)
            )
            for label, planned in self.planned.items()
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """How far the planned path is from the points."""
        planned = tuple(self.planned.values())
        away = max(each.deviation for each in planned)
        return (
            f"Scenario '{self.name}': {len(self.points):,} points became "
            f"{count(len(planned[0].segments), 'segment')} of constant speed and turn rate, at most "
            f"{away:.3f} m from the points at their times "
            f"({self.tolerance:g} m are allowed).",
        )

    @cached_property
    def planned(self) -> dict[str, ArcsThrough]:
        """The arcs of every trial, by the trial's path."""
        self._check()
        try:
            return dict(self._arcs())
        except ValueError as error:
            raise self._refused(str(error)) from error

    def _arcs(self) -> Iterator[tuple[str, ArcsThrough]]:
        lines = self.lines or range(1, len(self.points) + 1)
        places = [f"{'line' if self.lines else 'point'} {line}" for line in lines]
        for label, seconds in self._times(places):
            yield label, arcs_through(self.points, seconds, self.tolerance, places)

    def _times(self, places: Sequence[str]) -> Iterator[tuple[str, NDArray[np.float64]]]:
        """When each point is passed in each of the trials."""
        if self.seconds is not None:
            yield "as timed", self.seconds
        elif self.point_speeds is not None:
            yield "as timed", timed_by_speed(self.points, self.point_speeds, places)
        else:
            for speed in self.speeds:
                paces = np.full(len(self.points), speed)
                yield f"{speed:g} m/s", timed_by_speed(self.points, paces, places)

    def _refused(self, why: str) -> ValueError:
        return FormatError(why, file=self.file) if self.file else ValueError(f"{self.name}: {why}")

    def _check(self) -> None:
        points = self.points
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
            raise ValueError(f"{self.name}: a path needs two points (x, z) or more, not {points.shape}")
        if not 0.001 <= self.tolerance <= 10:
            raise ValueError(f"{self.name}: a tolerance of {self.tolerance:g} m; give 0.001 to 10 m")
        for what, values in (("seconds", self.seconds), ("point_speeds", self.point_speeds)):
            if values is not None and values.shape != (len(points),):
                raise ValueError(f"{self.name}: {what} are {values.shape}; give one for each point")
        given = [points, self.seconds, self.point_speeds, np.array(self.speeds)]
        if not all(np.isfinite(values).all() for values in given if values is not None):
            raise ValueError(f"{self.name}: a number is not finite")
        if self.seconds is not None and not (np.diff(self.seconds) > 0).all():
            raise ValueError(f"{self.name}: the seconds must rise from point to point")
        if self.seconds is None and not (np.array(self.speeds) > 0).all():
            raise ValueError(f"{self.name}: a speed must be above 0 m/s")
        self._check_length()

    def _check_length(self) -> None:
        """Refuses a way that nobody would see; who says when may stand, which is no way at all."""
        steps = np.hypot(*np.diff(self.points, axis=0).T)
        if self.seconds is None and 0 < steps.sum() < SHORTEST_WAY:
            raise self._refused(
                f"the path is {steps.sum():.3g} m long; give {SHORTEST_WAY:g} m at least, in metres, or, to "
                "stand, the same point at two times (x,z,t)"
            )
