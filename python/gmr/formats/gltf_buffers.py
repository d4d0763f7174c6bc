"""The bytes that a glTF file refers to: its own binary chunk, data: URIs, and files beside it."""

from __future__ import annotations

import base64
import binascii
from urllib.parse import unquote, unquote_to_bytes, urlsplit

from gmr.formats.beside import NotBesideError, read_beside
from gmr.formats.gltf_document import Document
from gmr.formats.text import named

__all__ = ["Buffers"]


class Buffers:
    """The buffers of a file, each read when it is first needed."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self._read: dict[int, bytes] = {}

    def size(self) -> int:
        """How many bytes were read so far."""
        return sum(len(data) for data in self._read.values())

    def view(self, index: int | None, asker: str) -> tuple[bytes, int, int]:
        """A buffer, and first byte and length of the view ``index`` in it.

        Raises:
            FormatError: there is no such view, or it points outside its buffer.
        """
        found = self.document.at("bufferViews", index, asker)
        place = f"bufferViews[{index}]"
        data = self.buffer(found.buffer, place)
        offset, length = found.byteOffset or 0, found.byteLength
        if length is None or length < 0 or offset < 0 or offset + length > len(data):
            self.document.wrong(
                f"{place} is {length} bytes from {offset} on, but buffers[{found.buffer}] has {len(data):,}; "
                "export the file again"
            )
        return data, offset, length

    def view_bytes(self, index: int | None, asker: str) -> bytes:
        """The bytes of the view ``index``."""
        data, offset, length = self.view(index, asker)
        return data[offset : offset + length]

    def buffer(self, index: int | None, asker: str) -> bytes:
        """All bytes of a buffer: as many as it says.

        Raises:
            FormatError: there is no such buffer, its bytes cannot be had, or there are fewer than it says.
        """
        buffer = self.document.at("buffers", index, asker)
        assert index is not None
        if index in self._read:
            return self._read[index]
        place = f"buffers[{index}]"
        if buffer.uri is not None:
            data = self.resource(buffer.uri, place)[0]
        elif index == 0 and self.document.binary is not None:
            data = self.document.binary
        else:
            self.document.wrong(f"{place} has neither a uri nor a binary chunk; export the file again")
        length = buffer.byteLength
        if length is None or length < 0 or length > len(data):
            self.document.wrong(
                f"{place} says that it has {length} bytes, but {len(data):,} are there; copy the file again, "
                "whole"
            )
        self._read[index] = data[:length]
        return self._read[index]

    def resource(self, uri: str, place: str) -> tuple[bytes, str | None]:
        """The bytes behind a URI, and their mime type where it tells.

        Only files in the folder of the file itself and below are opened.

        Raises:
            FormatError: they cannot be had.
        """
        if uri[:5].lower() == "data:":
            return self._embedded(uri, place)
        return self._beside(uri, place), None

    def _embedded(self, uri: str, place: str) -> tuple[bytes, str | None]:
        head, comma, body = uri[5:].partition(",")
        mime, *options = head.split(";")
        if not comma:
            self.document.wrong(f"{place} is a data: URI without a comma; export the file again")
        if "base64" not in (option.strip().lower() for option in options):
            return unquote_to_bytes(body), mime or None
        try:
            return base64.b64decode(body + "=" * (-len(body) % 4), validate=True), mime or None
        except (binascii.Error, ValueError) as error:
            self.document.wrong(f"{place} is no base64: {error}; copy the file again, whole")

    def _beside(self, uri: str, place: str) -> bytes:
        if urlsplit(uri).scheme:
            self.document.wrong(
                f"{place} is at {named(uri)}; only files beside are read. Write a relative path"
            )
        try:
            return read_beside(self.document.folder, unquote(uri))
        except NotBesideError as error:
            self.document.wrong(f"{place} is {error}")
