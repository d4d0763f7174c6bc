"""The bytes of a .gltf or .glb file: its JSON, and the binary chunk that a .glb may have.

Source: glTF 2.0 specification, 4 "GLB File Format Specification".
"""

from __future__ import annotations

import json
from typing import Any, Final, NamedTuple, NoReturn

from gmr.errors import FormatError
from gmr.formats.strict_json import no_constant, unique_object

__all__ = ["Chunks", "split_chunks"]

_MAGIC: Final = b"glTF"
_JSON: Final = b"JSON"
_BINARY: Final = b"BIN\0"


class Chunks(NamedTuple):
    """What a file is made of."""

    content: dict[str, Any]
    """The JSON."""
    binary: bytes | None
    """The binary chunk; None where there is none."""


def split_chunks(data: bytes, file: str | None) -> Chunks:
    """The JSON and the binary chunk of a file.

    Raises:
        FormatError: the file is cut off or none of glTF 2.0, or the JSON is none.
    """
    if not data.startswith(_MAGIC):
        return Chunks(_parsed(data, file), None)
    version, length = (int.from_bytes(data[at : at + 4], "little") for at in (4, 8))
    if len(data) < 20 or length > len(data):
        what = f"the header counts {length:,} bytes, but the file has {len(data):,}; copy it again, whole"
        raise FormatError(what, file=file)
    if version != 2:
        what = f"this is version {version} of the binary form; version 2 is read. Export it as glTF 2.0"
        raise FormatError(what, file=file)
    chunks = _chunks(data[:length], file)
    if not chunks or chunks[0][0] != _JSON:
        raise FormatError("the first chunk is no JSON; export the file again", file=file)
    # Chunks of other kinds are for extensions; programs skip those that they do not know.
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _BINARY else None
    return Chunks(_parsed(chunks[0][1], file), binary)


def _chunks(data: bytes, file: str | None) -> list[tuple[bytes, bytes]]:
    """Type and contents of each chunk; of more than two only these matter, and no more are looked at."""
    found: list[tuple[bytes, bytes]] = []
    at = 12
    while at < len(data) and len(found) < 2:
        length = int.from_bytes(data[at : at + 4], "little")
        if at + 8 + length > len(data):
            what = (
                f"chunk {len(found)} counts {length:,} bytes, but {max(len(data) - at - 8, 0):,} follow; "
                "copy the file again, whole"
            )
            raise FormatError(what, file=file)
        found.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += 8 + length
    return found


def _parsed(text: bytes, file: str | None) -> dict[str, Any]:
    """The JSON object in these bytes."""

    def wrong(what: str) -> NoReturn:
        raise FormatError(what, file=file)

    try:
        found = json.loads(
            text.decode("utf-8-sig"),
            object_pairs_hook=unique_object,
            parse_constant=no_constant,
            parse_int=_whole,
        )
    except UnicodeDecodeError as error:
        wrong(f"the JSON is no UTF-8 at its byte {error.start}; copy the file again, or export it again")
    except (ValueError, RecursionError) as error:
        said = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        wrong(f"the JSON cannot be read: {said:.200}; copy the file again, or export it again")
    if not isinstance(found, dict):
        wrong("the JSON is no object; a glTF file is one. Export it again")
    return found


def _whole(text: str) -> int | float:
    """A whole number; one of many digits is none that could count anything."""
    return int(text) if len(text) < 20 else float(text)
