"""From which clip to which: the jumps between the clips that carry the trials, as a matrix."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from gmr.evaluation.figures.classes import Classes
from gmr.evaluation.figures.clip_usage import recordings
from gmr.evaluation.figures.wording import short_names
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import percent
from gmr.matching.naming import recording_of
from gmr.pages.figure import Figure
from gmr.pages.theme import NAMES_AXIS, NAMES_CONFIG, ROW
from gmr.table import Table

__all__ = ["flows", "transition_matrix"]

_MOST_CLIPS: Final = 20
_JUMPS: Final = Classes("amount", (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0))


def transition_matrix(evaluation: Evaluation) -> Figure:
    """Jumps from clip (down) to clip (across) among the clips played most; copies count for recordings."""
    clips = recordings(evaluation.measured.clips)
    names = clips["clip"][: min(len(clips), _MOST_CLIPS)].tolist()
    number = {name: str(place + 1) for place, name in enumerate(names)}
    all_flows = flows(evaluation.measured.transitions)
    inside = np.array(
        [
            start in number and end in number
            for start, end in zip(all_flows["from_clip"].tolist(), all_flows["to_clip"].tolist(), strict=True)
        ],
        bool,
    )
    drawn = all_flows.take(inside)
    rows = {
        name: f"{label}  {place + 1}"
        for place, (name, label) in enumerate(zip(names, short_names(names), strict=True))
    }
    cells = Table(
        {
            **dict(drawn),
            "class": _JUMPS.of(drawn["count"]),
            "from": np.array([rows[name] for name in drawn["from_clip"].tolist()], object),
            "to": np.array([number[name] for name in drawn["to_clip"].tolist()], object),
        }
    )
    return Figure(
        name="transition_matrix",
        title=f"Jumps between the {len(names)} clips played most, from (down) to (across)",
        sentence=_sentence(all_flows, inside),
        chart=_chart(list(rows.values()), list(number.values())),
        data={"cells": cells},
    )


def flows(transitions: Table) -> Table:
    """Jumps summed over frames, kinds and mirrored copies.

    Returns:
        One row a pair of recordings, most jumps first: ``from_clip``, ``to_clip``, ``count``.
    """
    recording = {
        clip: recording_of(clip)
        for column in ("from_clip", "to_clip")
        for clip in dict.fromkeys(transitions[column].tolist())
    }
    names = sorted(set(recording.values()))
    place = {clip: names.index(name) for clip, name in recording.items()}
    ends = [
        np.fromiter((place[clip] for clip in transitions[column].tolist()), np.int64, len(transitions))
        for column in ("from_clip", "to_clip")
    ]
    pairs, row = np.unique(np.stack(ends, axis=1), axis=0, return_inverse=True)
    count = np.bincount(row.reshape(-1), transitions["count"], len(pairs)).astype(np.int64)
    labels = np.array(names, object)
    table = Table({"from_clip": labels[pairs[:, 0]], "to_clip": labels[pairs[:, 1]], "count": count})
    return table.take(np.argsort(-count, kind="stable"))


def _sentence(all_flows: Table, inside: Any) -> str:
    total = int(all_flows["count"].sum())
    if total == 0:
        return "There are no jumps to draw."
    start, end, count = (all_flows[name][0] for name in ("from_clip", "to_clip", "count"))
    way = f"within {start}" if start == end else f"from {start} to {end}"
    share = float(all_flows["count"][inside].sum()) / total
    held = "nearly all" if 0.995 <= share < 1 else percent(share)
    return (
        f"The most common jump is {way}: {int(count):,} times, {percent(int(count) / total)} of all. "
        f"The matrix holds {held} of the jumps."
    )


def _chart(rows: list[str], numbers: list[str]) -> dict[str, Any]:
    return {
        "width": "container",
        "config": NAMES_CONFIG,
        "height": ROW * max(len(rows), 1),
        "data": {"name": "cells"},
        "mark": {"type": "rect", "stroke": "var(--page)", "strokeWidth": 1, "aria": False},
        "encoding": {
            "y": {
                "field": "from",
                "type": "nominal",
                "title": None,
                "scale": {"domain": rows},
                "axis": NAMES_AXIS,
            },
            "x": {
                "field": "to",
                "type": "nominal",
                "title": "To clip number",
                "scale": {"domain": numbers},
                "axis": {
                    "labelAngle": 0,
                    "grid": False,
                    "labelOverlap": True,
                    "labelFontSize": {"expr": "windowSize()[0] < 600 ? 9 : 12"},
                },
            },
            "color": _JUMPS.colour("Jumps in all trials", narrow=2),
            "tooltip": [
                {"field": "from_clip", "title": "From"},
                {"field": "to_clip", "title": "To"},
                {"field": "count", "title": "Jumps", "format": ","},
            ],
        },
    }
