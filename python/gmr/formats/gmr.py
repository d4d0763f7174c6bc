"""GMR's own format: a motion whole, in any configuration, as text (``.gmr``) or binary (``.gmrb``)."""

from __future__ import annotations

from gmr.formats.gmr_binary_reader import read_gmr_binary
from gmr.formats.gmr_binary_writer import gmrb_pieces, write_gmrb
from gmr.formats.gmr_text_reader import read_gmr_text
from gmr.formats.gmr_text_writer import gmr_chunks, write_gmr
from gmr.formats.safetensors import looks_like_container
from gmr.motion import Motion

__all__ = ["gmr_chunks", "gmrb_pieces", "read_gmr", "write_gmr", "write_gmrb"]


def read_gmr(data: bytes | memoryview, *, name: str | None = None, strict: bool = False) -> Motion:
    """Motion of a GMR file, text or binary, which its bytes tell; see the two readers.

    Raises:
        FormatError: the file cannot be read; the message says where, why, and what to do.
    """
    if looks_like_container(data):
        return read_gmr_binary(data, name=name, strict=strict)
    return read_gmr_text(bytes(data), name=name, strict=strict)
