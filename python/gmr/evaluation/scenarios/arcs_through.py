"""Timed points as a path of arcs, each of constant speed and turn rate, near every point at its time."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.scenario import FASTEST, Segment
from gmr.evaluation.scenarios.biarcs import Arc, Place, biarc, circle_heading, wrapped

__all__ = ["ArcsThrough", "arcs_through", "timed_by_speed"]

REACH: Final = 0.2
"""Metres to the neighbours that tell the direction in a point: nearer ones tell the noise of a recording."""

SHORTEST: Final = 1e-6
"""Metres, and radians, that are rounding."""

STILL: Final = 0.005
"""Metres below which a character stands."""

FARTHEST_OUT: Final = 64
"""Points ahead that are tried where none of the nearer ones can be reached."""

SHARPEST: Final = math.radians(120)
"""A sharper bend is none: somebody turns round."""

STEEPEST: Final = 720.0
"""Degrees per second."""

Point: TypeAlias = tuple[float, float]
Points: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ArcsThrough:
    """A path of arcs, from its first point in the direction in which it begins.

    Attributes:
        segments: the arcs.
        deviation: metres from a point to the path's place at the point's time, at most.
    """

    segments: tuple[Segment, ...]
    deviation: float


def arcs_through(points: Points, seconds: Points, tolerance: float, places: Sequence[str]) -> ArcsThrough:
    """Lay arcs through points, as many points at a time as stay within the tolerance.

    Args:
        points: (N, 2) metres.
        seconds: (N,) rising.
        tolerance: metres.
        places: (N,) what errors call the points.

    Raises:
        ValueError: the path would be faster than 100 m/s, or turn faster than 720 degrees/s.
    """
    headings = _headings(points)
    here, start, segments, deviation = _place(points, headings, 0), 0, list[Segment](), 0.0
    while start < len(points) - 1:

        def reaching(end: int, here: Place = here, start: int = start) -> _Span:
            return _span(here, _place(points, headings, end), points, seconds, start, end, tolerance)

        span = _longest(reaching, start, len(points) - 1, tolerance)
        _check(span, places[start], places[span.end])
        segments += span.segments
        deviation = max(deviation, span.deviation)
        here, start = span.place, span.end
    return ArcsThrough(tuple(segments), deviation)


def timed_by_speed(points: Points, speeds: Points, places: Sequence[str]) -> Points:
    """(N,) when each point is passed, from the speeds (N,) in them: the mean of two over the arcs between.

    Raises:
        ValueError: two points are apart, and the speed in both is 0.
    """
    headings = _headings(points)
    seconds = [0.0]
    for place in range(len(points) - 1):
        one, other = (_place(points, headings, end) for end in (place, place + 1))
        mean = (speeds[place] + speeds[place + 1]) / 2
        length = math.dist(one[:2], other[:2])
        if length > 0:
            length = sum(arc.length for arc in biarc(one, other))
        if mean <= 0 or length <= 0:
            before, after = places[place], places[place + 1]
            what = f"from {before} to {after} the speed is 0"
            if length <= 0:
                what = f"{after} has the same point as {before}"
            raise ValueError(f"{what}; standing is told by time: give the points as x,z,t")
        seconds.append(seconds[-1] + length / float(mean))
    return np.array(seconds)


@dataclass(frozen=True, slots=True)
class _Span:
    """The arcs from a place to the point ``end``, the place they end in, and how far they are from points."""

    end: int
    segments: tuple[Segment, ...]
    place: Place
    deviation: float


def _place(points: Points, headings: Sequence[float], number: int) -> Place:
    return Place(float(points[number, 0]), float(points[number, 1]), headings[number])


def _longest(reaching: Callable[[int], _Span], start: int, last: int, tolerance: float) -> _Span:
    """The span to the farthest point found within the tolerance: by doubling, then by halving."""
    best, first, step = None, reaching(start + 1), 1
    while start + step <= last:
        tried = reaching(start + step)
        if tried.deviation <= tolerance:
            best = tried
        elif best or step > FARTHEST_OUT:
            break
        step *= 2
    if best is None:
        return first
    low, high = best.end, min(start + step, last + 1)
    while high - low > 1:
        middle = (low + high) // 2
        tried = reaching(middle)
        if tried.deviation <= tolerance:
            best, low = tried, middle
        else:
            high = middle
    return best


def _span(
    here: Place, there: Place, points: Points, seconds: Points, start: int, end: int, tolerance: float
) -> _Span:
    duration = float(seconds[end] - seconds[start])
    apart = math.dist(here[:2], there[:2])
    segments: tuple[Segment, ...] = ()
    if apart >= STILL:
        arcs = biarc(here, there)
        length = sum(arc.length for arc in arcs)
        segments = _segments(arcs, length / duration)
        # Where somebody turns on the spot, arcs through the points would run in circles.
        on_the_spot = apart < tolerance and (length > 2 * apart or not _can_be_asked(segments))
    if apart < STILL or on_the_spot:
        turn = wrapped(there.heading - here.heading)
        segments = (Segment(duration, 0.0, math.degrees(turn) / duration),)
        there = here._replace(heading=there.heading)
    if not _can_be_asked(segments):
        return _Span(end, segments, there, math.inf)
    inside = slice(start + 1, end + 1)
    away = np.hypot(*(points[inside] - _along(here, segments, seconds[inside] - seconds[start])).T)
    return _Span(end, segments, there, float(away.max()))


def _segments(arcs: Sequence[Arc], speed: float) -> tuple[Segment, ...]:
    """The arcs at one speed; an arc of no length either is nothing, or turns in no time."""
    return tuple(
        Segment(arc.length / speed, speed, math.degrees(arc.turn) * speed / arc.length)
        if arc.length > SHORTEST
        else Segment(0.0, speed, math.inf)
        for arc in arcs
        if arc.length > SHORTEST or abs(arc.turn) > SHORTEST
    )


def _can_be_asked(segments: Sequence[Segment]) -> bool:
    return all(part.speed <= FASTEST and abs(part.turn_rate_deg) <= STEEPEST for part in segments)


def _along(here: Place, segments: Sequence[Segment], times: Points) -> Points:
    """(T, 2) where a path is at some times: p0 + v t sinc(w t / 2) [sin(h0 + w t / 2), cos(h0 + w t / 2)]."""
    planned, before = np.zeros((len(times), 2)), 0.0
    for segment in segments:
        t = np.maximum(times - before, 0.0)
        half = math.radians(segment.turn_rate_deg) * t / 2
        chord = segment.speed * t * np.sinc(half / np.pi)
        way = here.heading + half
        now = t > 0 if before else t >= 0
        there = np.stack([here.x + chord * np.sin(way), here.z + chord * np.cos(way)], axis=1)
        planned[now] = there[now]
        turn = math.radians(segment.turn_rate_deg) * segment.seconds
        here = here.moved(Arc(segment.speed * segment.seconds, turn))
        before += segment.seconds
    return planned


def _check(span: _Span, one: str, other: str) -> None:
    for segment in span.segments:
        if segment.speed > FASTEST:
            raise ValueError(
                f"from {one} to {other} the path takes {segment.speed:,.0f} m/s; at most {FASTEST:g} can be "
                "asked for: look at the unit (metres), the times, and whether the way "
                "turns back without a stop"
            )
        if abs(segment.turn_rate_deg) > STEEPEST:
            rate = abs(segment.turn_rate_deg)
            by = f"by {rate:,.0f} degrees/s" if math.isfinite(rate) else "in no time"
            raise ValueError(
                f"from {one} to {other} the path turns {by}; at most {STEEPEST:g} degrees/s can be asked "
                "for: round the corner, go there more slowly, or stand there: the point twice, at two times"
            )


def _headings(points: Points) -> list[float]:
    """(N,) the direction in each point: of the circle through it and a neighbour on either side."""
    rows = [(float(x), float(z)) for x, z in points]
    anchors = _anchors(rows)
    headings, after = [], 0
    for place, row in enumerate(rows):
        while after < len(anchors) and anchors[after] <= place:
            after += 1
        before = [rows[a] for a in _neighbours(row, rows, anchors[max(after - 4, 0) : after][::-1])]
        ahead = [rows[a] for a in _neighbours(row, rows, anchors[after : after + 4])]
        if before and ahead and _turns_back(before[0], row, ahead[0]):
            back = rows[max(place - 1, 0)], rows[min(place + 1, len(rows) - 1)]
            headings.append(_nearer(_chord(before[0], row), _chord(row, ahead[0]), *back))
        else:
            headings.append(_heading(before, row, ahead) if before or ahead else _chord(rows[0], rows[-1]))
    return headings


def _anchors(rows: Sequence[Point]) -> list[int]:
    """The first point, then each that is a reach from the one before, and the last point."""
    anchors = [0]
    for place, row in enumerate(rows):
        if math.dist(row, rows[anchors[-1]]) >= REACH:
            anchors.append(place)
    return anchors if anchors[-1] == len(rows) - 1 else [*anchors, len(rows) - 1]


def _neighbours(row: Point, rows: Sequence[Point], anchors: Sequence[int]) -> list[int]:
    """Of the anchors on one side, the nearest first, those that are apart from the point and each other."""
    found: list[int] = []
    for anchor in anchors:
        if math.dist(rows[found[-1]] if found else row, rows[anchor]) >= REACH / 2:
            found.append(anchor)
    return found


def _heading(before: Sequence[Point], here: Point, ahead: Sequence[Point]) -> float:
    if before and ahead:
        return circle_heading(before[0], here, ahead[0])
    if len(ahead) > 1 and not _turns_back(here, *ahead[:2]):
        return circle_heading(here, ahead[0], ahead[1], at=-1)
    if len(before) > 1 and not _turns_back(before[1], before[0], here):
        return circle_heading(before[1], before[0], here, at=1)
    return _chord(here, ahead[0]) if ahead else _chord(before[0], here)


def _turns_back(before: Point, here: Point, ahead: Point) -> bool:
    """Whether there is no circle that somebody would walk on: the way goes back where it came from."""
    return abs(wrapped(_chord(here, ahead) - _chord(before, here))) > SHARPEST


def _nearer(coming: float, going: float, one: Point, other: Point) -> float:
    """The direction of coming or of going, whichever the points next to it are moving in."""
    if math.dist(one, other) < STILL:
        return going
    moving = _chord(one, other)
    return min(coming, going, key=lambda heading: abs(wrapped(heading - moving)))


def _chord(one: Point, other: Point) -> float:
    return math.atan2(other[0] - one[0], other[1] - one[1])
