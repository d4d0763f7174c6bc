"""All motions of a folder, in the order of their names."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from gmr.errors import FormatError, FormatWarning, GmrError
from gmr.formats.reading import Positions, Skeletons, given_options, read_with
from gmr.formats.registry import FORMATS, suffixes
from gmr.listing import listed
from gmr.threads import thread_count

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["Takes", "left_out_markers", "motion_files", "read_folder"]

_FEW = 5
"""Recordings of markers that a sentence names; the others it counts."""


class Takes(dict[str, "Motion"]):
    """Motions by their path relative to the folder (with ``/``), in name order.

    Attributes:
        failed: the error of each file that could not be read, by its relative path.
    """

    def __init__(self) -> None:
        super().__init__()
        self.failed: dict[str, GmrError] = {}


def motion_files(folder: str | os.PathLike[str]) -> list[str]:
    """Relative paths (with ``/``) of all motions in the folder and those below that gmr can read, in name
    order.

    Files that are only part of others, such as the ASF of an AMC, and hidden files and folders are left out;
    linked folders are followed, each once.

    Raises:
        FormatError: there is no such folder.
    """
    return _files(folder, "motion")


def left_out_markers(folder: str | os.PathLike[str]) -> str:
    """Which recordings of markers the folder and those below hold, why they are not among its motions, and
    how they come to be: a clause, empty where there are none.

    Raises:
        FormatError: there is no such folder.
    """
    paths = _files(folder, "markers")
    if not paths:
        return ""
    first = Path(folder, paths[0])
    example = f"gmr convert {first} {first.with_suffix('.gmr')}"
    if len(paths) == 1:
        return f"{paths[0]} is left out: it holds markers, not a motion; make one of it first: {example}"
    what = f"{len(paths)} files are left out ({listed(paths, _FEW)}): they hold markers, not motions"
    return f"{what}; make one of each first: {example}"


def _files(folder: str | os.PathLike[str], holds: Literal["motion", "markers"]) -> list[str]:
    """Relative paths of the files that hold the one or the other, in name order."""
    top = Path(folder)
    if not top.is_dir():
        what = "this is a file; read it with gmr.read" if top.exists() else "there is no such folder"
        raise FormatError(what, file=str(folder))
    try:
        return sorted(_walk(top, "", suffixes(holds), set()), key=lambda path: path.split("/"))
    except OSError as error:
        raise FormatError(f"this folder cannot be read: {error.strerror}", file=error.filename) from error


def read_folder(
    folder: str | os.PathLike[str],
    *,
    threads: int | None = None,
    errors: Literal["raise", "collect"] = "raise",
    positions: Positions = "replace",
    asf: Skeletons | None = None,
    fps: float | None = None,
    strict: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Takes:
    """Read all motions of a folder and the folders below.

    Args:
        folder: where they are; files of other kinds and hidden ones are left out. So are recordings of
            markers (C3D), of which a warning tells: each becomes a motion by :meth:`gmr.Markers.fit`.
        threads: how many files are read at once; 0 or None: all cores. The result does not depend on it.
        errors: "raise" the first file's error in name order, or "collect" them in ``.failed``.
        positions: see :func:`gmr.read`; for the BVH files.
        asf: see :func:`gmr.read`; for the AMC files.
        fps: see :func:`gmr.read`; for the AMC files.
        strict: see :func:`gmr.read`.
        progress: called with the number of files done and of all, after each.

    Returns:
        Relative path -> motion, in name order.

    Raises:
        FormatError: there is no such folder, or a file cannot be read and ``errors`` is "raise".

    Warns:
        FormatWarning: there are recordings of markers, or something odd was read all the same.
    """
    if errors not in ("raise", "collect"):
        raise ValueError(f"errors='{errors}' is not known; use 'raise' or 'collect'")
    most = thread_count(threads) or os.cpu_count() or 1
    options = given_options(positions, asf, fps)
    paths = motion_files(folder)
    if left_out := left_out_markers(folder):
        warnings.warn(f"{os.fspath(folder)}: {left_out}", FormatWarning, stacklevel=2)
    workers = max(1, min(most, len(paths)))
    takes = Takes()
    with ThreadPoolExecutor(workers, thread_name_prefix="gmr-read") as pool:
        jobs = [pool.submit(read_with, Path(folder, path), options, strict=strict) for path in paths]
        try:
            for done, (path, job) in enumerate(zip(paths, jobs, strict=True), start=1):
                _take(takes, path, job, collect=errors == "collect")
                if progress is not None:
                    progress(done, len(paths))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return takes


def _take(takes: Takes, path: str, job: Future[Motion], collect: bool) -> None:
    """Puts what became of one file where it belongs."""
    try:
        takes[path] = job.result()
    except GmrError as error:
        if not collect:
            raise
        takes.failed[path] = error


def _walk(folder: Path, prefix: str, wanted: tuple[str, ...], seen: set[tuple[int, int]]) -> Iterator[str]:
    """Relative paths of the files below ``folder`` with a wanted suffix, in no order."""
    status = folder.stat()
    if (status.st_dev, status.st_ino) in seen:
        return
    seen.add((status.st_dev, status.st_ino))
    names = []
    with os.scandir(folder) as entries:
        for entry in sorted(entries, key=lambda entry: entry.name):
            if entry.name.startswith("."):
                continue
            if entry.is_dir():
                yield from _walk(folder / entry.name, f"{prefix}{entry.name}/", wanted, seen)
            elif Path(entry.name).suffix.lower() in wanted:
                names.append(entry.name)
    serving: set[str] = set().union(*(known.serving_files(names) for known in FORMATS))
    yield from (prefix + name for name in names if name not in serving)
