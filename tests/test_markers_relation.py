"""Relations: those that ship are whole, faults are named, labels are matched as laboratories write them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import gmr
from gmr.markers import best_relation, load_relation, match_labels, read_relation, shipped_relations
from marker_scene import worn

PELVIS = """
[parts.pelvis]
joint = "Hips"
markers = ["LASI", "RASI", "LPSI", "RPSI"]
left = { from = ["RASI"], to = ["LASI"] }
forward = { from = ["LPSI", "RPSI"], to = ["LASI", "RASI"] }
"""

THIGH = """
[parts.left_thigh]
joint = "LeftUpLeg"
parent = "pelvis"
markers = ["LKNE", "LKNM", "LTHI"]
up = { from = ["LKNE", "LKNM"], to = ["LeftUpLeg"] }
left = { from = ["LKNM"], to = ["LKNE"] }
"""


def relation(text: str) -> gmr.markers.Relation:
    return read_relation(text.encode(), "mine.toml")


@pytest.mark.parametrize("name", ["ior", "plug_in_gait"])
def test_relations_that_ship_are_whole(name: str) -> None:
    assert name in shipped_relations()
    found = load_relation(name)
    assert found.about
    assert [part.name for part in found.parts if part.parent is None] == ["pelvis"]
    for part in found.parts:
        assert part.parent is None or part.centre is not None, part.name
    sides = {part.joint for part in found.parts}
    assert {joint.replace("Left", "Right") for joint in sides} == {
        joint.replace("Left", "Right") for joint in sides if not joint.startswith("Left")
    }


def test_what_nobody_has_is_refused() -> None:
    with pytest.raises(gmr.FormatError, match=r"there is no relation 'rizzoli': .* 'ior', 'plug_in_gait'"):
        load_relation("rizzoli")


def test_a_file_is_a_relation(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(PELVIS + THIGH)
    found = load_relation(path)
    assert [part.name for part in found.parts] == ["pelvis", "left_thigh"]
    assert found.name == "mine"
    assert load_relation(found) is found


def test_parts_may_be_written_in_any_order() -> None:
    assert [part.name for part in relation(THIGH + PELVIS).parts] == ["pelvis", "left_thigh"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "it has no parts"),
        ("[parts", "this is no TOML"),
        ("\nlength = 3" + PELVIS, "the file has an unknown entry 'length'"),
        (PELVIS.replace("markers", "makers"), r"\[parts.pelvis\] has an unknown entry 'makers'"),
        (PELVIS.replace('joint = "Hips"', ""), r"\[parts.pelvis\] has no joint"),
        (PELVIS.replace("left = {", "tip = [] #"), r"\[parts.pelvis\] gives 1 directions"),
        (PELVIS.replace('{ from = ["RASI"], ', "{ "), r"\[parts.pelvis\] left must say from where to where"),
        (PELVIS.replace('["RASI"]', '["RASX"]'), r"speaks of 'RASX', which is neither a marker nor a joint"),
        (PELVIS.replace('"LPSI", "RPSI"]', '"LPSI", 3]', 1), r"markers must be a list of names"),
        (PELVIS.replace('"RPSI"]', '"LPSI"]', 1), r"markers names a point twice"),
        (PELVIS + THIGH.replace('"pelvis"', '"trunk"'), r"hangs on 'trunk', which is no part"),
        (PELVIS + THIGH.replace("LeftUpLeg", "Hips"), r"have the same joint 'Hips'"),
        (PELVIS + THIGH.replace('"LTHI"', '"LASI"'), "the marker 'LASI' is on 'pelvis' and on 'left_thigh'"),
        (THIGH.replace('"pelvis"', '"left_thigh"'), r"\[parts.left_thigh\] hangs on itself"),
        (
            PELVIS + 'centre = { rule = "midpoint", of = ["LASI"] }',
            "has no parent, so that it has no joint centre",
        ),
        (
            PELVIS + THIGH + 'centre = { rule = "middle" }',
            "must name a rule: .* there are 'midpoint', 'offset'",
        ),
        (PELVIS + THIGH + 'centre = { rule = "midpoint" }', "centre lacks 'of'"),
        (
            PELVIS + THIGH + 'centre = { rule = "midpoint", of = ["LKNE"] }',
            "speaks of 'LKNE', .* of 'pelvis'",
        ),
        (
            PELVIS + THIGH + 'centre = { rule = "midpoint", of = ["LASI"], within = -1 }',
            "must be more than 0",
        ),
        (PELVIS + THIGH + 'centre = { rule = "midpoint", of = ["LASI"], within = 80 }', "a length in metres"),
        (
            PELVIS
            + THIGH
            + 'centre = { rule = "harrington", side = "up", asis = ["LASI", "RASI"], psis = ["LPSI"] }',
            "side must be 'left' or 'right'",
        ),
        (
            PELVIS
            + THIGH
            + 'centre = { rule = "harrington", side = "left", asis = ["LASI"], psis = ["LPSI"] }',
            "asis must name two markers",
        ),
        ('[aliases]\nA = "B"\n' + PELVIS, r"\[aliases\] A = 'B' names no marker of a part"),
    ],
)
def test_a_fault_in_a_relation_is_named(text: str, said: str) -> None:
    with pytest.raises(gmr.FormatError, match=said) as caught:
        relation(text)
    assert caught.value.file == "mine.toml"


@pytest.mark.parametrize(
    "written", ["{}", "Anna:{}", "lab:Anna:{}"], ids=["plain", "one prefix", "two prefixes"]
)
def test_labels_are_known_however_a_laboratory_writes_them(written: str) -> None:
    ior = load_relation("ior")
    labels = [written.format(label.replace("_", "").lower()) for label in ior.labels]
    match = match_labels(ior, labels)
    assert [match.found[label] for label in ior.labels] == list(range(len(labels)))
    assert not match.missing


def test_of_several_people_the_one_with_the_most_markers_is_taken_or_the_one_named() -> None:
    ior = load_relation("ior")
    labels = [*(f"Ben:{label}" for label in ior.labels[:20]), *(f"Anna:{label}" for label in ior.labels)]
    assert match_labels(ior, labels).prefix == "Anna"
    named = match_labels(ior, labels, subject="Ben")
    assert len(named.found) == 20
    assert max(named.found.values()) == 19


def test_another_name_for_a_marker_is_known() -> None:
    ior = load_relation("ior")
    labels = [{"SNJ": "SJN", "L_SAJ": "LCAJ"}.get(label, label) for label in ior.labels]
    assert not match_labels(ior, labels).missing


def test_a_missing_marker_is_reported_with_what_is_nearly_called_so() -> None:
    ior = load_relation("ior")
    labels = ["Anna:" + ("L_FLEE" if label == "L_FLE" else label) for label in ior.labels]
    match = match_labels(ior, labels)
    assert dict(match.missing) == {"L_FLE": ("Anna:L_FLEE",)}
    assert match.left_over == (ior.labels.index("L_FLE"),)


def test_the_relation_that_fits_is_told_by_the_labels() -> None:
    for name in shipped_relations():
        found = best_relation([f"X:{label}" for label in load_relation(name).labels])
        assert found is load_relation(name)
    assert best_relation(["Marker_1", "Marker_2"]) is None
    assert best_relation([]) is None


def test_a_relation_that_does_not_fit_says_what_is_missing_and_what_is_near() -> None:
    markers = worn().select(["L_FLE", "L_FME", "CV7"])
    with pytest.raises(
        gmr.GmrError, match=r"no part of 'IOR full body' can be fitted\. Missing are 'L_IAS', 'R_IAS'"
    ):
        markers.fit("ior")
    with pytest.raises(gmr.GmrError, match=r"it holds no markers, and a motion is made of markers\. Export"):
        markers.select([]).fit()
    rotations = replace(markers.select([]), name="turns.c3d", ignored=("rotations of 21 segments",))
    with pytest.raises(gmr.GmrError, match=r"turns\.c3d: it holds no markers, only rotations of 21 segments"):
        rotations.fit("ior")
    with pytest.raises(
        gmr.GmrError, match=r"its labels \('L_FLE', 'L_FME', 'CV7'\) are those of no marker set"
    ):
        markers.fit()
