"""Which clips carry the trials: share of the playing time by clip (paper's Figure 9)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.wording import short_names
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import count, percent
from gmr.matching.naming import recording_of
from gmr.pages.figure import Figure
from gmr.pages.theme import NAMES_AXIS, NAMES_CONFIG, ROW
from gmr.table import Table

__all__ = ["MOST_BARS", "clip_usage", "never_played", "recordings"]

MOST_BARS: Final = 25


def clip_usage(evaluation: Evaluation) -> Figure:
    """The clips that were played most, as recorded and mirrored, by their share of the playing time."""
    clips = recordings(evaluation.measured.clips)
    top = clips.take(np.arange(min(len(clips), MOST_BARS)))
    sides = ("as recorded", "mirrored")
    bars = Table(
        {
            "clip": np.repeat(top["clip"], 2),
            "label": np.repeat(np.array(short_names(top["clip"].tolist()), object), 2),
            "side": np.array(sides * len(top), object),
            "order": np.arange(2 * len(top)) % 2,
            "share": np.stack([top["share_recorded"], top["share_mirrored"]], axis=1).reshape(-1),
            "total": np.repeat(top["played_share"], 2),
            "played_seconds": np.repeat(top["played_seconds"], 2),
            "used_share": np.repeat(top["used_share"], 2),
            "seconds": np.repeat(top["seconds"], 2),
        }
    )
    mirrored = bool(evaluation.measured.clips["mirrored"].any())
    return Figure(
        name="clip_usage",
        title="Share of the playing time by clip"
        + (f", the {MOST_BARS} most played" if len(clips) > MOST_BARS else ""),
        sentence=_sentence(clips),
        chart=_chart(len(top), mirrored),
        data={"bars": bars if mirrored else bars.take(bars["order"] == 0)},
    )


def recordings(clips: Table) -> Table:
    """The clips table with every mirrored copy added to its recording, most played first.

    Returns:
        One row a recording: ``clip``, ``seconds`` and ``frames`` of the recording alone,
        ``played_seconds``, ``played_share`` and its parts ``share_recorded`` and ``share_mirrored``, and
        ``used_share``: the larger of the two shares of its frames that were played.
    """
    names, row = np.unique([recording_of(clip) for clip in clips["clip"]], return_inverse=True)
    copy = clips["mirrored"].astype(bool)

    def total(column: str, chosen: NDArray[np.bool_] | None = None) -> NDArray[np.float64]:
        weights = clips[column] if chosen is None else np.where(chosen, clips[column], 0)
        return np.bincount(row, weights, len(names)).astype(np.float64)

    used = np.zeros(len(names))
    np.maximum.at(used, row, clips["used_share"])
    table = Table(
        {
            "clip": names.astype(object),
            "seconds": total("seconds", ~copy),
            "frames": total("frames", ~copy).astype(np.int64),
            "played_seconds": total("played_seconds"),
            "played_share": total("played_share"),
            "share_recorded": total("played_share", ~copy),
            "share_mirrored": total("played_share", copy),
            "used_share": used,
        }
    )
    return table.take(np.argsort(-table["played_share"], kind="stable"))


def never_played(clips: Table) -> list[str]:
    """Names, in order, of the recordings of which not one frame was ever played, mirrored or not."""
    table = recordings(clips)
    return sorted(table["clip"][table["played_seconds"] == 0].tolist())


def _sentence(clips: Table) -> str:
    share = clips["played_share"]
    if share.sum() == 0:
        return "Nothing was played."
    half = int(np.searchsorted(np.cumsum(share), share.sum() / 2)) + 1
    never = int(np.sum(clips["played_seconds"] == 0))
    first, part = clips["clip"][0], percent(float(share[0]))
    carried = (
        f"{first} carries {part} of the playing time."
        if half == 1
        else f"{half} clips carry half of the playing time, {first} alone {part}."
    )
    rest = f"{never:,} of {count(len(clips), 'clip')} {'is' if never == 1 else 'are'} never played."
    return f"{carried} {rest}"


def _chart(bars: int, mirrored: bool) -> dict[str, Any]:
    colours = {
        "field": "side",
        "type": "nominal",
        "scale": {"domain": ["as recorded", "mirrored"], "range": ["var(--bar)", "var(--bar-second)"]},
        "legend": {"title": None} if mirrored else None,
    }
    return {
        "width": "container",
        "config": NAMES_CONFIG,
        "height": ROW * max(bars, 1),
        "data": {"name": "bars"},
        "mark": {"type": "bar", "height": {"band": 0.72}, "aria": False},
        "encoding": {
            "y": {
                "field": "label",
                "type": "nominal",
                "sort": {"field": "total", "op": "max", "order": "descending"},
                "title": None,
                "axis": NAMES_AXIS,
            },
            "x": {
                "field": "share",
                "type": "quantitative",
                "title": "Share of the playing time",
                "axis": {"format": "~%", "tickCount": 5},
            },
            "color": colours,
            "order": {"field": "order"},
            "tooltip": [
                {"field": "clip", "title": "Clip"},
                {"field": "side", "title": "Played"},
                {"field": "share", "title": "Share of all playing time", "format": ".1%"},
                {"field": "played_seconds", "title": "Played in all, s", "format": ".0f"},
                {"field": "seconds", "title": "Length of the clip, s", "format": ".1f"},
                {"field": "used_share", "title": "Of its frames played", "format": ".0%"},
            ],
        },
    }
