"""Edits of motions that are not known in some frames, as markers that nobody saw leave them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gmr
from gmr import GmrError, Motion
from gmr.demo import demo_folder
from gmr.editing import contacts, cut_at, grip, lock_feet, moved_roots, reach, rejoin, splice, warp_path
from gmr.frames import Pose

WALK = gmr.read(demo_folder() / "07_01.bvh")
KNOWN = 290


@pytest.fixture(scope="module")
def partly() -> Motion:
    rotations, translations = WALK.rotations.copy(), WALK.translations.copy()
    rotations[KNOWN:], translations[KNOWN:] = np.nan, np.nan
    return replace(WALK, source=Pose(rotations, WALK.translated, translations, WALK.layout))


def test_what_is_known_is_edited_as_if_there_were_no_more(partly: Motion) -> None:
    point = WALK.positions(dtype=float, joints=["RightArm"])[100, 0] + [0, 1, 5]
    for edit in (
        lambda motion: reach(motion, "RightHand", point, frame=100),
        lambda motion: grip(motion, frames=(10, 200)),
    ):
        found, wanted = edit(partly), edit(WALK[:KNOWN])
        places = found.motion.positions(dtype=float)
        np.testing.assert_allclose(places[:KNOWN], wanted.motion.positions(dtype=float), atol=1e-9)
        assert np.isnan(places[KNOWN:]).all()
        assert str(found.report).replace(f"of {len(WALK)} frames", f"of {KNOWN} frames") == str(wanted.report)


def test_the_hips_go_where_they_were_put(partly: Motion) -> None:
    loose = cut_at(partly, ["LeftFoot", "RightFoot"])
    lower = partly.positions(dtype=float, joints=["Hips"])[:, 0] - (0, 1.5, 0)
    edited = rejoin(moved_roots(loose, {partly.skeleton.index("Hips"): lower}), partly).motion
    np.testing.assert_allclose(edited.positions(dtype=float, joints=["Hips"])[:, 0], lower, atol=1e-9)


def test_feet_have_contacts_where_they_are_known(partly: Motion) -> None:
    assert contacts(partly).intervals[:-1] == contacts(WALK[:KNOWN]).intervals[:-1]
    assert not contacts(partly).mask[KNOWN:].any()
    report = lock_feet(partly).report
    assert report.slide_after.max() < 1e-9


@pytest.mark.parametrize("edit", [warp_path, lambda motion: splice(WALK, motion)])
def test_a_path_that_is_not_known_is_refused(partly: Motion, edit) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(GmrError, match=r"27 of its poses are not known \(NaN\), the first in frame 290; cut"):
        edit(partly)
