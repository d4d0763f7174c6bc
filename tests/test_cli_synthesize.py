"""``gmr synthesize``: a motion by the name of its action; what it cannot make is said in one sentence."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gmr
from action_files import SWING
from gmr.actionlets import library
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished

Captured = pytest.CaptureFixture[str]


def run(*args: str | Path) -> int:
    return finished(command, ["synthesize", *map(str, args)])


def test_it_writes_what_the_library_gives(tmp_path: Path, capsys: Captured) -> None:
    out = tmp_path / "walk.bvh"
    assert (
        run("walk", "--out", out, "--seconds", "2", "--fps", "60", "--speed", "1.5", "--turn-rate", "20") == 0
    )
    assert "121 frames, 2 s of 'walk'" in capsys.readouterr().err
    read = gmr.read(out)
    made = library()["walk"].motion(seconds=2, fps=60, speed=1.5, turn_rate=20)
    np.testing.assert_allclose(read.positions(), made.positions(), atol=1e-4)


def test_the_same_arguments_make_the_same_file(tmp_path: Path) -> None:
    one, other, third = (tmp_path / name for name in ("one.bvh", "other.bvh", "third.bvh"))
    for out, seed in ((one, "7"), (other, "7"), (third, "8")):
        assert run("wave", "--out", out, "--seed", seed, "--variation", "0.5") == 0
    assert one.read_bytes() == other.read_bytes()
    assert one.read_bytes() != third.read_bytes()


def test_a_parameter_may_change_on_the_way(tmp_path: Path) -> None:
    out = tmp_path / "faster.bvh"
    assert run("walk", "--out", out, "--seconds", "4", "--set", "speed=0:0.8,4:2", "--height", "1.6") == 0
    hips = gmr.read(out).positions(joints=["pelvis"], dtype=np.float64)[:, 0]
    speed = np.linalg.norm(np.diff(hips[:, ::2], axis=0), axis=1) * 120
    assert speed[:60].mean() == pytest.approx(0.85, abs=0.15)
    assert speed[-60:].mean() == pytest.approx(1.95, abs=0.15)


def test_it_lists_actions_with_their_parameters_and_those_of_your_file(
    tmp_path: Path, capsys: Captured
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(SWING)
    assert run("--list", "--library", file) == 0
    said = capsys.readouterr().out
    for name in (*library(), "swing"):
        assert f"\n{name} " in f"\n{said}"
    assert "speed      0 to 2.3 m/s [1.3]" in said
    assert "also: running" in said


def test_a_strip_is_drawn_with_and_without_a_motion(tmp_path: Path) -> None:
    strip = tmp_path / "bow.svg"
    assert run("bow", "--strip", strip) == 0
    assert strip.read_text().startswith("<svg")
    assert [file.name for file in tmp_path.iterdir()] == ["bow.svg"]


@pytest.mark.parametrize(
    ("args", "code", "says"),
    [
        ([], 2, "name an ACTION, or give --list"),
        (["walk"], 2, "give --out FILE, --strip FILE or both"),
        (["wlak", "--out", "x.bvh"], 1, "no action is called 'wlak'. Did you mean walk"),
        (
            ["walk", "--out", "x.bvh", "--speed", "9"],
            1,
            "'speed' of 'walk' is 9 m/s; its range is 0 to 2.3 m/s",
        ),
        (["wave", "--out", "x.bvh", "--speed", "1"], 1, "action 'wave' has no parameter 'speed'"),
        (["walk", "--out", "x.bvh", "--set", "speed"], 2, "'speed' sets nothing; write speed=1.2"),
        (["walk", "--out", "x.bvh", "--set", "speed=0:1,2"], 2, "sets nothing"),
        (["walk", "--out", "x.bvh", "--height", "4"], 1, "4"),
        (["walk", "--out", "x.bvh", "--seconds", "-1"], 1, "give more than 0"),
        (["walk", "--out", "x.bvh", "--variation", "3"], 1, "a variation of 3 cannot be"),
        (["walk", "--out", "x.xyz"], 1, ".xyz"),
        (["walk", "--out", "x.bvh", "--set", "seconds=3"], 1, "'walk' has no parameter 'seconds'"),
        (["walk", "--out", "x.bvh", "--set", "speed=1", "--set", "speed=2"], 2, "'speed' is set twice"),
        (["walk", "--out", "x.bvh", "--set", "speed=1", "--speed", "2"], 2, "'speed' is set twice"),
        (
            ["walk", "--out", "x.bvh", "--fps", "1e9"],
            1,
            "1e+09 frames a second cannot be; give more than 0 and at most 10,000",
        ),
        (["walk", "--out", "x.bvh", "--fps", "1000", "--seconds", "36000"], 1, "36,000,000 frames"),
        (["walk,run", "--out", "x.bvh"], 2, "are several actions; give --variations N"),
        (["walk", "--out", "x.bvh", "--format", "glb"], 2, "--format tells of a corpus"),
        (["walk", "--out", "x.bvh", "--workers", "2"], 2, "--workers tells of a corpus"),
        (["walk", "--out", "x.bvh", "--cluster", "local"], 2, "--cluster tells of a corpus"),
        (["walk", "--out", "x.bvh", "--json"], 2, "--json tells of a corpus"),
        (["walk", "--library", "gone.toml", "--out", "x.bvh"], 1, "gone.toml: it cannot be read"),
    ],
)
def test_what_it_cannot_make_is_said_in_a_sentence(
    args: list[str], code: int, says: str, capsys: Captured, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(*args) == code
    assert says in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
