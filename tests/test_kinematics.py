"""World positions and rotations against NumPy and SciPy in float64."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

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
