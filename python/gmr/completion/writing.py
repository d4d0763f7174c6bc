"""A completion as a folder: the clips that were made or chosen, its tables, its page and both reports."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Final

from gmr.completion.complete import Completion, Progress
from gmr.completion.page import page
from gmr.completion.words import headline, sentences
from gmr.formats import write
from gmr.motion import Motion
from gmr.replacing import replacing

__all__ = ["clips_of_before", "write_added", "write_completion"]

_STRIPS: Final = 3
"""Made clips of which the page shows a film strip: those that are played longest."""

_FIGURES: Final = 10


def write_completion(
    of: Completion,
    folder: str | os.PathLike[str],
    *,
    source: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Path:
    """Write all of it into a folder.

    Args:
        of: what to write.
        folder: where to; made where it is missing. Files of these names in it are replaced, each at once.
        source: the folder that clips were chosen from; see :func:`write_added`.
        progress: called with what is being written, how much of it is done, and of how much.

    Returns:
        The page, ``index.html``; beside it the full reports ``before.html`` and ``after.html``, and what
        :func:`write_added` writes.

    Raises:
        OSError: a file cannot be written.
    """
    tell = progress or _silent
    folder = write_added(of, folder, source=source, progress=progress)
    tell("writing the page", 0, 1)
    of.before.report(folder / "before.html")
    of.after.report(folder / "after.html")
    written = folder / "index.html"
    with replacing(written) as (file,):
        file.write(page(of, _strips(of)).encode())
    tell("writing the page", 1, 1)
    return written


def write_added(
    of: Completion,
    folder: str | os.PathLike[str],
    *,
    source: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Path:
    """Write the clips that were made or chosen into a folder, and what they bring as tables.

    Args:
        of: what to write.
        folder: where to; made where it is missing. Files of these names in it are replaced, each at once.
        source: the folder that clips were chosen from: those that are added as they are are copied from it,
            byte for byte, where a file tells all by itself; all others are written as BVH.
        progress: called with what is being written, how much of it is done, and of how much.

    Returns:
        The folder. In it ``clips/``, ``trials.csv`` and ``clips.csv``. Where the clips were chosen,
        ``chosen.csv`` and ``manifest.json`` too, which say what each is, where it comes from, what it took
        away, and which clips were refused and why.

    Raises:
        OSError: a file cannot be written.
    """
    tell = progress or _silent
    folder = Path(folder)
    clips = folder / "clips"
    clips.mkdir(parents=True, exist_ok=True)
    for number, (name, motion) in enumerate(of.added.items()):
        tell("writing clips", number, len(of.added))
        _add(of, name, motion, clips, None if source is None else Path(source))
    of.trials.to_csv(folder / "trials.csv")
    of.clips.to_csv(folder / "clips.csv")
    if of.source:
        of.chosen.to_csv(folder / "chosen.csv")
        with replacing(folder / "manifest.json") as (file,):
            file.write(_manifest(of).encode())
    tell("writing clips", len(of.added), len(of.added))
    return folder


def clips_of_before(of: Completion, folder: str | os.PathLike[str]) -> list[str]:
    """Files in ``clips/`` of a folder that are no part of this completion: of an earlier one, mostly."""
    clips = Path(folder) / "clips"
    own = {place for name in of.added for place in (clips / name, _written_as(clips / name))}
    return sorted(
        path.relative_to(clips).as_posix() for path in clips.rglob("*") if path.is_file() and path not in own
    )


def _silent(phase: str, done: int, of: int) -> None:
    """Tell nobody."""


def _add(of: Completion, name: str, motion: Motion, clips: Path, source: Path | None) -> None:
    """Copy a file that is added whole, or write what was made of it."""
    candidate = next((choice.candidate for choice in of.choices if choice.name == name), None)
    place = clips / name
    if candidate is None or not candidate.whole:
        write(motion, place)
    elif (
        source is not None
        and place.suffix.lower() in _WHOLE_IN_ONE_FILE
        and (source / candidate.source).is_file()  # it is not, under this name, where that is no UTF-8
    ):
        with replacing(place) as (file,):
            file.write((source / candidate.source).read_bytes())
    else:
        write(motion, _written_as(place))


_WHOLE_IN_ONE_FILE: Final = (".bvh", ".gmr", ".glb")


def _written_as(place: Path) -> Path:
    return place if place.suffix.lower() == ".bvh" else place.with_suffix(".bvh")


def _manifest(of: Completion) -> str:
    content = {
        "dataset": of.dataset,
        "chosen_from": of.source,
        "headline": headline(of),
        "sentences": sentences(of),
        "clips": list(of.chosen.rows()),
        "refused": dict(of.refused),
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)


def _strips(of: Completion) -> dict[str, str]:
    """Film strips of the made clips that are played longest."""
    from gmr.actionlets import film_strip

    played = of.clips["played_seconds"]
    longest = sorted(range(len(played)), key=lambda row: -played[row])[:_STRIPS]
    names = list(of.added)
    return {names[row]: film_strip(of.added[names[row]], count=_FIGURES) for row in longest}
