"""Axes that several figures share, as parts of a Vega-Lite encoding."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.words import count, duration
from gmr.pages.theme import turn_ticks

__all__ = [
    *("TURN_RATE", "WIDE"),
    *("at_the_edge", "bare_axes", "cell_axes", "not_drawn", "point_axes", "widest_turn"),
]

TURN_RATE: Final = "Turn rate, deg/s (left is positive)"

WIDE: Final = 1.4
"""Half the width of a drawing without axes, whose half height is 1."""

_RARE: Final = 0.02
"""Share of the windows that may turn too fast for the picture, which turning on the spot would stretch."""

_FAR: Final = 1.5
"""Times as far as the others that the farthest of these are before the picture is made for the others."""


def widest_turn(turn_rates_deg: NDArray[np.float64], asked_deg: NDArray[np.float64]) -> float:
    """Turn rate, degrees/s, up to which a picture of some windows reaches: that of the fastest, or where few
    turn much faster than all others, of the others; always as far as what is asked for."""
    turn = np.abs(turn_rates_deg)
    usual = float(np.quantile(turn, 1 - _RARE)) if len(turn) else 0.0
    reach, farthest = max(usual, float(np.abs(asked_deg).max(initial=0.0))), float(turn.max(initial=0.0))
    return max(reach, farthest) if farthest <= _FAR * reach else reach


def at_the_edge(turn_rates_deg: NDArray[np.float64], limit: float) -> str:
    """A sentence on the windows that are drawn at the edge, for they turn faster than the axis reaches; ""
    where there are none."""
    beyond = np.abs(turn_rates_deg)
    beyond = beyond[beyond > limit]
    if not len(beyond):
        return ""
    verb, is_ = ("turns", "is") if len(beyond) == 1 else ("turn", "are")
    windows = count(len(turn_rates_deg), "window")
    return (
        f"{len(beyond):,} of {windows} {verb} faster than {limit:.0f} degrees/s, up to {beyond.max():.0f}, "
        f"and {is_} drawn at the edge."
    )


def not_drawn(seconds: float, limit: float) -> str:
    """A sentence on the time in cells that a picture leaves out, for they turn faster than the axis reaches;
    "" where it is under a second."""
    if seconds < 1:
        return ""
    return f"{duration(seconds)} of turning faster than {limit:.0f} degrees/s are not drawn."


def cell_axes(title: str, turn_axis: Mapping[str, Any]) -> dict[str, Any]:
    """Cells of turn rate and speed, from ``turn_from`` to ``turn_to``, ``speed_from`` to ``speed_to``."""
    turn = {"type": "quantitative", "title": title, "axis": {"grid": False, **turn_axis}}
    speed = {"type": "quantitative", "title": "Speed, m/s", "axis": {"grid": False}}
    return {
        "x": {**turn, "field": "turn_from", "scale": {"nice": False, "padding": 6}},
        "x2": {"field": "turn_to"},
        "y": {**speed, "field": "speed_from", "scale": {"nice": False, "zero": True}},
        "y2": {"field": "speed_to"},
    }


def point_axes(fastest_turn: float, fastest: float) -> dict[str, Any]:
    """Points at ``turn_rate_deg`` and ``speed``, up to so many degrees/s either way, what turns faster at the
    edge, and so many m/s."""
    return {
        "x": {
            "field": "turn_rate_deg",
            "type": "quantitative",
            "title": TURN_RATE,
            "scale": {"domain": [-fastest_turn, fastest_turn], "nice": False, "padding": 4, "clamp": True},
            "axis": {"values": turn_ticks(fastest_turn)},
        },
        "y": {
            "field": "speed",
            "type": "quantitative",
            "title": "Speed, m/s",
            "scale": {"domain": [0.0, fastest], "nice": True},
        },
    }


def bare_axes() -> tuple[dict[str, Any], dict[str, Any]]:
    """Places at ``x``, within :data:`WIDE`, and ``y``, within 1, of which nothing is drawn."""
    x, y = (
        {
            "field": name,
            "type": "quantitative",
            "axis": None,
            "scale": {"domain": [-half, half], "nice": False},
        }
        for name, half in (("x", WIDE), ("y", 1))
    )
    return x, y
