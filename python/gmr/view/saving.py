"""A page that plays without a server: the viewer, and everything that it shows, in one HTML file."""

from __future__ import annotations

import html
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gmr.errors import GmrError
from gmr.replacing import replacing
from gmr.view.opening import closed, opened
from gmr.view.shown import figures_of
from gmr.view.stage import Look, Stage
from gmr.view.timeline import Timeline

if TYPE_CHECKING:
    from gmr.skinning.character import Character
    from gmr.view.figure import Figure
    from gmr.view.shown import Shown

__all__ = ["FPS", "Page", "page_of", "save"]

FPS = 30.0
"""Frames a second of a page, where nobody says."""


@dataclass(frozen=True)
class Page:
    """What was made."""

    text: str
    """HTML."""
    seconds: float
    fps: float
    ticks: int


def save(
    shown: Shown | Iterable[Shown],
    path: str | os.PathLike[str],
    *,
    character: Character | None = None,
    rule: str = "per_child",
    look: Look | None = None,
    fps: float | None = FPS,
) -> Page:
    """Writes one HTML file that plays offline, with a time line, and asks nothing of any network.

    Skins by "lbs" cost little; those by "dqbs" and "cor", and weights as colours, hold all vertices of every
    frame, 12 bytes each: fewer frames a second help.

    Args:
        shown: a motion, a character or a :class:`Figure`, or several.
        path: the file; an old one is replaced when the new one is whole.
        character: a skin for the motions.
        rule: how bones are drawn; see :func:`gmr.bones`.
        look: what is drawn.
        fps: frames a second at the most; None: all.

    Raises:
        MissingExtraError: viser is not installed (the extra ``view``).
        GmrError: there is nothing to show.
        OSError: the file cannot be written.
    """
    page = page_of(figures_of(shown, character, rule), look or Look(), fps)
    with replacing(path) as (file,):
        file.write(page.text.encode("utf-8"))
    return page


def page_of(figures: Sequence[Figure], look: Look, fps: float | None = FPS) -> Page:
    """The page of these figures.

    Raises:
        MissingExtraError: viser is not installed.
        GmrError: the rate is not above 0.
    """
    if fps is not None and not 0 < fps < float("inf"):
        raise GmrError(f"{fps} frames a second cannot be; give a rate above 0")
    timeline = Timeline.of(figures, fps)
    server = opened(0)
    try:
        stage = Stage(server, figures, look)
        stage.draw(timeline, 0)
        recorded = server.get_scene_serializer()
        for tick in range(1, timeline.tick_count):
            recorded.insert_sleep(timeline.step)
            stage.draw(timeline, tick)
        recorded.insert_sleep(timeline.step)
        text = recorded.as_html()
    finally:
        closed(server)
    title = html.escape(", ".join(figure.name for figure in figures))
    text = re.sub(r"<title>[^<]*</title>", lambda _: f"<title>{title}</title>", text, count=1)
    return Page(text, timeline.seconds, 1 / timeline.step, timeline.tick_count)
