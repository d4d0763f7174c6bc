"""OBJ, the text format of meshes by Wavefront: points, polygons, groups and materials; no joints.

Source: Wavefront, "Advanced Visualizer" manual, appendix B1 "Object Files (.obj)".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from gmr.errors import FormatError
from gmr.formats.mtl import Library, read_mtl
from gmr.formats.oddity import say
from gmr.formats.polygons import triangulated
from gmr.formats.text import named
from gmr.listing import quoted
from gmr.skinning.appearance import Material, Texture
from gmr.skinning.part import Part

__all__ = ["ObjFile", "read_obj"]

_SHOWN: Final = 6
_QUIET: Final = frozenset({"s", "mg", "lod", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj"})
"""Statements that say nothing about the shape."""


class ObjFile(NamedTuple):
    """What an OBJ file and its libraries of materials hold."""

    parts: tuple[Part, ...]
    """One for each group and material, without weights; texture coordinates with v downward. Faces with and
    without texture coordinates or normals are kept apart."""
    materials: tuple[Material, ...]
    textures: tuple[Texture, ...]


def read_obj(data: bytes, *, name: str | None = None, strict: bool = False) -> ObjFile:
    """The meshes of an OBJ file.

    Polygons are cut into triangles, concave ones too. Vertices that differ in texture coordinates or normals
    are kept apart.

    Args:
        data: the file's bytes.
        name: the file's path, to find the libraries of materials beside it.
        strict: raise where a warning would do.

    Raises:
        FormatError: a line cannot be read, or a corner names what is not there; says which line.

    Warns:
        FormatWarning: libraries or pictures that are missing, and lines, points and surfaces, which are left
            out.
    """
    text = _Lines(data, name)
    for number, words in text:
        text.take(number, words)
    found = _Meshes(text, name)
    library = _library(text, name, strict)
    names = list(dict.fromkeys(group.material for group in text.groups if group.material))
    missing = [material for material in names if material not in library.materials]
    if missing and text.libraries:
        say(f"materials that no library has are drawn plain: {quoted(missing, _SHOWN)}", name, strict)
    materials = [library.materials.get(material, Material(material)) for material in names]
    places = {material: k for k, material in enumerate(names)}
    parts = [found.part(group, places.get(group.material)) for group in text.groups if group.corners]
    if text.left_out:
        say(f"statements that gmr does not know are left out: {quoted(text.left_out, _SHOWN)}", name, strict)
    if not parts:
        raise FormatError("there is no face in the file, so nothing to draw; export it again", file=name)
    flat = sum(int(_degenerate(part).sum()) for part in parts)
    if flat:
        say(f"{flat:,} triangles have two corners that are one vertex; they are kept", name, strict)
    return ObjFile(tuple(parts), tuple(materials), tuple(library.textures))


@dataclass
class _Group:
    """The faces of one group and material that have, or have not, coordinates and normals."""

    name: str
    material: str
    has: tuple[bool, ...]
    """Whether all corners have texture coordinates, and normals."""
    corners: list[tuple[int, int, int]] = field(default_factory=list)
    """Place, texture coordinates and normal of each corner, counted from 0; -1: none."""
    sizes: list[int] = field(default_factory=list)
    """Corners of each polygon."""
    lines: list[int] = field(default_factory=list)
    """The line of each polygon."""


class _Lines:
    """The statements of a file, taken one by one."""

    def __init__(self, data: bytes, name: str | None) -> None:
        self.name = name
        self.text = _decoded(data)
        self.places: list[list[float]] = []
        self.coordinates: list[list[float]] = []
        self.normals: list[list[float]] = []
        self.groups: list[_Group] = []
        self.libraries: list[str] = []
        self.left_out: dict[str, int] = {}
        self._known: dict[Any, _Group] = {}
        self._group, self._material = "", ""

    def __iter__(self) -> _Statements:
        return _Statements(self.text)

    def wrong(self, number: int, what: str) -> NoReturn:
        raise FormatError(what, file=self.name, line=number)

    def take(self, number: int, words: list[str]) -> None:
        """One statement."""
        key, *values = words
        if key == "v":
            self.places.append(self._numbers(number, values, 3, 7))
        elif key == "f":
            self._face(number, values)
        elif key == "vt":
            self.coordinates.append([*self._numbers(number, values, 1, 2), 0.0][:2])
        elif key == "vn":
            self.normals.append(self._numbers(number, values, 3, 3))
        elif key in ("g", "o"):
            self._group = " ".join(values)
        elif key == "usemtl":
            self._material = " ".join(values)
        elif key == "mtllib":
            several = all(value.lower().endswith(".mtl") for value in values)
            self.libraries += values if several else [" ".join(values)]
        elif key not in _QUIET:
            self.left_out[key] = number

    def _numbers(self, number: int, values: list[str], least: int, most: int) -> list[float]:
        if len(values) < least:
            self.wrong(number, f"{len(values)} numbers where {least} are needed; write them")
        try:
            found = [float(value) for value in values[:most]]
        except ValueError:
            self.wrong(number, f"{named(' '.join(values))} are not all numbers; write them with a point")
        if not all(abs(value) <= 3e38 for value in found):
            self.wrong(number, f"{named(' '.join(values))}: numbers must be finite; mend the mesh")
        return found

    def _face(self, number: int, values: list[str]) -> None:
        if len(values) < 3:
            self.wrong(number, f"a face has {len(values)} corners; it needs 3 or more")
        corners = [self._corner(number, value) for value in values]
        has = tuple(all(corner[k] >= 0 for corner in corners) for k in (1, 2))
        key = self._group, self._material, has
        if key not in self._known:
            self._known[key] = _Group(*key)
            self.groups.append(self._known[key])
        group = self._known[key]
        group.corners += corners
        group.sizes.append(len(values))
        group.lines.append(number)

    def _corner(self, number: int, value: str) -> tuple[int, int, int]:
        """Indices from 0 of a corner such as 7/3/-1, 7//2, 7/3 or 7; -1 for what it has not."""
        fields = value.split("/")
        lists = (self.places, self.coordinates, self.normals)
        try:
            given = [int(text) if text else None for text in fields]
        except ValueError:
            given = [None]
        if given[0] is None or len(given) > 3:
            self.wrong(number, f"{named(value)} is no corner; write v, v/vt, v//vn or v/vt/vn")
        found = [-1, -1, -1]
        for k, index in enumerate(given):
            if index is None:
                continue
            found[k] = index - 1 if index > 0 else len(lists[k]) + index
            if index == 0 or not 0 <= found[k] < 1 << 31:
                self.wrong(number, f"{named(value)}: {index} is no line; the first is 1, the last -1")
        return found[0], found[1], found[2]


