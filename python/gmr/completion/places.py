"""How clips of another folder come to stand as the dataset's do: a folder has one up axis and one ground."""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import dataclass
from typing import Final

from gmr.completion.up import raised, turned_up
from gmr.matching.survey import Survey, axis_note, ground_note
from gmr.motion import Motion

__all__ = ["Place"]

_SAME_GROUND: Final = 0.02
"""Metres by which the ground of two folders may differ without anything being moved."""


@dataclass(frozen=True, slots=True)
class Place:
    """How clips that share an up axis and a ground stand, beside those of the dataset.

    Attributes:
        theirs: the clips.
        dataset: what they are to stand beside.
    """

    theirs: Survey
    dataset: Survey

    @property
    def turned(self) -> str:
        """The axis that they are turned to have up; "" where they have so by themselves."""
        return self.dataset.up if self.theirs.up != self.dataset.up else ""

    @property
    def lift(self) -> float:
        """Metres by which they are moved up; 0 where both stand near 0, or on nearly the same ground."""
        lift = self.dataset.lowest - self.theirs.lowest
        apart = (self.theirs.floor or self.dataset.floor) and abs(lift) >= _SAME_GROUND
        return lift if apart else 0.0

    def put(self, name: str, motion: Motion) -> Motion:
        """One of the clips as it stands in the dataset."""
        if self.turned:
            motion = turned_up(motion, self.theirs.up, self.turned)
        return raised(motion, self.dataset.up, self.lift / self.theirs.units[name]) if self.lift else motion

    def foreign(self, note: str) -> bool:
        """Whether a note tells how the clips are read by themselves, which is not what is done with them."""
        return note in (axis_note(self.theirs.up), ground_note(self.theirs.floor))

    def told(self, chosen: Container[str]) -> Iterator[str]:
        """What is done with them, in sentences, where one of them was chosen."""
        if not any(name in chosen for name in self.theirs.units):
            return
        if self.turned:
            yield (
                f"Its files have {self.theirs.up} up, those of the dataset {self.turned}: what is chosen is "
                f"turned to {self.turned} up."
            )
        if self.lift:
            yield (
                f"The ground of its files lies at {_metres(self.theirs.lowest)}, that of the dataset at "
                f"{_metres(self.dataset.lowest)}: what is chosen is moved to the dataset's."
            )


def _metres(height: float) -> str:
    """To the centimetre, without a sign at 0."""
    return f"{round(height, 2) + 0.0:.2f} m"
