"""What every edit gives back: the motion, and a report of what the edit cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from gmr.editing.scene import Unit
from gmr.motion import Motion

__all__ = ["Edited", "Stretch"]

Report = TypeVar("Report", covariant=True)


@dataclass(frozen=True, eq=False)
class Edited(Generic[Report]):
    """An edited motion, in the unit and the configuration of the motion before, and its report."""

    motion: Motion
    report: Report


@dataclass(frozen=True, eq=False)
class Stretch:
    """How far the end of a limb stayed from where it was wanted, because the limb is not long enough.

    Args:
        joint: the end's name.
        missed: (F,) file units; NaN where the pose is not known.
        unit: of ``missed``.
    """

    joint: str
    missed: NDArray[np.float64]
    unit: Unit

    @property
    def greatest(self) -> float:
        """In the frame in which it is worst, file units."""
        return float(np.nanmax(self.missed, initial=0))

    @property
    def mm(self) -> NDArray[np.float64]:
        """(F,) millimetres.

        Raises:
            GmrError: the unit is not known.
        """
        return self.missed * (1000 / self.unit.per_metre("a stretch in millimetres"))

    def __str__(self) -> str:
        frames = int(np.count_nonzero(self.missed > 1e-9 * max(self.greatest, 1)))
        if not frames:
            return f"{self.joint} reaches everywhere"
        return (
            f"{self.joint} stays {self.unit.said(self.greatest)} short at most, in {frames} of "
            f"{len(self.missed)} frames"
        )
