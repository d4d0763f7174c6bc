"""What playback would show of a database's rows, by forward kinematics of the rotations that it keeps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.matching import Database


def shown(database: Database, rows: slice) -> NDArray[np.float32]:
    """(F, J, 3) positions that forward kinematics makes of the rotations kept for playback."""
    core, topology = database.core, database.skeleton.topology
    positions = np.empty_like(database.positions[rows])
    _core.forward_kinematics(
        topology, np.ascontiguousarray(core.rotations[rows]), np.array(core.translated, np.int32),
        np.ascontiguousarray(core.translations[rows]), core.offsets(rows.start), None,
        np.empty(0, np.int32), positions,
    )  # fmt: skip
    return positions
