"""Ways of blending compared on a capsule and on a character in a clip: figures, stills, a film, a page.

Source: spec "Skinning", what the comparison must show (the paper's Figs. 5 and 6).
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Final

from gmr.replacing import replacing
from gmr.skinning.comparison.measured import METHODS, Comparison, compare
from gmr.skinning.comparison.page import headline, page
from gmr.skinning.comparison.pictures import Picture, direction, picture_count, pictures
from gmr.skinning.comparison.rendering import View, film, film_frames, look_of

__all__ = ["METHODS", "Comparison", "Picture", "compare", "headline", "page", "pictures", "write_comparison"]

_FILM_SECONDS: Final = 6.0
_FILM_SIZE: Final = (900, 420)

Progress = Callable[[str, int, int], None]


def write_comparison(
    of: Comparison,
    folder: str | os.PathLike[str],
    *,
    with_film: bool = True,
    progress: Progress = lambda what, done, total: None,
) -> Path:
    """Writes the page with all that it shows inside, and beside it the tables, stills and film it is made of.

    Args:
        of: what to show.
        folder: where to; made where it is missing. ``index.html``, ``frames.csv``, ``apart.csv``,
            ``capsule.csv``, ``*.png`` and ``side_by_side.mp4`` are written there.
        with_film: whether to draw the film, which takes longest: at most six seconds, round the frame in
            which the methods differ most.
        progress: hears what is being done, and how much of it is.

    Returns:
        The page.

    Raises:
        MissingExtraError: PyVista or imageio-ffmpeg are not installed.
        OSError: the folder may not be written to, or the disk is full.
    """
    target = Path(folder)
    drawn, count = [], picture_count(of)
    progress("stills", 0, count)
    for picture in pictures(of):
        drawn.append(picture)
        progress("stills", len(drawn), count)
    moving = _film(of, progress) if with_film else None
    target.mkdir(parents=True, exist_ok=True)
    for name in ("frames", "apart", "capsule"):
        getattr(of, name).to_csv(target / f"{name}.csv")
    files = {f"{picture.name}.png": picture.png for picture in drawn}
    if moving is not None:
        files["side_by_side.mp4"] = moving
    files["index.html"] = page(of, drawn, moving).encode()
    for name, content in files.items():
        with replacing(target / name) as (file,):
            file.write(content)
    return target / "index.html"


def _film(of: Comparison, progress: Progress) -> bytes:
    length = max(1, round(_FILM_SECONDS / of.frame_time))
    middle = int(of.apart["apart_max_mm"].argmax())
    start = max(0, min(middle - length // 2, len(of.poses) - length))
    poses = of.poses[start : start + length]
    look = look_of(of.character)
    views = [View(name, of.character.skin(poses, method), look) for method, name in METHODS.items()]
    total = len(film_frames(len(poses), of.frame_time))
    progress("film", 0, total)
    with tempfile.TemporaryDirectory() as room:
        path = Path(room) / "film.mp4"
        film(
            views,
            direction(of).tolist(),
            path,
            frame_time=of.frame_time,
            size=_FILM_SIZE,
            advance=lambda done: progress("film", done, total),
        )
        return path.read_bytes()
