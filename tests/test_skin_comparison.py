"""The comparison of a real character: its tables, its words, its pictures."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.skinning import comparison
from gmr.skinning.comparison import rendering

RIGGED = Path(__file__).parent / "data" / "rigged_simple.gltf"


@pytest.fixture(scope="module")
def compared() -> comparison.Comparison:
    character = gmr.read_character(RIGGED)
    poses = character.animation(fps=30)
    return comparison.compare(character, poses, 1 / 30, motion="<its own & only>")


def test_tables_say_what_blending_gives(compared: comparison.Comparison) -> None:
    character, poses = compared.character, compared.poses
    apart = np.linalg.norm(character.skin(poses, "dqbs") - character.skin(poses, "lbs"), axis=-1)
    assert np.allclose(compared.apart["apart_max_mm"], 1000 * apart.max(axis=1), rtol=1e-4, atol=1e-3)
    assert np.allclose(compared.apart["apart_mean_mm"], 1000 * apart.mean(axis=1), rtol=1e-4, atol=1e-3)
    assert len(compared.frames) == 3 * len(poses)
    assert set(compared.apart["joint"].tolist()) <= set(character.joint_names)
    assert len(compared.capsule) == 3 * (31 + 37)


def test_a_long_clip_in_pieces_is_measured_as_one(
    compared: comparison.Comparison, monkeypatch: pytest.MonkeyPatch
) -> None:
    from gmr.skinning.comparison import measured

    monkeypatch.setattr(measured, "_AT_A_TIME", 1000)
    again = comparison.compare(compared.character, compared.poses, compared.frame_time)
    for column in ("volume", "edge_worst"):
        assert np.array_equal(again.frames[column], compared.frames[column])
    assert np.array_equal(again.apart["apart_max_mm"], compared.apart["apart_max_mm"])


def test_the_frames_shown_are_the_most_different_and_not_neighbours(compared: comparison.Comparison) -> None:
    frames = compared.most_apart(3)
    apart = compared.apart["apart_max_mm"]
    assert int(apart.argmax()) in frames
    assert frames == sorted(frames)
    assert min(np.diff(frames), default=99) > 0.25 * 30


def test_the_page_holds_words_and_charts_and_no_markup_from_outside(compared: comparison.Comparison) -> None:
    html = comparison.page(compared, [], None)
    assert "&lt;its own &amp; only&gt;" in html
    assert "<its own" not in html
    assert comparison.headline(compared).split(";")[0] in html.replace("&#x27;", "'")
    for figure in ("clip_volume", "clip_apart", "bend_bulge", "twist_section"):
        assert f'data-figure="{figure}"' in html


def test_no_frame_is_refused(compared: comparison.Comparison) -> None:
    with pytest.raises(gmr.SkinError, match="no frame"):
        comparison.compare(compared.character, compared.poses[:0], 1 / 30)


def test_a_film_in_real_time_shows_each_frame_when_it_is_due() -> None:
    assert rendering.film_frames(4, 1 / 30) == [0, 1, 2, 3]
    assert rendering.film_frames(8, 1 / 60) == [0, 2, 4, 6]
    assert rendering.film_frames(2, 1 / 15) == [0, 0, 1, 1]
    assert rendering.film_frames(1, 1 / 120) == [0]


def test_stills_film_page_and_tables_are_written(compared: comparison.Comparison, tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    pytest.importorskip("imageio_ffmpeg")
    image = pytest.importorskip("PIL.Image")
    few = comparison.compare(compared.character, compared.poses[::20], 1 / 30, motion="few")
    heard: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        page = comparison.write_comparison(
            few, tmp_path / "out", progress=lambda what, done, total: heard.append(what)
        )
    files = {file.name: file for file in page.parent.iterdir()}
    assert {"index.html", "frames.csv", "apart.csv", "capsule.csv", "side_by_side.mp4"} <= files.keys()
    assert {"stills", "film"} == set(heard)
    stills = [name for name in files if name.endswith(".png")]
    assert {"capsule_bend.png", "capsule_twist.png"} < set(stills)
    for name in stills:
        pixels = np.asarray(image.open(files[name]).convert("L"))
        assert pixels.shape[1] == 1200
        assert (pixels < 200).mean() > 0.02, f"{name} is blank"
    assert files["side_by_side.mp4"].read_bytes()[4:8] == b"ftyp"
    assert "data:video/mp4" in page.read_text(encoding="utf-8")
