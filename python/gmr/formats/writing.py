"""A motion becomes a file, whole or not at all."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

from gmr.errors import GmrError
from gmr.formats.registry import FORMATS, Format, format_of_file, named_format
from gmr.replacing import replacing

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["Target", "write"]

Target = str | os.PathLike[str] | IO[str] | IO[bytes]


def write(motion: Motion, target: Target, format: str | None = None) -> None:
    """Write a motion.

    A file is written beside its place and renamed when it is whole: a full disk or an interrupt leaves what
    was there.

    Args:
        motion: what was read as rows is written with the very same values, names and channels.
        target: a path, or a file open for writing, text or binary.
        format: "bvh"; told by the suffix where left out, BVH for an open file.

    Raises:
        GmrError: the file cannot be written; what was there is untouched.
        FormatError: no format has that suffix.
        SkeletonError: the format cannot hold this motion.
    """
    if isinstance(target, str | os.PathLike):
        path = Path(target)
        chosen = format_of_file(str(path)) if format is None else named_format(format)
        _write_file(motion, path, chosen)
        return
    chosen = FORMATS[0] if format is None else named_format(format)
    for piece in chosen.write(motion):
        if isinstance(target, io.TextIOBase):
            target.write(piece.decode())
        else:
            cast(IO[bytes], target).write(piece)


def _write_file(motion: Motion, path: Path, chosen: Format) -> None:
    if not path.parent.is_dir():
        raise GmrError(f"{path}: there is no folder '{path.parent}' to write to; make it first")
    if path.is_dir():
        raise GmrError(f"{path}: this is a folder; name a file in it")
    pieces = chosen.write(motion)
    try:
        with replacing(path) as (file,):
            for piece in pieces:
                file.write(piece)
    except OSError as error:
        kept = "the file that was there is untouched" if path.exists() else "nothing is left of it"
        raise GmrError(f"{path}: cannot be written: {error.strerror}; {kept}") from error
