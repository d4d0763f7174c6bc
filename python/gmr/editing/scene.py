"""What an edit must know of a motion's world: how long its unit is, and which way is up."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import turned_upright
from gmr.errors import GmrError
from gmr.guesses import guess_body
from gmr.motion import Motion

__all__ = ["Scene", "Unit", "scene_of"]


@dataclass(frozen=True)
class Unit:
    """Metres per file unit, and whether they were guessed from the body."""

    metres: float | None
    guessed: bool
    name: str = ""

    def per_metre(self, what: str) -> float:
        """File units in a metre; ``what`` needs them.

        Raises:
            GmrError: the unit is not known.
        """
        if self.metres is None:
            raise GmrError(
                f"{what} needs to know how long a file unit is, and neither the file nor the body in it says "
                "so; declare it first: motion.with_unit('cm')"
            )
        return 1 / self.metres

    def said(self, length: float) -> str:
        """A length in millimetres where the unit is known, else in file units."""
        if self.metres is None:
            return f"{length:.4g} file units"
        return f"{length * self.metres * 1000:.1f} mm"

    @property
    def note(self) -> str:
        """What a reader of millimetres has to know; empty where the file said its unit."""
        if self.metres is None:
            return " (the unit is not known)"
        return f" (unit guessed from the body: {self.name})" if self.guessed else ""


@dataclass(frozen=True)
class Scene:
    """The unit of a motion and the axis that points up: "+Y", "-Z", ..."""

    unit: Unit
    up: str

    @cached_property
    def up_vector(self) -> NDArray[np.float64]:
        """(3,) the unit vector that points up."""
        return turned_upright(np.eye(3), self.up)[:, 1]


def scene_of(motion: Motion) -> Scene:
    """The unit that the motion says, else the one in which its body is a human's; up as its body stands, and
    +Y where that cannot be told."""
    guess = guess_body(motion)
    up = guess.up.axis if guess.up is not None and guess.up.sure else "+Y"
    if motion.unit is not None:
        return Scene(Unit(motion.unit, guessed=False), up)
    if guess.unit is None:
        return Scene(Unit(None, guessed=False), up)
    return Scene(Unit(guess.unit.metres, guessed=True, name=guess.unit.name), up)
