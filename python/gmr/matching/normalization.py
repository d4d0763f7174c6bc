"""The scaling of features."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Normalization"]


@dataclass(frozen=True, slots=True, eq=False)
class Normalization:
    """How raw features are scaled: ``feature = (raw - offset) / scale``."""

    offset: NDArray[np.float32]
    """(D,) mean of each number."""
    scale: NDArray[np.float32]
    """(D,) mean standard deviation of the number's group, over the group's weight."""
