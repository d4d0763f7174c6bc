"""What the maps of the trials show: the measures, their classes, and how each is put into words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.classes import Classes, two_sided
from gmr.evaluation.figures.wording import asked, metres
from gmr.evaluation.words import percent
from gmr.table import Table

__all__ = ["MEASURES", "Measure"]


@dataclass(frozen=True, slots=True)
class Measure:
    """One column of the trials as a map.

    Attributes:
        column: the column drawn.
        label: its name in a few words.
        title: its name with the unit.
        unit: what a cell counts in; the title says it too.
        factor: how many of them one unit of the column is.
        decimals: digits after the point in a cell.
        classes: its classes and their colours.
        spread: (N,) what stands behind the plus-minus in a cell, from the trials; None where there is none.
        sentence: what the map shows, in words.
    """

    column: str
    label: str
    title: str
    unit: str
    factor: float
    decimals: int
    classes: Classes
    spread: Callable[[Table], NDArray[np.float64]] | None
    sentence: Callable[[Table], str]


def _offset_spread(trials: Table) -> NDArray[np.float64]:
    """Standard deviation of the offset within a trial, metres, from its mean and its root mean square."""
    variance = trials["offset_rms"].astype(np.float64) ** 2 - trials["offset_mean"].astype(np.float64) ** 2
    return np.sqrt(np.maximum(variance, 0.0))


def _farthest(column: str, verb: str) -> Callable[[Table], str]:
    def sentence(trials: Table) -> str:
        values = trials[column]
        worst = int(np.argmax(values))
        close = float(np.mean(values < 0.5))
        return (
            f"{verb} {metres(float(np.median(values)))} in the median trial and "
            f"{metres(float(values[worst]))} in the worst, at {_asked(trials, worst)}; "
            f"{percent(close)} of the trials stay below half a metre."
        )

    return sentence


def _speed_sentence(trials: Table) -> str:
    error = trials["speed_error"]
    slow, fast = int(np.argmin(error)), int(np.argmax(error))
    near = float(np.mean(np.abs(error) <= 0.1))
    parts = [f"{percent(near)} of the trials keep their speed within 0.1 m/s."]
    if error[slow] < -0.1:
        parts.append(
            f"The slowest for what was asked is {_asked(trials, slow)}: {-error[slow]:.2f} m/s too slow."
        )
    if error[fast] > 0.1:
        parts.append(f"The fastest is {_asked(trials, fast)}: {error[fast]:.2f} m/s too fast.")
    return " ".join(parts)


def _turn_sentence(trials: Table) -> str:
    error = np.abs(trials["turn_rate_error_deg"])
    worst = int(np.argmax(error))
    near = float(np.mean(error <= 5))
    return (
        f"{percent(near)} of the trials keep their turn rate within 5 degrees/s; the worst, "
        f"{_asked(trials, worst)}, misses it by {error[worst]:.1f} degrees/s on average."
    )


def _jumps_sentence(trials: Table) -> str:
    rate = trials["transitions_per_second"]
    least, most = int(np.argmin(rate)), int(np.argmax(rate))
    return (
        f"The character jumps to another place in the data {float(np.mean(rate)):.1f} times a second on "
        f"average: from {rate[least]:.1f} at {_asked(trials, least)} to {rate[most]:.1f} at "
        f"{_asked(trials, most)}."
    )


def _pose_sentence(trials: Table) -> str:
    cost = trials["pose_discontinuity_mean"]
    worst = int(np.nanargmax(cost)) if np.isfinite(cost).any() else 0
    return (
        f"At a jump the joints are {float(np.nanmean(cost)) * 100:.1f} cm apart on average, before "
        f"smoothing; the roughest trial is {_asked(trials, worst)}, with {cost[worst] * 100:.1f} cm."
    )


def _asked(trials: Table, row: int) -> str:
    return asked(float(trials["speed"][row]), float(trials["turn_rate_deg"][row]))


def _slide_sentence(trials: Table) -> str:
    slide, own = trials["foot_slide_mm"], trials["foot_slide_own_mm"]
    if not np.isfinite(slide).any():
        return "No foot is ever seen to stand on the ground."
    worst = int(np.nanargmax(slide))
    return (
        f"While a foot is down it slides {float(np.nanmedian(slide)) / 10:.1f} cm in the median trial, where "
        f"the clips' own frames slide {float(np.nanmedian(own)) / 10:.1f} cm; most at "
        f"{_asked(trials, worst)}, {slide[worst] / 10:.0f} cm."
    )


_METRES: Final = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)

MEASURES: Final = (
    Measure(
        "offset_mean",
        "Mean offset",
        "Mean distance from the planned position, m",
        "Metres",
        1.0,
        2,
        Classes("error", _METRES),
        _offset_spread,
        _farthest("offset_mean", "On average the character is off by"),
    ),
    Measure(
        "offset_max",
        "Largest offset",
        "Largest distance from the planned position, m",
        "Metres",
        1.0,
        2,
        Classes("error", _METRES),
        None,
        _farthest("offset_max", "At its worst moment the character is off by"),
    ),
    Measure(
        "speed_error",
        "Speed error",
        "Speed played minus speed asked for, m/s",
        "m/s",
        1.0,
        2,
        two_sided((0.1, 0.25, 0.75)),
        lambda trials: trials["speed_deviation"],
        _speed_sentence,
    ),
    Measure(
        "turn_rate_error_deg",
        "Turn rate error",
        "Turn rate played minus turn rate asked for, deg/s",
        "deg/s",
        1.0,
        1,
        two_sided((2.0, 5.0, 15.0)),
        lambda trials: trials["turn_rate_deviation_deg"],
        _turn_sentence,
    ),
    Measure(
        "transitions_per_second",
        "Jumps per second",
        "Jumps to another place in the data, per second",
        "Jumps per second",
        1.0,
        1,
        Classes("amount", (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)),
        None,
        _jumps_sentence,
    ),
    Measure(
        "pose_discontinuity_mean",
        "Pose gap at jumps",
        "Mean distance between the joints left and entered at a jump, cm",
        "Centimetres",
        100.0,
        1,
        Classes("error", (1.0, 2.0, 4.0, 6.0, 8.0, 12.0)),
        None,
        _pose_sentence,
    ),
    Measure(
        "foot_slide_mm",
        "Foot slide",
        "How far a foot slides while it is down, mean over the stances, cm",
        "Centimetres",
        0.1,
        1,
        Classes("error", (2.0, 4.0, 8.0, 16.0, 32.0, 64.0)),
        None,
        _slide_sentence,
    ),
)
"""The measures that the report shows, in order; one more is one more entry."""