class _Statements:
    """Line numbers and words of each line that says something; a line that ends with \\ goes on."""

    def __init__(self, text: str) -> None:
        self._lines = enumerate(text.splitlines(), 1)

    def __iter__(self) -> _Statements:
        return self

    def __next__(self) -> tuple[int, list[str]]:
        while True:
            number, line = next(self._lines)
            pieces = [line]
            while pieces[-1].endswith("\\"):
                pieces[-1] = pieces[-1][:-1]
                pieces.append(next(self._lines, (0, ""))[1])
            if words := "".join(pieces).partition("#")[0].split():
                return number, words


class _Meshes:
    """Makes the parts of a file."""

    def __init__(self, text: _Lines, name: str | None) -> None:
        self.text = text
        self.name = name
        width = min((len(row) for row in text.places), default=3)
        rows = np.array([row[:width] for row in text.places], np.float32).reshape(-1, width)
        self.places = rows[:, :3]
        # Many programs write the colour of a vertex after its place; a fourth number alone is a weight.
        self.colors = rows[:, -3:] if width >= 6 else None
        self.coordinates = np.array(text.coordinates, np.float32).reshape(-1, 2)
        self.normals = np.array(text.normals, np.float32).reshape(-1, 3)

    def part(self, group: _Group, material: int | None) -> Part:
        """The part of a group."""
        corners = np.array(group.corners, np.int64)
        self._check(group, corners)
        has = (True, *group.has)
        corners = np.where(has, corners, -1)
        vertices, numbers = np.unique(corners, axis=0, return_inverse=True)
        place, coordinate, normal = vertices.T
        points = self.places[place]
        try:
            faces = triangulated(numbers.ravel().astype(np.int32), np.array(group.sizes), points)
        except ValueError as error:
            polygon, what = error.args
            self.text.wrong(group.lines[polygon], what)
        count = len(vertices)
        return Part(
            name=group.name or "mesh",
            vertices=points,
            faces=faces,
            normals=self.normals[normal] if has[2] else None,
            texture_coordinates=self.coordinates[coordinate] * (1, -1) + (0, 1) if has[1] else None,
            material=material,
            joints=np.zeros((count, 0), np.int32),
            weights=np.zeros((count, 0), np.float32),
            inverse_bind=None,
            colors=None if self.colors is None else _opaque(self.colors[place]),
        )

    def _check(self, group: _Group, corners: NDArray[np.int64]) -> None:
        """Refuses corners that name what is not there."""
        lists = (("vertices", self.places), ("coordinates", self.coordinates), ("normals", self.normals))
        for k, (what, found) in enumerate(lists):
            if len(bad := np.flatnonzero(corners[:, k] >= len(found))):
                polygon = int(np.searchsorted(np.cumsum(group.sizes), bad[0], side="right"))
                index = int(corners[bad[0], k]) + 1
                said = f"a corner has the index {index:,}, but there are {len(found):,} {what}"
                self.text.wrong(group.lines[polygon], f"{said}; export the file again")


def _opaque(colors: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.concatenate([colors, np.ones((len(colors), 1), np.float32)], axis=1)


def _degenerate(part: Part) -> Any:
    """(T,) whether two corners are one."""
    ahead = np.roll(part.faces, 1, axis=1)
    return np.equal(part.faces, ahead).any(axis=1)


def _decoded(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _library(text: _Lines, name: str | None, strict: bool) -> Library:
    """The materials of all libraries that the file names."""
    folder = None if name is None else Path(name).parent
    library = Library({}, [])
    for path in dict.fromkeys(text.libraries):
        read_mtl(path, folder, library, file=name, strict=strict)
    return library
