"""Jumps per second by turn rate and kind (the "Transitions" of the paper's Figure 9, told apart)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import count, percent, turning
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["KIND_LABELS", "transition_kinds"]

KIND_LABELS: Final = {
    "inter-clip": "to another clip",
    "intra-clip": "within the clip",
    "forced end": "forced by the end of a clip",
}
_COLUMNS: Final = ("inter_clip_per_second", "intra_clip_per_second", "forced_end_per_second")


def transition_kinds(evaluation: Evaluation) -> Figure:
    """Jumps per second, mean over the speeds, by turn rate and kind."""
    trials = evaluation.measured.trials
    turns, row = np.unique(trials["turn_rate_deg"], return_inverse=True)
    number = np.bincount(row, minlength=len(turns))
    rates = np.stack([np.bincount(row, trials[name], len(turns)) / number for name in _COLUMNS], axis=1)
    bars = Table(
        {
            "turn_rate_deg": np.repeat(turns, len(_COLUMNS)),
            "kind": np.array(list(KIND_LABELS.values()) * len(turns), object),
            "order": np.arange(rates.size) % len(_COLUMNS),
            "rate": rates.reshape(-1),
        }
    )
    return Figure(
        name="transition_kinds",
        title="Jumps per second by turn rate, mean over the speeds",
        sentence=_sentence(evaluation.measured.transitions, turns, rates.sum(axis=1)),
        chart=_chart(),
        data={"bars": bars},
    )


def _sentence(transitions: Table, turns: Any, rates: Any) -> str:
    total = int(transitions["count"].sum())
    if total == 0:
        return "The character never jumps: every trial plays on in one clip."
    shares = {
        label: float(transitions["count"][transitions["kind"] == kind].sum()) / total
        for kind, label in KIND_LABELS.items()
    }
    most = int(np.argmax(rates))
    parts = ", ".join(f"{percent(share)} {label}" for label, share in shares.items() if share > 0)
    return (
        f"{count(total, 'jump')} in all trials: {parts}. "
        f"Most often the character jumps when {turning(turns[most], turns[most])}, "
        f"{rates[most]:.1f} times a second."
    )


def _chart() -> dict[str, Any]:
    labels = list(KIND_LABELS.values())
    return {
        "width": "container",
        "height": 260,
        "data": {"name": "bars"},
        "mark": {"type": "bar", "width": {"band": 0.7}, "aria": False},
        "encoding": {
            "x": {
                "field": "turn_rate_deg",
                "type": "ordinal",
                "title": "Turn rate asked for, deg/s (left is positive)",
                "axis": {"labelAngle": 0, "format": "~g"},
            },
            "y": {
                "field": "rate",
                "type": "quantitative",
                "title": "Jumps per second",
                "axis": {"tickCount": 5},
            },
            "color": {
                "field": "kind",
                "type": "nominal",
                "scale": {
                    "domain": labels,
                    "range": [f"var(--kind-{number})" for number in range(len(labels))],
                },
                "legend": {"title": None, "columns": {"expr": "windowSize()[0] < 600 ? 1 : 3"}},
            },
            "order": {"field": "order"},
            "tooltip": [
                {"field": "turn_rate_deg", "title": "Turn rate, deg/s", "format": "~g"},
                {"field": "kind", "title": "Jump"},
                {"field": "rate", "title": "Per second", "format": ".2f"},
            ],
        },
    }
