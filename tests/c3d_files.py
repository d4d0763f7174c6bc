"""C3D files for tests: written by ezc3d, and their numbers put into the bytes of other computers."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.markers import Markers

BLOCK = 512


def written(
    path: Path,
    positions: NDArray[np.float64],
    labels: Sequence[str],
    *,
    rate: float = 100.0,
    unit: str = "mm",
    extra: dict[str, dict[str, Any]] | None = None,
) -> Path:
    """A C3D file by ezc3d: (F, M, 3) positions, NaN where not seen."""
    import ezc3d

    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [rate]
    file["parameters"]["POINT"]["LABELS"]["value"] = tuple(labels)
    file["parameters"]["POINT"]["UNITS"]["value"] = (unit,)
    for group, values in (extra or {}).items():
        for name, value in values.items():
            file.add_parameter(group, name, value)
    points = np.ones((4, positions.shape[1], len(positions)))
    points[:3] = positions.transpose(2, 1, 0)
    file["data"]["points"] = points
    hidden = np.asarray(np.isnan(positions).any(axis=2)).T[None]
    file["data"]["meta_points"]["residuals"] = np.where(hidden, -1.0, 0.0)
    file.write(str(path))
    return path


def recorded(path: Path, markers: Markers) -> Path:
    """A recording in metres as a C3D file in millimetres."""
    return written(
        path, 1000 * markers.positions * (markers.unit or 1.0), markers.labels, rate=round(markers.fps, 6)
    )


def as_written_by(data: bytes, processor: str, *, integers: bool = False, step: float = 0.1) -> bytes:
    """A C3D file of ezc3d's (Intel, floats, no analog data) as another computer writes it.

    Args:
        data: the file.
        processor: "Intel", "DEC" or "MIPS".
        integers: whether coordinates are whole numbers of ``step`` file units.
    """
    at = (data[0] - 1) * BLOCK
    frames, points = _frames(data)
    scale = step if integers else -step
    header = bytearray(data[:at])
    parameters = bytearray(data[at : at + data[at + 2] * BLOCK])
    parameters[3] = {"Intel": 84, "DEC": 85, "MIPS": 86}[processor]
    _convert_header(header, processor, scale)
    _convert_parameters(parameters, processor, scale)
    start = (struct.unpack("<h", data[16:18])[0] - 1) * BLOCK
    values = np.frombuffer(data, "<f4", frames * points * 4, start).reshape(-1, 4)
    body = _words(values, step, processor) if integers else _floats(values, processor)
    gap = data[at + len(parameters) : start]
    return bytes(header) + bytes(parameters) + gap + body


def _frames(data: bytes) -> tuple[int, int]:
    points, first, last = (struct.unpack("<H", data[k : k + 2])[0] for k in (2, 6, 8))
    return last - first + 1, points


def _words(values: NDArray[np.float32], step: float, processor: str) -> bytes:
    rounded = np.concatenate([np.round(values[:, :3].astype(np.float64) / step), values[:, 3:]], axis=1)
    return rounded.astype(">i2" if processor == "MIPS" else "<i2").tobytes()


def _floats(values: NDArray[np.floating[Any]], processor: str) -> bytes:
    if processor == "MIPS":
        return values.astype(">f4").tobytes()
    if processor == "Intel":
        return values.astype("<f4").tobytes()
    # A DEC float is a quarter of the IEEE one with the same bits, its halves exchanged.
    halves = (values.astype(np.float32) * np.float32(4)).astype("<f4").view("<u2").reshape(-1, 2)
    return np.ascontiguousarray(halves[:, ::-1]).tobytes()


def _convert_header(header: bytearray, processor: str, scale: float) -> None:
    rate = struct.unpack("<f", header[20:24])[0]
    for at in (*range(2, 12, 2), 16, 18):
        header[at : at + 2] = _integer(header[at : at + 2], processor)
    header[12:16] = _floats(np.array([scale]), processor)
    header[20:24] = _floats(np.array([rate]), processor)


def _convert_parameters(section: bytearray, processor: str, scale: float) -> None:
    at = 4
    while section[at]:
        length = section[at] if section[at] < 128 else 256 - section[at]
        group = section[at + 1]
        name = bytes(section[at + 2 : at + 2 + length])
        link = at + 2 + length
        step = struct.unpack("<h", section[link : link + 2])[0]
        section[link : link + 2] = _integer(section[link : link + 2], processor)
        if group < 128:
            _convert_values(section, link + 2, processor, scale if name == b"SCALE" else None)
        if step == 0:
            return
        at = link + step


def _convert_values(section: bytearray, at: int, processor: str, scale: float | None) -> None:
    kind, count = section[at], section[at + 1]
    size = int(np.prod([1, *section[at + 2 : at + 2 + count]]))
    start = at + 2 + count
    for k in range(size):
        if kind == 2:
            place = slice(start + 2 * k, start + 2 * k + 2)
            section[place] = _integer(section[place], processor)
        elif kind == 4:
            place = slice(start + 4 * k, start + 4 * k + 4)
            value = np.frombuffer(bytes(section[place]), "<f4") if scale is None else np.array([scale])
            section[place] = _floats(value, processor)


def _integer(raw: bytes | bytearray, processor: str) -> bytes:
    return bytes(raw[::-1] if processor == "MIPS" else raw)
