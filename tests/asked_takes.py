"""Takes of the library anywhere in the ranges of their parameters, which go as they are asked to."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from gmr.actionlets import Body, library
from gmr.actionlets.actions.taking import Take


def checked_take(
    name: str, shares: Sequence[float], fps: float, seed: int, body: Body | None, variation: float
) -> Take:
    """A take whose parameters lie at these shares of their ranges: it meets speed and turn rate."""
    action = library()[name]
    asked = {
        parameter.name: parameter.low + share * (parameter.high - parameter.low)
        for share, parameter in zip(shares, action.parameters.values(), strict=False)
    }
    take = action.take(None, fps, seed, body, variation, **asked)
    report = take.report
    assert report.slide_mm < 10
    if take.performance.travel == "path" and report.speed_asked:
        assert report.speed == pytest.approx(report.speed_asked, rel=0.03)
        assert report.turn_rate_deg == pytest.approx(report.turn_rate_asked_deg, abs=3)
    return take
