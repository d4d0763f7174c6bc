"""The colours of the figures and of the page, light and dark, and the look that all charts share.

A chart names its colours ``var(--error-3)`` and the like: the page defines them as CSS custom properties, so
that one drawing follows the reader's light or dark mode and prints on white; a standalone SVG gets the light
ones written in. Every scale is ordered by lightness, and none opposes red to green, so that colour-blind
readers and grey printers see the same order.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

__all__ = [
    "DARK",
    "FONT",
    "LIGHT",
    "LOOK",
    "NAMES_AXIS",
    "NAMES_CONFIG",
    "ROW",
    "STEPS",
    "in_light_colours",
    "turn_ticks",
]

FONT: Final = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
ROW: Final = 21
"""Height of a row of a chart with one row a clip, pixels."""
STEPS: Final = 7
"""Colours of a scale: more cannot be told apart in a small cell."""

_AMOUNT_LIGHT: Final = ("#e4f2e9", "#bbe1d0", "#82cabe", "#48a9b5", "#3092b8", "#255b93", "#1d2f6b")
_AMOUNT_DARK: Final = ("#1d304b", "#214b71", "#256d90", "#3390a1", "#5bb4a7", "#98d3af", "#e2f2b8")
_ERROR_LIGHT: Final = ("#fdf3dd", "#fbe0ab", "#f7c375", "#ee9c49", "#d9722b", "#ad4b19", "#742c0f")
_ERROR_DARK: Final = ("#2f261b", "#4e351d", "#764820", "#a46224", "#d08335", "#edab5b", "#fbdca4")
_SIGNED_LIGHT: Final = ("#1f4e8c", "#5b8fc7", "#b5d0e8", "#eef0f1", "#f5cf9f", "#dd9243", "#9c5412")
_SIGNED_DARK: Final = ("#a3c9f5", "#628fc7", "#34547c", "#2b3037", "#6d4a24", "#b87b36", "#f3bd77")

_OUTCOMES_LIGHT: Final = {
    "holds": ("#dcebf7",),
    "strays": ("#f7c375",),
    "wrong-speed": ("#c4621f",),
    "wrong-turn": ("#5a4a68",),
}
_OUTCOMES_DARK: Final = {
    "holds": ("#1f3a52",),
    "strays": ("#8a5a1e",),
    "wrong-speed": ("#d98a3d",),
    "wrong-turn": ("#cdbbe0",),
}


def _palette(plain: Mapping[str, str], **scales: tuple[str, ...]) -> dict[str, str]:
    colours = dict(plain)
    for name, steps in scales.items():
        for step, colour in enumerate(steps):
            colours[f"{name}-{step}"] = colour
            colours[f"on-{name}-{step}"] = _black_or_white(colour)
    return colours


def _black_or_white(colour: str) -> str:
    """The text colour with the greater contrast on ``colour`` (WCAG 2 relative luminance)."""
    parts = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return "#ffffff" if 1.05 / (luminance + 0.05) > (luminance + 0.05) / 0.05 else "#111417"


LIGHT: Final[Mapping[str, str]] = _palette(
    {
        "page": "#ffffff",
        "panel": "#f6f7f8",
        "ink": "#16191d",
        "ink-soft": "#4d555e",
        "line": "#d9dde2",
        "accent": "#1f5f99",
        "reference": "#c2550a",
        "warning": "#8a4b08",
        "warning-panel": "#fdf4e3",
        "bar": "#2a6ea8",
        "bar-second": "#9dbfdd",
        "kind-0": "#2a6ea8",
        "kind-1": "#e39b3d",
        "kind-2": "#5a4a68",
    },
    amount=_AMOUNT_LIGHT,
    error=_ERROR_LIGHT,
    **_OUTCOMES_LIGHT,
    signed=_SIGNED_LIGHT,
)
DARK: Final[Mapping[str, str]] = _palette(
    {
        "page": "#121518",
        "panel": "#1a1e23",
        "ink": "#eceff2",
        "ink-soft": "#a6b0ba",
        "line": "#333a42",
        "accent": "#7db8ee",
        "reference": "#f29a52",
        "warning": "#f2c178",
        "warning-panel": "#2c2416",
        "bar": "#5b9dd6",
        "bar-second": "#2f5577",
        "kind-0": "#5b9dd6",
        "kind-1": "#e8a54a",
        "kind-2": "#b9a3cc",
    },
    amount=_AMOUNT_DARK,
    error=_ERROR_DARK,
    **_OUTCOMES_DARK,
    signed=_SIGNED_DARK,
)

LOOK: Final[Mapping[str, Any]] = {
    "background": "transparent",
    "font": FONT,
    "view": {"stroke": None},
    "axis": {
        "domain": False,
        "ticks": False,
        "gridColor": "var(--line)",
        "labelColor": "var(--ink-soft)",
        "labelFontSize": 12,
        "labelPadding": 6,
        "titleColor": "var(--ink-soft)",
        "titleFontSize": 12,
        "titleFontWeight": "normal",
        "titlePadding": 10,
    },
    "legend": {
        "labelColor": "var(--ink-soft)",
        "labelFontSize": 12,
        "titleColor": "var(--ink-soft)",
        "titleFontSize": 12,
        "titleFontWeight": "normal",
        "titleLimit": 320,
        "orient": "top",
        "symbolSize": 130,
        "columnPadding": 14,
        "symbolType": "square",
        "symbolStrokeWidth": 0,
    },
    "text": {"color": "var(--ink)", "fontSize": 12},
}
"""Vega-Lite ``config`` of every chart."""


NAMES_AXIS: Final[Mapping[str, Any]] = {
    "labelLimit": 260,
    "labelColor": "var(--ink)",
    "labelFontSize": {"expr": "windowSize()[0] < 600 ? 9 : 12"},
    "grid": False,
}
"""An axis of clip names: smaller on a phone, where they would leave no room for the bars."""

NAMES_CONFIG: Final[Mapping[str, Any]] = {
    "legend": {"layout": {"top": {"anchor": {"signal": "windowSize()[0] < 600 ? 'end' : 'start'"}}}}
}
"""Beside clip names the chart of a phone is narrower than its legend, which may then reach over the names."""


def in_light_colours(description: Any) -> Any:
    """A chart description with the light colours written in where it names CSS custom properties."""
    match description:
        case str():
            return re.sub(r"var\(--([a-z0-9-]+)\)", lambda found: LIGHT[found[1]], description)
        case Mapping():
            return {key: in_light_colours(value) for key, value in description.items()}
        case list() | tuple():
            return [in_light_colours(value) for value in description]
        case _:
            return description


def turn_ticks(limit: float) -> list[float]:
    """Where an axis of turn rates up to ``limit`` deg/s is labelled: at few and round numbers."""
    step = next((size for size in (25.0, 50.0, 100.0, 200.0) if limit / size <= 5), 500.0)
    number = int(limit / step)
    return [step * place for place in range(-number, number + 1)]
