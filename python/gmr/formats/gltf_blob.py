"""The one buffer of a .glb that is being written, with its views and accessors."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["ELEMENTS", "VERTICES", "Blob"]

VERTICES: Final = 34962
"""Target of views that hold what vertices carry."""
ELEMENTS: Final = 34963
"""Target of views that hold the corners of triangles."""

_COMPONENTS: Final = {"u1": 5121, "u2": 5123, "u4": 5125, "f4": 5126}
_TYPES: Final = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}


class Blob:
    """Bytes in order, 4 by 4; arrays that are the same are kept once.

    Args:
        model: the module pygltflib.
    """

    def __init__(self, model: Any) -> None:
        self.model = model
        self.views: list[Any] = []
        self.accessors: list[Any] = []
        self._pieces: list[bytes] = []
        self._size = 0
        self._known: dict[tuple[Any, ...], int] = {}

    def data(self) -> bytes:
        """All bytes."""
        return b"".join(self._pieces)

    def view(self, data: bytes, target: int | None = None) -> int:
        """A view of these bytes, for one accessor or picture."""
        self.views.append(
            self.model.BufferView(buffer=0, byteOffset=self._size, byteLength=len(data), target=target)
        )
        padding = b"\0" * (-len(data) % 4)
        self._pieces += [data, padding]
        self._size += len(data) + len(padding)
        return len(self.views) - 1

    def array(self, array: NDArray[Any], target: int | None = None, *, bounds: bool = False) -> int:
        """The accessor of (count, ...) values, matrices as (count, rows, columns).

        Args:
            array: float32, or unsigned whole numbers; elements of a multiple of 4 bytes, or plain numbers.
            target: what its view is for.
            bounds: say the least and greatest component, as the standard asks for places and times.
        """
        kind, shape = array.dtype.newbyteorder("=").str[1:], array.shape[1:]
        lying = array.swapaxes(1, 2) if len(shape) == 2 else array
        data = np.ascontiguousarray(lying, f"<{kind}").tobytes()
        key = (data, kind, shape, target, bounds)
        if key not in self._known:
            accessor = self.model.Accessor(
                bufferView=self.view(data, target),
                byteOffset=None,
                componentType=_COMPONENTS[kind],
                count=len(array),
                type=_TYPES[shape],
                normalized=None,
                min=np.atleast_1d(array.min(axis=0)).tolist() if bounds else None,
                max=np.atleast_1d(array.max(axis=0)).tolist() if bounds else None,
            )
            self._known[key] = len(self.accessors)
            self.accessors.append(accessor)
        return self._known[key]
