"""What all jobs of a run share, on the side of a cluster's worker: unpacked once."""

from __future__ import annotations

import pickle
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

__all__ = ["WithShared", "joined"]

Result = TypeVar("Result")

_held: dict[str, Any] = {}
_holding = threading.Lock()


@dataclass(frozen=True)
class WithShared(Generic[Result]):
    """Work that is given what all jobs share, and the job.

    Attributes:
        work: the work.
        run: the name under which a worker holds what they share.
    """

    work: Callable[..., Result]
    run: str

    def __call__(self, job: Any, packed: bytes) -> Result:
        """The result of one job; ``packed`` is what is shared, as the worker may not hold it yet."""
        return self.work(_hold(self.run, packed), job)


def _hold(run: str, packed: bytes) -> Any:
    """What the jobs of a run share, unpacked once; of what an earlier run shared nothing is kept."""
    with _holding:
        if run not in _held:
            found = pickle.loads(packed)
            _held.clear()
            _held[run] = found
        return _held[run]


def joined(*pieces: bytes) -> bytes:
    """Pieces put together."""
    return b"".join(pieces)
