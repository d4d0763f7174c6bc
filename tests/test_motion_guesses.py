"""What a file does not say: which way is up, its unit, whether a converter put a T-pose in front."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr import ChannelLayout, Motion, Skeleton
from gmr.description import describe
from gmr.guesses import guess_body
from gmr.matching.survey import survey
from gmr.tpose import has_leading_tpose, leading_rest_frames, without_leading_tpose
from gmr.units import UNITS, metres_per_unit


@pytest.fixture(scope="module")
def walk() -> Motion:
    return gmr.read(Path(__file__).parent / "data" / "cmu_07_01.bvh")


def with_rows(motion: Motion, rows: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Motion:
    assert motion.layout is not None
    return Motion.from_rows(motion.skeleton, motion.layout, rows, motion.frame_time)


def test_the_t_pose_of_a_converter_is_told_from_the_recording(walk: Motion) -> None:
    assert has_leading_tpose(walk)
    assert without_leading_tpose(walk) == walk[1:]
    assert without_leading_tpose(walk[1:]) == walk[1:]
    assert leading_rest_frames(replace(walk, source=walk.pose)) == 1


def test_frames_of_zeros_behind_the_t_pose_count_too(walk: Motion) -> None:
    zeros = np.zeros((4, walk.rows.shape[1]))
    assert leading_rest_frames(with_rows(walk, np.concatenate([walk.rows[:1], zeros, walk.rows[1:]]))) == 5


def test_a_recording_that_starts_from_rest_is_left_whole(walk: Motion) -> None:
    weight = np.linspace(0, 1, 30)[:, None]
    eased = (1 - weight) * walk.rows[:1] + weight * walk.rows[1:2]
    assert leading_rest_frames(with_rows(walk, eased)) == 0
    assert leading_rest_frames(with_rows(walk, np.repeat(walk.rows[:1], 50, axis=0))) == 0
    assert [leading_rest_frames(walk[:k]) for k in range(3)] == [0, 0, 0]


@pytest.mark.parametrize("unit", ["m", "cm", "mm", "in", "ft", "cmu"])
def test_the_unit_of_a_walk_is_guessed(walk: Motion, unit: str) -> None:
    guess = guess_body(walk.with_unit("cmu").to_unit(unit)).unit
    assert guess is not None
    assert guess.name == unit
    assert 1.4 < guess.body_metres < 1.9


def test_no_unit_is_guessed_for_what_is_no_human(walk: Motion) -> None:
    assert guess_body(walk.with_unit(1).to_unit(2.0)).unit is None


@pytest.mark.parametrize("child", [0.55, 0.7, 0.8, 1.0, 1.3, 1.45, 1.6, 0.08, 13.0])
def test_a_guess_is_what_evaluation_takes(walk: Motion, child: float) -> None:
    sized = replace(walk.with_unit(1).to_unit(1 / child), unit=None)
    guess = guess_body(sized).unit
    if guess is None:
        with pytest.raises(gmr.errors.DatasetError, match="unit="):
            survey({"walk": sized}, 0.0)
        return
    surveyed = survey({"walk": sized}, 0.0)
    assert (surveyed.units["walk"], surveyed.up) == (guess.metres, "+Y")
    assert guess.by == "legs"


def test_a_body_on_its_knees_is_measured_by_its_legs(walk: Motion) -> None:
    assert walk.layout is not None
    rows = walk.rows.copy()
    for knee in walk.skeleton.indices(["LeftLeg", "RightLeg"]).tolist():
        bent = [name.lower() for name in walk.layout.names[knee]].index("xrotation")
        rows[:, walk.layout.starts[knee] + bent] = 110
    kneeling, upright = guess_body(with_rows(walk, rows)), guess_body(walk)
    assert kneeling.height is not None
    assert upright.height is not None
    assert kneeling.height < 0.9 * upright.height
    assert kneeling.unit is not None
    assert upright.unit is not None
    assert kneeling.unit.name == upright.unit.name
    assert kneeling.unit.body_metres == pytest.approx(upright.unit.body_metres)


@pytest.mark.parametrize(
    ("axis", "turn"),
    [("+Y", (0, 0, 0)), ("-Y", (180, 0, 0)), ("+Z", (90, 0, 0)), ("-X", (0, 0, 90)), ("+X", (0, 0, -90))],
)
def test_up_is_from_feet_to_head(axis: str, turn: tuple[float, float, float]) -> None:
    skeleton = Skeleton.post_rotation(
        ["Hips", "Head", "LeftFoot", "LeftHand"], [-1, 0, 0, 0], [[0, 0, 0], [0, 1, 0], [0, -1, 0], [3, 0, 0]]
    )
    layout = ChannelLayout.of(skeleton, [("Xrotation", "Yrotation", "Zrotation"), (), (), ()])
    motion = Motion.from_rows(skeleton, layout, [turn], 0.1)
    guess = guess_body(motion)
    assert guess.up is not None
    assert (guess.up.axis, guess.up.sure) == (axis, True)
    assert guess.height == pytest.approx(2)


def test_without_frames_nothing_is_guessed(walk: Motion) -> None:
    described = describe(walk[:0])
    assert (described.up_guess, described.unit_guess, described.height) == (None, None, None)
    assert "no frames: a skeleton alone" in described.oddities


@pytest.mark.parametrize("unit", [*UNITS, 0.3, "0.3", "CM"])
def test_a_unit_goes_by_its_name_or_its_metres(unit: float | str) -> None:
    assert metres_per_unit(unit) > 0


@pytest.mark.parametrize("unit", ["parsec", 0, -1, "nan", float("inf")])
def test_what_is_no_unit_is_refused(unit: float | str) -> None:
    with pytest.raises(gmr.GmrError, match="unit"):
        metres_per_unit(unit)
