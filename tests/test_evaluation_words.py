"""Plain English with the right plurals."""

from __future__ import annotations

import pytest

from gmr.evaluation import words


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (words.listing([]), ""),
        (words.listing(["a"]), "a"),
        (words.listing(["a", "b"]), "a and b"),
        (words.listing(["a", "b", "c"]), "a, b and c"),
        (words.some_of(["a", "b", "c", "d"], 3), "a, b, c and 1 more"),
        (words.some_of(["a", "b", "c"], 3), "a, b and c"),
        (words.count(0, "clip"), "no clips"),
        (words.count(1, "clip"), "1 clip"),
        (words.count(2, "copy", "copies"), "2 copies"),
        (words.count(23197, "frame"), "23,197 frames"),
        (words.number(0.03449), "0.034"),
        (words.number(1.0), "1"),
        (words.number(-9.96), "-10"),
        (words.number(123.4), "123"),
        (words.number(0.0), "0"),
        (words.number(1e-7), "0.0000001"),
        (words.percent(0.0), "0%"),
        (words.percent(0.004), "under 1%"),
        (words.percent(0.345), "34%"),
        (words.duration(0.0), "0 seconds"),
        (words.duration(0.42), "0.4 seconds"),
        (words.duration(1.04), "1 second"),
        (words.duration(9.96), "10 seconds"),
        (words.duration(59.6), "60 seconds"),
        (words.duration(150), "2.5 minutes"),
        (words.span(1.0, 1.0, "m/s"), "1 m/s"),
        (words.span(1.25, 3.0, "m/s"), "1.25 to 3 m/s"),
        (words.turning(0, 0), "going straight"),
        (words.turning(25, 75), "turning left by 25 to 75 degrees/s"),
        (words.turning(-75, -75), "turning right by 75 degrees/s"),
        (words.turning(-50, 50), "going straight and turning up to 50 degrees/s either way"),
        (
            words.turning(-50, 25),
            "going straight and turning up to 25 degrees/s to the left and 50 degrees/s to the right",
        ),
        (words.turning(0, 25), "going straight and turning up to 25 degrees/s to the left"),
        (words.going(1.35, 0), "going straight at 1.35 m/s"),
        (words.going(0.05, 0), "standing"),
        (words.going(0.05, -30), "turning right by 30 degrees/s on the spot"),
        (words.gait_of(1.75), "a walk"),
        (words.gait_of(2.0), "a jog"),
        (words.gait_of(2.25), "a run"),
        (words.circles(1.0, 1.0), "circles of 1 m radius"),
        (words.circles(0.573, 3.44), "circles of 0.57 to 3.4 m radius"),
    ],
)
def test_the_words(said: str, expected: str) -> None:
    assert said == expected
