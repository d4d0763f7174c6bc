"""The formats that gmr knows: a format is a module of its own and one entry here."""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, Final, Literal

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
        begins: what its files begin with, any of these: words of text in upper case, after comments that
            begin with ``#``, or bytes of a binary file.
        module: the module that knows it, imported when first needed.
        reader: its function ``(data: bytes, *, name, strict, **options) -> Motion``, or Markers; None where
            gmr only writes it.
        writer: its function ``(motion) -> bytes`` or pieces of them; None where gmr only reads it.
        options: what the reader can be told besides ``name`` and ``strict``.
        beside: suffix and writer of a second file without which its files say nothing.
        serving: its function ``(names) -> names``: of the files of a folder, those that are part of others.
        begins_at: the byte at which ``begins`` stands, for a binary file; None: it is text.
        is_mapped: the reader takes the map of a file in memory as well as its bytes.
        holds: what is in its files; folders are searched for motions only.
        in_metres: lengths are in metres whatever the unit of the motion is.
        roots: which roots it can keep: all; the "joined" ones, which were not split off; or the "first",
            those from before any was moved.
    """

    name: str
    suffixes: tuple[str, ...]
    begins: tuple[bytes, ...]
    module: str
    reader: str | None
    writer: str | None
    options: tuple[str, ...] = ()
    beside: tuple[str, str] | None = None
    serving: str | None = None
    begins_at: int | None = None
    is_mapped: bool = False
    holds: Literal["motion", "markers"] = "motion"
    in_metres: bool = False
    roots: Literal["all", "joined", "first"] = "joined"

    @property
    def is_text(self) -> bool:
        """Whether its files are text."""
        return self.begins_at is None

    def is_begun_by(self, data: bytes, text: bytes) -> bool:
        """Whether a file may be one of these, by its first bytes and by the same as text."""
        if self.begins_at is not None:
            return data.startswith(self.begins, self.begins_at)
        return text.upper().startswith(self.begins)

    def read(self, data: bytes | memoryview, **options: Any) -> Motion:
        """What is in ``data``: a motion, or markers as :attr:`holds` says.

        Raises:
            FormatError: gmr writes the format but does not read it.
        """
        if self.reader is None:
            what = f"gmr writes {self.name} but does not read it; read the motion that it was written from"
            raise FormatError(what, file=options.get("name"))
        read: Callable[..., Motion] = getattr(import_module(self.module), self.reader)
        return read(data, **options)

    def write(self, motion: Motion) -> Iterable[bytes | memoryview]:
        """The pieces, in order, of a file that holds ``motion``.

        Raises:
            FormatError: gmr reads the format but does not write it.
        """
        self.check_written(None)
        assert self.writer is not None
        return self._pieces(self.writer, motion)

    def check_written(self, file: str | None) -> None:
        """Refuses to write ``file`` where gmr only reads the format.

        Raises:
            FormatError: it does.
        """
        if self.writer is None:
            what = f"gmr reads {self.name} but does not write it; write one of: {_written_suffixes()}"
            raise FormatError(what, file=file)

    def write_beside(self, motion: Motion) -> Iterable[bytes | memoryview]:
        """The pieces, in order, of the second file."""
        assert self.beside is not None
        return self._pieces(self.beside[1], motion)

    def place_beside(self, path: Path) -> Path | None:
        """Where the second file of a file at ``path`` stands; None where there is none."""
        if self.beside is None:
            return None
        suffix = self.beside[0]
        return path.with_suffix(suffix.upper() if path.suffix.isupper() else suffix)

    def serving_files(self, names: Iterable[str]) -> set[str]:
        """Of the names of the files of one folder, those that are only part of others."""
        if self.serving is None:
            return set()
        serving: Callable[[Iterable[str]], set[str]] = getattr(import_module(self.module), self.serving)
        return serving(names)

    def _pieces(self, writer: str, motion: Motion) -> Iterable[bytes | memoryview]:
        make: Callable[[Motion], bytes | Iterable[bytes | memoryview]]
        make = getattr(import_module(self.module), writer)
        made = make(motion)
        return [made] if isinstance(made, bytes) else made


_LOOKED_AT = 4096
"""Bytes that tell a format at most."""

_COMMENTS = re.compile(rb"\A(?:\s+|#[^\r\n]*+)*+")

FORMATS: Final = (
    Format(
        "BVH", (".bvh",), (b"HIERARCHY",), "gmr.formats.bvh", "read_bvh", "bvh_chunks",
        options=("positions",),
    ),
    Format(
        "AMC", (".amc",), (b":FULLY-SPECIFIED", b":DEGREES", b":RADIANS", b":SAMPLES-PER-SECOND"),
        "gmr.formats.asf_amc", "read_amc", "amc_chunks",
        options=("asf", "fps"), beside=(".asf", "asf_chunks"),
    ),
    Format(
        "ASF", (".asf",), (b":VERSION", b":NAME", b":UNITS", b":DOCUMENTATION", b":ROOT", b":BONEDATA"),
        "gmr.formats.asf_amc", "read_asf", "asf_chunks",
        serving="serving_asf",
    ),
    Format(
        "GMR", (".gmr",), (b"GMR",), "gmr.formats.gmr", "read_gmr", "gmr_chunks", is_mapped=True, roots="all",
    ),
    Format(
        "GMRB", (".gmrb",), (b'{"__metadata__":',), "gmr.formats.gmr", "read_gmr", "gmrb_pieces",
        begins_at=8, is_mapped=True, roots="all",
    ),
    Format("C3D", (".c3d",), (b"\x02P",), "gmr.formats.c3d", "read_c3d", None, begins_at=0, holds="markers"),
    Format(
        "GLB", (".glb",), (b"glTF",), "gmr.formats.gltf", "read_gltf", "glb_of_motion",
        options=("animation", "fps"), begins_at=0, in_metres=True,
    ),
    Format("glTF", (".gltf",), (b"{",), "gmr.formats.gltf", "read_gltf", None, options=("animation", "fps")),
    Format(
        "X3D", (".x3d",), (b"<?XML", b"<X3D"), "gmr.formats.x3d", None, "x3d_chunks",
        in_metres=True, roots="first",
    ),
)  # fmt: skip


def suffixes(holds: Literal["motion", "markers"] | None = None) -> tuple[str, ...]:
    """Suffixes of files that gmr reads; of those that hold motions, or markers, or of all."""
    found = (known for known in FORMATS if known.reader is not None and holds in (None, known.holds))
    return tuple(suffix for known in found for suffix in known.suffixes)


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


def format_of_file(file: str, *, written: bool = False) -> Format:
    """The format that the suffix of ``file`` tells.

    Args:
        file: its name.
        written: it is to be written; otherwise read.

    Raises:
        FormatError: no format has it, or the file is to be written and gmr only reads its format.
    """
    suffix = PurePath(file).suffix.lower()
    for known in FORMATS:
        if suffix in known.suffixes:
            if written:
                known.check_written(file)
            return known
    found = f"the suffix '{suffix}' is" if suffix else "a name without a suffix is"
    example = f"format='{FORMATS[0].name.lower()}'"
    if written:
        what = (
            f"{found} none that gmr writes ({_written_suffixes()}). Give the file one of these; or name its "
        )
        what += f"format, in Python ({example}) or for gmr convert (--to {FORMATS[0].name.lower()})."
    else:
        what = (
            f"{found} none that gmr reads ({', '.join(suffixes())}). Rename the file; or name its format in "
        )
        what += f"Python ({example}), or put - in its place on the command line."
    raise FormatError(what, file=file)


def _written_suffixes() -> str:
    """Suffixes of files that gmr writes, with commas between them."""
    return ", ".join(suffix for known in FORMATS if known.writer for suffix in known.suffixes)


def format_of_text(data: bytes, file: str | None) -> Format:
    """The format that the first bytes tell.

    Raises:
        FormatError: none begins like this.
    """
    start = data[:_LOOKED_AT]
    if start.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        start = start.decode("utf-16", "replace").encode()
    start = _COMMENTS.sub(b"", start.removeprefix(codecs.BOM_UTF8))
    for known in FORMATS:
        if known.is_begun_by(data, start):
            return known
    begins = ", ".join(f"{known.begins[0].decode('latin-1')!r} ({known.name})" for known in FORMATS)
    raise FormatError(
        f"this begins like no format that gmr knows: {start[:20]!r}. A file begins with {begins}; "
        "check that it is a motion, or name its format.",
        file=file,
        line=1,
        column=1,
        expected=begins,
    )
