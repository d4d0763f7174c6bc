"""The safetensors container: named arrays behind a JSON header, mapped into memory without a copy.

The file is the header's length (8 bytes, little-endian), the header, and the data. The header is a JSON
object: for each array its ``dtype``, ``shape`` and ``data_offsets`` (first byte and one past the last, from
the end of the header on), and strings by name in ``__metadata__``. The arrays fill the data without gaps.
Source: the safetensors format, github.com/huggingface/safetensors, "Format".
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from gmr.errors import FormatError
from gmr.formats.strict_json import no_constant, unique_object
from gmr.formats.text import named
from gmr.listing import quoted

__all__ = ["Container", "Tensor", "container_pieces", "looks_like_container", "read_container"]

_MOST_HEADER: Final = 1 << 24
"""Bytes of a header at most; it is read whole."""

_SIZES: Final = {
    "BOOL": 1, "U8": 1, "I8": 1, "F8_E4M3": 1, "F8_E5M2": 1, "I16": 2, "U16": 2, "F16": 2, "BF16": 2,
    "I32": 4, "U32": 4, "F32": 4, "I64": 8, "U64": 8, "F64": 8,
}  # fmt: skip
"""Bytes of a number of each type that the container knows."""

_TYPES: Final = {"F64": "<f8", "F32": "<f4", "I32": "<i4", "U8": "u1"}
"""Those that arrays are made of here."""

_PIECE: Final = 1 << 23
"""Bytes that are written at a time."""


class Tensor(NamedTuple):
    """An array of the file, not yet looked at."""

    dtype: str
    shape: tuple[int, ...]
    begin: int
    """First byte, from the end of the header on."""
    end: int
    """One past the last."""


@dataclass(frozen=True)
class Container:
    """What a file holds.

    Args:
        data: the whole file.
        start: the byte after the header.
        metadata: strings by name.
        tensors: arrays by name.
    """

    data: bytes | memoryview
    start: int
    metadata: Mapping[str, str]
    tensors: Mapping[str, Tensor]

    def array(self, name: str) -> NDArray[Any]:
        """The array called ``name``, read-only, in the file's own memory wherever that is aligned."""
        tensor = self.tensors[name]
        dtype = np.dtype(_TYPES[tensor.dtype])
        count = math.prod(tensor.shape)
        if not count:
            return np.empty(tensor.shape, dtype)
        at = self.start + tensor.begin
        found: NDArray[Any] = np.frombuffer(self.data, dtype, count, at).reshape(tensor.shape)
        return found if found.flags.aligned else found.copy()


def looks_like_container(data: bytes | memoryview) -> bool:
    """Whether bytes begin as a container does and no text can."""
    start = bytes(data[:9])
    return start.endswith(b"{") and b"\0" in start[:8]


def read_container(data: bytes | memoryview, name: str | None) -> Container:
    """The header of a file; its arrays are not touched.

    Raises:
        FormatError: the header is none, or its arrays do not fill the file.
    """

    def wrong(what: str) -> NoReturn:
        raise FormatError(what, file=name)

    length = int.from_bytes(data[:8], "little")
    if len(data) < 8 or length > len(data) - 8:
        wrong(f"the header claims {length:,} bytes, but the file has {len(data):,}. Copy it again, whole.")
    if length > _MOST_HEADER:
        wrong(
            f"the header claims {length:,} bytes; more than {_MOST_HEADER:,} are not read. It may be damaged."
        )
    try:
        header = json.loads(
            bytes(data[8 : 8 + length]).decode(),
            object_pairs_hook=unique_object,
            parse_constant=no_constant,
        )
    except UnicodeDecodeError as error:
        wrong(f"the header is no UTF-8 at its byte {error.start}. The file is damaged: copy it again.")
    except (ValueError, RecursionError) as error:
        said = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        wrong(f"the header is no JSON: {said:.200}. The file is damaged: copy it again.")
    if not isinstance(header, dict):
        wrong("the header is no JSON object. The file is damaged: copy it again.")
    metadata = header.pop("__metadata__", {})
    if not isinstance(metadata, dict) or not all(isinstance(text, str) for text in metadata.values()):
        wrong("__metadata__ is no object of strings. Write each value as a string.")
    try:
        tensors = {key: _tensor(entry) for key, entry in header.items()}
    except ValueError as error:
        key = next(key for key, entry in header.items() if not _is_tensor(entry))
        wrong(f"the array {named(key)} {error}")
    if (fault := _fault(tensors, len(data) - 8 - length)) is not None:
        wrong(fault)
    return Container(data, 8 + length, metadata, tensors)


