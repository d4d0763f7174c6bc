"""What is done with tracks and scores; the result is as smooth as what it is made of."""

from __future__ import annotations

from gmr.actionlets.operations.joining import concatenate
from gmr.actionlets.operations.pasting import insert
from gmr.actionlets.operations.timing import is_periodic, repeated, stretched, synchronise

__all__ = ["concatenate", "insert", "is_periodic", "repeated", "stretched", "synchronise"]
