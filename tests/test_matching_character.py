"""A character stepped by hand: it is a trial where it is asked for the same."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from gmr.matching import Character, Database, Status
from walkers import walker

DATABASE = Database.build(
    [walker(4.0, 1.2, 0.4, name="curve"), walker(4.0, 2.5, -0.2, swing=0.8, name="run")]
)


def ahead(character: Character, speed: float, turn_rate: float) -> NDArray[np.float64]:
    """What a stick asks for: an arc from where it stands."""
    x, z, heading = character.place
    times = character.times
    middle = heading + 0.5 * turn_rate * times
    away = speed * times * np.sinc(turn_rate * times / (2 * np.pi))
    return np.stack(
        [x + away * np.sin(middle), z + away * np.cos(middle), heading + turn_rate * times], axis=1
    )


def test_a_character_goes_where_it_is_sent() -> None:
    character = Character(DATABASE, x=2.0, z=-1.0, heading=0.5)
    np.testing.assert_allclose(character.times, [1 / 3, 2 / 3, 1.0])
    begun = np.array(character.place)
    np.testing.assert_array_equal(begun, [2.0, -1.0, 0.5])
    way = 0.0
    for _ in range(5 * 90):
        before = np.array(character.place[:2])
        shown = character.step(ahead(character, 1.2, 0.4), 1 / 90)
        way += float(np.linalg.norm(np.array(character.place[:2]) - before))
    assert way == pytest.approx(1.2 * 5, rel=0.1)
    assert character.place[2] - 0.5 == pytest.approx(0.4 * 5, rel=0.15)
    assert np.hypot(shown.x - character.place[0], shown.z - character.place[1]) < 0.1
    assert shown.positions.shape == (len(DATABASE.skeleton.names), 3)
    np.testing.assert_allclose(np.linalg.norm(shown.bone_rotations, axis=1), 1, atol=1e-5)


def test_a_search_that_is_asked_for_is_made_at_the_next_tick() -> None:
    character = Character(DATABASE, search_every=60.0)
    for _ in range(3):
        character.step(ahead(character, 1.2, 0.4), 1 / 60)
        assert character.status == Status.PLAYED_ON
        assert np.isnan(character.costs).all()
    character.search_now()
    character.step(ahead(character, 2.5, -0.2), 1 / 60)
    assert character.status == Status.JUMPED
    assert DATABASE.clips[character.row] == 1


def test_a_character_is_put_where_a_program_wants_it() -> None:
    character = Character(DATABASE)
    character.step(ahead(character, 1.2, 0.4), 0.5)
    character.place = (5.0, 6.0, 1.0)
    np.testing.assert_allclose(character.place, (5.0, 6.0, 1.0), atol=1e-12)
    np.testing.assert_allclose(character.shown.positions[:, [0, 2]].mean(axis=0), (5.0, 6.0), atol=1.0)


def test_what_cannot_be_stepped_is_refused_in_words() -> None:
    character = Character(DATABASE)
    wanted = ahead(character, 1.2, 0.4)
    for places, dt, words in [
        (wanted[:2], 0.01, "wanted places holds 2 elements where 3 are needed"),
        (wanted[:, :2], 0.01, "wanted has 2 columns; give x, z and heading"),
        (wanted[0], 0.01, r"wanted must be \(3, 3\)"),
        (wanted * np.nan, 0.01, "wanted place 0 is not finite"),
        (wanted, -1.0, "a step of -1 s is not possible; use 0 to 10 s"),
    ]:
        with pytest.raises(ValueError, match=words):
            character.step(places, dt)
    with pytest.raises(ValueError, match="a search every 0 s is not possible"):
        Character(DATABASE, search_every=0)
    with pytest.raises(ValueError, match="no frame that may be jumped to carries all of the tag bits 0b100"):
        Character(DATABASE, tags=4)
