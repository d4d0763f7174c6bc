"""The actions that ship: all can be performed by a body, and do what they are asked."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.actionlets import Body, library

SHIPPED = tuple(library())
PAGE = Path(__file__).parent.parent / "docs" / "actions.md"


@pytest.mark.parametrize("name", SHIPPED)
def test_every_action_becomes_a_motion_that_can_be_written(name: str, tmp_path: Path) -> None:
    take = library()[name].take(fps=60)
    assert take.motion.frame_count == int(take.performance.seconds * 60 + 1e-6) + 1
    assert take.motion.name == name
    gmr.write(take.motion, tmp_path / "out.bvh")
    read = gmr.read(tmp_path / "out.bvh")
    np.testing.assert_allclose(read.positions(), take.motion.positions(), atol=1e-4)
    heights = take.motion.positions(dtype=np.float64)[:, :, 1]
    assert heights.min() > -0.02
    assert heights.max() < 2.8


@pytest.mark.parametrize(
    ("name", "speed"), [("walk", 0.6), ("walk", 1.3), ("walk", 2.0), ("run", 3.5), ("run", 5.0), ("jog", 2.3),
                        ("sneak", 0.55), ("march", 1.2)],
)  # fmt: skip
def test_who_goes_goes_as_fast_as_is_asked(name: str, speed: float) -> None:
    motion = library()[name].motion(seconds=6, fps=60, speed=speed)
    hips = motion.positions(joints=["pelvis"], dtype=np.float64)[:, 0]
    assert np.hypot(*(hips[-1] - hips[0])[::2]) / 6 == pytest.approx(speed, rel=0.03)


@pytest.mark.parametrize(("name", "rate"), [("walk", 45), ("walk", -30), ("run", 40), ("turn", 75)])
def test_who_turns_turns_as_fast_and_to_the_side_that_is_asked(name: str, rate: float) -> None:
    seconds = 5.0
    take = library()[name].take(seconds=seconds, fps=60, turn_rate=rate)
    hips = take.motion.positions(joints=["left_hip", "right_hip"], dtype=np.float64)
    across = hips[:, 0] - hips[:, 1]
    heading = np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))
    asked = np.trapezoid(take.performance.turn_rate[:, 1], take.performance.turn_rate[:, 0])
    assert np.sign(asked) == np.sign(rate)
    assert np.degrees(heading[-1] - heading[0]) == pytest.approx(np.degrees(asked), abs=12)


@pytest.mark.parametrize("height", [0.1, 0.3, 0.5])
def test_a_jump_rises_as_high_as_is_asked(height: float) -> None:
    take = library()["jump"].take(fps=120, height=height)
    from gmr.actionlets import posing

    centre = posing.centre_of_mass(Body.of(), take.motion)[:, 1]
    (before, after) = take.performance.contacts["left"]
    assert after[0] - before[1] == pytest.approx(np.sqrt(8 * height / 9.81), abs=0.02)
    inside = np.arange(len(centre)) / 120
    flight = centre[(inside >= before[1]) & (inside <= after[0])]
    assert flight.max() - (flight[0] + flight[-1]) / 2 == pytest.approx(height, rel=0.1)


@pytest.mark.parametrize("name", ["wave", "punch", "kick"])
def test_the_left_handed_do_the_same_in_a_mirror(name: str) -> None:
    right, left = (library()[n].motion(fps=30).positions(dtype=np.float64) for n in (name, f"{name}_left"))
    names = library()[name].motion(fps=30).skeleton.names
    other = [n.replace("left", "x").replace("right", "left").replace("x", "right") for n in names]
    mirrored = left[:, [names.index(n) for n in other]] * [-1, 1, 1]
    np.testing.assert_allclose(mirrored, right, atol=5e-3)


@pytest.mark.parametrize(("tempo", "speed"), [(90, 0.0), (90, 1.2), (105, 1.4), (120, 1.2), (140, 1.4)])
def test_a_march_moves_up_and_down_by_few_centimetres_with_steps_of_up_to_80_centimetres(
    tempo: float, speed: float
) -> None:
    take = library()["march"].take(4, 60, tempo=tempo, speed=speed)
    assert np.ptp(take.carried.root[80:-40, 1]) < 0.055
    assert take.report.slide_mm < 1


def test_the_names_that_the_interface_promises_are_there() -> None:
    known = library()
    assert known["running"] is known["run"]
    for name in ("walk", "run", "jog", "sneak", "march", "turn in place", "start", "stop", "jump", "squat"):
        assert name in known
    for name in ("sit down", "wave", "punch", "kick", "clap", "bow"):
        assert known[name].about


def test_every_action_has_words_and_the_page_tells_it_with_its_parameters() -> None:
    page = PAGE.read_text(encoding="utf-8")
    for name in library():
        action = library()[name]
        assert action.words
        assert action.about
        (row,) = re.findall(rf"^\| `{name}` \|.*$", page, re.MULTILINE)
        assert action.about in row
        for parameter in action.parameters.values():
            unit = f" {parameter.unit}" if parameter.unit else ""
            assert (
                f"{parameter.name} {parameter.low:g} to {parameter.high:g}{unit} [{parameter.default:g}]"
                in row
            )
