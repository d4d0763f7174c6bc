"""A corpus is written: in parallel, and on from where it was left, however that was."""

from __future__ import annotations

import os
import pickle
import re
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gmr.actionlets.corpus.exclusive import exclusive
from gmr.actionlets.corpus.journal import Journal, Record, journal, put_in_order, records_in
from gmr.actionlets.corpus.making import Made, Work, make
from gmr.actionlets.corpus.manifest import MANIFEST, check_pyarrow, write_manifest
from gmr.actionlets.corpus.plan import Plan
from gmr.cluster import results, worker_count
from gmr.errors import GmrError
from gmr.formats.writing import write_pieces
from gmr.replacing import replacing

if TYPE_CHECKING:
    from gmr.actionlets.actions.library import Library

__all__ = ["JOURNAL", "PLAN", "Progress", "Written", "write_corpus"]

PLAN: Final = "corpus.json"
JOURNAL: Final = "takes.jsonl"

Progress = Callable[[int, int, float], None]
"""Told how many takes are there, of how many, and how many seconds of motion were made."""

_BATCH: Final = 8
"""Takes in a job at most: enough that sending it costs nothing, few enough that a kill costs little."""

_LEFTOVER: Final = re.compile(r"\..+\.[0-9a-f]{8}")
"""What a killed process leaves of a file that it was writing beside its place."""


@dataclass
class Written:
    """What became of a corpus.

    Args:
        there: takes that were there before.
        made: takes that were made.
        seconds: of motion in these.
        failed: why takes could not be made, by the name of their file.
    """

    there: int = 0
    made: int = 0
    seconds: float = 0.0
    failed: dict[str, str] = field(default_factory=dict)


def write_corpus(
    plan: Plan,
    library: Library,
    folder: str | os.PathLike[str],
    *,
    workers: int | None = None,
    cluster: str | None = None,
    progress: Progress | None = None,
) -> Written:
    """Make all takes of a plan, and a manifest of them.

    A folder where some of them are is gone on with. The same plan gives the same files, byte for byte,
    however many workers make them, and however often they were interrupted.

    Args:
        plan: what is to be made.
        library: its actions.
        folder: new, empty, or one in which the same plan was begun.
        workers: processes, see :func:`gmr.cluster.results`.
        cluster: likewise.
        progress: told how far it is, after some takes each.

    Raises:
        MissingExtraError: pyarrow is not installed (the extra ``corpus``).
        GmrError: the folder holds something else, or another command is at work in it; or a file cannot be
            written, and the same call goes on from there.
    """
    check_pyarrow()
    place = Path(os.path.abspath(folder))  # noqa: PTH100  (links stay as they are)
    with _told(place):
        place.mkdir(parents=True, exist_ok=True)
        with exclusive(place) as word:
            _begin(plan, place)
            work = Work(plan, pickle.dumps(library), str(place), word)
            return _write(work, place, worker_count(workers, cluster), cluster, progress or _silent)


def _write(work: Work, place: Path, workers: int, cluster: str | None, progress: Progress) -> Written:
    plan = work.plan
    places = _there(plan, place)
    lacking = [number for number in range(len(plan)) if number not in places]
    written = Written(there=len(places))
    progress(written.there, len(plan), 0.0)
    if lacking:
        (place / MANIFEST).unlink(missing_ok=True)
        batches = _batches(lacking, workers)
        with (
            _told(place, lambda: len(places), len(plan)),
            journal(place / JOURNAL) as log,
            closing(results(partial(make, work), batches, workers=workers, cluster=cluster)) as done,  # type: ignore[type-var]
        ):
            for _, batch in done:
                places |= _kept(batch, plan, place, log, written)
                progress(len(places) + len(written.failed), len(plan), written.seconds)
    put_in_order(place / JOURNAL, places)
    write_manifest(place / MANIFEST, plan, (record for _, record in records_in(place / JOURNAL)))
    return written


def _there(plan: Plan, place: Path) -> dict[int, int]:
    """The takes that are there, whole, by number: at which byte of the journal their labels are."""
    sizes = _sizes(place)
    return {
        number: at
        for at, record in records_in(place / JOURNAL)
        if 0 <= (number := record["take"]) < len(plan)
        and record["file"] == plan.file(number)
        and sizes.get(record["file"]) == record["bytes"]
    }


def _kept(batch: list[Made], plan: Plan, place: Path, log: Journal, written: Written) -> dict[int, int]:
    """What a worker has made is written down, and written where it could not do so; where in the journal."""
    new: list[Record] = []
    for made in batch:
        if made.record is None:
            written.failed[plan.file(made.number)] = made.failed
            continue
        if made.data is not None:
            path = place / made.record["file"]
            path.parent.mkdir(parents=True, exist_ok=True)
            write_pieces(path, [made.data])
        new.append(made.record)
    places = log.add(new)
    written.made += len(new)
    written.seconds += sum(record["frames"] / record["fps"] for record in new)
    return places


def _begin(plan: Plan, place: Path) -> None:
    """The plan's file, written or found to be the same; what dead processes have left is removed.

    Raises:
        GmrError: there is another plan, or something else.
    """
    path = place / PLAN
    try:
        there = path.read_bytes()
    except FileNotFoundError:
        found = sorted(other.name for other in place.iterdir() if not other.name.startswith("."))
        if found:
            raise GmrError(
                f"{place}: there is no corpus in this folder, but '{found[0]}' and perhaps more; "
                "name an empty or a new folder"
            ) from None
        with replacing(path) as (file,):
            file.write(plan.to_json().encode())
        return
    try:
        differences = plan.differences(there.decode())
    except (ValueError, RecursionError):
        raise GmrError(
            f"{path}: this is no plan of a corpus; name another folder, or remove this one"
        ) from None
    if differences:
        raise GmrError(
            f"{place}: another corpus is in this folder: {'; '.join(differences)}. Ask for the same to go on "
            "with it, or name another folder"
        )


def _sizes(place: Path) -> dict[str, int]:
    """Bytes of each file below a folder, by its path with ``/``; leftovers of dead processes are removed."""
    found: dict[str, int] = {}
    waiting = [""]
    while waiting:
        prefix = waiting.pop()
        with os.scandir(place / prefix) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    waiting.append(f"{prefix}{entry.name}/")
                elif _LEFTOVER.fullmatch(entry.name):
                    Path(entry.path).unlink(missing_ok=True)
                else:
                    found[prefix + entry.name] = entry.stat().st_size
    return found


def _batches(numbers: list[int], workers: int) -> list[tuple[int, ...]]:
    """The takes in jobs: so many that at the end no worker waits long for another."""
    size = min(_BATCH, max(1, len(numbers) // (8 * max(workers, 1))))
    return [tuple(numbers[start : start + size]) for start in range(0, len(numbers), size)]


@contextmanager
def _told(place: Path, there: Callable[[], int] | None = None, of: int = 0) -> Iterator[None]:
    """An error while writing is one sentence; once takes are there it says that they are not lost."""
    try:
        yield
    except (GmrError, OSError) as error:
        words = str(error)
        if isinstance(error, OSError) and not isinstance(error, GmrError):
            words = f"{error.filename or place}: {error.strerror or error}"
        elif there is None:
            raise
        if there is not None:
            words += f". {there():,} of {of:,} takes are in '{place}'; the same command goes on from there"
        raise GmrError(words) from error


def _silent(done: int, of: int, seconds: float) -> None:
    pass
