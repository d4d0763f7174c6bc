"""Characters from files, and to files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from gmr.errors import FormatError
from gmr.formats.reading import Source, contents
from gmr.formats.writing import write_pieces
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from gmr.motion import Motion
    from gmr.skinning.character import Character

__all__ = ["read_character", "write_character"]

_SUFFIXES = (".glb", ".gltf", ".obj")


def read_character(
    source: Source, skeleton: Skeleton | Motion | None = None, *, strict: bool = False
) -> Character:
    """Read a character: its meshes, the joints that carry them, materials, textures and animations.

    Args:
        source: the path of a .gltf, .glb or .obj file; or the contents or an open file of one of the first
            two.
        skeleton: for a file that has no joints, such as any OBJ: its meshes are bound to these joints at rest
            by :func:`gmr.skinning.bind`. Both stand in one place, in one unit.
        strict: refuse what is read with a warning otherwise.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``; for glTF files).
        FormatError: the file is missing, damaged or of another kind; or it needs a skeleton and there is
            none, or it has a skin of its own and there is one. Says where and how to mend it.

    Warns:
        FormatWarning: something odd was read all the same, such as weights that do not sum to 1.
    """
    name, data = contents(source)
    if not data:
        raise FormatError("the file is empty, it holds no character; export it again", file=name)
    suffix = Path(source).suffix.lower() if isinstance(source, str | os.PathLike) else None
    if suffix not in (None, *_SUFFIXES):
        what = f"the suffix '{suffix}' is none of a character: {', '.join(_SUFFIXES)}"
        raise FormatError(f"{what}. Rename the file, or read a motion with gmr.read", file=name)
    home = skeleton if skeleton is None or isinstance(skeleton, Skeleton) else skeleton.skeleton
    if suffix == ".obj":
        return _bound_obj(bytes(data), name, home, strict)
    from gmr.formats.gltf import read_gltf_character

    character = read_gltf_character(bytes(data), name=name, strict=strict)
    return character if home is None else _rebound(character, name, home)


def _bound_obj(data: bytes, name: str | None, skeleton: Skeleton | None, strict: bool) -> Character:
    from gmr.formats.obj import read_obj
    from gmr.skinning.bound import bound

    if skeleton is None:
        what = "an OBJ file has no joints; give it some: gmr.read_character(path, skeleton=...)"
        raise FormatError(what, file=name)
    found = read_obj(data, name=name, strict=strict)
    called = Path(name).stem if name else "character"
    return bound(called, found.parts, skeleton, found.materials, found.textures)


def _rebound(character: Character, name: str | None, skeleton: Skeleton) -> Character:
    """The meshes of a character that has no joints, bound to some."""
    from gmr.skinning.bound import bound, in_the_world

    if character.skinned_parts:
        raise FormatError("the file has a skin of its own; leave skeleton= out", file=name)
    parts = [in_the_world(part, character.nodes.world[part.node]) for part in character.parts]
    return bound(character.name, parts, skeleton, character.materials, character.textures)


def write_character(
    character: Character,
    path: str | os.PathLike[str],
    poses: ArrayLike | None = None,
    frame_time: float | None = None,
) -> None:
    """Write a character as a .glb file: nodes, skins, materials, textures and animations.

    The file is written beside its place and renamed when it is whole. Joints, weights, materials and the keys
    of animations read back as they are, parts in the order of their nodes.

    Args:
        character: its own animations are written where no poses are given.
        path: where to; its suffix is .glb.
        poses: (F, J, 4, 4) world matrices of the joints: the file has one animation, which shows these.
            Rotations of consecutive frames are on the same side, so that viewers turn the short way.
        frame_time: seconds from a pose to the next.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``).
        FormatError: the suffix is another, a part has no triangle, or a node is sheared.
        GmrError: the poses do not fit the character, or joints would have to be sheared, which glTF cannot
            say; or the file cannot be written, and what was there is untouched.

    Warns:
        FormatWarning: something had to be mended or left out: normals without a direction, pictures that are
            neither PNG nor JPEG.
    """
    from gmr.formats.gltf_writer import glb_pieces

    place = Path(path)
    if place.suffix.lower() != ".glb":
        raise FormatError("a character is written as .glb; name the file so", file=str(path))
    write_pieces(place, glb_pieces(character, poses, frame_time))
