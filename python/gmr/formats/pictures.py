"""What kind of picture some bytes are, told by how they begin."""

from __future__ import annotations

from pathlib import PurePath
from typing import Final

__all__ = ["picture_type"]

_BEGINNINGS: Final = (
    (b"\x89PNG\r\n\x1a\n", "image/png"),
    (b"\xff\xd8\xff", "image/jpeg"),
    (b"GIF8", "image/gif"),
    (b"BM", "image/bmp"),
    (b"\xabKTX 20\xbb", "image/ktx2"),
    (b"DDS ", "image/vnd-ms.dds"),
)
_SUFFIXES: Final = {".tga": "image/x-tga", ".tif": "image/tiff", ".tiff": "image/tiff"}


def picture_type(data: bytes, said: str | None = None, file: str = "") -> str:
    """The mime type of a picture: by its bytes, else as somebody said, else by the suffix of its file."""
    if data[:4] == b"RIFF" and data[8:12] == b"WEBP":
        return "image/webp"
    for beginning, mime in _BEGINNINGS:
        if data.startswith(beginning):
            return mime
    return said or _SUFFIXES.get(PurePath(file).suffix.lower(), "application/octet-stream")
