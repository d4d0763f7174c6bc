"""Axes that several figures share, as parts of a Vega-Lite encoding."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from gmr.pages.theme import turn_ticks

__all__ = ["TURN_RATE", "WIDE", "bare_axes", "cell_axes", "point_axes"]

TURN_RATE: Final = "Turn rate, deg/s (left is positive)"

WIDE: Final = 1.4
"""Half the width of a drawing without axes, whose half height is 1."""


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
    """Points at ``turn_rate_deg`` and ``speed``, up to so many degrees/s either way and so many m/s."""
    return {
        "x": {
            "field": "turn_rate_deg",
            "type": "quantitative",
            "title": TURN_RATE,
            "scale": {"domain": [-fastest_turn, fastest_turn], "nice": False, "padding": 4},
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
