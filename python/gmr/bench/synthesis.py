"""Synthesis: takes of a corpus, from the library to files, beside real time."""

from __future__ import annotations

import pickle
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gmr.bench.harness import Contest

if TYPE_CHECKING:
    from gmr.actionlets.corpus.making import Work

__all__ = ["takes"]

_ACTIONS: Final = ("walk", "run")
_SECONDS: Final = 10


def takes(frame_count: int) -> Iterator[Contest]:
    """Takes at 120 fps of many bodies, parameters and variations, made and written, in seconds a second."""
    from gmr.actionlets import library
    from gmr.actionlets.corpus import planned
    from gmr.actionlets.corpus.exclusive import exclusive
    from gmr.actionlets.corpus.making import Work, make

    shipped = library()
    count = max(1, min(8, frame_count // (120 * _SECONDS)))
    for action in _ACTIONS:
        settings = {"seconds": str(_SECONDS), "height": "1.5..1.9", "sex": "male,female"}
        plan = planned(shipped, [action], count, settings=settings)
        with tempfile.TemporaryDirectory() as folder, exclusive(Path(folder)) as word:
            work = Work(plan, pickle.dumps(shipped), folder, word)
            numbers = tuple(range(count))
            if failed := [made.failed for made in make(work, numbers) if made.record is None]:
                raise AssertionError(f"a take could not be made: {failed[0]}")
            yield Contest(
                work=f"synthesise and write takes of '{action}', {_SECONDS} s at 120 fps",
                unit="x real time",
                amount=count * _SECONDS,
                ours=lambda work=work, numbers=numbers: _anew(work, numbers),  # type: ignore[misc]
            )


def _anew(work: Work, numbers: tuple[int, ...]) -> None:
    """Takes in new files, as in any corpus: one that takes the place of another waits for the disk."""
    from gmr.actionlets.corpus.making import make

    for number in numbers:
        Path(work.folder, work.plan.file(number)).unlink()
    make(work, numbers)
