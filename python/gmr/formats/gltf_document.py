"""What the JSON of a glTF file says, checked for its types and held in pygltflib's classes.

pygltflib (https://gitlab.com/dodgyville/pygltflib) names what there is in a glTF 2.0 file and of which type;
its own reading believes both the bytes and the types, so that the objects are made here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, is_dataclass
from functools import cache
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Final, NoReturn, Union, get_args, get_origin, get_type_hints

from gmr.errors import FormatError, MissingExtraError
from gmr.formats.gltf_container import split_chunks
from gmr.formats.oddity import say
from gmr.formats.text import named
from gmr.listing import quoted

__all__ = ["KEPT_EXTENSIONS", "Document", "open_document", "pygltflib"]

KEPT_EXTENSIONS: Final = ("KHR_materials_unlit", "KHR_materials_emissive_strength", "KHR_texture_transform")
"""Extensions of materials that hold numbers alone and are kept as they are."""

_UNDERSTOOD: Final = (*KEPT_EXTENSIONS, "KHR_mesh_quantization")
_APPEARANCE: Final = ("KHR_materials_", "KHR_lights_", "KHR_texture_", "EXT_texture_", "MSFT_texture_")
"""How extensions begin without which the shape and the motion are whole."""

_SHOWN: Final = 6


@dataclass(frozen=True)
class Document:
    """A glTF file, looked at but not yet understood.

    Args:
        content: the ``pygltflib.GLTF2`` object; all values have the types that it says.
        binary: the binary chunk; None where there is none.
        file: the file's name, for errors.
        strict: raise where a warning would do.
    """

    content: Any
    binary: bytes | None = field(repr=False)
    file: str | None
    strict: bool

    @property
    def folder(self) -> Path | None:
        """Where other files that it names are; None where it is from no folder."""
        return None if self.file is None else Path(self.file).parent

    def wrong(self, what: str) -> NoReturn:
        """Refuses the file."""
        raise FormatError(what, file=self.file)

    def odd(self, what: str) -> None:
        """Warns of something that is read all the same, or refuses it where strict."""
        say(what, self.file, self.strict)

    def at(self, kind: str, index: int | None, asker: str) -> Any:
        """The entry ``index`` of a list of the file, such as "accessors".

        Raises:
            FormatError: there is none; says who asked for it.
        """
        entries = getattr(self.content, kind)
        if index is None or not 0 <= index < len(entries):
            asked = "none" if index is None else f"{kind}[{index}]"
            self.wrong(f"{asker} refers to {asked}, but the file has {len(entries)} {kind}; export it again")
        return entries[index]


def open_document(data: bytes, file: str | None, strict: bool) -> Document:
    """The file of these bytes.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``).
        FormatError: the file is cut off, no glTF 2.0, a value has another type than the standard says, or it
            needs an extension without which its shape cannot be read.
    """
    model = pygltflib()
    chunks = split_chunks(data, file)
    version = chunks.content.get("asset", {})
    version = version.get("version") if isinstance(version, dict) else None
    if not isinstance(version, str) or version.split(".")[0] != "2":
        what = "asset.version is missing" if version is None else f"this is glTF {named(str(version))}"
        raise FormatError(f"{what}; version 2.0 is read. Export it as glTF 2.0", file=file)
    try:
        content = _made(chunks.content, model.GLTF2, "")
    except _WrongTypeError as error:
        raise FormatError(f"{error}; export the file again", file=file) from None
    document = Document(content, chunks.binary, file, strict)
    _check_extensions(document)
    return document


def pygltflib() -> Any:
    """The module pygltflib.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        import pygltflib as model
    except ImportError as error:
        raise MissingExtraError("pygltflib", "gltf", "Reading and writing glTF") from error
    return model


def _check_extensions(document: Document) -> None:
    """Refuses what cannot be read without an extension that is not known here, and names what is left out."""
    needed = [name for name in document.content.extensionsRequired if name not in _UNDERSTOOD]
    if vital := [name for name in needed if not name.startswith(_APPEARANCE)]:
        document.wrong(
            f"the file cannot be read without {quoted(vital, _SHOWN)}, which gmr does not know; "
            "export it without compression and extensions"
        )
    used = {*document.content.extensionsUsed, *needed}
    if left := sorted(name for name in used if name not in _UNDERSTOOD):
        document.odd(f"extensions that gmr does not know are left out: {quoted(left, _SHOWN)}")


class _WrongTypeError(Exception):
    """A value is of another type than the standard says; tells where and what."""

    def __init__(self, place: str, found: Any, expected: str) -> None:
        super().__init__(f"{place} is {named(repr(found)[:60])}, where {expected} is expected")


_hints = cache(get_type_hints)


def _made(found: Any, hint: Any, place: str) -> Any:
    """The value of a JSON file as the type that pygltflib says it has."""
    origin = get_origin(hint)
    if origin in (Union, UnionType):
        (hint,) = (one for one in get_args(hint) if one is not NoneType)
        return _made(found, hint, place)
    if is_dataclass(hint):
        return _object(found, hint, place)
    if origin is list:
        (inner,) = get_args(hint)
        if not isinstance(found, list):
            raise _WrongTypeError(place, found, "a list")
        return [_made(one, inner, f"{place}[{k}]") for k, one in enumerate(found)]
    if hint in (int, float, bool, str):
        return _plain(found, hint, place)
    if not isinstance(found, dict):
        raise _WrongTypeError(place, found, "an object")
    if origin is dict:
        known = {name: value for name, value in found.items() if name in _UNDERSTOOD}
        return {name: value for name, value in known.items() if isinstance(value, dict)}
    # What is left are the attributes of a primitive: whatever name -> accessor.
    return {name: _plain(value, int, f"{place}.{name}") for name, value in found.items()}


def _object(found: Any, hint: Any, place: str) -> Any:
    """An object of one of pygltflib's classes; what the class does not know, and null, is left out."""
    if not isinstance(found, dict):
        raise _WrongTypeError(place or "the JSON", found, "an object")
    hints = _hints(hint)
    return hint(
        **{
            key: _made(value, hints[key], f"{place}.{key}" if place else key)
            for key, value in found.items()
            if key in hints and key != "extras" and value is not None
        }
    )


def _plain(found: Any, hint: type, place: str) -> Any:
    """A number, a truth or a text."""
    if hint is int and type(found) is float and found.is_integer() and abs(found) < 2**53:
        return int(found)
    if hint is float and type(found) in (int, float):
        if not math.isfinite(found):
            raise _WrongTypeError(place, found, "a finite number")
        return float(found)
    if type(found) is not hint:
        words = {int: "a whole number", float: "a number", bool: "true or false", str: "a text"}
        raise _WrongTypeError(place, found, words[hint])
    return found
