"""Joint centres: what the motion of two parts says, and what anatomy says, each weighed by its uncertainty.

The functional estimate is the symmetrical centre of rotation: the points c1 of the parent and c2 of the child
that stay nearest to each other, ``sum |R1 c1 + t1 - R2 c2 - t2|^2 -> min``. With c2 eliminated, what it says
of c1 has the information matrix ``(I - M M^T) / s^2``, ``M = mean R1^T R2``: directions in which the two
parts hardly turn against each other have none. ``s^2`` has two terms: the variance of the residuals over the
number of independent frames, and the square of the parts' slip, the distance by which their markers stray
from rigid bodies. Skin slides with the angle of the joint, so that its slip shifts the centre without showing
in the residuals, and no number of frames averages it out.
Sources: Ehrig et al., "A survey of formal methods for determining the centre of rotation of ball joints",
J. Biomech. 39 (2006) 2798; that clusters slide as bodies at least as far as they deform: Barré et al., "Soft
tissue artifact assessment during treadmill walking in subjects with total knee arthroplasty", IEEE Trans.
Biomed. Eng. 60 (2013) 3131.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.markers.rigid import RigidFit

__all__ = ["Centre", "Guess", "joint_centre"]

Array = NDArray[np.float64]

_EXACT: Final = 1e-9
"""Metres below which residuals are rounding."""
_UNTOLD: Final = 1e-9
"""Part of the greatest information below which a direction counts as not told by the motion."""
_NO_TURN: Final = 1e-14
"""Variance of a turn, in radians squared, that is rounding."""
_FEWEST: Final = 10
"""Frames that a functional estimate takes."""


@dataclass(frozen=True, slots=True)
class Guess:
    """A joint centre as anatomy has it.

    Args:
        place: (3,) metres in the parent's template.
        covariance: (3, 3) square metres.
        rule: where it is from, in words.
    """

    place: Array
    covariance: Array
    rule: str


@dataclass(frozen=True, slots=True)
class Centre:
    """The centre of a joint.

    Args:
        in_parent: (3,) metres in the parent's template.
        in_child: (3,) metres in the child's.
        gap: root mean square distance in metres of the two from each other over the frames.
        functional: (3,) in the parent, what the motion alone says; None where it was not asked.
        functional_sd: (3,) metres, its standard deviations along ``directions``; infinite where not told.
        directions: (3, 3) columns: the directions in the parent in which ``functional_sd`` is.
        anatomical: (3,) in the parent, what anatomy alone says; None where no rule is given.
        apart: metres between the two estimates; None where one is missing.
        weight: 0 to 1, the part that the motion has in the result; the mean over directions.
    """

    in_parent: Array
    in_child: Array
    gap: float
    functional: Array | None
    functional_sd: Array
    directions: Array
    anatomical: Array | None
    apart: float | None
    weight: float


def joint_centre(
    parent: RigidFit, child: RigidFit, guess: Guess | None, *, functional: bool = True
) -> Centre:
    """The centre of the joint between two parts.

    Args:
        parent: fit of the part above, F frames.
        child: fit of the part below.
        guess: what anatomy says, None where nothing.
        functional: whether the motion is asked; not where the child's fit was made with the guess itself.

    Raises:
        ValueError: no frame shows both parts, or neither the motion nor anatomy says anything.
    """
    both = parent.known & child.known
    r1, t1 = parent.rotations[both], parent.origins[both]
    r2, t2 = child.rotations[both], child.origins[both]
    if not len(r1):
        raise ValueError("no frame shows it and the part above")
    asked = functional and len(r1) >= _FEWEST
    if not asked and guess is None:
        raise ValueError(f"{len(r1)} frames show both parts; {_FEWEST} are needed, or a rule for the centre")
    start = guess.place if guess else _between(r1, t1, r2, t2, child.points)
    if not asked or _still(r1, r2):
        in_child = _seen_by_child(start, r1, t1, r2, t2)
        none = np.full(3, np.inf)
        gap = _gap(start, in_child, r1, t1, r2, t2)
        return Centre(start, in_child, gap, None, none, np.eye(3), start, None, 0.0)
    slip = float(np.hypot(parent.slip, child.slip))
    moved, information, directions = _symmetrical(start, r1, t1, r2, t2, slip)
    found = start + directions @ moved
    gain: Array = np.eye(3)
    if guess is not None:
        held = directions.T @ np.linalg.inv(guess.covariance) @ directions
        gain = np.asarray(np.linalg.solve(np.diag(information) + held, np.diag(information)), np.float64)
    place, weight = start + directions @ gain @ moved, float(np.trace(gain) / 3)
    with np.errstate(divide="ignore"):
        deviations = 1 / np.sqrt(information)
    in_child = _seen_by_child(place, r1, t1, r2, t2)
    return Centre(
        in_parent=place,
        in_child=in_child,
        gap=_gap(place, in_child, r1, t1, r2, t2),
        functional=found,
        functional_sd=deviations,
        directions=directions,
        anatomical=guess.place if guess else None,
        apart=float(np.linalg.norm(moved)) if guess else None,
        weight=weight,
    )


def _still(r1: Array, r2: Array) -> bool:
    """Whether the parts do not turn against each other at all, so that the motion says nothing."""
    mean = (np.swapaxes(r1, 1, 2) @ r2).mean(axis=0)
    return bool(np.linalg.norm(np.eye(3) - mean @ mean.T) < _NO_TURN)


def _symmetrical(
    start: Array, r1: Array, t1: Array, r2: Array, t2: Array, slip: float
) -> tuple[Array, Array, Array]:
    """The functional centre as a step from ``start`` along three directions, the information in each, and
    the directions as columns: the eigenvectors of the information matrix.

    In directions that the motion does not tell step and information are 0.
    """
    relative = np.swapaxes(r1, 1, 2) @ r2
    mean = relative.mean(axis=0)
    # d: where the child's origin is as the parent sees it, from the start; then c1 - d = R1^T R2 c2.
    d = np.einsum("fji,fj->fi", r1, t2 - t1) - start
    carried = np.einsum("fji,fj->fi", relative, d)
    normal = np.eye(3) - mean @ mean.T
    right = d.mean(axis=0) - mean @ carried.mean(axis=0)
    values, vectors = np.linalg.eigh(normal)
    told = values > max(_UNTOLD * values[-1], _NO_TURN)
    along = np.where(told, vectors.T @ right / np.where(told, values, 1.0), 0.0)
    step = vectors @ along
    c2 = (np.swapaxes(relative, 1, 2) @ step).mean(axis=0) - carried.mean(axis=0)
    residuals = step - d - relative @ c2
    variance = _variance(residuals) * _inefficiency(residuals) / len(residuals) + slip**2
    return along, np.where(told, values, 0.0) / variance, vectors


def _variance(residuals: Array) -> float:
    """Variance of one coordinate; six numbers were fitted."""
    return max(float(np.square(residuals).sum() / max(residuals.size - 6, 1)), _EXACT**2)


def _inefficiency(residuals: Array) -> float:
    """How many successive frames say as much as one independent one, for a first-order autoregression.

    Source: Bayley and Hammersley, "The 'Effective' Number of Independent Observations in an Autocorrelated
    Time Series", J. R. Stat. Soc. Suppl. 8 (1946) 184.
    """
    deviations = residuals - residuals.mean(axis=0)
    power = float(np.square(deviations).sum())
    if power < residuals.size * _EXACT**2:
        return 1.0
    correlation = min(max(float((deviations[1:] * deviations[:-1]).sum()) / power, 0.0), 1.0)
    most = len(residuals)
    return min((1 + correlation) / max(1 - correlation, 1 / most), float(most))


def _between(r1: Array, t1: Array, r2: Array, t2: Array, points: Array) -> Array:
    """A place to start from without anatomy: the middle of the child's markers, as the parent sees it."""
    return _seen_by_child(np.nanmean(points, axis=0), r2, t2, r1, t1)


def _seen_by_child(place: Array, r1: Array, t1: Array, r2: Array, t2: Array) -> Array:
    """(3,) the mean place of a point of the first part as the second sees it."""
    seen: Array = np.einsum("fji,fj->fi", r2, r1 @ place + t1 - t2).mean(axis=0)
    return seen


def _gap(in_parent: Array, in_child: Array, r1: Array, t1: Array, r2: Array, t2: Array) -> float:
    apart = r1 @ in_parent + t1 - r2 @ in_child - t2
    return float(np.sqrt(np.square(apart).sum(axis=1).mean()))
