"""Random actionlets, tracks and scores for property tests; they shrink to one symmetric actionlet."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import strategies as st

from gmr.actionlets import Actionlet, Measured, Piece, Score, Track

angles = st.one_of(st.integers(-180, 180).map(lambda deg: float(np.radians(deg))), st.floats(-3, 3))
durations = st.one_of(st.integers(1, 20).map(lambda tenths: tenths / 10), st.floats(0.02, 3))
skews = st.one_of(st.just(0.5), st.floats(0.05, 0.95))
shares = st.floats(0, 1)
actionlets = st.builds(Actionlet, angles, angles, durations, skews)
measured = st.builds(Measured, st.lists(angles, min_size=2, max_size=9), durations)


@st.composite
def tracks(
    draw: st.DrawFn, max_pieces: int = 5, whole: bool = True, periodic: bool = False, curves: bool = True
) -> Track:
    """Pieces one after the other, some of them silences or measured; begun and ended midway if not whole."""
    count = draw(st.integers(1, max_pieces))
    ends = [draw(angles) for _ in range(count + 1)]
    if periodic:
        ends[-1] = ends[0]
    pieces: list[Piece] = []
    for start, end in pairwise(ends):
        if curves and draw(st.integers(0, 4)) == 4:
            pieces.append(draw(measured).between(start, end))
        else:
            still = not periodic and draw(st.integers(0, 4)) == 4
            pieces.append(Actionlet(start, end, draw(durations), draw(skews)))
            if still:
                pieces.append(Actionlet.silence(end, draw(durations)))
    if whole:
        return Track(tuple(pieces))
    lead, trail = (0.45 * draw(shares) * piece.duration for piece in (pieces[0], pieces[-1]))
    return Track(tuple(pieces), lead, trail)


@st.composite
def scores(
    draw: st.DrawFn, dofs: int = 3, whole: bool = True, periodic: bool = False, curves: bool = True
) -> Score:
    """Tracks stretched to last as long."""
    duration = draw(durations)
    made = {}
    for number in range(draw(st.integers(1, dofs))):
        track = draw(tracks(whole=whole, periodic=periodic, curves=curves))
        factor = duration / track.duration
        made[f"dof {number}"] = Track(
            tuple(piece.lasting(piece.duration * factor) for piece in track.pieces),
            track.lead * factor,
            track.trail * factor,
        )
    return Score(made)


def assert_smooth(track: Track) -> None:
    """No jump of the angle or of the velocity anywhere: C1."""
    inner = track.times[1:-1]
    inner = inner[(inner > 0) & (inner < track.duration)]
    step = 1e-7
    scale = max(1.0, float(np.abs(track.velocity(np.linspace(0, track.duration, 200))).max()))
    before, after = np.maximum(inner - step, 0), np.minimum(inner + step, track.duration)
    np.testing.assert_allclose(track.angle(before), track.angle(after), atol=1e-6 * scale)
    np.testing.assert_allclose(track.velocity(inner), 0, atol=1e-7 * scale)
    for times in (before, after):
        # Velocity rises from 0 at most as the steepest acceleration lets it.
        steepest = max(abs(p.acceleration(np.linspace(0, p.duration, 33))).max() for p in track.pieces)
        assert (np.abs(track.velocity(times)) <= 1e-7 + 4 * step * steepest).all()
