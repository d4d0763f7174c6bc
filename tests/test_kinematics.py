"""World positions and rotations against NumPy and SciPy in float64."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gmr import _core
from kinematics_oracle import Case, random_case, world

TOLERANCE = {np.float32: 2e-6, np.float64: 1e-9}

cases = st.builds(
    random_case,
    st.integers(0, 2**32),
    st.integers(3, 40),
    st.integers(1, 40),
    root_count=st.integers(1, 3),
    pre=st.booleans(),
)
widths = st.sampled_from([np.float32, np.float64])


def run(case: Case, dtype: Any, **asked: Any) -> tuple[Any, Any, Any]:
    """Positions of all joints, world rotations of the slots that turn a bone, and which slots those are."""
    topology = _core.Topology(case.parents, case.slots, case.slot_count)
    turning = np.unique(case.slots[case.slots >= 0]).astype(np.int32)
    frames = len(case.rotations)
    positions = np.full((frames, len(case.parents), 3), np.nan, dtype)
    rotations = np.full((frames, len(turning), 4), np.nan, dtype)
    _core.forward_kinematics(
        topology, case.rotations.astype(dtype), case.translated, case.translations.astype(dtype),
        case.offsets, None, turning, positions, rotations, **asked,
    )  # fmt: skip
    return positions, rotations, turning


@given(cases, widths)
def test_positions_and_rotations_are_those_of_the_formula(case: Case, dtype: Any) -> None:
    positions, rotations, turning = run(case, dtype)
    expected, turned = world(case)
    tolerance = TOLERANCE[dtype]
    assert np.abs(positions - expected).max() < tolerance * case.height
    for k, slot in enumerate(turning):
        joint = int(np.flatnonzero(case.slots == slot)[0])
        assert np.abs(np.abs((rotations[:, k] * turned[joint].as_quat()).sum(-1)) - 1).max() < tolerance


def test_a_slot_that_turns_no_bone_cannot_be_asked_for() -> None:
    case = random_case(1, 5, 2)
    topology = _core.Topology(case.parents, np.full(5, -1, np.int32), 5)
    out = np.empty((2, 1, 4))
    with pytest.raises(ValueError, match="slot 3 turns no bone"):
        _core.forward_kinematics(
            topology, case.rotations, case.translated, case.translations, case.offsets,
            None, np.array([3], np.int32), None, out,
        )  # fmt: skip


def about(axis: int, degrees: Any) -> Rotation:
    """Turns about x, y or z."""
    return Rotation.from_rotvec(np.outer(degrees, np.eye(3)[axis]), degrees=True)


@st.composite
def rows_of_a_case(draw: st.DrawFn) -> tuple[Case, dict[str, Any]]:
    """Euler rows of any order, with missing columns and several moved joints, and the case that they mean."""
    case = draw(cases)
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    frames, slots, moved = len(case.rotations), case.slot_count, len(case.translated)
    columns = rng.permutation(3 * (slots + moved)).astype(np.int32)
    columns[rng.random(len(columns)) < 0.1] = -1
    turning, moving = np.split(columns.reshape(-1, 3), [slots])
    axes = rng.integers(0, 3, (slots, 3), np.uint8)
    rows = rng.uniform(-400, 400, (frames, len(columns)))
    rows[:, moving[moving >= 0]] /= 400
    adds_offset = draw(st.booleans())

    degrees = np.where(turning >= 0, rows[:, turning], 0)
    turned = [
        about(axis[0], step[0]) * about(axis[1], step[1]) * about(axis[2], step[2])
        for step, axis in zip(degrees.transpose(1, 2, 0), axes.tolist(), strict=True)
    ]
    offsets = case.offsets[case.translated]
    channels = np.where(moving >= 0, rows[:, moving] + (offsets if adds_offset else 0), offsets)
    meant = replace(case, rotations=np.stack([r.as_quat() for r in turned], axis=1), translations=channels)
    given_as = {
        "rows": rows, "rotation_columns": turning, "rotation_axes": axes, "translated": case.translated,
        "translation_columns": moving, "adds_offset": adds_offset, "offsets": case.offsets,
    }  # fmt: skip
    return meant, given_as


@given(rows_of_a_case(), widths)
def test_rows_of_degrees_give_what_scipy_makes_of_them(case: tuple[Case, dict[str, Any]], dtype: Any) -> None:
    meant, given_as = case
    expected, _ = world(meant)
    out = np.full(expected.shape, np.nan, dtype)
    topology = _core.Topology(meant.parents, meant.slots, meant.slot_count)
    _core.forward_kinematics_euler(topology, **given_as, positions_out=out)
    assert np.abs(out - expected).max() < TOLERANCE[dtype] * meant.height


@given(cases, st.data())
def test_a_subset_of_joints_is_a_part_of_the_whole(case: Case, data: st.DataObject) -> None:
    whole, _, _ = run(case, np.float32)
    joints = data.draw(st.lists(st.integers(0, len(case.parents) - 1), max_size=6))
    part = np.empty((len(case.rotations), len(joints), 3), np.float32)
    _core.forward_kinematics(
        _core.Topology(case.parents, case.slots, case.slot_count), case.rotations.astype(np.float32),
        case.translated, case.translations.astype(np.float32), case.offsets,
        np.array(joints, np.int32), None, part,
    )  # fmt: skip
    np.testing.assert_array_equal(part, whole[:, joints])


def test_arrays_that_do_not_fit_are_refused_and_never_read_beyond() -> None:
    case = random_case(9, 4, 6)
    topology = _core.Topology(case.parents, case.slots, case.slot_count)
    out = np.empty((6, 4, 3))
    frozen = out.copy()
    frozen.flags.writeable = False
    good = (topology, case.rotations, case.translated, case.translations, case.offsets)
    wrong: list[tuple[Any, type[Exception], str]] = [
        ({1: case.rotations[:5]}, ValueError, "translations holds"),
        ({1: case.rotations[:, ::-1]}, ValueError, "C-contiguous"),
        ({1: case.rotations[..., :3].copy()}, ValueError, r"\(frames, N, 4\)"),
        ({1: case.rotations.astype(">f8")}, TypeError, "rotations"),
        ({3: case.translations.astype(np.float32)}, TypeError, "translations"),
        ({4: case.offsets[:2]}, ValueError, "offsets holds 6 elements where 12"),
        ({4: case.offsets.astype(int)}, TypeError, "offsets"),
        ({5: np.array([4], np.int32)}, ValueError, "joints holds 4"),
        ({7: out[:, :3].copy()}, ValueError, "positions holds"),
        ({7: out.astype(np.float32)}, TypeError, "positions_out"),
        ({7: frozen}, ValueError, "positions_out"),
        ({8: case.rotations}, ValueError, "rotations_out: .*already borrowed"),
    ]
    for changes, error, message in wrong:
        arguments: list[Any] = [*good, None, None, out, None]
        for place, value in changes.items():
            arguments[place] = value
        with pytest.raises(error, match=message):
            _core.forward_kinematics(*arguments)


@pytest.mark.parametrize(("joints", "frames"), [(0, 0), (0, 7), (3, 0)])
def test_no_joints_and_no_frames_are_solved_at_once(joints: int, frames: int) -> None:
    case = random_case(2, joints, frames)
    positions, rotations, _ = run(case, np.float32)
    assert positions.size == rotations.size == 0
