"""What is done to many frames at once is what is done to one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from gmr.actionlets import Body, Score, Track, posing
from gmr.actionlets.travel import turns
from gmr.actionlets.travel.mass import mass_from_pelvis
from scores import tracks

few = settings(max_examples=25, deadline=None)
seeds = st.integers(0, 2**32 - 1)


@given(tracks(curves=False), seeds)
@few
def test_a_track_at_times_in_any_order_is_each_of_its_pieces_at_its_own_time(track: Track, seed: int) -> None:
    """Pieces sample themselves by the bell, tracks by halves of actionlets."""
    times = np.random.default_rng(seed).uniform(-0.5, track.duration + 0.5, 40)
    found = track.angle(times), track.velocity(times), track.acceleration(times)
    steepest = max(
        np.abs(piece.acceleration(np.linspace(0, piece.duration, 33))).max() for piece in track.pieces
    )
    for k, time in enumerate(np.clip(times, 0, track.duration).tolist()):
        number = int(np.searchsorted(track.times[1:-1], time, side="right"))
        piece, since = track.pieces[number], time - track.times[number]
        assert found[0][k] == pytest.approx(piece.angle(since), abs=1e-9)
        assert found[1][k] == pytest.approx(piece.velocity(since), abs=1e-9 * max(1.0, steepest))
        assert found[2][k] == pytest.approx(piece.acceleration(since), abs=1e-6 * max(1.0, steepest))


@given(st.lists(tracks(), min_size=2, max_size=4), seeds)
@few
def test_a_score_moves_each_degree_of_freedom_as_its_track_does(some: list[Track], seed: int) -> None:
    lasts = [Track(tuple(p.lasting(p.duration / track.duration) for p in track.pieces)) for track in some]
    score = Score({f"dof {k}": track for k, track in enumerate(lasts)})
    times = np.random.default_rng(seed).uniform(-0.1, 1.1, 30)
    alone = np.stack([track.angle(times) for track in lasts], axis=1)
    np.testing.assert_array_equal(score.angles(times), alone)
    np.testing.assert_array_equal(score.angles(np.sort(times)), alone[np.argsort(times)])


@given(seeds, st.sampled_from([Body.of(1.6, "female"), Body.of(1.9, "male", detailed=False)]))
@few
def test_the_mass_from_the_pelvis_is_that_of_the_body_in_motion(seed: int, body: Body) -> None:
    moving = [not dof.is_length for dof in body.dofs]
    angles = np.random.default_rng(seed).uniform(-1, 1, (5, body.dof_count)) * moving
    posed = posing.motion(body, angles, root=[0.0, 0.0, 0.0])
    np.testing.assert_allclose(mass_from_pelvis(body, angles), posing.centre_of_mass(body, posed), atol=1e-12)


@given(seeds, st.booleans())
@few
def test_turns_are_matrices_in_whatever_order_they_lie(seed: int, is_fortran: bool) -> None:
    numbers = np.random.default_rng(seed)
    x, z, y = numbers.uniform(-3, 3, (3, 7))
    order = np.asfortranarray if is_fortran else np.ascontiguousarray
    one: NDArray[np.float64] = order(turns.about_x(x) @ turns.about_z(z) @ turns.about_y(y))
    other: NDArray[np.float64] = order(numbers.normal(size=(7, 3, 3)))
    ways: NDArray[np.float64] = order(numbers.normal(size=(7, 3)))
    back = one.swapaxes(1, 2)
    for found, expected in (
        (turns.product(x, z, y), one),
        (turns.times(one, other), one @ other),
        (turns.seen_from(one, other), back @ other),
        (turns.bent(one, x), one @ turns.about_x(x)),
        (turns.turned(one, ways), (one @ ways[:, :, None])[:, :, 0]),
        (turns.turned(one, ways[0]), one @ ways[0]),
        (turns.turned_back(one, ways), (back @ ways[:, :, None])[:, :, 0]),
        (turns.dots(ways, ways[::-1]), (ways * ways[::-1]).sum(axis=1)),
        (turns.picked(one, np.array([4, 0])), one[[4, 0]]),
    ):
        np.testing.assert_allclose(found, expected, atol=1e-14)
