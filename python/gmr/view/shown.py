"""What may be shown, as figures."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gmr.errors import GmrError
from gmr.view.figure import Figure, motion_figure, posed_figure

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skinning.character import Character

    Shown = Motion | Character | Figure

__all__ = ["figures_of"]


def figures_of(shown: Shown | Iterable[Shown], character: Character | None, rule: str) -> tuple[Figure, ...]:
    """A figure for each motion, character and figure; what is a figure already stays as it is.

    Raises:
        GmrError: there is nothing, or something that is none of these.
    """
    from gmr.motion import Motion
    from gmr.skinning.character import Character

    things = [shown] if isinstance(shown, Motion | Character | Figure) else list(shown)
    if not things:
        raise GmrError("there is nothing to show: give a motion, a character or a figure")
    found = []
    for thing in things:
        if isinstance(thing, Motion):
            found.append(motion_figure(thing, character, rule=rule))
        elif isinstance(thing, Character):
            found.append(posed_figure(thing, rule=rule))
        elif isinstance(thing, Figure):
            found.append(thing)
        else:
            raise GmrError(f"a motion, a character or a figure can be shown, not {thing!r:.60}")
    return tuple(found)
