"""The formats that gmr knows: a format is a module of its own and one entry here."""

from __future__ import annotations

import codecs
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Final

from gmr.errors import FormatError

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["FORMATS", "Format", "format_of_file", "format_of_text", "named_format", "suffixes"]


@dataclass(frozen=True)
class Format:
    """A file format.

    Args:
        name: as people call it.
        suffixes: of its files, in lower case.
        begins: what its files begin with.
        module: the module that knows it, imported when first needed.
        reader: its function ``(data: bytes, *, name, positions, strict) -> Motion``.
        writer: its function ``(motion) -> bytes`` or pieces of them.
    """

    name: str
    suffixes: tuple[str, ...]
    begins: str
    module: str
    reader: str
    writer: str

    def read(self, data: bytes, **options: Any) -> Motion:
        """The motion in ``data``."""
        read: Callable[..., Motion] = getattr(import_module(self.module), self.reader)
        return read(data, **options)

    def write(self, motion: Motion) -> Iterable[bytes]:
        """The pieces, in order, of a file that holds ``motion``."""
        write: Callable[[Motion], bytes | Iterable[bytes]] = getattr(import_module(self.module), self.writer)
        made = write(motion)
        return [made] if isinstance(made, bytes) else made


FORMATS: Final = (Format("BVH", (".bvh",), "HIERARCHY", "gmr.formats.bvh", "read_bvh", "bvh_chunks"),)


def suffixes() -> tuple[str, ...]:
    """All suffixes of files that gmr reads."""
    return tuple(suffix for known in FORMATS for suffix in known.suffixes)


def named_format(name: str) -> Format:
    """The format called ``name``.

    Raises:
        FormatError: there is none.
    """
    wanted = name.lower().lstrip(".")
    for known in FORMATS:
        if wanted == known.name.lower() or f".{wanted}" in known.suffixes:
            return known
    names = ", ".join(known.name.lower() for known in FORMATS)
    raise FormatError(f"there is no format '{name}'; use one of: {names}")


def format_of_file(file: str) -> Format:
    """The format that the suffix of ``file`` tells.

    Raises:
        FormatError: no format has it.
    """
    suffix = PurePath(file).suffix.lower()
    for known in FORMATS:
        if suffix in known.suffixes:
            return known
    found = f"the suffix '{suffix}' is" if suffix else "a name without a suffix is"
    raise FormatError(
        f"{found} none that gmr knows ({', '.join(suffixes())}). Rename the file; or name its format in "
        f"Python (format='{FORMATS[0].name.lower()}'), or put - in its place on the command line.",
        file=file,
    )


def format_of_text(data: bytes, file: str | None) -> Format:
    """The format that the first bytes tell.

    Raises:
        FormatError: none begins like this.
    """
    start = data[:64]
    if start.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        start = start.decode("utf-16", "replace").encode()
    start = start.removeprefix(codecs.BOM_UTF8).lstrip()
    for known in FORMATS:
        if start.upper().startswith(known.begins.encode()):
            return known
    begins = ", ".join(f"'{known.begins}' ({known.name})" for known in FORMATS)
    raise FormatError(
        f"this begins like no format that gmr knows: {start[:20]!r}. A file begins with {begins}; "
        "check that it is a motion, or name its format.",
        file=file,
        line=1,
        column=1,
        expected=begins,
    )
