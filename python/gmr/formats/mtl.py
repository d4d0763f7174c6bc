"""MTL, the libraries of materials that an OBJ file names.

Source: Wavefront, "MTL material format", and the widely written extension for physically based materials
(Pr, Pm, norm).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Final

from gmr.errors import FormatError
from gmr.formats.beside import NotBesideError, read_beside
from gmr.formats.oddity import say
from gmr.formats.pictures import picture_type
from gmr.formats.text import named
from gmr.skinning.appearance import Material, Texture, TextureUse

__all__ = ["Library", "read_mtl"]

_OPTIONS: Final = {
    "-blendu": 1, "-blendv": 1, "-boost": 1, "-bm": 1, "-cc": 1, "-clamp": 1, "-imfchan": 1, "-mm": 2,
    "-texres": 1, "-type": 1, "-o": 3, "-s": 3, "-t": 3,
}  # fmt: skip
"""Options before the name of a picture, and how many values each has at most."""

_PICTURES: Final = {
    "map_kd": "base_color_texture",
    "map_ke": "emissive_texture",
    "norm": "normal_texture",
}


@dataclass
class Library:
    """Materials by their names, and the textures that they use."""

    materials: dict[str, Material]
    textures: list[Texture]


def read_mtl(path: str, folder: Path | None, library: Library, *, file: str | None, strict: bool) -> None:
    """Adds the materials of a library to those that are there; the first of a name stays.

    Args:
        path: of the library, as the OBJ file has it.
        folder: of the OBJ file.
        library: takes the materials.
        file: the name of the OBJ file.
        strict: raise where a warning would do.

    Raises:
        FormatError: a line cannot be read.

    Warns:
        FormatWarning: the library or a picture is not there.
    """
    try:
        data = read_beside(folder, path.replace("\\", "/"))
    except NotBesideError as error:
        say(f"the materials are {error}; all are drawn plain", file, strict)
        return
    place = str(Path(folder or "", path))
    within = None if folder is None else (folder / path.replace("\\", "/")).parent
    pictures = _Pictures(folder, within, library, place, strict)
    for name, statements in _materials(data):
        if name not in library.materials:
            library.materials[name] = _material(name, statements, pictures)


Statements = dict[str, tuple[int, str]]
"""Keyword in lower case -> line and the rest of it."""


def _materials(data: bytes) -> Iterator[tuple[str, Statements]]:
    name: str | None = None
    found: Statements = {}
    for number, line in enumerate(data.decode("utf-8", "replace").lstrip("\ufeff").splitlines(), 1):
        key, _, rest = line.strip().replace("\t", " ").partition(" ")
        if key.lower() == "newmtl":
            if name is not None:
                yield name, found
            name, found = rest.strip(), {}
        elif key and not key.startswith("#"):
            found[key.lower()] = (number, rest.strip())
    if name is not None:
        yield name, found


@dataclass
class _Pictures:
    """Reads pictures, each once."""

    folder: Path | None
    within: Path | None
    library: Library
    file: str
    strict: bool

    def use(self, line: int, rest: str) -> TextureUse | None:
        """The picture of a statement such as ``map_Kd -clamp on skin.png``."""
        words = rest.split()
        while words and words[0].lower() in _OPTIONS:
            values = _OPTIONS[words.pop(0).lower()]
            while values and len(words) > 1 and (values < 3 or _is_number(words[0])):
                words.pop(0)
                values -= 1
        clamped = "-clamp on" in rest.lower()
        path = " ".join(words).replace("\\", "/")
        try:
            data = self._found(path)
        except NotBesideError as error:
            say(f"line {line}: the picture is {error}; the texture is left out", self.file, self.strict)
            return None
        wrap = 33071 if clamped else 10497
        name = PurePosixPath(path).stem
        texture = Texture(data, picture_type(data, file=path), name, wrap_s=wrap, wrap_t=wrap)
        if texture not in self.library.textures:
            self.library.textures.append(texture)
        return TextureUse(self.library.textures.index(texture))

    def _found(self, path: str) -> bytes:
        """The picture where the library says it is, else beside it: many have the path of another machine."""
        try:
            return read_beside(self.within, path)
        except NotBesideError:
            base = PurePosixPath(path).name
            if not base or base == path:
                raise
            try:
                return read_beside(self.within, base)
            except NotBesideError:
                pass
            raise


def _material(name: str, statements: Statements, pictures: _Pictures) -> Material:
    def numbers(key: str, count: int) -> list[float] | None:
        if key not in statements:
            return None
        line, rest = statements[key]
        try:
            found = [float(word) for word in rest.split()[:count]]
        except ValueError:
            found = []
        if not found or not all(math.isfinite(value) for value in found):
            what = f"{key} {named(rest)} are no numbers; write {count}"
            raise FormatError(what, file=pictures.file, line=line)
        return (found * count)[:count]

    uses = {place: pictures.use(*statements[key]) for key, place in _PICTURES.items() if key in statements}
    alpha = (numbers("d", 1) or [1 - value for value in numbers("tr", 1) or [0.0]])[0]
    color = numbers("kd", 3) or [0.8, 0.8, 0.8]
    if uses.get("base_color_texture"):
        color = [1.0, 1.0, 1.0]  # the picture stands in the place of the colour, as programs draw it
    shine = numbers("ns", 1)
    rough = numbers("pr", 1) or [1 - math.sqrt(_part(shine[0] / 1000)) if shine else 1.0]
    emissive = numbers("ke", 3) or [0.0] * 3
    if uses.get("emissive_texture"):
        emissive = [1.0] * 3
    plain: Any = {
        "base_color": (*map(_part, color), _part(alpha)),
        "emissive": tuple(map(_part, emissive)),
        **uses,
    }
    return Material(
        name=name,
        metallic=_part((numbers("pm", 1) or [0.0])[0]),
        roughness=_part(rough[0]),
        alpha_mode="BLEND" if alpha < 1 else "OPAQUE",
        **plain,
    )


def _part(value: float) -> float:
    return min(max(value, 0.0), 1.0)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
