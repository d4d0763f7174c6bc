"""Arrays that nobody changes any more."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["frozen", "read_only"]

Scalar = TypeVar("Scalar", bound=np.generic)


def frozen(array: ArrayLike, dtype: type[Scalar]) -> NDArray[Scalar]:
    """``array`` as a C-contiguous, read-only array of ``dtype``.

    An array that is read-only already is shared; one that its maker could still write to is copied, so nobody
    can change what an immutable object holds. To hand over a large array without a copy, make it read-only
    first.
    """
    found = np.asarray(array, dtype, order="C")
    if found.flags.writeable and (found is array or np.may_share_memory(found, np.asarray(array))):
        found = found.copy()
    return read_only(found)


def read_only(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """The same memory, seen read-only; for arrays that only their new owner knows."""
    if array.flags.writeable:
        array = array.view()
        array.flags.writeable = False
    return array
