"""A completion as a folder: its page, both reports, its tables, and the clips that were made."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from gmr.completion.complete import Completion
from gmr.completion.page import page
from gmr.formats import write
from gmr.replacing import replacing

__all__ = ["write_completion"]

_STRIPS: Final = 3
"""Made clips of which the page shows a film strip: those that are played longest."""

_FIGURES: Final = 10


def write_completion(
    of: Completion,
    folder: str | os.PathLike[str],
    *,
    progress: Callable[[str, int, int], object] | None = None,
) -> Path:
    """Write all of it into a folder.

    Args:
        of: what to write.
        folder: where to; made where it is missing. Files of these names in it are replaced, each at once.
        progress: called with what is being written, how much of it is done, and of how much.

    Returns:
        The page, ``index.html``; beside it the full reports ``before.html`` and ``after.html``,
        ``trials.csv`` and ``clips.csv``, and ``clips/``, the clips that were made, as BVH.

    Raises:
        OSError: a file cannot be written.
    """
    tell = progress or (lambda what, done, total: None)
    folder = Path(folder)
    clips = folder / "clips"
    clips.mkdir(parents=True, exist_ok=True)
    for number, (name, motion) in enumerate(of.added.items()):
        tell("writing clips", number, len(of.added))
        write(motion, clips / name)
    tell("writing clips", len(of.added), len(of.added))
    tell("writing the page", 0, 1)
    of.trials.to_csv(folder / "trials.csv")
    of.clips.to_csv(folder / "clips.csv")
    of.before.report(folder / "before.html")
    of.after.report(folder / "after.html")
    written = folder / "index.html"
    with replacing(written) as (file,):
        file.write(page(of, _strips(of)).encode())
    tell("writing the page", 1, 1)
    return written


def _strips(of: Completion) -> dict[str, str]:
    """Film strips of the made clips that are played longest."""
    from gmr.actionlets import film_strip

    played = of.clips["played_seconds"]
    longest = sorted(range(len(played)), key=lambda row: -played[row])[:_STRIPS]
    names = list(of.added)
    return {names[row]: film_strip(of.added[names[row]], count=_FIGURES) for row in longest}
