"""A dataset is completed alike, whichever axis is up and wherever the ground lies in its files and others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
from gmr.body.measures import UP_TURNS
from gmr.completion import Completion, complete, complete_from, synthesised, write_added
from gmr.completion.candidates import Candidate, variants
from gmr.completion.up import mirrored_upright, raised, turned_up
from gmr.matching.prepare import turned
from walkers import CMU, walker

LEFT = float(np.radians(45.0))
ASKED: Mapping[str, Any] = {"speeds": (1.2,), "turn_rates_deg": (-45.0, 0.0, 45.0), "threads": 2}
AXES = tuple(UP_TURNS)
NEXT = (*AXES[1:], AXES[0])
MIXAMO = {part: f"mixamorig:{name}" for part, name in CMU.items()}

TAKES = {"straight.bvh": walker(5, 1.2), "faster.bvh": walker(5, 1.5)}
ARCHIVE = {"left.bvh": walker(6, 1.2, LEFT), "stands.bvh": walker(3, 0.1)}


def with_up(motions: Mapping[str, gmr.Motion], up: str) -> dict[str, gmr.Motion]:
    """The clips as files with another up axis have them."""
    return {name: turned(motion, "+Y", up) for name, motion in motions.items()}


def same(one: Completion, other: Completion) -> bool:
    """Whether the same was chosen, and the dataset does the same with it."""
    (chosen, costs, held, offset), (their_chosen, their_costs, their_held, their_offset) = (
        (
            [(c.candidate.source, c.candidate.mirrored, c.candidate.factor) for c in of.choices],
            [c.cost_after for c in of.choices],
            of.trials["held_after"],
            of.trials["offset_after"],
        )
        for of in (one, other)
    )
    return (
        chosen == their_chosen
        and np.allclose(costs, their_costs, atol=1e-3)
        and np.array_equal(held, their_held)
        and np.allclose(offset, their_offset, atol=1e-2)
    )


@pytest.fixture(scope="module")
def upright() -> Completion:
    return complete_from(TAKES, ARCHIVE, source="archive", **ASKED)


@pytest.mark.parametrize(
    ("takes_up", "archive_up"), [*zip(AXES, AXES, strict=True), *zip(AXES, NEXT, strict=True)]
)
def test_an_archive_helps_as_much_whichever_axis_is_up(
    upright: Completion, takes_up: str, archive_up: str
) -> None:
    found = complete_from(with_up(TAKES, takes_up), with_up(ARCHIVE, archive_up), source="archive", **ASKED)
    assert upright.choices
    assert same(found, upright)
    turned_to = "" if takes_up == archive_up else takes_up
    assert {choice.candidate.turned for choice in found.choices} == {turned_to}
    said = [note for note in found.noticed if note.startswith(f"archive: Its files have {archive_up} up")]
    assert len(said) == bool(turned_to)


def test_the_written_clips_beside_the_dataset_do_what_was_promised(tmp_path: Path) -> None:
    for up, motions, place in (("+Z", TAKES, "takes"), ("+Y", ARCHIVE, "archive")):
        (tmp_path / place).mkdir()
        for name, motion in with_up(motions, up).items():
            gmr.write(motion, tmp_path / place / name)
    takes, archive = (gmr.read_folder(tmp_path / place) for place in ("takes", "archive"))
    found = complete_from(takes, archive, **ASKED)
    folder = write_added(found, tmp_path / "completed", source=tmp_path / "archive")
    again = gmr.evaluate({**takes, **gmr.read_folder(folder / "clips")}, scenarios="constant", **ASKED)
    assert found.choices
    promised = found.after.measured.trials
    np.testing.assert_allclose(again.measured.trials["offset_mean"], promised["offset_mean"], atol=1e-2)
    assert again.summary.clip_count == len(takes) + len(found.added)
    assert not any("lie above the feet" in note for note in again.notes)


@pytest.mark.parametrize(("takes_up", "archive_up"), [("+Z", "+Y"), ("+Y", "-Z"), ("+X", "-X")])
def test_clips_that_are_laid_on_the_skeleton_stand_in_the_dataset(takes_up: str, archive_up: str) -> None:
    strange = {"left.bvh": walker(6, 1.2, LEFT, names=MIXAMO)}
    usual = complete_from(TAKES, strange, lay=True, **ASKED)
    found = complete_from(with_up(TAKES, takes_up), with_up(strange, archive_up), lay=True, **ASKED)
    assert all(choice.candidate.laid and not choice.candidate.turned for choice in found.choices)
    assert usual.choices
    assert same(found, usual)


@pytest.mark.parametrize("up", ["+Z", "-X"])
def test_made_clips_stand_in_the_dataset(up: str) -> None:
    clips = {"near.bvh": walker(3, 1.2)}
    fill = synthesised(seconds=3)
    usual = complete_from(TAKES, clips, fill=fill, **ASKED)
    found = complete_from(with_up(TAKES, up), clips, fill=fill, **ASKED)
    assert {choice.candidate.made for choice in usual.choices} == {True}
    assert same(found, usual)


def test_clips_are_laid_on_one_that_stands_as_the_others_do() -> None:
    odd = {"a.bvh": turned(TAKES["faster.bvh"], "+Y", "-Z"), **TAKES, "b.bvh": walker(4, 1.3)}
    fill = synthesised(seconds=3)
    found = complete(odd, fill, **ASKED)
    assert found.added
    note = next(note for note in found.after.notes if "lie above the feet" in note)
    assert "In 1 of " in note


@pytest.mark.parametrize("up", AXES)
def test_a_mirror_image_stands_as_its_clip_does(up: str) -> None:
    clip = ARCHIVE["left.bvh"]
    image = turned_up(mirrored_upright(turned(clip, "+Y", up), up), up, "+Y").positions(dtype=np.float64)
    usual = clip.mirror().positions(dtype=np.float64)
    np.testing.assert_allclose(image[..., 1], usual[..., 1], atol=1e-9)
    np.testing.assert_allclose(
        np.linalg.norm(image - image[:, :1], axis=2), np.linalg.norm(usual - usual[:, :1], axis=2), atol=1e-9
    )


def test_a_turned_clip_says_so_and_keeps_its_channels(tmp_path: Path) -> None:
    candidate = next(variants("a/b.bvh", mirror=False, laid=False, turned="+Z"))
    assert (candidate.how, candidate.name, candidate.whole) == ("turned to +Z up", "b_turned.bvh", False)
    both = Candidate("a/b.bvh", mirrored=True, factor=0.8, turned="-X")
    assert both.how == "turned to -X up, mirrored, 0.8 times as fast"
    assert both.name == "b_turned_mirrored_x0.8.bvh"
    gmr.write(ARCHIVE["left.bvh"], tmp_path / "a.bvh")
    text = (
        (tmp_path / "a.bvh")
        .read_text()
        .replace("Zrotation Xrotation Yrotation", "Yrotation Xrotation Zrotation")
    )
    (tmp_path / "a.bvh").write_text(text)
    read = gmr.read(tmp_path / "a.bvh")
    lain = turned_up(read, "+Y", "-Z")
    assert read.layout is not None
    assert lain.layout == read.layout
    gmr.write(lain, tmp_path / "b.bvh")
    back = gmr.read(tmp_path / "b.bvh").positions(dtype=np.float64)
    np.testing.assert_allclose(back[..., [0, 2, 1]] * (1, -1, 1), read.positions(dtype=np.float64), atol=1e-4)


def test_centimetres_complete_metres() -> None:
    centimetres = {
        name: replace(walker(6, 1.2, LEFT, scale=100.0, unit=None), name=name) for name in ("left.bvh",)
    }
    metres = {name: replace(motion, unit=None) for name, motion in TAKES.items()}
    same_unit = {"left.bvh": replace(walker(6, 1.2, LEFT), unit=None)}
    assert same(complete_from(metres, centimetres, **ASKED), complete_from(metres, same_unit, **ASKED))


def lifted(motions: Mapping[str, gmr.Motion], by: float) -> dict[str, gmr.Motion]:
    """The clips as files whose ground lies elsewhere have them; metres."""
    return {name: raised(motion, "+Y", by) for name, motion in motions.items()}


@pytest.mark.parametrize("height", [0.2, 1.13, -1.13])
def test_an_archive_helps_as_much_wherever_its_ground_lies(upright: Completion, height: float) -> None:
    found = complete_from(TAKES, lifted(ARCHIVE, height), source="archive", **ASKED)
    assert same(found, upright)
    assert {choice.candidate.how for choice in found.choices} <= {
        f"moved to the same ground{more}" for more in ("", *(f", {c.candidate.how}" for c in upright.choices))
    }
    said = [note for note in found.noticed if "ground of" in note]
    assert said == [
        f"archive: The ground of its files lies at {height - 0.02:.2f} m, that of the dataset at -0.02 m: "
        "what is chosen is moved to the dataset's."
    ]


@pytest.mark.parametrize("height", [0.2, 1.13, -1.13])
def test_a_dataset_is_helped_as_much_wherever_its_ground_lies(upright: Completion, height: float) -> None:
    takes = lifted(TAKES, height)
    found = complete_from(takes, ARCHIVE, source="archive", **ASKED)
    assert same(found, upright)
    assert all(choice.candidate.moved for choice in found.choices)
    beside = complete_from(takes, lifted(ARCHIVE, height), source="archive", **ASKED)
    assert same(beside, upright)
    assert [c.candidate for c in beside.choices] == [c.candidate for c in upright.choices]
    assert not any("ground of" in note for note in beside.noticed)


def test_axis_ground_and_unit_may_all_differ(upright: Completion) -> None:
    centimetres = {
        "left.bvh": walker(6, 1.2, LEFT, scale=100.0, unit=None),
        "stands.bvh": walker(3, 0.1, scale=100.0, unit=None),
    }
    archive = with_up({name: raised(motion, "+Y", 50.0) for name, motion in centimetres.items()}, "-X")
    found = complete_from(with_up(lifted(TAKES, 1.13), "+X"), archive, source="archive", **ASKED)
    assert same(found, upright)
    assert {choice.candidate.turned for choice in found.choices} == {"+X"}
    assert [note for note in found.noticed if "up" in note or "ground" in note] == [
        "archive: Its files have -X up, those of the dataset +X: what is chosen is turned to +X up.",
        "archive: The ground of its files lies at 0.48 m, that of the dataset at 1.11 m: what is chosen is "
        "moved to the dataset's.",
    ]


def test_what_is_not_done_is_not_told() -> None:
    useless = {"stands.bvh": walker(3, 0.0)}
    found = complete_from(TAKES, with_up(lifted(useless, 1.13), "+Z"), source="archive", **ASKED)
    assert not found.choices
    assert not any("turned" in note or "ground" in note for note in found.noticed)


def test_written_clips_stand_on_the_ground_of_the_dataset(tmp_path: Path) -> None:
    for motions, place in ((TAKES, "takes"), (lifted(ARCHIVE, 1.13), "archive")):
        (tmp_path / place).mkdir()
        for name, motion in motions.items():
            gmr.write(motion, tmp_path / place / name)
    takes, archive = (gmr.read_folder(tmp_path / place) for place in ("takes", "archive"))
    found = complete_from(takes, archive, **ASKED)
    folder = write_added(found, tmp_path / "completed", source=tmp_path / "archive")
    written = gmr.read_folder(folder / "clips")
    assert written
    for name, motion in written.items():
        assert "_moved" in name
        assert abs(float(motion.positions()[..., 1].min())) < 0.05
    again = gmr.evaluate({**takes, **written}, scenarios="constant", **ASKED)
    promised = found.after.measured.trials
    np.testing.assert_allclose(again.measured.trials["offset_mean"], promised["offset_mean"], atol=1e-2)


def test_a_moved_clip_says_so() -> None:
    candidate = Candidate("a/b.bvh", factor=0.8, turned="+Z", moved=True)
    assert candidate.how == "turned to +Z up, moved to the same ground, 0.8 times as fast"
    assert candidate.name == "b_turned_moved_x0.8.bvh"
    assert not Candidate("a/b.bvh", moved=True).whole


@pytest.mark.parametrize("takes_up", ["+Y", "+Z", "+X"])
@pytest.mark.parametrize("useful_up", ["+Y", "+Z"])
def test_clips_of_an_archive_of_two_axes_stand_each_by_their_own(
    upright: Completion, takes_up: str, useful_up: str
) -> None:
    upright_ones = {f"a{number}.bvh": walker(3, 0.1 + number / 100) for number in range(3)}
    others = with_up({f"b{number}.bvh": walker(3, 0.2 + number / 100) for number in range(3)}, "+Z")
    archive = {**upright_ones, **others, **with_up(ARCHIVE, useful_up)}
    found = complete_from(with_up(TAKES, takes_up), archive, source="archive", **ASKED)
    assert same(found, upright)
    needed = takes_up if takes_up != useful_up else ""
    assert {(choice.candidate.turned, choice.candidate.moved) for choice in found.choices} == {
        (needed, False)
    }
    expected = (
        f"archive: 5 of its 8 files have {useful_up} up, those of the dataset {takes_up}: "
        f"what is chosen of them is turned to {takes_up} up."
    )
    assert [note for note in found.noticed if " up" in note] == ([expected] if needed else [])


def test_a_body_that_lies_is_turned_as_the_clips_around_it(upright: Completion) -> None:
    lies = turned(walker(3, 0.1), "+Y", "-Y")
    archive = {**ARCHIVE, "a.bvh": walker(3, 0.2), "lies.bvh": lies}
    found = complete_from(TAKES, with_up(archive, "+Z"), source="archive", **ASKED)
    assert same(found, upright)
    assert any("In 1 of 4 clips ('lies.bvh')" in note for note in found.noticed)
    assert "archive: Its files have +Z up, those of the dataset +Y: what is chosen is turned to +Y up." in (
        found.noticed
    )


def test_a_moved_clip_keeps_its_channels(tmp_path: Path) -> None:
    gmr.write(ARCHIVE["left.bvh"], tmp_path / "a.bvh")
    read = gmr.read(tmp_path / "a.bvh")
    higher = raised(read, "+Y", 1.0)
    assert higher.layout == read.layout
    gmr.write(higher, tmp_path / "b.bvh")
    back = gmr.read(tmp_path / "b.bvh").positions(dtype=np.float64)
    np.testing.assert_allclose(back - (0.0, 1.0, 0.0), read.positions(dtype=np.float64), atol=1e-4)
