"""A motion to a GMR binary file: safetensors, to be mapped into memory. The format: docs/gmr-format.md."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.formats.gmr_content import check, kept
from gmr.formats.safetensors import container_pieces
from gmr.frames import Rows
from gmr.motion import Motion

__all__ = ["gmrb_pieces", "write_gmrb"]


def write_gmrb(motion: Motion) -> bytes:
    """The motion as a GMR binary file; see :func:`gmrb_pieces`."""
    return b"".join(gmrb_pieces(motion))


def gmrb_pieces(motion: Motion) -> Iterator[bytes | memoryview]:
    """The motion as a GMR binary file, piece by piece; a piece is good until the next one is asked for.

    What is kept and what is not: :mod:`gmr.formats.gmr_content`. All is checked before the first piece comes
    out.

    Raises:
        FormatError: a number is not finite, there is no joint, or the names are longer than a header may be.
    """
    motion = kept(motion)
    check(motion)
    return container_pieces(_metadata(motion), _arrays(motion))


def _metadata(motion: Motion) -> dict[str, str]:
    found = {"format": "gmr", "version": "1", "frame_time": _number(motion.frame_time)}
    if motion.unit is not None:
        found["unit"] = _number(motion.unit)
    found["names"] = json.dumps(motion.skeleton.names, separators=(",", ":"))
    if (layout := motion.layout) is not None:
        post = {"positions": "add" if layout.adds_offset else "replace", "channels": layout.names}
        found["post"] = json.dumps(post, separators=(",", ":"))
    return found


def _arrays(motion: Motion) -> dict[str, NDArray[Any]]:
    """The arrays, those of wider numbers first."""
    skeleton, source, home = motion.skeleton, motion.source, motion.skeleton.home
    arrays: dict[str, NDArray[Any]] = {"offsets": skeleton.offsets}
    if home is not None:
        arrays["home_offsets"] = home.offsets
    if isinstance(source, Rows):
        arrays["rows"] = source.values
    else:
        arrays |= {"rotations": motion.rotations, "translations": motion.translations}
    arrays |= {"parents": skeleton.parents, "slots": skeleton.slots}
    if home is not None:
        arrays |= {"home_parents": home.parents, "home_slots": home.slots}
    if not isinstance(source, Rows):
        arrays["translated"] = motion.translated
    arrays["ends"] = skeleton.ends
    return arrays


def _number(value: float) -> str:
    return _core.format_rows(np.array([[value]])).decode().strip()
