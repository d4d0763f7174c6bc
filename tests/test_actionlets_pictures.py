"""Film strips."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from gmr.actionlets import Body, film_strip, posing
from gmr.actionlets.figure import LIMBS, figure, outline
from gmr.demo import demo_folder
from gmr.errors import ActionletError

BODY = Body.of()
STEPS = posing.motion(
    BODY,
    np.zeros((50, 40)),
    np.stack([np.zeros(50), np.full(50, BODY.hip_height), np.linspace(0, 1, 50)], axis=-1),
    fps=50,
)
circles = st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(0.1, 2)), min_size=1, max_size=5)


def shapes(svg: str) -> list[ElementTree.Element]:
    return list(ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}path"))


@given(circles)
def test_an_outline_is_convex_and_holds_its_circles(given_circles: list[tuple[float, float, float]]) -> None:
    hull = outline(np.array(given_circles))
    edges = np.roll(hull, -1, axis=0) - hull
    after = np.roll(edges, -1, axis=0)
    assert (edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0] > -1e-9).all()
    for x, y, _ in given_circles:
        inward = edges[:, 0] * (y - hull[:, 1]) - edges[:, 1] * (x - hull[:, 0])
        assert (inward > 0).all()


@pytest.mark.parametrize("view", ["side", "front", "three-quarter"])
@pytest.mark.parametrize("count", [1, 5])
def test_a_strip_has_as_many_figures_as_asked(view: str, count: int) -> None:
    svg = film_strip(STEPS, count=count, view=view, plan=False)
    filled = [shape for shape in shapes(svg) if shape.get("fill") not in (None, "none")]
    assert len(filled) == count * len(LIMBS)
    assert svg == film_strip(STEPS, count=count, view=view, plan=False)


def test_a_strip_of_several_motions_has_a_row_for_each(tmp_path: Path) -> None:
    walk = gmr.read(demo_folder() / "07_01.bvh")
    svg = film_strip([STEPS, walk], tmp_path / "both.svg", 4, titles=["own & <plain>", "captured"])
    assert (tmp_path / "both.svg").read_text(encoding="utf-8") == svg
    assert "own &amp; &lt;plain>" in svg
    assert svg.count(" s</text>") == 8


def test_a_png_is_drawn(tmp_path: Path) -> None:
    pytest.importorskip("vl_convert")
    film_strip(STEPS, tmp_path / "steps.png", 3)
    assert (tmp_path / "steps.png").read_bytes().startswith(b"\x89PNG")


def test_the_figure_of_a_standing_body_stands_on_its_soles() -> None:
    shown = figure(STEPS)
    assert shown.ground == 0
    assert shown.height == pytest.approx(BODY.height, rel=0.01)
    assert np.allclose(shown.facing, 0)
    for side in ("left", "right"):
        for point, at in (("heel", BODY.foot.heel), ("ball", BODY.foot.ball)):
            sole = shown.places[f"{side}_{point}"] - shown.places[f"{side}_ankle"]
            assert np.allclose(sole[:, 2], at[2], atol=0.02)
            assert np.allclose(sole[:, 1] - 0.013 * shown.height, at[1], atol=0.01)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"view": "above"}, "give one of side, front, three-quarter"),
        ({"count": 0}, "give 1 or more figures"),
        ({"count": 10**9}, "give 1 or more figures, 10,000 at most"),
        ({"motion": []}, "there is no motion to draw"),
        ({"path": "strip.gif"}, r"written as .svg or .png, not as 'strip.gif'"),
    ],
)
def test_what_cannot_be_drawn_is_refused(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(ActionletError, match=words):
        film_strip(**{"motion": STEPS, **arguments})  # type: ignore[arg-type]
