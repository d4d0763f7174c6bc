"""Which part of a clip is played: plays per frame along the clips played most (paper's Figure 3)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from gmr.evaluation.figures.classes import Classes
from gmr.evaluation.figures.clip_usage import MOST_BARS, recordings
from gmr.evaluation.figures.wording import short_names
from gmr.evaluation.result import Evaluation
from gmr.evaluation.usage import plays
from gmr.evaluation.words import count, percent
from gmr.matching.naming import recording_of
from gmr.pages.figure import Figure
from gmr.pages.theme import NAMES_AXIS, NAMES_CONFIG, ROW
from gmr.table import Table

__all__ = ["frame_usage"]

_PIECES: Final = 40
_PLAYS: Final = Classes("amount", (0.1, 1.0, 3.0, 10.0, 30.0, 100.0))


def frame_usage(evaluation: Evaluation) -> Figure:
    """Plays per frame in each fortieth of the clips played most; a copy counts for its recording."""
    clips = recordings(evaluation.measured.clips)
    names = clips["clip"][: min(len(clips), MOST_BARS)]
    usage = plays(evaluation.measured.usage)
    pieces = _pieces(usage, names.tolist())
    return Figure(
        name="frame_usage",
        title="Plays per frame along each clip",
        sentence=_sentence(usage),
        chart=_chart(short_names(names.tolist())),
        data={"pieces": pieces},
    )


def _pieces(usage: Table, names: list[str]) -> Table:
    place = {name: number for number, name in enumerate(names)}
    by_name = {clip: place.get(recording_of(clip), -1) for clip in dict.fromkeys(usage["clip"].tolist())}
    clip = np.fromiter((by_name[name] for name in usage["clip"].tolist()), np.int64, len(usage))
    chosen = clip >= 0
    clip, frame, seconds = clip[chosen], usage["frame"][chosen].astype(np.int64), usage["seconds"][chosen]
    length = np.zeros(len(names), np.int64)
    np.maximum.at(length, clip, frame + 1)
    piece = clip * _PIECES + frame * _PIECES // length[clip]
    cells = len(names) * _PIECES
    frames = np.bincount(piece, minlength=cells)
    plays = np.bincount(piece, usage["count"][chosen], cells)
    start = np.full(cells, np.inf)
    np.minimum.at(start, piece, seconds)
    held = np.flatnonzero(frames)
    return Table(
        {
            "clip": np.array(names, object)[held // _PIECES],
            "label": np.array(short_names(names), object)[held // _PIECES],
            "from": (held % _PIECES) / _PIECES,
            "to": (held % _PIECES + 1) / _PIECES,
            "time": start[held],
            "plays": plays[held] / frames[held],
            "class": _PLAYS.of(plays[held] / frames[held]),
        }
    )


def _sentence(usage: Table) -> str:
    plays = usage["count"]
    if plays.sum() == 0:
        return "Nothing was played."
    used = plays > 0
    ranked = np.cumsum(np.sort(plays)[::-1])
    half = int(np.searchsorted(ranked, ranked[-1] / 2)) + 1
    return (
        f"{percent(float(np.mean(used)))} of the {count(len(usage), 'frame')} are played at least once; "
        f"{percent(half / len(usage))} of them make up half of the playing time."
    )


def _chart(labels: list[str]) -> dict[str, Any]:
    return {
        "width": "container",
        "config": NAMES_CONFIG,
        "height": ROW * max(len(labels), 1),
        "data": {"name": "pieces"},
        "mark": {"type": "rect", "height": {"band": 0.72}, "aria": False},
        "encoding": {
            "y": {
                "field": "label",
                "type": "nominal",
                "sort": labels,
                "title": None,
                "axis": NAMES_AXIS,
            },
            "x": {
                "field": "from",
                "type": "quantitative",
                "title": "Position in the clip",
                "axis": {"format": "~%", "tickCount": 5, "grid": False},
                "scale": {"domain": [0, 1]},
            },
            "x2": {"field": "to"},
            "color": _PLAYS.colour("Plays per frame", narrow=2),
            "tooltip": [
                {"field": "clip", "title": "Clip"},
                {"field": "time", "title": "From second", "format": ".2f"},
                {"field": "plays", "title": "Plays per frame", "format": ".1f"},
            ],
        },
    }
