"""How clips of another folder come to stand as the dataset's do.

What is to be added has to have the up axis and the ground of the dataset, whatever its own folder has; and a
folder that was gathered from several places may have several.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from gmr.completion.up import own_axes, raised, turned_up
from gmr.errors import DatasetError
from gmr.evaluation.words import capital
from gmr.matching.survey import Survey, axis_note, ground_note
from gmr.motion import Motion

__all__ = ["Place", "placed"]

_SAME_GROUND: Final = 0.02
"""Metres by which the ground of two folders may differ without anything being moved."""

_PART: Final = 0.2
"""Share of a folder's clips, at least two, from which an axis is one of files, not of a body that lies."""


@dataclass(frozen=True, slots=True)
class Place:
    """How clips that share an up axis and a ground stand, beside those of the dataset.

    Attributes:
        theirs: the clips.
        dataset: what they are to stand beside.
        of: how many clips the folder has with others that stand otherwise; 0 where there are none.
    """

    theirs: Survey
    dataset: Survey
    of: int = 0

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
        some = f"{len(self.theirs.units)} of its {self.of} files" if self.of else "its files"
        chosen_of = "what is chosen of them" if self.of else "what is chosen"
        if self.turned:
            yield (
                f"{capital(some)} have {self.theirs.up} up, those of the dataset {self.turned}: "
                f"{chosen_of} is turned to {self.turned} up."
            )
        if self.lift:
            yield (
                f"The ground of {some} lies at {_metres(self.theirs.lowest)}, that of the dataset at "
                f"{_metres(self.dataset.lowest)}: {chosen_of} is moved to the dataset's."
            )


def placed(
    motions: Mapping[str, Motion], dataset: Survey, look: Callable[[Mapping[str, Motion]], Survey]
) -> Iterator[tuple[dict[str, Motion], Place | None]]:
    """Clips in parts that have one up axis and one ground each, and how each part stands.

    A part whose clips cannot be used together has no place; why is told when they are added.

    Args:
        motions: by name.
        dataset: what they are to stand beside.
        look: surveys some of them.
    """
    try:
        seen = look(motions) if motions else None
    except DatasetError:
        seen = None
    parts = [motions] if seen is None else _by_axis(motions, own_axes(seen))
    if len(parts) == 1:
        yield dict(motions), None if seen is None else Place(seen, dataset)
        return
    for part in parts:
        try:
            yield dict(part), Place(look(part), dataset, len(motions))
        except DatasetError:
            yield dict(part), None


def _by_axis(motions: Mapping[str, Motion], axes: Mapping[str, str]) -> list[Mapping[str, Motion]]:
    """The clips by the axis along which each stands; those of rare axes stay with the most of them."""
    usual = Counter(axes.values()).most_common()
    kept = [axis for axis, clips in usual if clips >= max(2, _PART * len(axes))]
    if len(kept) < 2:
        return [motions]
    parts: dict[str, dict[str, Motion]] = {axis: {} for axis in kept}
    for name, motion in motions.items():
        parts.get(axes.get(name, kept[0]), parts[kept[0]])[name] = motion
    return list(parts.values())


def _metres(height: float) -> str:
    """To the centimetre, without a sign at 0."""
    return f"{round(height, 2) + 0.0:.2f} m"
