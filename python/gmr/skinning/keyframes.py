"""Animations as a file keeps them, key by key, and their values at any time.

Source: glTF 2.0 specification, 3.11 "Animations" and appendix C "Animation Sampler Interpolation Modes".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import frozen
from gmr.errors import GmrError

__all__ = ["Animation", "Channel"]

Array = NDArray[np.float64]
Path = Literal["translation", "rotation", "scale"]
Interpolation = Literal["STEP", "LINEAR", "CUBICSPLINE"]

_SPARSE_FPS = 30.0
"""Rate at which an animation is sampled whose keys are too far apart to be one for each frame."""
_SLOWEST = 10.0
"""Keys a second below which they are taken to be far apart."""
_ROUNDED = 1e-3
"""Share by which a rate from times that a program rounded may miss the whole number that was meant."""
_SINGLE = 1e-6
"""The same for times that single precision alone rounded."""
_MOST_FRAMES = 10**8


@dataclass(frozen=True, eq=False)
class Channel:
    """What moves one node in one way.

    Args:
        node: which of the nodes.
        path: what of it: "translation", "rotation" (xyzw) or "scale".
        times: (K,) float32 seconds, ascending.
        values: (K, C) float32, C = 4 for rotations and else 3; (K, 3, C) for "CUBICSPLINE": the tangent
            before, the value, the tangent after.
        interpolation: between two keys the value of the first ("STEP"), a straight line or the short arc
            ("LINEAR"), or a Hermite spline ("CUBICSPLINE").
    """

    node: int
    path: Path
    times: NDArray[np.float32]
    values: NDArray[np.float32]
    interpolation: Interpolation = "LINEAR"

    def __post_init__(self) -> None:
        object.__setattr__(self, "times", frozen(self.times, np.float32))
        object.__setattr__(self, "values", frozen(self.values, np.float32))
        width = 4 if self.path == "rotation" else 3
        middle = (3,) if self.interpolation == "CUBICSPLINE" else ()
        wanted = (len(self.times), *middle, width)
        if not len(self.times) or self.values.shape != wanted:
            raise GmrError(f"the values of a channel have the shape {self.values.shape}; it must be {wanted}")

    def at(self, times: Array) -> Array:
        """(F, C) float64 values at (F,) seconds; before the first key its value, after the last its own."""
        keys = self.times.astype(np.float64)
        times = np.clip(times, keys[0], keys[-1])
        before = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, max(len(keys) - 2, 0))
        after = np.minimum(before + 1, len(keys) - 1)
        span = keys[after] - keys[before]
        share = np.where(span > 0, (times - keys[before]) / np.where(span > 0, span, 1), 0.0)[:, None]
        if self.interpolation == "STEP":
            found = np.where(share >= 1, self.values[after], self.values[before]).astype(np.float64)
        elif self.interpolation == "LINEAR":
            a, b = (self.values[k].astype(np.float64) for k in (before, after))
            found = _arc(a, b, share) if self.path == "rotation" else a + share * (b - a)
        else:
            found = _spline(self.values, before, after, span[:, None], share)
        return _unit(found) if self.path == "rotation" else found


@dataclass(frozen=True, eq=False)
class Animation:
    """A clip: channels that play together."""

    name: str
    channels: tuple[Channel, ...]

    @cached_property
    def start(self) -> float:
        """Seconds at the first key of any channel; 0 without channels."""
        return float(min((channel.times[0] for channel in self.channels), default=0.0))

    @cached_property
    def end(self) -> float:
        """Seconds at the last key of any channel; 0 without channels."""
        return float(max((channel.times[-1] for channel in self.channels), default=0.0))

    @cached_property
    def fps(self) -> float:
        """Keys a second of the channel that has the most; 30 where they are far apart (fewer than 10 a
        second)."""
        keys = max((channel.times for channel in self.channels), key=len, default=np.zeros(0, np.float32))
        steps = np.diff(keys.astype(np.float64))
        steps = steps[steps > 0]
        rate, slack = 1 / float(np.median(steps)) if len(steps) else 0.0, _ROUNDED
        if rate < _SLOWEST:
            return _SPARSE_FPS
        if np.abs(steps - 1 / rate).max() <= 4 * float(np.finfo(np.float32).eps) * abs(keys).max():
            # Evenly apart but for the rounding of each time: from end to end the rate is told best, and a
            # whole number that was not meant would leave the keys behind.
            rate, slack = len(steps) / float(steps.sum()), _SINGLE
        whole = round(rate)
        return float(whole) if abs(rate - whole) <= slack * rate else rate

    def frame_times(self, fps: float | None = None) -> Array:
        """(F,) seconds from the first key to the last, ``fps`` a second; :attr:`fps` where left out.

        Raises:
            GmrError: the rate is not above 0, or there would be too many frames.
        """
        rate = self.fps if fps is None else float(fps)
        if not 0 < rate < np.inf:
            raise GmrError(f"an animation cannot have {fps} frames a second; give a rate above 0")
        frames = (self.end - self.start) * rate
        if not frames <= _MOST_FRAMES:
            raise GmrError(
                f"animation '{self.name}' lasts {self.end - self.start:.6g} s, which is {frames:.3g} "
                f"frames at {rate:.6g} a second; check its times, or give a lower rate"
            )
        # A key that single precision puts just before a frame belongs to that frame.
        count = int(np.floor(frames * (1 + 1e-6) + 1e-3)) + 1
        return np.asarray(self.start + np.arange(count) / rate)


def _arc(a: Array, b: Array, share: Array) -> Array:
    """(F, 4) spherical interpolation along the short arc. Source: Shoemake, SIGGRAPH 1985."""
    a, b = _unit(a), _unit(b)
    dot = (a * b).sum(axis=-1, keepdims=True)
    b = np.where(dot < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(dot), 0, 1))
    sine = np.sin(angle)
    near = sine < 1e-6
    divisor = np.where(near, 1, sine)
    return np.where(
        near,
        a + share * (b - a),
        (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / divisor,
    )


def _spline(
    values: NDArray[np.float32],
    before: NDArray[np.intp],
    after: NDArray[np.intp],
    span: Array,
    share: Array,
) -> Array:
    """(F, C) the cubic Hermite spline of glTF 2.0, appendix C.3."""
    point, leaving = (values[before, k].astype(np.float64) for k in (1, 2))
    arriving, following = (values[after, k].astype(np.float64) for k in (0, 1))
    t, tt = share, share * share
    ttt = tt * t
    return np.asarray(
        (2 * ttt - 3 * tt + 1) * point
        + span * (ttt - 2 * tt + t) * leaving
        + (3 * tt - 2 * ttt) * following
        + span * (ttt - tt) * arriving
    )


def _unit(found: Array) -> Array:
    """(F, 4) quaternions of length 1; one of length 0 is the identity."""
    lengths = np.linalg.norm(found, axis=-1, keepdims=True)
    identity = np.array([0.0, 0.0, 0.0, 1.0])
    return np.where(lengths > 0, found / np.where(lengths > 0, lengths, 1), identity)
