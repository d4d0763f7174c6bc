"""C3D files for tests: written by ezc3d, and their numbers put into the bytes of other computers."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from hypothesis import strategies as st
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


def with_everything(path: Path, positions: NDArray[np.float64] | None = None) -> Path:
    """Three markers over 7 frames at 100 Hz, two analog channels of ten values a frame, and rotations of two
    segments, once a frame."""
    import ezc3d

    places = np.full((7, 3, 3), 7.0) if positions is None else positions
    count = len(places)
    file = ezc3d.c3d(str(written(path, places, ("LASI", "RASI", "C7"))))
    file["parameters"]["ANALOG"]["RATE"]["value"] = [1000.0]
    file["parameters"]["ANALOG"]["LABELS"]["value"] = ("A1", "A2")
    file["data"]["analogs"] = np.arange(20.0 * count).reshape(1, 2, 10 * count)
    file.add_parameter("ROTATION", "RATE", [100.0])
    file["data"]["rotations"] = np.tile(np.eye(4)[..., None, None], (1, 1, 2, count))
    file.write(str(path))
    return path


@dataclass(frozen=True)
class Parameter:
    """Where a parameter of an Intel file lies: its type at ``at``, its first value at ``values``."""

    group: str
    name: str
    at: int
    values: int
    count: int

    def kind(self, data: bytes) -> int:
        """-1, 1, 2 or 4."""
        return data[self.at] - 256 if data[self.at] > 127 else data[self.at]


def parameters_of(data: bytes) -> list[Parameter]:
    """All parameters of a whole file, in its order."""
    at = (data[0] - 1) * BLOCK + 4
    groups: dict[int, str] = {}
    found: list[tuple[int, str, int, int, int]] = []
    while data[at]:
        length = data[at] if data[at] < 128 else 256 - data[at]
        name, link = data[at + 2 : at + 2 + length].decode(), at + 2 + length
        if data[at + 1] > 127:
            groups[256 - data[at + 1]] = name
        else:
            dimensions = data[link + 4 : link + 4 + data[link + 3]]
            values = link + 4 + len(dimensions)
            found.append((data[at + 1], name, link + 2, values, int(np.prod([1, *dimensions]))))
        step = int.from_bytes(data[link : link + 2], "little")
        if not step:
            break
        at = link + step
    return [Parameter(groups[group], name, at, values, count) for group, name, at, values, count in found]


def with_value(data: bytes, group: str, name: str, value: float, place: int = 0) -> bytes:
    """The file with another value of the type that the parameter has."""
    found = next(entry for entry in parameters_of(data) if (entry.group, entry.name) == (group, name))
    return _with_number(data, found, value, place)


def _with_number(data: bytes, found: Parameter, value: float, place: int) -> bytes:
    kind = found.kind(data)
    with np.errstate(over="ignore"):
        raw = np.float32(value).tobytes() if kind == 4 else struct.pack("<q", int(value) % 2**48)[:kind]
    at = found.values + place * len(raw)
    return data[:at] + raw + data[at + len(raw) :]


Change = Callable[[bytes], bytes]
"""One change of a file, of the same length after it as before."""

EXTREMES: Final = (0, 1, -1, 2, 127, -128, 255, 256, 32767, -32768, 65535, 1e9, -1e9, 3e38, 1e-38)
_COUNTS: Final = {
    *(("POINT", name) for name in ("USED", "FRAMES", "RATE", "SCALE", "DATA_START", "LABELS", "LONG_FRAMES")),
    *(("ANALOG", name) for name in ("USED", "RATE", "GEN_SCALE", "SCALE", "OFFSET", "LABELS")),
    *(("ROTATION", name) for name in ("USED", "RATE", "RATIO", "DATA_START")),
    *(("TRIAL", name) for name in ("ACTUAL_START_FIELD", "ACTUAL_END_FIELD")),
}
"""What readers count by, which every second change is of."""
_NOT_FINITE: Final = (np.nan, np.inf, -np.inf)


def changes_of_c3d() -> st.SearchStrategy[Change]:
    """Changes that keep the file a C3D file: extreme values, other types, dimensions, names and counts."""
    return st.builds(_change, st.integers(0, 2**16 - 1), st.integers(0, 5), st.integers(0, 2**16 - 1))


def _change(which: int, what: int, how: int) -> Change:
    return lambda data: changed(data, which, what, how)


def changed(data: bytes, which: int, what: int, how: int) -> bytes:
    """One change: ``which`` chooses the parameter, ``what`` the kind of change, ``how`` the new value.

    A parameter whose place an earlier change has made impossible stays as it is.
    """
    try:
        entries = parameters_of(data)
    except (IndexError, KeyError, UnicodeDecodeError):
        entries = []
    if what == 0 or not entries:  # a word of the header
        at = 2 + 2 * (which % 11)
        return data[:at] + struct.pack("<H", how) + data[at + 2 :]
    counts = [entry for entry in entries if (entry.group, entry.name) in _COUNTS]
    chosen = counts if which % 2 and counts else entries
    entry = chosen[which // 2 % len(chosen)]
    if what in (1, 2) and entry.count and entry.kind(data) in (1, 2, 4):
        values = EXTREMES if entry.kind(data) < 4 else EXTREMES + _NOT_FINITE
        return _with_number(data, entry, values[how % len(values)], how // 64 % entry.count)
    if what == 3:  # the type
        return data[: entry.at] + bytes([(255, 1, 2, 4, 0, how % 256)[how % 6]]) + data[entry.at + 1 :]
    if what == 4:  # a dimension, or how many there are
        at = entry.at + 1 + how % 8
        return data[:at] + bytes([(0, 1, 2, 7, 127, 255)[how // 8 % 6]]) + data[at + 1 :]
    at = entry.at - 2 - len(entry.name)  # the name: another parameter is asked for and not there
    return data[:at] + bytes([(data[at] + 1) % 128]) + data[at + 1 :]
