"""Mistakes in calls of the Python interface: each gets a sentence on what was given and what is needed."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import gmr as typed
from gmr.matching import Database
from locomotion import Arc
from walker import walker_bvh

gmr: Any = typed  # what a type checker would refuse is called here

Call = Callable[[Any, Path], object]
"""A call with a motion and the folder of small files."""


@pytest.fixture(scope="module")
def motion(walk_path: Path) -> typed.Motion:
    return typed.read(walk_path)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda m, d: m.positions(joints="LeftFoot"), "put 'LeftFoot' into a list"),
        (lambda m, d: m.positions(joints=[1.5]), "by its name or its index, not by 1.5"),
        (lambda m, d: m.positions(out=[1.0]), r"an array to write into, not \[1.0\]"),
        (lambda m, d: m.positions(threads="all"), "threads must be a whole number, not 'all'"),
        (lambda m, d: m.resample("fast"), "frames a second, not 'fast'"),
        (lambda m, d: gmr.write("walk", d / "walk.bvh"), "a motion is written, not 'walk'"),
        (lambda m, d: gmr.write(m, None), "to a path or an open file, not to None"),
        (lambda m, d: gmr.concatenate([m, 3]), "motions are needed here, not 3"),
        (lambda m, d: gmr.concatenate(m), "put this one into a list"),
        (lambda m, d: gmr.evaluate([m], speeds="1,2"), "speeds is a list of numbers, not '1,2'"),
        (lambda m, d: gmr.evaluate([m], speeds=1.0), "speeds is a list of numbers, not 1.0"),
        (lambda m, d: gmr.evaluate([m], turn_rates_deg=["left"]), "turn_rates_deg is a list of numbers"),
        (lambda m, d: gmr.evaluate([m], names="hips"), "names are joints by role"),
        (lambda m, d: gmr.evaluate([m], schema=[1.0, 2.0]), "a schema is a gmr.matching.Schema"),
        (
            lambda m, d: gmr.forward_kinematics([-1], [[0, 0, 0]], [[0, 0, 0, 1]], out=[1]),
            "an array to write",
        ),
    ],
)
def test_what_is_of_the_wrong_type_is_told_from_what_is_needed(
    motion: typed.Motion, data: Path, call: Call, says: str
) -> None:
    with pytest.raises(TypeError, match=says):
        call(motion, data)


@pytest.mark.parametrize(
    "call",
    [
        lambda m, d: m.positions(threads=-1),
        lambda m, d: m.bone_rotations(threads=-1),
        lambda m, d: gmr.read_folder(d, threads=-1),
        lambda m, d: gmr.evaluate([m], threads=-1),
        lambda m, d: gmr.forward_kinematics([-1], [[0, 0, 0]], [[0, 0, 0, 1]], threads=-1),
    ],
)
def test_fewer_than_no_threads_are_refused(motion: typed.Motion, data: Path, call: Call) -> None:
    with pytest.raises(ValueError, match="there cannot be -1 threads; give 0 for all cores"):
        call(motion, data)


def test_more_threads_than_any_machine_has_do_no_harm(motion: typed.Motion) -> None:
    np.testing.assert_array_equal(motion.positions(threads=10**20), motion.positions())


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda m, d: gmr.read(""), "an empty text names no file"),
        (lambda m, d: gmr.write(m, d), "this is a folder; name a file in it"),
        (lambda m, d: gmr.write(m, d / "cmu_07_01.bvh" / "new.bvh"), r"cmu_07_01.bvh' is no folder"),
        (lambda m, d: gmr.write(m, d / "missing" / "new.bvh"), "make it first"),
        (lambda m, d: m.positions(dtype="banana"), "float32 or float64, not 'banana'"),
        (lambda m, d: m.with_unit(1e30), r"a unit cannot be 1e\+30 metres; give from"),
        (lambda m, d: m.with_unit(float("nan")), "a unit cannot be nan metres"),
        (
            lambda m, d: gmr.forward_kinematics([-1, 0], [[0, 0, 0], [0]], [[0, 0, 0, 1]] * 2),
            "offsets is no array: its rows are not equally long",
        ),
    ],
)
def test_what_cannot_be_done_is_said_as_an_error_of_gmr(
    motion: typed.Motion, data: Path, call: Call, says: str
) -> None:
    with pytest.raises(gmr.GmrError, match=says):
        call(motion, data)


@pytest.mark.parametrize("k", [-1, 10**9, 10**20])
def test_as_many_rows_as_there_are_can_be_asked_for(k: int) -> None:
    database = Database.build([gmr.read(walker_bvh(Arc(3.0, 1.0)).encode())])
    assert database.search(database.features[:2], k=len(database))[0].shape == (2, len(database))
    with pytest.raises(ValueError, match=f"{k} nearest rows cannot be found among {len(database)}"):
        database.search(database.features[:2], k=k)


def test_a_search_says_what_it_can_be_asked(motion: typed.Motion) -> None:
    database = Database.build([gmr.read(walker_bvh(Arc(3.0, 1.0)).encode())])
    queries = database.features[database.candidates][:5]
    pose_only = {"trajectory position": 0.0, "trajectory facing": 0.0}
    by_name, by_number = (
        database.search(queries, 3, weights=weights)
        for weights in (pose_only, database.schema.spread(pose_only))
    )
    np.testing.assert_array_equal(by_name, by_number)
    parts = database.costs_by_group(queries, by_name[1], weights=pose_only)
    assert not parts["trajectory facing"].any()
    rows = database.search(queries, 3, exclude=(10, 50))[1]
    np.testing.assert_array_equal(rows, database.search(queries, 3, exclude=[(10, 50)] * 5)[1])
    assert not ((rows >= 10) & (rows < 50)).any()
    with pytest.raises(gmr.GmrError, match="no feature group is called 'facing'"):
        database.search(queries, weights={"facing": 1.0})
    for wrong in ((1, 2, 3), [(1, 2)] * 4):
        with pytest.raises(ValueError, match=r"give the first and one past the last row, \(2,\) for all"):
            database.search(queries, exclude=wrong)
    for tags in (1 << 33, -1, 0.5):
        with pytest.raises(ValueError, match="tags must be whole numbers, bits from 0 to 2"):
            database.search(queries, tags=tags)


def test_a_file_that_takes_a_part_at_a_time_gets_all(motion: typed.Motion) -> None:
    class Sipping(io.RawIOBase):
        held = b""

        def writable(self) -> bool:
            return True

        def write(self, given: Any) -> int:
            self.held += bytes(given[:1000])
            return min(len(given), 1000)

    whole, sipping = io.BytesIO(), Sipping()
    gmr.write(motion, whole)
    gmr.write(motion, cast(Any, sipping))
    assert sipping.held == whole.getvalue()
