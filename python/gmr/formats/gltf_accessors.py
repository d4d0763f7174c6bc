"""Accessors of a glTF file as arrays: all component types, interleaved, normalised, sparse.

Source: glTF 2.0 specification, 3.6.2 "Accessors".
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.formats.gltf_buffers import Buffers
from gmr.formats.gltf_document import Document
from gmr.formats.text import named

__all__ = ["Accessors"]

COMPONENTS: Final = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""Component types by their number."""

_SHAPES: Final = {
    "SCALAR": (), "VEC2": (2,), "VEC3": (3,), "VEC4": (4,), "MAT2": (2, 2), "MAT3": (3, 3), "MAT4": (4, 4),
}  # fmt: skip

_FREE: Final = 1 << 26
"""Bytes that arrays may take whatever the file's size."""
_PER_BYTE: Final = 32
"""Bytes of arrays for each byte of the file beyond that; more can only be one place read again and again."""


class Accessors:
    """The accessors of a file; each is read once, and shared by all who ask."""

    def __init__(self, document: Document, buffers: Buffers) -> None:
        self.document = document
        self.buffers = buffers
        self._read: dict[int, NDArray[Any]] = {}
        self._taken = 0

    def array(self, index: int | None, asker: str, types: tuple[str, ...]) -> NDArray[Any]:
        """The accessor ``index``, read-only: (count, ...) integers, or float32.

        Matrices are (count, rows, columns).

        Args:
            index: which.
            asker: what refers to it, for errors.
            types: what it may be: "SCALAR", "VEC3", "MAT4" and so on.

        Raises:
            FormatError: it is missing, of another type, or points outside its bytes.
        """
        found = self.document.at("accessors", index, asker)
        if found.type not in types:
            self.document.wrong(
                f"{asker} is accessors[{index}] of the type {named(str(found.type))}; it must be "
                f"{' or '.join(types)}"
            )
        assert index is not None
        if index not in self._read:
            array = self._read_one(found, f"accessors[{index}]")
            array.flags.writeable = False
            self._read[index] = array
        return self._read[index]

    def floats(self, index: int | None, asker: str, types: tuple[str, ...]) -> NDArray[np.float32]:
        """As :meth:`array`, in float32."""
        array = self.array(index, asker, types)
        if array.dtype == np.float32:
            return array
        self.take(4 * array.size, asker)
        return array.astype(np.float32)

    def take(self, size: int, asker: str) -> None:
        """Counts bytes that are about to be allocated.

        Raises:
            FormatError: the file asks for more than its own bytes can account for.
        """
        self._taken += size
        own = self.buffers.size()
        if self._taken > _FREE + _PER_BYTE * own:
            self.document.wrong(
                f"{asker}: the file of {own:,} bytes of data asks for {self._taken:,} bytes of arrays; "
                "it refers to the same bytes too often. Export it again"
            )

    def _read_one(self, found: Any, place: str) -> NDArray[Any]:
        dtype, shape, count = self._layout(found, place)
        width = int(np.prod(shape, dtype=np.int64)) * dtype.itemsize
        if found.bufferView is None:
            # Of an accessor without a view all is 0 but what is sparse.
            self.take(count * width, place)
            array = np.zeros((count, *shape), dtype)
        else:
            array = self._viewed(found, place, dtype, shape, count)
        if found.sparse is not None:
            self._replace(found.sparse, place, array)
        if len(shape) == 2:
            array = array.swapaxes(1, 2)
        if found.normalized and dtype.kind in "iu":
            self.take(4 * array.size, place)
            return _normalised(array)
        return array

    def _layout(self, found: Any, place: str) -> tuple[np.dtype[Any], tuple[int, ...], int]:
        """Component type, shape of an element, and their count."""
        if found.componentType not in COMPONENTS:
            self.document.wrong(
                f"{place} has the component type {found.componentType}; it must be one of "
                f"{', '.join(map(str, COMPONENTS))}"
            )
        if found.type not in _SHAPES:
            self.document.wrong(f"{place} has the type {named(str(found.type))}; use {', '.join(_SHAPES)}")
        if found.count is None or found.count < 1:
            self.document.wrong(f"{place} counts {found.count} elements; it must be 1 or more")
        return np.dtype(COMPONENTS[found.componentType]), _SHAPES[found.type], found.count

    def _viewed(
        self, found: Any, place: str, dtype: np.dtype[Any], shape: tuple[int, ...], count: int
    ) -> NDArray[Any]:
        """The elements that lie in a view, copied from it."""
        data, start, length = self.buffers.view(found.bufferView, place)
        strides, size = _packed(dtype, shape)
        offset = found.byteOffset or 0
        step = self.document.content.bufferViews[found.bufferView].byteStride or _aligned(size, shape)
        if offset < 0 or step < size or offset + step * (count - 1) + size > length:
            self.document.wrong(
                f"{place} wants {count:,} elements of {size} bytes, {step} apart, from byte {offset} on; "
                f"bufferViews[{found.bufferView}] has {length:,} bytes. Export the file again"
            )
        self.take(count * size, place)
        lying: NDArray[Any] = np.ndarray((count, *shape), dtype, data, start + offset, (step, *strides))
        return np.array(lying)

    def _replace(self, sparse: Any, place: str, array: NDArray[Any]) -> None:
        """Puts the values of a sparse accessor where its indices say."""
        place = f"{place}.sparse"
        count = sparse.count
        if count is None or not 1 <= count <= len(array) or sparse.indices is None or sparse.values is None:
            self.document.wrong(f"{place} replaces {count} of {len(array):,} elements; export the file again")
        indices = self._plain(sparse.indices, f"{place}.indices", sparse.indices.componentType, (), count)
        if indices.dtype.kind != "u" or indices.max() >= len(array):
            self.document.wrong(
                f"{place}.indices go up to {indices.max():,}; they must be unsigned, and there are "
                f"{len(array):,} elements"
            )
        kind = next(number for number, name in COMPONENTS.items() if np.dtype(name) == array.dtype)
        array[indices] = self._plain(sparse.values, f"{place}.values", kind, array.shape[1:], count)

    def _plain(
        self, found: Any, place: str, kind: int | None, shape: tuple[int, ...], count: int
    ) -> NDArray[Any]:
        """Elements that lie one after the other."""
        if kind not in COMPONENTS:
            self.document.wrong(f"{place} has the component type {kind}, which there is not")
        data, start, length = self.buffers.view(found.bufferView, place)
        dtype = np.dtype(COMPONENTS[kind])
        strides, size = _packed(dtype, shape)
        step = _aligned(size, shape)
        offset = found.byteOffset or 0
        if offset < 0 or offset + step * (count - 1) + size > length:
            self.document.wrong(
                f"{place} wants {count:,} elements of {size} bytes from byte {offset} on; "
                f"bufferViews[{found.bufferView}] has {length:,} bytes. Export the file again"
            )
        lying: NDArray[Any] = np.ndarray((count, *shape), dtype, data, start + offset, (step, *strides))
        return lying


def _packed(dtype: np.dtype[Any], shape: tuple[int, ...]) -> tuple[tuple[int, ...], int]:
    """Strides inside an element, and its size up to the last byte that it uses.

    The columns of a matrix begin at multiples of 4 bytes.
    """
    if len(shape) < 2:
        return (dtype.itemsize,) * len(shape), dtype.itemsize * int(np.prod(shape, dtype=np.int64))
    column = shape[1] * dtype.itemsize
    padded = column + -column % 4
    return (padded, dtype.itemsize), padded * (shape[0] - 1) + column


def _aligned(size: int, shape: tuple[int, ...]) -> int:
    """From an element to the next where the view does not say: they follow each other."""
    return size + -size % 4 if len(shape) == 2 else size


def _normalised(array: NDArray[Any]) -> NDArray[np.float32]:
    """Integers as parts of 1. Source: glTF 2.0 specification, 3.11, the table of conversions."""
    most = np.float32(np.iinfo(array.dtype).max)
    parts: NDArray[np.float32] = array.astype(np.float32) / most
    return np.maximum(parts, np.float32(-1))
