"""Whether a movement stays in the ranges of motion of its joints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.errors import ActionletError

if TYPE_CHECKING:
    from gmr.actionlets.body import Body
    from gmr.actionlets.dofs import Dof

__all__ = ["check", "outside"]

_EXACT = 1e-9
"""Radians (metres) that rounding may add to a value at the end of its range."""


def check(body: Body, angles: ArrayLike | Any, times: ArrayLike | None = None, what: str = "") -> None:
    """See :meth:`gmr.actionlets.Body.check`."""
    tracks = getattr(angles, "tracks", None)
    if isinstance(tracks, Mapping):
        _check_tracks(body, tracks, what)
        return
    values = np.atleast_2d(np.asarray(angles, np.float64))
    if values.ndim != 2 or values.shape[1] != body.dof_count:
        raise ActionletError(
            f"angles have the shape {np.shape(angles)}; the {body.name} body needs "
            f"(frames, {body.dof_count}), a column for each degree of freedom"
        )
    wrong = np.argwhere(outside(body, values))
    if not len(wrong):
        return
    frame, column = wrong[0].tolist()
    when = f"frame {frame}" if times is None else f"{float(np.asarray(times)[frame]):.3f} s"
    raise ActionletError(_message(body.dofs[column], float(values[frame, column]), when, what))


def outside(body: Body, angles: ArrayLike) -> NDArray[np.bool_]:
    """(..., D) whether each value is out of its range; NaN is."""
    values = np.asarray(angles, np.float64)
    return ~((values >= body.low - _EXACT) & (values <= body.high + _EXACT))


def _check_tracks(body: Body, tracks: Mapping[str, Any], what: str) -> None:
    """The extremes of a score are its pieces' starts and ends, for between them each piece is monotone; a
    measured piece is looked at in its samples."""
    for name, track in tracks.items():
        dof = body.dof(name)
        for start, piece in zip(track.times, track.pieces, strict=False):
            samples = getattr(piece, "angles", None)
            values = np.asarray((piece.start, piece.end) if samples is None else samples, np.float64)
            wrong = np.flatnonzero(~((values >= dof.low - _EXACT) & (values <= dof.high + _EXACT)))
            if len(wrong):
                when = f"the piece that begins at {float(start):.3f} s"
                raise ActionletError(_message(dof, float(values[wrong[0]]), when, what))


def _message(dof: Dof, value: float, when: str, what: str) -> str:
    unit = "m" if dof.is_length else "degrees"
    shown = value if dof.is_length else np.degrees(value)
    of = f"{what}: " if what else ""
    return (
        f"{of}joint '{dof.joint}', degree of freedom '{dof.name}': {shown:.4g} {unit} in {when} is outside "
        f"the range of motion, {dof.low_deg:g} to {dof.high_deg:g} {unit}. Keep it inside, or clip it: "
        "body.clipped(angles)"
    )
