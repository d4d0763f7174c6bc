"""What trials lack of holding: a cost between 0 and 1, which a clip that helps takes away."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation import metrics
from gmr.evaluation.regions import Limits
from gmr.evaluation.simulation import log_of
from gmr.matching.trial import TrialLog

__all__ = ["shortfalls"]

_LIMITS: Final = Limits()


def shortfalls(log: TrialLog) -> NDArray[np.float64]:
    """(T,) for each trial ``1 - 1/r``, where ``r`` is the worst of its errors over the limit within which a
    trial holds: 0 where it holds, 1/2 where it is twice as far off, and nearly 1 where it is hopeless.

    The mean cost of its searches would not do: a character that stands still is searched for at little cost.
    """
    seen = log_of(log)
    speed, turn = metrics.path_speed(seen), metrics.turn_rate(seen)
    share = metrics.worst_share(speed, seen.ref_speed, seen.moving)
    turned = np.degrees(metrics.static_error(turn, seen.ref_turn_rate, seen.moving))
    errors = [np.abs(share) / _LIMITS.speed, np.abs(turned) / _LIMITS.turn_rate_deg]
    if log.tracking == "time":
        errors.append(metrics.mean_where(metrics.offset(seen), seen.recorded) / _LIMITS.offset)
    return np.asarray(1 - 1 / np.maximum(np.max(errors, axis=0), 1.0))
