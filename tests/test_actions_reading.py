"""Library files: what is wrong in one is said with file, table, key, value and what was expected."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from action_files import SWING, library_of, swinging
from gmr.actionlets import library
from gmr.errors import FormatError

HEAD = "format = 1\n"
ACTION = '[action.a]\nperiod = 1\nunits = ["j"]\n'
JOINT = '[joint.j]\njoint = "neck"\nflexion = [[0, 0], [0.5, 10]]\n'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("walk", ["this is no TOML", "docs/actions.md"]),
        ("", ["[mine.toml] format = (nothing)", "format = 1"]),
        ("format = 2", ["format = 2", "expected format = 1"]),
        (HEAD + "[actoin.a]\nperiod = 1\n", ["no key 'actoin'", "Did you mean action"]),
        (HEAD + JOINT + "[action.a]\nunits = ['j']\n", ["[action.a] has neither period nor duration"]),
        (HEAD + JOINT + "[action.a]\nperiod = 1\nduration = 2\n", ["has period and duration", "one of them"]),
        (
            HEAD + JOINT + "[action.a]\nperiod = 0\nunits = ['j']\n",
            ["[action.a] period = 0", "more than 0 s"],
        ),
        (
            HEAD + JOINT + "[action.a]\nperiod = { tempo = [[1, 2], [2, -1]] }\n",
            ["[action.a] period = ", "more than 0 s, whatever the parameters"],
        ),
        (HEAD + ACTION, ["[action.a] uses 'j'", "no joint, limb or group is called"]),
        (HEAD + ACTION.replace('"j"', '"walk_lge"'), ["uses 'walk_lge'", "Did you mean walk_leg"]),
        (HEAD + "[joint.j]\njoint = 'nekc'\nflexion = 3\n", ["[joint.j] moves the joint 'nekc'", "neck"]),
        (HEAD + "[joint.j]\njoint = 'neck'\nflexoin = 3\n", ["the motion 'flexoin'", "Did you mean flexion"]),
        (HEAD + "[joint.j]\njoint = 'neck'\n", ["[joint.j] moves nothing"]),
        (
            HEAD + "[joint.j]\njoint = 'neck'\nflexion = [[0, 0], [0.5, 100]]\n",
            ["[joint.j] takes neck.flexion to 100 degrees", "-45 to 45 degrees"],
        ),
        (
            HEAD + "[joint.j]\njoint = 'neck'\nflexion = { mood = [[0, 40], [1, 46]] }\n",
            ["takes neck.flexion to 46 degrees"],
        ),
        (
            HEAD + "[joint.j]\njoint = 'neck'\nflexion = [[0, 0], [0.5, 10, 1]]\n",
            ["flexion[1] skew = 1", "above 0 and below 1"],
        ),
        (
            HEAD + "[joint.j]\njoint = 'neck'\nflexion = [[0.5, 0], [0.5, 10]]\n",
            ["flexion[1] = [0.5, 10]", "phases that rise", "an actionlet must last"],
        ),
        (
            HEAD + "[joint.j]\njoint = 'neck'\nflexion = [[0, 0], [1.5, 10]]\n",
            ["flexion[1] phase = 1.5", "from 0 to 1"],
        ),
        (
            HEAD + "[joint.j]\njoint = 'neck'\nflexion = [[0, nan]]\n",
            ["flexion[0] angle = nan", "a number"],
        ),
        (
            HEAD + "[joint.j]\njoint = 'neck'\nflexion = { mood = [[1, 40], [0, 46]] }\n",
            ["flexion.mood", "mood rising; 0 comes after 1"],
        ),
        (
            HEAD + JOINT + '[joint.k]\njoint = "left_knee"\nflexion = 3\n[limb.l]\nunits = ["j", "k"]\n',
            ["[limb.l] is a limb", "not connected", "neck and left_knee", "[group]"],
        ),
        (HEAD + JOINT + '[limb.l]\nunits = ["j"]\n', ["[limb.l] units", "two joint actions or more"]),
        (
            HEAD + '[group.g]\nunits = ["h"]\n[group.h]\nunits = ["g"]\n',
            ["circle of names", "g -> h -> g"],
        ),
        (
            HEAD + '[action.a]\nfrom = "b"\n[action.b]\nfrom = "a"\n',
            ["no circle of names", "a -> b -> a"],
        ),
        (HEAD + '[action.a]\nfrom = "wlak"\n', ["[action.a] from = 'wlak'", "Did you mean walk"]),
        (
            HEAD + '[action.a]\nperiod = 1\nunits = ["walk_leg"]\n',
            [
                "[action.a] uses 'walk_leg', which moves a hip",
                "without saying which",
                "side = 'left' or 'right'",
            ],
        ),
        (
            HEAD + JOINT + '[action.a]\nperiod = 1\nunits = ["j", "walk_neck"]\n',
            ["has 'j' and 'walk_neck'", "both move neck.flexion"],
        ),
        (
            HEAD + ACTION + '[joint.j]\njoint = "neck"\nflexion = { vigour = [[0, 0], [1, 10]] }\n',
            ["[action.a] moves neck.flexion by the parameter 'vigour'", "does not have"],
        ),
        (
            HEAD + JOINT + ACTION + '[action.a.dofs]\n"neck.flexoin" = 3\n',
            ["'neck.flexoin'", "Did you mean neck.flexion"],
        ),
        (
            HEAD + JOINT + ACTION + '[action.a.dofs]\n"waist.flexion" = { scale = 2 }\n',
            ["changes waist.flexion, which no unit of it moves"],
        ),
        (
            HEAD + JOINT + ACTION + "[action.a.parameters.fps]\nlow = 0\nhigh = 1\ndefault = 0\n",
            ["a parameter cannot be called 'fps'"],
        ),
        (
            HEAD + JOINT + ACTION + "[action.a.parameters.vigour]\nlow = 0\nhigh = 1\ndefault = 2\n",
            ["[action.a.parameters.vigour] default = 2", "low = 0 to high = 1"],
        ),
        (
            HEAD + JOINT + ACTION + "contacts.middle = [[0, 1]]\n",
            ["[action.a.contacts] has no key 'middle'"],
        ),
        (HEAD + JOINT + ACTION + "travel = 'flying'\n", ["[action.a] travel = 'flying'", "path, feet"]),
        (
            HEAD + JOINT + ACTION + "course.tempo = [[1, 0], [0.5, 1]]\n",
            ["[action.a.course] tempo", "rising from the beginning"],
        ),
        (
            HEAD + JOINT + '[action."../../out"]\nperiod = 1\nunits = ["j"]\n',
            ["[mine.toml] action = '../../out'", "letters, digits, _ and -"],
        ),
        (HEAD + JOINT + '[action."a,b"]\nperiod = 1\nunits = ["j"]\n', ["action = 'a,b'", "letters"]),
        (HEAD + JOINT + '[action.""]\nperiod = 1\nunits = ["j"]\n', ["action = ''", "letters"]),
        (HEAD + JOINT + ACTION.replace("1", "1e-9"), ["period = 1e-09", "0.01 to 3600"]),
        (HEAD + JOINT + ACTION.replace("1", "1e300"), ["period = 1e+300", "a number from -1e6 to 1e6"]),
        (HEAD + JOINT + ACTION.replace("1", "9" * 400), ["period = 9999", "a number from -1e6 to 1e6"]),
        (HEAD + JOINT + ACTION.replace("1", "9" * 5000), ["this is no TOML", "digits"]),
        (HEAD + JOINT + ACTION + "begins = 1e300\n", ["begins = 1e+300", "a number from -1e6 to 1e6"]),
        (HEAD + JOINT + ACTION + "seconds = 1e5\n", ["seconds = 100000.0", "36,000 at most"]),
        (
            HEAD + JOINT + ACTION.replace("1", "{ speed = [[0, 1], [1, 2]] }"),
            ["[action.a] lasts as long as it does by the parameter 'speed'", "does not have"],
        ),
        (
            HEAD + JOINT + ACTION + "contacts = { left = [[0, { sped = [[0, 1], [1, 2]] }]] }\n",
            ["[action.a] has contacts of the left foot by the parameter 'sped'"],
        ),
        (
            HEAD + JOINT + ACTION + "phases = { up = [0, { sped = [[0, 1], [1, 2]] }] }\n",
            ["[action.a] has the phase 'up' by the parameter 'sped'"],
        ),
        (
            HEAD + JOINT + ACTION + "course = { speed = [[0, 1]] }\n",
            ["[action.a] has the course of a parameter 'speed', which it does not have"],
        ),
        (HEAD + "[action.a]\nperiod = 1\n", ["[action.a] moves nothing", "give it units"]),
        (
            HEAD + JOINT + ACTION + '[action.a.dofs]\n"root.surge" = 1e5\n',
            ["[action.a] takes root.surge to 100000 m", "-100 to 100 m"],
        ),
        (
            HEAD
            + JOINT
            + "".join(f'[group.g{i}]\nunits = ["g{i + 1}"]\n' for i in range(3000))
            + '[group.g3000]\nunits = ["j"]\n',
            ["units in units more than 100 deep"],
        ),
        (
            HEAD
            + JOINT
            + ACTION
            + "".join(f'[action.b{i}]\nfrom = "b{i + 1}"\n' for i in range(3000))
            + '[action.b3000]\nfrom = "a"\n',
            ["at most 100 names that take from each other in a row"],
        ),
        (
            HEAD
            + JOINT
            + '[group.g0]\nunits = [{ unit = "j", rate = 100 }]\n'
            + "".join(f'[group.g{i + 1}]\nunits = [{{ unit = "g{i}", rate = 100 }}]\n' for i in range(9)),
            ["has 'g0' 100 times in a period", "10,000 are the most"],
        ),
        (
            HEAD + "[sequence.s]\nactions = [" + '"walk", ' * 5000 + "]\n",
            ["1,000 actions at most", "5,000"],
        ),
        (
            HEAD + '[sequence.s]\nactions = [{ action = "walk", seconds = 30000 }, '
            '{ action = "run", seconds = 30000 }]\n',
            ["36,000 s together at most", "60,000"],
        ),
        (HEAD + '[sequence.s]\nactions = ["walk"]\njoin = 1e5\n', ["join = 100000.0", "60 at most"]),
        (
            HEAD + '[sequence.s]\nactions = ["walk", "sitt"]\n',
            ["[sequence.s] actions[1] = 'sitt'", "sit"],
        ),
        (
            HEAD + '[sequence.s]\nactions = [{ action = "walk", speed = 9 }]\n',
            ["[sequence.s] actions[0]", "'speed' of 'walk' is 9 m/s", "0 to 2.3 m/s"],
        ),
        (HEAD + '[joint.walk_hip]\njoint = "hip"\nflexion = 3\n', ["1_walking.toml gives to", "another"]),
        (
            HEAD + JOINT + ACTION + 'aliases = ["walking"]\n',
            ["[action.a] aliases: 'walking' means 'walk' already"],
        ),
    ],
)
def test_what_is_wrong_is_named_with_its_place(text: str, says: list[str], tmp_path: Path) -> None:
    with pytest.raises(FormatError) as caught:
        library_of(text, tmp_path)
    said = str(caught.value)
    assert said.startswith(f"{tmp_path / 'mine.toml'}: ")
    for words in says:
        assert words in said


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"gone\.toml: it cannot be read"):
        library(tmp_path / "gone.toml")


def test_a_users_file_takes_what_ships_and_changes_some_of_it(tmp_path: Path) -> None:
    known = library_of('format = 1\n[action.stiff]\nfrom = "walk"\ndofs."left_knee.flexion" = 5\n', tmp_path)
    assert {*known} == {*library(), "stiff"}
    stiff, walk = (known[name].perform().score for name in ("stiff", "walk"))
    assert np.ptp(stiff["left_knee.flexion"].extremes) == 0
    assert stiff["right_knee.flexion"] == walk["right_knee.flexion"]


def test_a_unit_from_another_keeps_what_it_does_not_change(tmp_path: Path) -> None:
    text = 'format = 1\n[joint.high]\nfrom = "walk_knee"\nflexion = [[0.0, 5], [0.7, 90]]\n'
    text += '[action.a]\nperiod = 1\nunits = [{ unit = "high", side = "left" }]\n'
    score = library_of(text, tmp_path)["a"].perform(seconds=1).score
    assert score.dofs == ("left_knee.flexion",)
    assert np.degrees(score["left_knee.flexion"].extremes.max()) == pytest.approx(90)


def test_files_may_use_each_others_names(tmp_path: Path) -> None:
    (tmp_path / "one.toml").write_text(SWING)
    (tmp_path / "two.toml").write_text('format = 1\n[action.far]\nfrom = "swing"\n')
    assert "far" in library(tmp_path / "one.toml", tmp_path / "two.toml")


def test_what_is_used_for_the_right_is_mirrored(tmp_path: Path) -> None:
    text = SWING + '[action.other]\nfrom = "swing"\nmirrored = true\n'
    known = library_of(text, tmp_path)
    one = known["swing"].perform({"drift": 7}, 3).score
    other = known["other"].perform({"drift": -7}, 3).score
    times = np.linspace(0, 3, 50)
    np.testing.assert_allclose(
        one.angles(times, ["waist.rotation"]), -other.angles(times, ["waist.rotation"])
    )
    np.testing.assert_allclose(
        one.angles(times, ["left_hip.flexion"]), other.angles(times, ["right_hip.flexion"])
    )


def test_an_unknown_action_offers_the_nearest(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no action is called 'swnig'\. Did you mean swing"):
        swinging(tmp_path)["swnig"]


def test_a_file_without_end_is_refused_and_not_read_to_the_end() -> None:
    with pytest.raises(FormatError, match="/dev/zero: so much is no library of actions; 16 MB are the most"):
        library("/dev/zero")
