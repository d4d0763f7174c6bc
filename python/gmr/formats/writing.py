"""A motion becomes a file, whole or not at all."""

from __future__ import annotations

import io
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

from gmr.errors import GmrError
from gmr.formats.registry import FORMATS, Format, format_of_file, named_format
from gmr.replacing import replacing
from gmr.unbuffered import write_all

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["Target", "write", "write_pieces"]

Target = str | os.PathLike[str] | IO[str] | IO[bytes]


def write(motion: Motion, target: Target, format: str | None = None) -> None:
    """Write a motion.

    A file is written beside its place and renamed when it is whole: a full disk or an interrupt leaves what
    was there.

    Args:
        motion: what was read as rows is written with the very same values, names and channels.
        target: a path, or a file open for writing, text or binary. With a path to an .amc its .asf is written
            beside it, both or none; an .asf alone, and an .amc into an open file, hold half of a motion.
        format: "bvh", "amc", "asf", "gmr" (text), "gmrb" (binary), "glb" or "x3d"; told by the suffix where
            left out, BVH for an open file.

    Raises:
        GmrError: the file cannot be written; what was there is untouched.
        FormatError: no format that gmr writes has that suffix or is called so.
        SkeletonError: the format cannot hold this motion.
    """
    from gmr.motion import Motion

    if not isinstance(motion, Motion):
        raise TypeError(f"a motion is written, not {motion!r:.60}")
    if isinstance(target, str | os.PathLike):
        path = Path(target)
        if os.path.isdir(path):  # noqa: PTH112  (a folder that may not be looked into is none here)
            raise GmrError(f"{path}: this is a folder; name a file in it")
        if format is None:
            chosen = format_of_file(str(path), written=True)
        else:
            chosen = named_format(format)
            chosen.check_written(str(path))
        _write_file(motion, path, chosen)
        return
    if not hasattr(target, "write"):
        raise TypeError(f"a motion is written to a path or an open file, not to {target!r:.60}")
    chosen = FORMATS[0] if format is None else named_format(format)
    if isinstance(target, io.TextIOBase) and not chosen.is_text:
        raise GmrError(f"{chosen.name} is no text; open the file for bytes, with mode 'wb'")
    for piece in chosen.write(motion):
        if isinstance(target, io.TextIOBase):
            target.write(bytes(piece).decode())
        else:
            write_all(cast(IO[bytes], target), piece)


def _write_file(motion: Motion, path: Path, chosen: Format) -> None:
    beside = chosen.place_beside(path)
    if beside is not None and os.path.isdir(beside):  # noqa: PTH112
        raise GmrError(f"{beside}: this is a folder; its place is needed for the other half of the motion")
    parts = {path: chosen.write(motion)}
    if beside is not None:
        parts[beside] = chosen.write_beside(motion)
    _replace(path, parts)


def write_pieces(path: Path, pieces: Iterable[bytes | memoryview]) -> None:
    """Writes a file, whole or not at all.

    Raises:
        GmrError: it cannot be written; what was there is untouched.
    """
    if os.path.isdir(path):  # noqa: PTH112
        raise GmrError(f"{path}: this is a folder; name a file in it")
    _replace(path, {path: pieces})


def _replace(path: Path, parts: Mapping[Path, Iterable[bytes | memoryview]]) -> None:
    """Puts files in their places together; ``path`` names them in errors."""
    try:
        with replacing(*parts) as files:
            for file, pieces in zip(files, parts.values(), strict=True):
                file.writelines(pieces)
    except OSError as error:
        raise GmrError(f"{path}: {_why_not(path, error)}") from error


def _why_not(path: Path, error: OSError) -> str:
    """Why a file could not be written; what the disk refuses to answer is answered with no."""
    folder = path.parent
    if isinstance(error, NotADirectoryError):
        return f"'{folder}' is no folder; name a file in one"
    if isinstance(error, FileNotFoundError) and not os.path.exists(folder):  # noqa: PTH110
        return f"there is no folder '{folder}' to write to; make it first"
    kept = "the file that was there is untouched" if os.path.exists(path) else "nothing is left of it"  # noqa: PTH110
    return f"cannot be written: {error.strerror}; {kept}"
