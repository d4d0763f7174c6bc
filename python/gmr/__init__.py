"""gmr: motion capture at memory speed."""

from __future__ import annotations

from gmr._core import __version__
from gmr.errors import (
    DatasetError,
    FormatError,
    FormatWarning,
    GmrError,
    MissingExtraError,
    SkeletonError,
)

__all__ = [
    "DatasetError",
    "FormatError",
    "FormatWarning",
    "GmrError",
    "MissingExtraError",
    "SkeletonError",
    "__version__",
]
