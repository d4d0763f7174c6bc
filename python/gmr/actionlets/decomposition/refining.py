"""Cuts, angles and skews of many curves together, moved to where the squared error is least.

Levenberg and Marquardt's method. A sample depends on its own piece alone, so the unknowns hang together like
a chain: angle and time of an instant of rest and skew of the piece that begins there, coupled to the next.
All curves are laid one after the other on one axis of time; the gaps between them are pieces without samples.
Source: Marquardt, "An algorithm for least-squares estimation of nonlinear parameters", J. SIAM 11, 1963.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.bell import bell, share, share_by_skew
from gmr.actionlets.decomposition.chain import solved
from gmr.actionlets.decomposition.outline import Outline

__all__ = ["refined"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_STEEPEST: Final = float(np.log(0.96 / 0.04))
"""Of log(T / (1 - T)): skews stay within 0.04 and 0.96, beyond which a bell has a corner."""

_SETTLED: Final = 3e-4
"""Share of the squared error that a step must take away for another to be worth it."""

_TIED: Final = 1e5
"""How much more than by its samples an end of a silence is held to its other end."""


def refined(
    times: Floats, curves: Sequence[Floats], outlines: Sequence[Outline], shortest: float, steps: int = 40
) -> list[Outline]:
    """The outlines after at most ``steps`` steps.

    Args:
        times: (N,) seconds of the samples, common to all curves.
        curves: C of (N,) radians.
        outlines: where to start from, one for each curve; a piece that has no travel keeps having none.
        shortest: seconds below which no piece is shortened.
    """
    if not curves:
        return []
    samples = _Samples.of(times, curves)
    state = _State.of(outlines, samples.spacing)
    residuals = state.residuals(samples)
    error = samples.by_curve(residuals**2)
    damping = np.full(len(curves), 1e-2)
    moving = np.ones(len(curves), bool)
    for left in range(steps - 1, -1, -1):  # noqa: B007  (looked at after the loop)
        step = _step(state, samples, residuals, damping)
        trial = state.moved(step, moving, shortest)
        trial_residuals = trial.residuals(samples)
        trial_error = samples.by_curve(trial_residuals**2)
        better = moving & (trial_error < error)
        gained = error - trial_error
        state = trial.only(better, state)
        residuals = np.where(better[samples.curve], trial_residuals, residuals)
        damping = np.where(better, np.maximum(damping / 6, 1e-9), damping * 5)
        moving &= ~((better & (gained <= _SETTLED * error)) | (damping > 1e6))
        error = np.where(better, trial_error, error)
        if 2 * moving.sum() <= len(curves):
            break
    else:
        return state.outlines(samples.spacing)
    # Those that are settled need not be looked at any more.
    found = state.outlines(samples.spacing)
    going_on = np.flatnonzero(moving).tolist()
    if going_on:
        of_these = refined(times, [curves[n] for n in going_on], [found[n] for n in going_on], shortest, left)
        for n, outline in zip(going_on, of_these, strict=True):
            found[n] = outline
    return found


@dataclass(frozen=True, slots=True)
class _Samples:
    """All samples of all curves on one axis of time."""

    times: Floats
    values: Floats
    curve: Ints
    count: int
    spacing: float
    """From the beginning of one curve to that of the next, seconds."""

    @classmethod
    def of(cls, times: Floats, curves: Sequence[Floats]) -> _Samples:
        spacing = float(times[-1] - times[0]) + 1.0
        shifts = np.arange(len(curves)) * spacing
        return cls(
            (times - times[0] + shifts[:, None]).ravel(),
            np.concatenate(curves),
            np.repeat(np.arange(len(curves)), len(times)),
            len(curves),
            spacing,
        )

    def by_curve(self, values: Floats) -> Floats:
        """(C,) sums."""
        sums: Floats = np.bincount(self.curve, values, self.count).astype(np.float64)
        return sums


@dataclass(frozen=True, slots=True)
class _State:
    """All outlines as one chain of K instants; the piece that begins at a curve's last instant is a gap."""

    times: Floats
    angles: Floats
    odds: Floats
    """(K,) log(T / (1 - T)) of the piece that begins at each instant."""
    curve: Ints
    held: NDArray[np.bool_]
    """(K,) whether the instant is an end of its curve and keeps its time."""
    still: NDArray[np.bool_]
    """(K,) whether the piece that begins there is a silence."""

    @classmethod
    def of(cls, outlines: Sequence[Outline], spacing: float) -> _State:
        skews = np.concatenate([np.append(outline.skews, 0.5) for outline in outlines])
        curve = np.repeat(np.arange(len(outlines)), [len(outline.times) for outline in outlines])
        angles = np.concatenate([outline.angles for outline in outlines])
        ends = np.diff(curve, prepend=-1, append=len(outlines)) != 0
        return cls(
            np.concatenate([o.times - o.times[0] + n * spacing for n, o in enumerate(outlines)]),
            angles,
            np.log(skews / (1 - skews)),
            curve,
            ends[:-1] | ends[1:],
            (np.diff(angles, append=np.nan) == 0) & ~ends[1:],
        )

    @property
    def skews(self) -> Floats:
        return 1 / (1 + np.exp(-self.odds))

    def places(self, samples: _Samples) -> tuple[Ints, Floats, Floats]:
        """Of each sample: its piece, how long that is, and the share of it that is over."""
        piece = np.searchsorted(self.times, samples.times, side="right") - 1
        piece -= self.times[piece] >= self.times[np.flatnonzero(self.held)[1::2]][samples.curve]
        length = self.times[piece + 1] - self.times[piece]
        return piece, length, np.clip((samples.times - self.times[piece]) / length, 0, 1)

    def residuals(self, samples: _Samples) -> Floats:
        piece, _, u = self.places(samples)
        s = share(u, self.skews[piece])
        found: Floats = (1 - s) * self.angles[piece] + s * self.angles[piece + 1] - samples.values
        return found

    def moved(self, step: Floats, moving: NDArray[np.bool_], shortest: float) -> _State:
        """After a step, of which as much of the times is taken as leaves half of every piece."""
        step = np.where(moving[self.curve][:, None], step, 0.0)
        length, shrinking = np.diff(self.times), step[:-1, 1] - step[1:, 1]
        spare = np.maximum(np.minimum(length / 2, length - shortest), 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            allowed = np.where(shrinking > spare, spare / shrinking, 1.0)
        # A gap has no samples and its ends are held: it allows all.
        share_taken = np.ones(int(self.curve[-1]) + 1)
        np.minimum.at(share_taken, self.curve[:-1], allowed)
        return _State(
            self.times + step[:, 1] * share_taken[self.curve],
            self.angles + step[:, 0],
            np.clip(self.odds + np.clip(step[:, 2], -1, 1), -_STEEPEST, _STEEPEST),
            self.curve,
            self.held,
            self.still,
        )

    def only(self, better: NDArray[np.bool_], other: _State) -> _State:
        """This state in the curves that are better, else the other."""
        here = better[self.curve]
        return _State(
            np.where(here, self.times, other.times),
            np.where(here, self.angles, other.angles),
            np.where(here, self.odds, other.odds),
            self.curve,
            self.held,
            self.still,
        )

    def outlines(self, spacing: float) -> list[Outline]:
        """Back as one outline for each curve; both ends of a silence at one angle."""
        angles = self.angles.copy()
        for place in np.flatnonzero(self.still):
            angles[place + 1] = angles[place]
        found = []
        for number in range(int(self.curve[-1]) + 1):
            mine = np.flatnonzero(self.curve == number)
            found.append(Outline(self.times[mine] - number * spacing, angles[mine], self.skews[mine[:-1]]))
        return found


def _step(state: _State, samples: _Samples, residuals: Floats, damping: Floats) -> Floats:
    """(K, 3) change of angles, times and odds by the damped normal equations."""
    piece, length, u = state.places(samples)
    skew = state.skews[piece]
    s = share(u, skew)
    travel = state.angles[piece + 1] - state.angles[piece]
    speed = 2 * travel * bell(u, skew) / length
    free = ~state.held
    by_skew = travel * share_by_skew(u, skew) * skew * (1 - skew)
    # By angle, time and odds of the instant before, by angle and time of the one after.
    slopes = np.stack(
        [1 - s, -speed * (1 - u) * free[piece], by_skew, s, -speed * u * free[piece + 1]], axis=-1
    )
    count = len(state.times)
    products = np.empty((count, 5, 5))
    for i in range(5):
        for j in range(i, 5):
            sums = np.bincount(piece, slopes[:, i] * slopes[:, j], count)
            products[:, i, j] = products[:, j, i] = sums
    pulls: Floats = np.stack(
        [np.bincount(piece, slopes[:, i] * residuals, count) for i in range(5)], axis=-1, dtype=np.float64
    )

    diagonal = products[:, :3, :3].copy()
    diagonal[1:, :2, :2] += products[:-1, 3:, 3:]
    above = np.zeros((count - 1, 3, 3))
    above[:, :, :2] = products[:-1, :3, 3:]
    right = -pulls[:, :3]
    right[1:, :2] -= pulls[:-1, 3:]
    _tie(state, diagonal, above, right)

    own = np.einsum("kii->ki", diagonal)
    floor = 1e-9 * own.mean(axis=0) + 1e-30
    own += damping[state.curve][:, None] * own + floor
    return solved(diagonal, above, right)


def _tie(state: _State, diagonal: Floats, above: Floats, right: Floats) -> None:
    """Holds the ends of silences together."""
    still = np.flatnonzero(state.still)
    if not len(still):
        return
    weight = _TIED * (diagonal[still, 0, 0] + diagonal[still + 1, 0, 0])
    apart = weight * (state.angles[still + 1] - state.angles[still])
    diagonal[still, 0, 0] += weight
    np.add.at(diagonal[:, 0, 0], still + 1, weight)
    above[still, 0, 0] -= weight
    right[still, 0] += apart
    right[still + 1, 0] -= apart
