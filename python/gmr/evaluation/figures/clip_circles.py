"""Clips as circles of frames, joined by the jumps between them (paper's Figures 3 and 10)."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.axes import WIDE, bare_axes
from gmr.evaluation.figures.clip_usage import recordings
from gmr.evaluation.result import Evaluation
from gmr.evaluation.usage import plays
from gmr.evaluation.words import count, percent
from gmr.matching.naming import recording_of
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["clip_circles", "jumps_with"]

_MOST_CLIPS: Final = 12
_DOTS: Final = 60
"""Dots a circle: a dot is a sixtieth of the clip, for the frames of a long one would run into each other."""
_MOST_LINES: Final = 400
_RING: Final = 0.78
_RADIUS: Final = 0.155


def clip_circles(evaluation: Evaluation) -> Figure:
    """The clips played most as circles of dots, sized by plays, and the strongest jumps between the dots."""
    names = recordings(evaluation.measured.clips)["clip"][:_MOST_CLIPS].tolist()
    number = {name: place for place, name in enumerate(names)}
    usage, transitions = plays(evaluation.measured.usage), evaluation.measured.transitions
    length = _lengths(usage, number)
    dots = _dots(usage, names, number, length)
    lines, joined = _lines(transitions, number, length)
    return Figure(
        name="clip_circles",
        title=f"The {len(names)} clips played most as circles of frames, and the jumps between them",
        sentence=_sentence(names, transitions, lines, joined),
        chart=_chart(),
        data={"dots": dots, "lines": lines, "names": _labels(names)},
        key=_key(names),
    )


def _key(names: list[str]) -> tuple[str, ...]:
    """The names behind the numbers, in lines."""
    # A name does not break at its own spaces.
    each = [f"{number} {name}".replace(" ", "\u00a0") for number, name in enumerate(names, 1)]
    return tuple(
        line.replace("\u00a0", " ") for line in textwrap.wrap(" · ".join(each), 110, break_on_hyphens=False)
    )


def _numbers(clips: NDArray[Any], number: Mapping[str, int]) -> NDArray[np.int64]:
    """(N,) the circle of each clip, -1 for clips without one."""
    known = {clip: number.get(recording_of(clip), -1) for clip in dict.fromkeys(clips.tolist())}
    return np.fromiter((known[clip] for clip in clips.tolist()), np.int64, len(clips))


def _lengths(usage: Table, number: Mapping[str, int]) -> NDArray[np.int64]:
    clip = _numbers(usage["clip"], number)
    length = np.ones(len(number), np.int64)
    np.maximum.at(length, clip[clip >= 0], usage["frame"][clip >= 0] + 1)
    return length


def _centres(circles: int) -> NDArray[np.float64]:
    """(circles, 2) centres of the circles on an ellipse, clockwise from the top."""
    angle = 2 * np.pi * np.arange(circles) / max(circles, 1)
    return np.stack([_RING * WIDE * np.sin(angle), _RING * np.cos(angle)], axis=1)


def _places(dot: NDArray[np.int64], circles: int) -> NDArray[np.float64]:
    """(N, 2) where dots stand, from their numbers: circle * _DOTS + place, clockwise from the top."""
    angle = 2 * np.pi * (dot % _DOTS + 0.5) / _DOTS
    around = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    return _centres(circles)[dot // _DOTS] + _RADIUS * around


def _dots(usage: Table, names: list[str], number: Mapping[str, int], length: NDArray[np.int64]) -> Table:
    clip = _numbers(usage["clip"], number)
    chosen = clip >= 0
    clip = clip[chosen]
    dot = clip * _DOTS + usage["frame"][chosen] * _DOTS // length[clip]
    frames = np.bincount(dot, minlength=len(names) * _DOTS)
    plays = np.bincount(dot, usage["count"][chosen], len(names) * _DOTS)
    held = np.flatnonzero(frames)
    place = _places(held, len(names))
    return Table(
        {
            "x": place[:, 0],
            "y": place[:, 1],
            "clip": np.array(names, object)[held // _DOTS],
            "part": held % _DOTS / _DOTS,
            "plays": plays[held] / frames[held],
        }
    )


def _lines(
    transitions: Table, number: Mapping[str, int], length: NDArray[np.int64]
) -> tuple[Table, NDArray[np.int64]]:
    """The strongest jumps between dots, and (clips, clips) the jumps between all circles."""
    start, end = _numbers(transitions["from_clip"], number), _numbers(transitions["to_clip"], number)
    inside = (start >= 0) & (end >= 0)
    start, end, times = start[inside], end[inside], transitions["count"][inside]
    joined = np.zeros((len(number), len(number)), np.int64)
    np.add.at(joined, (start, end), times)
    dots = np.stack(
        [
            start * _DOTS + transitions["from_frame"][inside] * _DOTS // length[start],
            end * _DOTS + transitions["to_frame"][inside] * _DOTS // length[end],
        ],
        axis=1,
    )
    pairs, row = np.unique(dots, axis=0, return_inverse=True)
    jumps = np.bincount(row.reshape(-1), times, len(pairs)).astype(np.int64)
    strongest = np.sort(np.argsort(-jumps, kind="stable")[:_MOST_LINES])
    ends = [_places(pairs[strongest, side].astype(np.int64), len(number)) for side in (0, 1)]
    table = Table(
        {
            "x": ends[0][:, 0],
            "y": ends[0][:, 1],
            "x2": ends[1][:, 0],
            "y2": ends[1][:, 1],
            "count": jumps[strongest],
        }
    )
    return table, joined


def _labels(names: list[str]) -> Table:
    centres = _centres(len(names))
    return Table(
        {
            "x": centres[:, 0],
            "y": centres[:, 1],
            "number": np.array([str(place + 1) for place in range(len(names))], object),
            "clip": np.array(names, object),
        }
    )


def _sentence(names: list[str], transitions: Table, lines: Table, joined: NDArray[np.int64]) -> str:
    total = int(transitions["count"].sum())
    if total == 0:
        return "There are no jumps to draw."
    others = (joined + joined.T > 0) & ~np.eye(len(names), dtype=bool)
    partners = others.sum(axis=1)
    hub = int(np.argmax(partners))
    share = percent(int(lines["count"].sum()) / total)
    with_whom = jumps_with(int(partners[hub]), len(names) - 1)
    return (
        f"Drawn are the {count(len(lines), 'strongest path')}, {share} of the jumps. {names[hub]} "
        f"(number {hub + 1}) {with_whom}. "
        f"Frames run clockwise from the top of each circle; a larger dot is played more."
    )


def jumps_with(partners: int, others: int) -> str:
    """With how many of the other clips the one exchanges jumps that does so with most."""
    if not partners:
        return "jumps only within itself"
    if others == 1:
        return "exchanges jumps with the other clip"
    return f"exchanges jumps with {'each' if partners == others else partners} of the other {others} clips"


def _chart() -> dict[str, Any]:
    x, y = bare_axes()
    return {
        "width": "container",
        "height": "container",
        "resolve": {"scale": {"size": "independent"}},
        "layer": [
            {
                "data": {"name": "lines"},
                "mark": {"type": "rule", "color": "var(--bar)", "aria": False},
                "encoding": {
                    "x": x,
                    "y": y,
                    "x2": {"field": "x2"},
                    "y2": {"field": "y2"},
                    "opacity": {
                        "field": "count",
                        "type": "quantitative",
                        "scale": {"type": "log", "domain": [1, 100], "range": [0.12, 0.9], "clamp": True},
                        "legend": None,
                    },
                    "strokeWidth": {
                        "field": "count",
                        "type": "quantitative",
                        "scale": {"type": "log", "domain": [1, 100], "range": [0.5, 2.5], "clamp": True},
                        "legend": None,
                    },
                },
            },
            {
                "data": {"name": "dots"},
                "mark": {
                    "type": "point",
                    "filled": True,
                    "color": "var(--reference)",
                    "opacity": 1,
                    "aria": False,
                },
                "encoding": {
                    "x": x,
                    "y": y,
                    "size": {
                        "field": "plays",
                        "type": "quantitative",
                        "scale": {"domain": [0, 100], "range": [2, 60], "clamp": True},
                        "legend": None,
                    },
                    "tooltip": [
                        {"field": "clip", "title": "Clip"},
                        {"field": "part", "title": "Position in the clip", "format": ".0%"},
                        {"field": "plays", "title": "Plays per frame", "format": ".1f"},
                    ],
                },
            },
            # A number is read through the lines that cross it.
            {
                "data": {"name": "names"},
                "mark": {
                    "type": "text",
                    "fontSize": 13,
                    "stroke": "var(--page)",
                    "strokeWidth": 5,
                    "strokeJoin": "round",
                    "aria": False,
                },
                "encoding": {"x": x, "y": y, "text": {"field": "number", "type": "nominal"}},
            },
            {
                "data": {"name": "names"},
                "mark": {"type": "text", "fontSize": 13, "aria": False},
                "encoding": {
                    "x": x,
                    "y": y,
                    "text": {"field": "number", "type": "nominal"},
                    "tooltip": [{"field": "clip", "title": "Clip"}],
                },
            },
        ],
    }
