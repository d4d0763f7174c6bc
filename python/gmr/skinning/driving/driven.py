"""A character that follows a motion, and how it does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.listing import quoted
from gmr.skinning.driving.standing import FootReport

__all__ = ["Driven", "DrivingReport"]

_SHOWN = 12


@dataclass(frozen=True)
class DrivingReport:
    """How a character follows a motion.

    Args:
        follows: character's joint -> the joint of the motion whose bone it follows.
        matched_by: what told who follows whom.
        unmatched_character: joints that keep their rest pose relative to their parents.
        unmatched_motion: joints that nothing follows; ends left out.
        scale: metres that the character goes for a metre of the motion; None where the motion's unit is not
            known.
        scaled_by: what the scale was told by.
        unit: of the motion, in words.
        up: the motion's axis that points up.
        rest: which pose of the motion the character's rest was laid on.
        facing_deg: by how much the character was turned about the vertical for that.
        rest_turns_deg: character's joint -> how far its bone was turned for that.
        left_out: frames that a converter put before the recording.
        raised_mm: by how much the whole was raised to stand on the ground, in the middle of the frames.
        sunk_mm: by how much the hips sank at most for the legs to reach.
        feet_before: before anything was done for the feet.
        feet: after it.
    """

    follows: Mapping[str, str]
    matched_by: str
    unmatched_character: tuple[str, ...]
    unmatched_motion: tuple[str, ...]
    scale: float | None
    scaled_by: str
    unit: str
    up: str
    rest: str
    facing_deg: float
    rest_turns_deg: Mapping[str, float]
    left_out: int
    raised_mm: float
    sunk_mm: float
    feet_before: tuple[FootReport, ...]
    feet: tuple[FootReport, ...]

    def as_dict(self) -> dict[str, Any]:
        """All of it, as JSON can hold it."""
        return asdict(self)

    def __str__(self) -> str:
        turned = sorted(self.rest_turns_deg.items(), key=lambda one: -one[1])
        said = [f"'{name}' by {angle:.0f}" for name, angle in turned[:4] if angle >= 1]
        lines = [
            f"{len(self.follows)} joints follow, matched {self.matched_by}",
            self._kept("of the character's keep their rest pose", self.unmatched_character),
            self._kept("of the motion's are followed by none", self.unmatched_motion),
            f"rest: laid on {self.rest}, turned by {self.facing_deg:.0f} degrees about the vertical"
            + (f"; bones turned most: {', '.join(said)} degrees" if said else ""),
            f"scale: {'not known' if self.scale is None else f'{self.scale:.3f}'}, {self.scaled_by}; "
            f"{self.up} is up; {self.unit}",
            f"{self.left_out} frames before the recording are left out" if self.left_out else "",
            *self._feet(),
        ]
        return "\n".join(line for line in lines if line)

    @staticmethod
    def _kept(what: str, names: tuple[str, ...]) -> str:
        return f"{len(names)} {what}: {quoted(names, _SHOWN)}" if names else ""

    def _feet(self) -> list[str]:
        if not self.feet:
            return ["feet: no legs are matched, so nothing was done for them"]
        if self.feet == self.feet_before:
            lines = ["feet: left as the bones' turns put them"]
        else:
            lines = [
                f"feet: raised by {self.raised_mm:.1f} mm as a whole; hips sink by {self.sunk_mm:.1f} mm at "
                "most"
            ]
        for before, after in zip(self.feet_before, self.feet, strict=True):
            lines.append(
                f"{after.side} foot: {after.contacts} contacts; sole off the ground in them by "
                f"{after.height_mm:.1f} mm at most (before: {before.height_mm:.1f}), lowest "
                f"{after.lowest_mm:.1f} mm ({before.lowest_mm:.1f}); slides {after.slide_mm:.1f} mm a "
                f"contact ({before.slide_mm:.1f}; the motion's own: {after.source_slide_mm:.1f})"
            )
        return lines


@dataclass(frozen=True, eq=False)
class Driven:
    """A character in the poses of a motion.

    Args:
        poses: (F, J, 4, 4) float64 world matrices of the joints, for :meth:`Character.skin` and
            :func:`gmr.write_character`; metres, +Y up.
        frame_time: seconds.
        report: how it was done.
    """

    poses: NDArray[np.float64]
    frame_time: float
    report: DrivingReport
