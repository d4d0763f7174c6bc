"""``gmr decompose``: the score of a motion, from the command line and in a real browser."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from playwright.sync_api import Browser, ViewportSize

import gmr
from browsers import chromium, opened
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.demo import demo_folder

WALK = demo_folder() / "07_01.bvh"
Captured = pytest.CaptureFixture[str]
SIZES: list[ViewportSize] = [{"width": 1280, "height": 900}, {"width": 390, "height": 844}]


def run(*args: str | Path) -> int:
    """The exit code of ``gmr decompose ARGS``, in this process."""
    return finished(command, ["decompose", *(str(arg) for arg in args)])


def test_a_line_for_each_degree_of_freedom_that_moves(capsys: Captured) -> None:
    assert run(WALK, "--dofs", "file", "--joints", "LeftUpLeg, LeftLeg,LHipJoint") == 0
    first, *lines = capsys.readouterr().out.splitlines()
    assert first.startswith(f"{WALK}: 2.62 s, 9 degrees of freedom, ")
    assert [line.split()[0] for line in lines[1:4]] == [f"LeftUpLeg.{axis}rotation" for axis in "ZYX"]
    assert lines[-1] == "  3 more hold one angle throughout"


def test_the_body_s_degrees_of_freedom_unless_told_otherwise(capsys: Captured) -> None:
    assert run(WALK) == 0
    said = capsys.readouterr().out
    assert "22 degrees of freedom" in said
    assert "left_knee.flexion" in said


def test_the_json_holds_the_whole_score(capsys: Captured) -> None:
    assert run(WALK, "--dofs", "file", "--joints", "LeftLeg", "--tolerance", "2", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    direct = gmr.actionlets.decompose(gmr.read(WALK), joints=["LeftLeg"], tolerance_deg=2)
    assert found["pieces"] == direct.score.piece_count
    track = found["dofs"]["LeftLeg.Xrotation"]["track"]
    assert sum(piece["seconds"] for piece in track) == pytest.approx(found["seconds"])
    for one, other in pairwise(track):
        assert one["end_deg"] == pytest.approx(other["start_deg"])


@pytest.mark.parametrize(
    ("args", "code", "words"),
    [
        (["--joints", "Tail", "--dofs", "file"], 1, "no angles of a joint 'Tail'"),
        (["--tolerance", "0"], 2, "0"),
        (["--dofs", "arms"], 2, "arms"),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence(
    args: list[str], code: int, words: str, capsys: Captured
) -> None:
    assert run(WALK, *args) == code
    assert words in capsys.readouterr().err


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    yield from chromium("--disable-gpu")


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("score") / "<b>score.html"
    assert run(WALK, "--dofs", "file", "--joints", "LeftUpLeg,LeftLeg,RightArm", "--out", path) == 0
    return path


@pytest.mark.browser
@pytest.mark.parametrize("size", SIZES, ids=["desktop", "phone"])
def test_the_score_draws_itself_and_tells_what_is_pointed_at(
    browser: Browser, page_file: Path, size: ViewportSize
) -> None:
    page, complaints = opened(browser, page_file, size)
    found = gmr.actionlets.decompose(gmr.read(WALK), joints=["LeftUpLeg", "LeftLeg", "RightArm"])
    pieces = found.score.piece_count
    shown = page.locator(".score .hit").evaluate_all(
        "all => new Set(all.map(one => one.dataset.stave + '/' + one.dataset.piece)).size"
    )
    assert shown == pieces
    systems = page.locator(".score svg").count()
    assert systems == (1 if size["width"] > 1000 else 2)
    assert page.locator(".score .recorded").count() == 9 * systems
    assert page.locator(".score-tip").is_hidden()
    page.locator(".score .hit").first.hover()
    told = page.locator(".score-tip").inner_text()
    assert "LeftUpLeg" in told
    assert "T = " in told
    assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
    assert complaints == []
    page.close()