def container_pieces(
    metadata: Mapping[str, str], arrays: Mapping[str, NDArray[Any]]
) -> Iterator[bytes | memoryview]:
    """The file of these arrays, in their order, piece by piece.

    The header is padded with blanks, so that arrays are aligned if the wider types come first.

    Raises:
        FormatError: the header is longer than is read.
    """
    header: dict[str, Any] = {"__metadata__": dict(metadata)}
    at = 0
    names = {np.dtype(dtype): name for name, dtype in _TYPES.items()}
    for key, array in arrays.items():
        dtype = names[array.dtype.newbyteorder("<")]
        header[key] = {"dtype": dtype, "shape": list(array.shape), "data_offsets": [at, at + array.nbytes]}
        at += array.nbytes
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 8)
    if len(text) > _MOST_HEADER:
        raise FormatError(
            f"the header would have {len(text):,} bytes; more than {_MOST_HEADER:,} are not read. "
            "Write shorter names, or fewer joints."
        )
    return _pieces(text, list(arrays.values()))


def _pieces(header: bytes, arrays: list[NDArray[Any]]) -> Iterator[bytes | memoryview]:
    yield len(header).to_bytes(8, "little") + header
    for array in arrays:
        flat = array.reshape(-1)
        step = _PIECE // array.itemsize
        for start in range(0, len(flat), step):
            piece = np.ascontiguousarray(flat[start : start + step], array.dtype.newbyteorder("<"))
            yield piece.view(np.uint8).data


def _is_tensor(entry: Any) -> bool:
    try:
        _tensor(entry)
    except ValueError:
        return False
    return True


def _tensor(entry: Any) -> Tensor:
    """What the header says of an array; ValueError: what is wrong with it."""
    if not isinstance(entry, dict) or not {"dtype", "shape", "data_offsets"} <= entry.keys():
        raise ValueError("has not all of dtype, shape and data_offsets. Write them.")
    dtype, shape, offsets = entry["dtype"], entry["shape"], entry["data_offsets"]
    if not isinstance(dtype, str) or dtype not in _SIZES:
        raise ValueError(f"is of the unknown type {named(str(dtype))}. Use one of {', '.join(_SIZES)}.")
    if not _are_counts(shape) or not _are_counts(offsets) or len(offsets) != 2 or offsets[0] > offsets[1]:
        raise ValueError("has a shape or data_offsets that are no whole numbers from 0. Correct them.")
    begin, end = offsets
    if math.prod(shape) * _SIZES[dtype] != end - begin:
        shown = quoted([str(n)[:20] for n in shape], 6) or "nothing"
        raise ValueError(
            f"of {dtype} and the shape {shown} does not take {end - begin:,} bytes. Correct one."
        )
    return Tensor(dtype, tuple(shape), begin, end)


def _are_counts(found: Any) -> bool:
    """Whether this is a short list of whole numbers that a file may need."""
    return (
        isinstance(found, list)
        and len(found) <= 8
        and all(type(n) is int and 0 <= n < 1 << 63 for n in found)
    )


def _fault(tensors: Mapping[str, Tensor], size: int) -> str | None:
    """What is wrong with the places of the arrays in ``size`` bytes."""
    at, before = 0, ""
    for key, tensor in sorted(tensors.items(), key=lambda item: (item[1].begin, item[1].end)):
        if tensor.begin < at:
            return (
                f"the arrays {named(before)} and {named(key)} overlap. The file is damaged: write it again."
            )
        if tensor.begin > at:
            return f"{tensor.begin - at:,} bytes before the array {named(key)} belong to none. Leave no gaps."
        at, before = tensor.end, key
    if at > size:
        return f"the array {named(before)} ends {at - size:,} bytes after the file. Copy it again, whole."
    if at < size:
        return f"{size - at:,} bytes at the end belong to no array. The file is damaged: write it again."
    return None
