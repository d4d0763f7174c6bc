"""All motions of a folder, in the order of their names."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from gmr.errors import FormatError, GmrError
from gmr.formats.reading import Positions, Skeletons, given_options, read_with
from gmr.formats.registry import FORMATS, suffixes
from gmr.threads import thread_count

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["Takes", "motion_files", "read_folder"]


class Takes(dict[str, "Motion"]):
    """Motions by their path relative to the folder (with ``/``), in name order.

    Attributes:
        failed: the error of each file that could not be read, by its relative path.
    """

    def __init__(self) -> None:
        super().__init__()
        self.failed: dict[str, GmrError] = {}


def motion_files(folder: str | os.PathLike[str]) -> list[str]:
    """Relative paths (with ``/``) of all files in the folder and those below that gmr can read, in name
    order.

    Files that are only part of others, such as the ASF of an AMC, and hidden files and folders are left out;
    linked folders are followed, each once.

    Raises:
        FormatError: there is no such folder.
    """
    top = Path(folder)
    if not top.is_dir():
        what = "this is a file; read it with gmr.read" if top.exists() else "there is no such folder"
        raise FormatError(what, file=str(folder))
    try:
        return sorted(_walk(top, "", set()), key=lambda path: path.split("/"))
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
        folder: where they are; files of other kinds and hidden ones are left out.
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
    """
    if errors not in ("raise", "collect"):
        raise ValueError(f"errors='{errors}' is not known; use 'raise' or 'collect'")
    most = thread_count(threads) or os.cpu_count() or 1
    options = given_options(positions, asf, fps)
    paths = motion_files(folder)
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


def _walk(folder: Path, prefix: str, seen: set[tuple[int, int]]) -> Iterator[str]:
    """Relative paths of the motion files below ``folder``, in no order."""
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
                yield from _walk(folder / entry.name, f"{prefix}{entry.name}/", seen)
            elif Path(entry.name).suffix.lower() in suffixes("motion"):
                names.append(entry.name)
    serving: set[str] = set().union(*(known.serving_files(names) for known in FORMATS))
    yield from (prefix + name for name in names if name not in serving)
