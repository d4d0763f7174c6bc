"""CSV files of path points, read with care."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.errors import FormatError

__all__ = ["FilePoints", "read_points"]

MOST_POINTS: Final = 100_000
MOST_BYTES: Final = 20_000_000
FARTHEST: Final = 1e5
"""Metres, and seconds: more is a mistake in the unit."""

HEADERS: Final = (("x", "z"), ("x", "z", "t"), ("x", "z", "speed"))
_FORMS: Final = "'x,z', 'x,z,t' (seconds) or 'x,z,speed' (m/s)"


class FilePoints(NamedTuple):
    """What a file says: (N, 2) points, (N,) seconds or speeds or neither, and the line of each point."""

    points: NDArray[np.float64]
    seconds: NDArray[np.float64] | None
    speeds: NDArray[np.float64] | None
    lines: tuple[int, ...]


def read_points(path: str | os.PathLike[str]) -> FilePoints:
    """Read the points of a path; see :meth:`PathPoints.read`.

    Raises:
        FormatError: names the line, the value and what was expected.
    """
    file = os.fspath(path)
    lines = list(_lines(file))
    header = tuple(cell.lower() for cell in lines[0][1]) if lines else ()
    if header in HEADERS:
        lines = lines[1:]
    elif lines and (len(header) != 2 or not any(map(_is_number, header))):
        raise FormatError(
            f"the first line is '{','.join(lines[0][1]):.60}'; begin with a header: {_FORMS}",
            file=file,
            line=lines[0][0],
            expected=_FORMS,
        )
    else:
        header = HEADERS[0]
    if not 2 <= len(lines) <= MOST_POINTS:
        points = "1 point" if len(lines) == 1 else f"{len(lines):,} points"
        raise FormatError(f"{points}; a path has 2 to {MOST_POINTS:,}", file=file)
    rows = [_row(cells, header, file, line) for line, cells in lines]
    table, third = np.array(rows), header[2] if len(header) > 2 else ""
    found = FilePoints(
        np.ascontiguousarray(table[:, :2]),
        table[:, 2] if third == "t" else None,
        table[:, 2] if third == "speed" else None,
        tuple(line for line, _ in lines),
    )
    _check_order(found, file)
    return found


def _lines(file: str) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of every line that says something."""
    try:
        if Path(file).stat().st_size > MOST_BYTES:
            raise FormatError(
                f"the file is longer than {MOST_BYTES:,} bytes; is it a list of points?", file=file
            )
        text = Path(file).read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise FormatError(f"the file cannot be read: {error.strerror}", file=file) from error
    except UnicodeDecodeError as error:
        raise FormatError(
            "the file holds no text in UTF-8; save the points as a CSV file in UTF-8", file=file
        ) from error
    for line, content in enumerate(text.splitlines(), start=1):
        if content.strip() and not content.lstrip().startswith("#"):
            yield line, [cell.strip() for cell in content.split(",")]


def _row(cells: list[str], header: tuple[str, ...], file: str, line: int) -> list[float]:
    if len(cells) != len(header):
        raise FormatError(
            f"{len(cells)} values where {len(header)} were expected ({','.join(header)})",
            file=file,
            line=line,
            expected=",".join(header),
        )
    return [_number(cell, name, file, line) for cell, name in zip(cells, header, strict=True)]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _number(cell: str, name: str, file: str, line: int) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    most = 100.0 if name == "speed" else FARTHEST
    if not (math.isfinite(value) and (-most if name in "xz" else 0.0) <= value <= most):
        least = f"{-most:g}" if name in "xz" else "0"
        raise FormatError(
            f"{name} is '{cell:.40}'; give a number from {least} to {most:g}", file=file, line=line
        )
    return value


def _check_order(found: FilePoints, file: str) -> None:
    if found.seconds is None:
        return
    for place in np.flatnonzero(np.diff(found.seconds) <= 0)[:1] + 1:
        raise FormatError(
            f"t is {found.seconds[place]:g} after {found.seconds[place - 1]:g}; time must rise from line to "
            "line",
            file=file,
            line=found.lines[place],
        )
