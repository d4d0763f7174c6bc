"""Feet in the air: nominal paths, led from the footprint that is left to the footprint that is met."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.plan import Stance

__all__ = ["cleared", "gaps", "led_over", "risen_share", "slope"]

Floats = NDArray[np.float64]

_HELD = 0.5
"""Seconds within which a correction fades in the air."""

_CARRIED = 0.3
"""Seconds within which the speed of a correction fades."""

_OVERSHOOT = np.radians(8.0)
"""Radians that the speed of a correction may add to it: a faster one fades sooner."""

_RISEN = 0.2
"""Seconds in which a foot has risen so far, where the motion does not show the whole swing."""

_CLEARANCE = 0.012
"""Metres between ground and foot in the middle of a swing, at least."""


def gaps(stances: Sequence[Stance], frame_count: int) -> list[tuple[Stance | None, Stance | None, slice]]:
    """Where a foot is in the air: the stance before, the stance after, and the frames between them."""
    befores, afters = [None, *stances], [*stances, None]
    found = []
    for before, after in zip(befores, afters, strict=True):
        first = before.last + 1 if before else 0
        end = after.first if after else frame_count
        if end > first:
            found.append((before, after, slice(first, end)))
    return found


def led_over(offsets: Floats, stances: Sequence[Stance], fps: float) -> None:
    """Writes what a foot is moved by in the air, from what it is moved by on the ground, C1.

    The offset at the end of a stance fades as ``(1 + 2x)(1 - x)^2``, its speed as ``x (1 - x)^2``, both of
    which end without speed; the same goes backwards from the next stance. Source: cubic Hermite
    interpolation.

    Args:
        offsets: (F, K), known where the foot stands; the rest is written.
        stances: of this foot in time.
        fps: frames a second.
    """
    for before, after, air in gaps(stances, len(offsets)):
        frames = np.arange(air.start, air.stop)
        held = min(_HELD * fps, len(frames) + 1) if before and after else _HELD * fps
        found = np.zeros((len(frames), offsets.shape[1]))
        if before:
            stood = offsets[before.frames]
            found += _fading(stood[-1], slope(stood, -1), frames - before.last, held, fps)
        if after:
            stands = offsets[after.frames]
            found += _fading(stands[0], -slope(stands, 0), after.first - frames, held, fps)
        offsets[air] = found


def slope(values: Floats, at: int) -> Floats:
    """(K,) change of (n, K) values a frame at the first (0) or the last (-1) of them, to second order."""
    if at == -1:
        return -slope(values[::-1], 0)
    if len(values) < 3:
        return np.asarray(values[-1] - values[0], np.float64)
    return np.asarray(-1.5 * values[0] + 2 * values[1] - 0.5 * values[2], np.float64)


def cleared(heel: Floats, toe: Floats, rise: Floats) -> Floats:
    """(n,) metres by which a foot in the air has to be lifted to clear the ground.

    A foot at height ``c`` that should be at ``r`` is lifted by 0 if ``c > r + w``, by ``r - c`` if ``c < r -
    w`` and by ``(r - c + w)^2 / 4w`` between; ``r = w`` is 0 with level slope where the foot leaves and meets
    the ground, so that nothing changes there. ``c`` is the lower of heel and toe, rounded where they change
    over: ``(a + b)/2 - sqrt((a - b)^2/4 + w^2)``.

    Args:
        heel: (n,) height of the heel over the ground.
        toe: (n,) the same of the tip of the toes.
        rise: (n,) how far it is to have risen, of 1; see :func:`risen_share`.
    """
    w = _CLEARANCE * rise
    short = w - (heel + toe) / 2 + np.hypot((heel - toe) / 2, w)
    return np.asarray(np.where(short <= -w, 0, np.where(short >= w, short, (short + w) ** 2 / (4 * w))))


def risen_share(before: Stance | None, after: Stance | None, count: int, fps: float) -> Floats:
    """(n,) share of its clearance that a foot has in the frames between two stances: up and down by
    ``x^2 (3 - 2x)`` in the first and the second half, or over 0.2 s at the ends of the motion."""
    half = (count + 1) / 2 if before and after else _RISEN * fps
    frames = np.arange(1, count + 1)
    up = np.minimum(frames / half, 1) if before else np.ones(count)
    down = np.minimum(frames[::-1] / half, 1) if after else np.ones(count)
    return np.asarray(up * up * (3 - 2 * up) * down * down * (3 - 2 * down), np.float64)


def _fading(offset: Floats, speed: Floats, frames: NDArray[np.intp], held: float, fps: float) -> Floats:
    """(n, K) an offset that would go on with a speed a frame, fading over the frames after it."""
    x = np.minimum(frames / held, 1)[:, None]
    window = np.minimum(min(held, _CARRIED * fps), _OVERSHOOT / (4 / 27) / np.maximum(np.abs(speed), 1e-9))
    y = np.minimum(frames[:, None] / window, 1)
    found: Floats = (1 + 2 * x) * (1 - x) ** 2 * offset + window * y * (1 - y) ** 2 * speed
    return found
