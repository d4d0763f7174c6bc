"""Exchanged, flickering and jumping markers: found, named, undone; nothing found where nothing is."""

from __future__ import annotations

import os
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import gmr
from gmr.markers import Markers
from marker_scene import exchanged, hidden, noisy, worn

DATA = os.environ.get("GMR_DATA")

PAIRS = [
    ("L_FLE", "L_FME"), ("L_TAM", "R_TAM"), ("L_HM2", "L_HM5"), ("L_HDF", "R_HDF"), ("L_IAS", "L_IPS"),
    ("CV7", "SNJ"), ("L_FTC", "L_UHE"), ("R_HME", "R_HLE"), ("L_FM1", "L_FM5"),
]  # fmt: skip
"""Within a part and across parts, in symmetrical parts and in others."""


@given(
    pair=st.sampled_from(PAIRS),
    first=st.integers(0, 314),
    length=st.integers(1, 150),
    relation=st.sampled_from([None, "ior"]),
    noise=st.sampled_from([0.0, 0.5]),
)
@settings(max_examples=40)
def test_an_exchange_is_found_and_undone(
    pair: tuple[str, str], first: int, length: int, relation: str | None, noise: float
) -> None:
    # The toes of this take go 21, 54 and 33 mm in successive frames, where paths alone do not tell.
    assume(relation is not None or pair != ("L_FM1", "L_FM5"))
    truth = noisy(worn(), noise)
    last = min(first + length, truth.frame_count)
    markers = exchanged(truth, *pair, first, last - first)
    found = markers.findings(relation)
    assert [(set(each.markers), each.first, each.length) for each in found] == [
        (set(pair), first, last - first)
    ]
    assert markers.undo_swaps(found) == truth


def test_an_exchange_is_told_in_words() -> None:
    (found,) = exchanged(worn(), "L_FLE", "L_FME", 40, 20).findings("ior")
    assert found.kind == "swap"
    assert str(found) == (
        "'L_FLE' and 'L_FME' have each other's labels in frames 40 to 59: each goes on where the other was"
    )
    (found,) = exchanged(worn(), "L_FLE", "L_FME", 40, 1).findings()
    assert str(found) == (
        "'L_FLE' and 'L_FME' have each other's labels in frame 40: each goes on where the other was"
    )


def test_two_exchanges_at_once_are_both_undone() -> None:
    markers = exchanged(exchanged(worn(), "L_FLE", "L_FME", 40, 60), "CV7", "SNJ", 80, 100)
    found = markers.findings("ior")
    assert {frozenset(each.markers) for each in found} == {
        frozenset({"L_FLE", "L_FME"}),
        frozenset({"CV7", "SNJ"}),
    }
    assert markers.undo_swaps(found) == worn()


@pytest.mark.parametrize("relation", [None, "ior"])
def test_an_exchange_that_begins_in_a_gap_is_found(relation: str | None) -> None:
    truth = hidden(hidden(worn(), "L_FLE", 98, 5), "L_FME", 99, 6)
    markers = hidden(hidden(exchanged(worn(), "L_FLE", "L_FME", 100, 90), "L_FLE", 98, 5), "L_FME", 99, 6)
    found = [each for each in markers.findings(relation) if each.kind == "swap"]
    assert len(found) == 1
    undone = markers.undo_swaps(found)
    both = undone.visible & truth.visible
    np.testing.assert_array_equal(undone.positions[both], truth.positions[both])


@pytest.mark.parametrize("clip", ["07_01"])
@pytest.mark.parametrize("relation", [None, "ior"])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_nothing_is_found_where_nothing_is_wrong(clip: str, relation: str | None, noise: float) -> None:
    assert noisy(worn(clip), noise).findings(relation) == ()


def test_a_flicker_is_named_with_its_frames() -> None:
    markers = hidden(hidden(worn(), "CV7", 40, 10), "CV7", 52, 10)
    (found,) = markers.findings()
    assert (found.kind, found.markers, found.first, found.length) == ("flicker", ("CV7",), 50, 2)
    assert "'CV7' is seen for frames 50 to 51 only" in str(found)


def jumping(first: int, length: int, metres: float) -> Markers:
    positions = worn().positions.copy()
    positions[first : first + length, worn().index("R_FAX"), 1] += metres
    return replace(worn(), positions=positions)


@pytest.mark.parametrize(("length", "count"), [(1, 1), (30, 2)])
def test_a_jump_is_named_where_it_happens(length: int, count: int) -> None:
    found = jumping(90, length, 0.25).findings()
    assert [each.kind for each in found] == ["jump"] * count
    assert found[0].markers == ("R_FAX",)
    assert found[0].first in (90, 91)
    assert "mm at frame" in str(found[0])


def test_undoing_leaves_what_is_no_exchange() -> None:
    markers = jumping(90, 30, 0.25)
    assert markers.undo_swaps(markers.findings()) is markers


def test_residuals_are_exchanged_with_their_markers() -> None:
    residuals = np.arange(worn().positions[..., 0].size, dtype=float).reshape(worn().positions.shape[:2])
    markers = exchanged(replace(worn(), residuals=residuals), "L_FLE", "L_FME", 40, 20)
    undone = markers.undo_swaps(markers.findings())
    knee, inner = worn().index("L_FLE"), worn().index("L_FME")
    assert undone.residuals is not None
    np.testing.assert_array_equal(undone.residuals[40:60, knee], residuals[40:60, inner])


def test_speeds_need_a_unit_and_a_rate() -> None:
    with pytest.raises(gmr.GmrError, match="does not say in what unit"):
        worn().with_unit(None).findings()
    with pytest.raises(gmr.GmrError, match="does not say how long a frame lasts"):
        replace(worn(), frame_time=0.0).findings()


def test_a_recording_that_is_noise_ends_soon_and_quietly() -> None:
    """As where the unit is wrong by a thousand: everything jumps in every frame."""
    places = np.random.default_rng(0).normal(size=(400, 60, 3))
    markers = Markers(tuple(f"M{k}" for k in range(60)), places, 0.01, unit=1.0)
    assert all(each.kind == "jump" for each in markers.findings())


@pytest.mark.skipif(DATA is None, reason="GMR_DATA is not set")
@pytest.mark.parametrize("pair", PAIRS[:8])
@pytest.mark.parametrize(("first", "length"), [(100, 80), (0, 50), (200, 140), (77, 1)])
@pytest.mark.parametrize("relation", [None, "ior"])
def test_an_exchange_in_a_real_walk_is_found_and_undone(
    pair: tuple[str, str], first: int, length: int, relation: str | None
) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        truth = gmr.read_markers(Path(DATA or "") / "c3d" / "Qualisys.c3d")
    assert truth.findings(relation) == ()
    markers = exchanged(truth, *pair, first, length)
    found = markers.findings(relation)
    assert len(found) == 1
    assert markers.undo_swaps(found) == truth
