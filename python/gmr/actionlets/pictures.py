"""A film strip: the figure of a moving body at equal times, side by side, to judge a movement by eye.

The left limbs are light, the right ones dark. Bars on the ground mark the heels and the balls of the feet
that stand on it; below, the path of the pelvis and the places of the feet are seen from above.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from gmr.actionlets.figure import INK, PAPER, figure
from gmr.actionlets.strip import drawing, row_of
from gmr.errors import ActionletError, MissingExtraError
from gmr.motion import Motion
from gmr.replacing import replacing

__all__ = ["VIEWS", "film_strip"]

VIEWS = {"side": (90.0, 0.0), "front": (0.0, 0.0), "three-quarter": (40.0, 10.0)}
"""By name: how far the camera goes round from the front to the body's right, and how high, degrees."""

_MOST_FIGURES = 10_000


def film_strip(
    motion: Motion | Sequence[Motion],
    path: str | os.PathLike[str] | None = None,
    count: int = 12,
    view: str = "side",
    *,
    titles: Sequence[str] | None = None,
    labels: Sequence[str] | None = None,
    plan: bool = True,
    scale: float = 1.5,
) -> str:
    """Draws a film strip of one motion, or of several below each other.

    Args:
        motion: of a body that gmr knows, in any unit.
        path: ``.svg`` or ``.png`` to write; None: nothing is written.
        count: figures of each motion, from its first frame to its last.
        view: ``"side"`` (from the body's right, so that it goes to the right), ``"front"`` or
            ``"three-quarter"``, as the body faces in the first frame.
        titles: above each row.
        labels: below each figure of every row, instead of its time.
        plan: show the path from above.
        scale: of the pixels of a PNG.

    Returns:
        The SVG.

    Raises:
        ActionletError: an unknown view, a count that cannot be, another suffix, no motion, or no body in one.
        MissingExtraError: a PNG needs the extra [report].
    """
    if view not in VIEWS:
        raise ActionletError(f"view={view!r}: give one of {', '.join(VIEWS)}")
    if not 1 <= count <= _MOST_FIGURES:
        raise ActionletError(f"count={count}: give 1 or more figures, {_MOST_FIGURES:,} at most")
    motions = [motion] if isinstance(motion, Motion) else list(motion)
    if not motions:
        raise ActionletError("there is no motion to draw; give one or more")
    if labels is not None and len(labels) < count:
        raise ActionletError(f"{len(labels)} labels for {count} figures; give one for each")
    rows = []
    width, top = 0.0, 8.0
    for k, one in enumerate(motions):
        title = titles[k] if titles is not None and k < len(titles) else None
        row = row_of(figure(one), count, *VIEWS[view], head=22.0 if title else 4.0)
        drawn, tall = drawing(row, labels, plan)
        rows.append(f'<g transform="translate(8 {top:.1f})">{_title(title)}{drawn}</g>')
        width, top = max(width, row.width + 16), top + tall
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {top:.0f}" width="{width:.0f}" '
        f'height="{top:.0f}" font-family="system-ui, Segoe UI, Roboto, Helvetica, Arial, sans-serif">'
        f'<rect width="100%" height="100%" fill="{PAPER}"/>{"".join(rows)}</svg>\n'
    )
    if path is not None:
        _write(svg, Path(path), scale)
    return svg


def _title(words: str | None) -> str:
    if not words:
        return ""
    safe = words.replace("&", "&amp;").replace("<", "&lt;")
    return f'<text x="0" y="13" font-size="13" font-weight="600" fill="{INK}">{safe}</text>'


def _write(svg: str, path: Path, scale: float) -> None:
    suffix = path.suffix.lower()
    if suffix not in (".svg", ".png"):
        raise ActionletError(f"a film strip is written as .svg or .png, not as '{path.name}'")
    data = svg.encode()
    if suffix == ".png":
        try:
            import vl_convert
        except ImportError as error:
            raise MissingExtraError("vl-convert-python", "report", "a film strip as PNG") from error
        data = vl_convert.svg_to_png(svg, scale=scale)
    with replacing(path) as (file,):
        file.write(data)
