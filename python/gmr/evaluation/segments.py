"""Trials whose speed switches, stretch by stretch: how each new speed is taken up, and how well it is kept.

Source: the paper's second scenario (section 3.4), "the time it takes for it to react when there is a change
in speed"; its errors (Eqs 1 to 4) for every stretch of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation import metrics
from gmr.evaluation.log import Log
from gmr.evaluation.regions import Limits
from gmr.evaluation.scenario import Trial
from gmr.evaluation.step_response import StepResponse, step_response
from gmr.table import Table

__all__ = ["answer", "segments_table"]

_SMOOTHED_OVER: Final = 0.5
"""Seconds, about one step: over these the sway of single footsteps is no answer to what was asked."""

_NONE: Final = StepResponse(np.nan, np.nan, np.nan)

_COLUMNS: Final = {
    **dict.fromkeys(("dataset", "scenario", "tracking"), object),
    **dict.fromkeys(("speed", "turn_rate_deg"), np.float64),
    "segment": np.int64,
    **dict.fromkeys(("from_speed", "to_speed", "start", "seconds"), np.float64),
    **dict.fromkeys(("speed_error", "turn_rate_error_deg"), np.float64),
    **dict.fromkeys(("speed_deviation", "turn_rate_deviation_deg", "offset_mean"), np.float64),
    **dict.fromkeys(("rise_time", "overshoot", "settling_time"), np.float64),
}


def segments_table(
    dataset: str, trials: Sequence[Trial], tracking: str, log: Log, limits: Limits | None = None
) -> Table:
    """One row a stretch at one speed of every trial whose speed switches; columns: see :class:`Tables`.

    Args:
        dataset: name of the dataset.
        trials: what was asked for; those of constant speed have no rows.
        tracking: "time" or "velocity".
        log: what happened.
        limits: a new speed is taken up where it stays within the limit of a trial's speed.
    """
    named = {"dataset": dataset, "tracking": tracking}
    rows = [named | row for row in _rows(trials, log, (limits or Limits()).speed)]
    return Table({name: np.array([row[name] for row in rows], kind) for name, kind in _COLUMNS.items()})


def answer(speed: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """The speed of a stretch without the sway of single footsteps.

    Args:
        speed: (S,) of every step of the stretch.
        rate: steps per second.

    Returns:
        (S - h,) means over h = half a second about each step, over less where that would reach over the
        beginning of the stretch, so that a ramp keeps its shape and no step is foreseen; the last quarter of
        a second, which has no such means, is left out.
    """
    reach = round(_SMOOTHED_OVER * rate / 2)
    place = np.arange(max(len(speed) - reach, 0))
    about = np.minimum(place, reach)
    total = np.concatenate([[0.0], np.cumsum(speed)])
    return np.asarray((total[place + about + 1] - total[place - about]) / (2 * about + 1))


def _rows(trials: Sequence[Trial], log: Log, within: float) -> Iterator[dict[str, Any]]:
    speed, turn_rate, offset = metrics.path_speed(log), metrics.turn_rate(log), metrics.offset(log)
    speed_error = speed - log.ref_speed
    turn_error = np.degrees(turn_rate - log.ref_turn_rate)
    for number, trial in enumerate(trials):
        if trial.switching is None:
            continue
        steps = np.flatnonzero(log.moving[number])
        asked = log.ref_speed[number, steps]
        edges = [0, *(np.flatnonzero(np.diff(asked)) + 1).tolist(), len(steps)]
        for segment, (first, end) in enumerate(pairwise(edges)):
            stretch = (number, steps[first:end])
            start, target = (float(asked[first - 1]) if first else np.nan), float(asked[first])
            taken = _NONE
            if first:
                smooth = answer(speed[stretch], log.rate)
                taken = (
                    step_response(smooth, start, target, log.rate, within * target) if len(smooth) else _NONE
                )
            yield {
                "scenario": trial.scenario,
                "speed": trial.speed,
                "turn_rate_deg": trial.turn_rate_deg,
                "segment": segment,
                "from_speed": start,
                "to_speed": target,
                "start": first / log.rate,
                "seconds": (end - first) / log.rate,
                "speed_error": speed_error[stretch].mean(),
                "turn_rate_error_deg": turn_error[stretch].mean(),
                "speed_deviation": speed_error[stretch].std(),
                "turn_rate_deviation_deg": turn_error[stretch].std(),
                "offset_mean": offset[stretch].mean(),
                "rise_time": taken.rise_time,
                "overshoot": taken.overshoot,
                "settling_time": taken.settling_time,
            }
