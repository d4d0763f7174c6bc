"""Rigid fits: where a cluster of markers is and how it is turned, frame by frame.

The template of a cluster and its poses are found in turns: every frame is fitted to the template, and the
template is the mean of the frames seen from their fits (generalised Procrustes analysis).
Sources: Kabsch, Acta Cryst. A32 (1976) 922 and A34 (1978) 827; Gower, Psychometrika 40 (1975) 33.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.markers.gaps import seen

__all__ = ["FEWEST", "RigidFit", "Template", "find_template", "fit_poses"]

FEWEST: Final = 3
"""Points that a pose takes."""

_THINNEST: Final = 0.004
"""Metres that points must spread across their longest line (root mean square), or the turn about it is not
told."""
_SAMPLES: Final = 80
"""Frames, spread over the recording, that the template is made of."""
_ROUNDS: Final = 50
_STILL: Final = 1e-9
"""Metres by which a template that has settled may change."""

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Template:
    """The shape of a cluster.

    Args:
        points: (m, 3) metres, in a frame of the cluster's own with the centroid near its origin; NaN for a
            marker that is never seen together with three others.
    """

    points: Array

    @property
    def spread(self) -> float:
        """Root mean square of the points' distances from their longest line: what tells the turn about it."""
        known = self.points[seen(self.points)]
        if len(known) < FEWEST:
            return 0.0
        sizes = np.linalg.svd(known - known.mean(axis=0), compute_uv=False)
        return float(sizes[1] / np.sqrt(len(known)))


@dataclass(frozen=True, slots=True)
class RigidFit:
    """A cluster over F frames: a point p of its template is at ``rotations @ p + origins`` in the world.

    Args:
        points: (m, 3) metres, the template.
        rotations: (F, 3, 3) with determinant +1, NaN where not known.
        origins: (F, 3) metres, NaN where not known.
        known: (F,) whether three markers or more were seen, and not on one line.
        residuals: (F, m) metres from each marker to its place in the fit; NaN where not seen or not known.
    """

    points: Array
    rotations: Array
    origins: Array
    known: NDArray[np.bool_]
    residuals: Array

    @property
    def slip(self) -> float:
        """Root mean square of the residuals in metres: how far the markers stray from one rigid body."""
        known = self.residuals[np.isfinite(self.residuals)]
        return float(np.sqrt(np.square(known).mean())) if len(known) else 0.0

    def place(self, point: Array) -> Array:
        """(F, 3) where a point of the template is in the world."""
        return self.rotations @ point + self.origins

    def seen_from(self, positions: Array) -> Array:
        """(F, ..., 3) world positions (F, ..., 3) as the cluster sees them."""
        shift = positions - self.origins.reshape(len(positions), *(1,) * (positions.ndim - 2), 3)
        return np.asarray(np.einsum("fji,f...j->f...i", self.rotations, shift), np.float64)


def find_template(positions: Array) -> Template | None:
    """The shape of a cluster of m markers over F frames.

    Args:
        positions: (F, m, 3) metres, NaN where not seen.

    Returns:
        The template, or None where no frame shows three of the markers off one line.
    """
    there = seen(positions)
    usable = np.flatnonzero(there.sum(axis=1) >= FEWEST)
    if not len(usable):
        return None
    fullest = usable[np.argmax(there[usable].sum(axis=1))]
    step = max(1, len(usable) // _SAMPLES)
    frames = positions[usable[::step]]
    points = positions[fullest] - np.nanmean(positions[fullest], axis=0)
    for _ in range(_ROUNDS):
        fit = fit_poses(points, frames)
        if not fit.known.any():
            return None
        held = _mean_over_frames(fit.seen_from(frames))
        change = np.nanmax(np.abs(held - points), initial=0.0)
        settled = np.array_equal(np.isnan(held), np.isnan(points)) and change < _STILL
        points = held
        if settled:
            break
    return Template(points)


def fit_poses(points: Array, positions: Array) -> RigidFit:
    """The rigid motions that take the template nearest to the markers, frame by frame (least squares).

    Args:
        points: (m, 3) metres, NaN for points without a place in the template.
        positions: (F, m, 3) metres, NaN where not seen.
    """
    used = seen(positions) & seen(points)
    count = np.maximum(used.sum(axis=1), 1)[:, None]
    world, local = np.where(used[..., None], positions, 0.0), np.where(np.isnan(points), 0.0, points)
    world_mean = world.sum(axis=1) / count
    local_mean = used @ local / count
    # Points that are not seen are zeros, so that only one of the two factors needs its mean taken off.
    covariance = np.swapaxes(world, 1, 2) @ local - count[..., None] * (
        world_mean[:, :, None] * local_mean[:, None, :]
    )
    u, sizes, vt = np.linalg.svd(covariance)
    u[np.linalg.det(u @ vt) < 0, :, 2] *= -1
    rotations = u @ vt
    known = (used.sum(axis=1) >= FEWEST) & (sizes[:, 1] >= _THINNEST**2 * count[:, 0])
    rotations[~known] = np.nan
    origins = world_mean - (rotations @ local_mean[..., None])[..., 0]
    fitted = local @ np.swapaxes(rotations, 1, 2) + origins[:, None]
    distances = np.sqrt(np.square(fitted - world).sum(axis=2))
    residuals = np.where(used & known[:, None], distances, np.nan)
    return RigidFit(points, rotations, origins, known, residuals)


def _mean_over_frames(places: Array) -> Array:
    """(m, 3) mean of (F, m, 3) over the frames in which each is seen; NaN where none is."""
    there = seen(places)
    sums = np.where(there[..., None], places, 0.0).sum(axis=0)
    with np.errstate(invalid="ignore"):
        mean: Array = sums / np.where(there.any(axis=0), there.sum(axis=0), np.nan)[:, None]
    return mean
