"""One file, one stream or some bytes become a motion."""

from __future__ import annotations

import difflib
import os
from collections.abc import Callable
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Literal

from gmr.errors import FormatError
from gmr.formats.mapping import mapped
from gmr.formats.registry import Format, format_of_file, format_of_text, named_format

if TYPE_CHECKING:
    from gmr.markers.recording import Markers
    from gmr.motion import Motion

__all__ = [
    "Positions",
    "Skeletons",
    "Source",
    "contents",
    "given_options",
    "read",
    "read_markers",
    "read_with",
]

Positions = Literal["replace", "add"]
Source = str | os.PathLike[str] | bytes | bytearray | memoryview | IO[str] | IO[bytes]
Skeletons = str | os.PathLike[str] | bytes
"""An ASF: its path, or its contents."""


def read(
    source: Source,
    format: str | None = None,
    *,
    positions: Positions = "replace",
    asf: Skeletons | None = None,
    fps: float | None = None,
    animation: str | int | None = None,
    strict: bool = False,
) -> Motion:
    """Read a motion.

    Args:
        source: a path; or the contents of a file as bytes; or an open file, text or binary.
        format: "bvh", "amc", "asf", "gmr", "gmrb", "c3d", "glb" or "gltf"; told by the suffix of a path, and
            by the first bytes of anything else, where left out. GMR's text and binary files are told apart by
            their bytes, whatever the suffix.
        positions: BVH: whether position channels "replace" a joint's OFFSET (as in Blender) or "add" to it.
        asf: AMC: its skeleton, a path or the bytes of a file; where left out, the one beside (07_01.asf or
            07.asf for 07_01.amc, or the only one in the folder).
        fps: AMC: frames a second, for most files do not say; 120 where they and you do not. glTF: the rate
            at which the animation is sampled; that of its keys where left out.
        animation: glTF: which one, by name or index; the first where left out.
        strict: refuse what is read with a warning otherwise, such as fewer rows than the file declares.

    Returns:
        The motion as the file has it, all joints kept; ``unit`` is None where the file names none. An ASF
        alone is a motion without frames. A C3D file holds no motion: it gives :class:`gmr.Markers`, for which
        programs that check types have :func:`read_markers`.

    Raises:
        FormatError: the file is missing, empty or not what it claims to be; says where and how to mend it.

    Warns:
        FormatWarning: something odd was read all the same.
    """
    options = given_options(positions, asf, fps, animation)
    return read_with(source, options, format=format, strict=strict, all_taken=True)


def read_markers(source: Source, format: str | None = None, *, strict: bool = False) -> Markers:
    """Read a recording of markers (C3D); as :func:`read`, but of that type for those who check types.

    Raises:
        FormatError: as :func:`read`; or the file holds a motion.
    """
    from gmr.markers.recording import Markers

    found: object = read(source, format, strict=strict)
    if not isinstance(found, Markers):
        what = "this file holds a motion, not markers; read it with gmr.read"
        raise FormatError(what, file=source if isinstance(source, str) else None)
    return found


def given_options(
    positions: Positions,
    asf: Skeletons | None,
    fps: float | None,
    animation: str | int | None = None,
) -> dict[str, Any]:
    """What differs from how each format is read by itself.

    Raises:
        ValueError: ``positions`` is neither "replace" nor "add".
    """
    if positions not in ("replace", "add"):
        raise ValueError(f"positions='{positions}' is not known; use 'replace' or 'add'")
    chosen = None if positions == "replace" else positions
    options = {"positions": chosen, "asf": asf, "fps": fps, "animation": animation}
    return {name: value for name, value in options.items() if value is not None}


def read_with(
    source: Source,
    options: dict[str, Any],
    *,
    format: str | None = None,
    strict: bool = False,
    all_taken: bool = False,
) -> Motion:
    """:func:`read` with options for several formats, each of which takes what it knows.

    Raises:
        FormatError: as :func:`read`; or ``all_taken`` is asked for and the format does not know an option.
    """
    chosen = None if format is None else named_format(format)
    name, data = contents(source, lambda path: (chosen or format_of_file(path)).is_mapped)
    if not data:
        raise FormatError("the file is empty, it holds no motion; export it again", file=name)
    if chosen is None:
        is_path = isinstance(source, str | os.PathLike)
        chosen = format_of_file(name or "") if is_path else format_of_text(bytes(data), name)
    return chosen.read(data, name=name, strict=strict, **_taken(chosen, options, name, all_taken))


def _taken(chosen: Format, options: dict[str, Any], name: str | None, all_taken: bool) -> dict[str, Any]:
    """Those of the options that the format knows."""
    unknown = [option for option in options if option not in chosen.options]
    if unknown and all_taken:
        what = f"{unknown[0]}= says nothing of {chosen.name} files; leave it out"
        raise FormatError(what, file=name)
    return {option: value for option, value in options.items() if option in chosen.options}


def contents(
    source: Source, is_mapped: Callable[[str], bool] = lambda path: False
) -> tuple[str | None, bytes | memoryview]:
    """What the source is called, and all its bytes, or its map in memory where ``is_mapped`` of its path.

    Raises:
        FormatError: the file is missing or cannot be read.
    """
    if isinstance(source, bytes | bytearray | memoryview):
        return None, bytes(source)
    if isinstance(source, str | os.PathLike):
        if isinstance(source, str) and "\n" in source:
            raise FormatError("this is the text of a file where its path is needed; encode it: text.encode()")
        path = Path(source)
        if not str(source):
            raise FormatError("an empty text names no file; give a path", file="''")
        return str(path), _file_contents(path, path.is_file() and is_mapped(str(path)))
    if not hasattr(source, "read"):
        raise TypeError(f"a motion is read from a path, bytes or an open file, not from {source!r:.60}")
    data = source.read()
    name = getattr(source, "name", None)
    return name if isinstance(name, str) else None, data.encode() if isinstance(data, str) else data


def _file_contents(path: Path, is_mapped: bool) -> bytes | memoryview:
    """All bytes of a file, or a sentence why there are none."""
    try:
        return mapped(path) if is_mapped else path.read_bytes()
    except FileNotFoundError:
        if path.is_symlink():
            what = (
                f"this is a link to '{path.readlink()}', which is not there; put it there, or remove the link"
            )
            raise FormatError(what, file=str(path)) from None
        raise FormatError(f"there is no such file{_nearest(path)}", file=str(path)) from None
    except IsADirectoryError:
        raise FormatError(
            "this is a folder; read all its files with gmr.read_folder", file=str(path)
        ) from None
    except OSError as error:
        raise FormatError(f"the file cannot be read: {error.strerror}", file=str(path)) from error


def _nearest(path: Path) -> str:
    """The files beside that are called nearly the same, as the end of a sentence."""
    try:
        beside = [entry.name for entry in os.scandir(path.parent)]
    except OSError:
        return f", and no folder '{path.parent}' either"
    near = difflib.get_close_matches(path.name, beside, n=3)
    return f"; did you mean {' or '.join(near)}?" if near else f" in '{path.parent}'"
