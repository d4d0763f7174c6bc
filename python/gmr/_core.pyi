"""The extension module: kernels over plain arrays."""

import numpy as np
from numpy.typing import NDArray

__version__: str

# --- isa ---

def instruction_set() -> str: ...
def instruction_sets() -> list[str]: ...

# --- index ---

class Index:
    """Exact nearest neighbours of float32 rows in squared distance; ties go to the lowest frame.

    Args:
        features: (N, D), C-contiguous; finite in every candidate row.
        candidates: (N,) rows that can be found; all where left out.
        tags: (N,) bits of each row; none where left out.

    Raises:
        ValueError: when shapes do not fit or a candidate's feature is not finite.
    """

    def __init__(
        self,
        features: NDArray[np.float32],
        candidates: NDArray[np.bool_] | None = None,
        tags: NDArray[np.uint32] | None = None,
    ) -> None: ...
    @property
    def dims(self) -> int: ...
    @property
    def frame_count(self) -> int: ...
    @property
    def candidate_count(self) -> int: ...
    def search(
        self,
        queries: NDArray[np.float32],
        k: int = 1,
        tags: NDArray[np.uint32] | None = None,
        exclude: NDArray[np.uint32] | None = None,
        max_cost: float = ...,
        threads: int = 0,
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """The ``k`` best frames of each query, best first.

        Args:
            queries: (Q, D), C-contiguous and finite.
            k: hits a query.
            tags: (1,) or (Q,) bits that a frame must all carry.
            exclude: (Q, 2) first and one past the last frame that is no candidate.
            max_cost: only frames that cost strictly less are hits.
            threads: 0 means all cores; the answer is the same for every number.

        Returns:
            Costs (Q, k), float32, inf where there is no hit; frames (Q, k), -1 where there is no hit.

        Raises:
            ValueError: when shapes do not fit or a query is not finite.
        """

# --- numbers ---

def parse_rows(
    data: bytes, start: int, columns: int, limit: int
) -> tuple[NDArray[np.float64], int, tuple[str, int, int, int, int, int] | None]:
    """Rows of numbers from text, one row a line, each value the nearest float64.

    Args:
        data: the whole text.
        start: byte at which the rows begin.
        columns: numbers in a row.
        limit: the most rows to read; memory is bounded by the text whatever this says.

    Returns:
        The rows, (F, columns); the byte after the last whole row; what ended the reading early, if anything:
        "not a number", "overflow", "row too short", "row too long" or "cut" (the text ends inside the row),
        its row and value from 0, its line from 1, the bytes from and to which the token reaches.
    """

def count_rows(data: bytes, start: int) -> int:
    """Number of lines from byte ``start`` on that hold more than blanks and NUL bytes."""

def format_rows(rows: NDArray[np.float64]) -> tuple[bytes | None, tuple[int, int] | None]:
    """Text of (F, C) C-contiguous rows, one line each: the shortest decimals that read back bit-identical.

    Returns:
        The text and None; or None and the row and column of the first value that is not finite.
    """
