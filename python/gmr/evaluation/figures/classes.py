"""Values sorted into a few classes of fixed borders, so that one colour means the same in every report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.pages.theme import STEPS

__all__ = ["Classes", "two_sided"]


@dataclass(frozen=True, slots=True)
class Classes:
    """Classes of a value and their colours.

    Attributes:
        palette: "amount", "error" or "signed".
        borders: borders between the classes, rising, fewer than there are colours. A value on a border
            belongs to the class above it.
    """

    palette: str
    borders: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.borders) >= STEPS:
            raise ValueError(
                f"a palette has {STEPS} colours; {len(self.borders)} borders part more classes than that"
            )

    def of(self, values: NDArray[Any]) -> NDArray[np.int64]:
        """(N,) the class of each value; -1, which has no colour, for values that are not finite."""
        number = np.searchsorted(self.borders, values, side="right")
        return np.where(np.isfinite(values), number, -1).astype(np.int64)

    def colour(self, title: str, columns: int = STEPS, narrow: int = 3) -> dict[str, Any]:
        """The Vega-Lite colour of the field ``class``; its legend has ``narrow`` columns on a phone."""
        return {
            "field": "class",
            "type": "ordinal",
            "scale": self._scale(""),
            "legend": {
                "title": title,
                "labelExpr": f"{self._labels()}[datum.value]",
                "columns": {"expr": f"windowSize()[0] < 600 ? {narrow} : {columns}"},
            },
        }

    def ink(self) -> dict[str, Any]:
        """The Vega-Lite colour channel of text that stands on a cell of this colour."""
        return {"field": "class", "type": "ordinal", "scale": self._scale("on-"), "legend": None}

    def _scale(self, prefix: str) -> dict[str, Any]:
        numbers = list(range(len(self.borders) + 1))
        return {"domain": numbers, "range": [f"var(--{prefix}{self.palette}-{number})" for number in numbers]}

    def _labels(self) -> list[str]:
        first, last = self.borders[0], self.borders[-1]
        inner = [f"{low:g}–{high:g}" for low, high in zip(self.borders, self.borders[1:], strict=False)]
        if self.palette == "signed":
            inner = [
                f"within ±{high:g}" if low == -high else f"{_signed(low)} to {_signed(high)}"
                for low, high in zip(self.borders, self.borders[1:], strict=False)
            ]
        return [
            f"under {_signed(first) if first < 0 else f'{first:g}'}",
            *inner,
            f"{_signed(last) if self.palette == 'signed' else f'{last:g}'} and more",
        ]


def two_sided(borders: Sequence[float]) -> Classes:
    """Classes around zero; ``borders`` are those above it, rising, and stand below it with a minus."""
    return Classes("signed", (*(-border for border in reversed(borders)), *borders))


def _signed(value: float) -> str:
    return f"{value:+g}".replace("-", "−")
