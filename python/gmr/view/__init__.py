"""Motions and characters in a browser: a local viewer, and pages that play without one (the extra ``view``).

The data goes one way: a motion or a character becomes a :class:`Figure` (plain arrays, metres, Y up), figures
stand on a stage beside each other, and the stage is shown live or saved.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gmr.lazily import lazily

if TYPE_CHECKING:
    from gmr.view.figure import Figure, Worn, motion_figure, posed_figure
    from gmr.view.saving import save
    from gmr.view.server import Live, show
    from gmr.view.stage import Look

__all__ = ["Figure", "Live", "Look", "Worn", "motion_figure", "posed_figure", "save", "show"]

# Imported when first used: figures are made without viser, which only drawing needs.
_HOMES = {
    "Figure": "gmr.view.figure",
    "Live": "gmr.view.server",
    "Look": "gmr.view.stage",
    "Worn": "gmr.view.figure",
    "motion_figure": "gmr.view.figure",
    "posed_figure": "gmr.view.figure",
    "save": "gmr.view.saving",
    "show": "gmr.view.server",
}

__getattr__ = lazily(__name__, _HOMES)
