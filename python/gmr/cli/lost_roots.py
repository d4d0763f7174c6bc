"""Which roots of a motion a format cannot keep."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gmr.listing import quoted

if TYPE_CHECKING:
    from gmr.formats.registry import Format
    from gmr.motion import Motion
    from gmr.skeleton import Skeleton

__all__ = ["lost_roots"]

FEW: Final = 6
"""Roots that the sentence names; the others it counts."""


def lost_roots(motion: Motion, written: Format) -> str:
    """The roots that hang on other joints in a file of this format, as a clause; empty where there are
    none."""
    home = motion.skeleton.home
    if home is None or written.roots == "all":
        return ""
    lost = _turned(motion.skeleton, home) if written.roots == "first" else _linked(motion.skeleton)
    if not lost:
        return ""
    names = quoted([motion.skeleton.names[root] for root in lost], FEW)
    if len(lost) == 1:
        said = f"{names} as a root, so it hangs on its old parent again; .gmr and .gmrb keep it"
    else:
        said = f"{names} as roots, so they hang on their old parents again; .gmr and .gmrb keep them"
    return f"{written.name} cannot keep {said}"


def _linked(skeleton: Skeleton) -> list[int]:
    """Roots of trees that were split off."""
    return [root for root in skeleton.roots if skeleton.links[skeleton.forest.top_of(root)] >= 0]


def _turned(skeleton: Skeleton, home: Skeleton) -> list[int]:
    """Roots of such trees, and of those that were turned over."""
    return [root for root in skeleton.roots if root not in home.roots]
