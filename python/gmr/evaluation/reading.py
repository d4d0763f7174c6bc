"""The clips of a folder: what was read, what was odd about it, and what could not be read and why."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from gmr.errors import DatasetError, FormatWarning
from gmr.evaluation.words import some_of
from gmr.formats.folder import left_out_markers, read_folder
from gmr.formats.registry import suffixes
from gmr.motion import Motion

if TYPE_CHECKING:
    from gmr.errors import GmrError

__all__ = ["Read", "printable", "read_clips"]


@dataclass(frozen=True, slots=True)
class Read:
    """What a folder held.

    Attributes:
        motions: by their path below the folder.
        failed: files that could not be read, and why.
        notes: what was odd in files that could, in sentences.
        name: of the folder.
    """

    motions: Mapping[str, Motion]
    failed: Mapping[str, str]
    notes: tuple[str, ...]
    name: str = "motions"


def read_clips(
    folder: str | os.PathLike[str],
    *,
    threads: int | None = None,
    errors: Literal["raise", "collect"] = "collect",
    progress: Callable[[int, int], None] | None = None,
) -> Read:
    """Read every motion file below a folder.

    Args:
        folder: where they are.
        threads: how many to use, all cores by default.
        errors: "collect": files that cannot be read are named in ``failed``; "raise": the first ends it.
        progress: called with how many files are read, and of how many.

    Raises:
        DatasetError: the folder holds no motion that can be read.
        FormatError: there is no such folder; or a file cannot be read and ``errors`` is "raise".
    """
    with _format_warnings() as odd:
        takes = read_folder(folder, threads=threads, errors=errors, progress=progress)
    if not takes:
        raise DatasetError(_no_motion(folder, takes.failed))
    return Read(
        motions={printable(path): take for path, take in takes.items()},
        failed={printable(path): printable(str(error)) for path, error in takes.failed.items()},
        notes=tuple(odd),
        name=printable(Path(folder).resolve().name),
    )


def _no_motion(folder: str | os.PathLike[str], failed: Mapping[str, GmrError]) -> str:
    if failed:
        first = next(iter(failed.values()))
        if len(failed) == 1:
            return f"the only motion file of {os.fspath(folder)} could not be read: {first}"
        return (
            f"none of the {len(failed)} motion files of {os.fspath(folder)} could be read; the first: {first}"
        )
    nothing = f"{os.fspath(folder)} holds no motion files ({some_of(suffixes('motion'), 10)})"
    if left_out := left_out_markers(folder):
        return f"{nothing}; {left_out}"
    return f"{nothing}, nor do the folders in it; give the folder that the clips are in"


def printable(text: str) -> str:
    """Text with a file's name in it: bytes that are no UTF-8 are written as escapes."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


@contextmanager
def _format_warnings() -> Iterator[list[str]]:
    """Collect what readers find odd in files as sentences; other warnings go their usual way."""
    sentences: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", FormatWarning)
        yield sentences
    for warning in caught:
        if issubclass(warning.category, FormatWarning):
            sentences.append(printable(str(warning.message)))
        else:
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)
