"""Linear equations whose unknowns hang together like a chain: block tridiagonal and symmetric."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["solved"]

Floats = NDArray[np.float64]


def solved(diagonal: Floats, above: Floats, right: Floats) -> Floats:
    """The solution of a symmetric positive definite block tridiagonal system.

    Every other link is written in terms of its two neighbours, which leaves a chain of half the length.
    Source: block cyclic reduction; Golub and Van Loan, "Matrix Computations", section 4.5.4.

    Args:
        diagonal: (N, B, B) blocks.
        above: (N - 1, B, B) blocks that couple each link to the next.
        right: (N, B).

    Returns:
        (N, B)
    """
    count, size = right.shape
    if count == 1:
        only: Floats = np.linalg.solve(diagonal, right[..., None])[..., 0].astype(np.float64)
        return only
    odd = np.arange(1, count, 2)
    next_above = np.zeros((len(odd), size, size))
    inner = odd[odd < count - 1]
    next_above[: len(inner)] = above[inner]
    terms = np.concatenate([np.swapaxes(above[odd - 1], 1, 2), next_above, right[odd][..., None]], axis=2)
    terms = np.linalg.solve(diagonal[odd], terms)
    on_left, on_right, alone = terms[..., :size], terms[..., size : 2 * size], terms[..., -1]

    kept_diagonal, kept_right = diagonal[::2].copy(), right[::2].copy()
    ahead = above[odd - 1]  # from the even link before each odd one
    kept_diagonal[: len(odd)] -= ahead @ on_left
    kept_right[: len(odd)] -= (ahead @ alone[..., None])[..., 0]
    kept_above = -(ahead @ on_right)[: len(inner)]
    back = np.swapaxes(above[inner], 1, 2)  # from the even link after it
    kept_diagonal[1 : len(inner) + 1] -= back @ on_right[: len(inner)]
    kept_right[1 : len(inner) + 1] -= (back @ alone[: len(inner), :, None])[..., 0]

    found = np.empty_like(right)
    found[::2] = even = solved(kept_diagonal, kept_above, kept_right)
    found[odd] = alone - (on_left @ even[: len(odd), :, None])[..., 0]
    found[inner] -= (on_right[: len(inner)] @ even[1 : len(inner) + 1, :, None])[..., 0]
    return found
