"""Characters from files, and to files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from gmr.errors import FormatError
from gmr.formats.reading import Source, contents
from gmr.formats.writing import write_pieces

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from gmr.skinning.character import Character

__all__ = ["read_character", "write_character"]

_SUFFIXES = (".glb", ".gltf")


def read_character(source: Source, *, strict: bool = False) -> Character:
    """Read a character: its meshes, the joints that carry them, materials, textures and animations.

    Args:
        source: the path of a .gltf or .glb file; or its contents as bytes; or an open file.
        strict: refuse what is read with a warning otherwise.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``).
        FormatError: the file is missing, damaged or of another kind; says where and how to mend it.

    Warns:
        FormatWarning: something odd was read all the same, such as weights that do not sum to 1.
    """
    from gmr.formats.gltf import read_gltf_character

    name, data = contents(source)
    if not data:
        raise FormatError("the file is empty, it holds no character; export it again", file=name)
    if isinstance(source, str | os.PathLike) and Path(source).suffix.lower() not in _SUFFIXES:
        what = f"the suffix '{Path(source).suffix}' is none of a character: {', '.join(_SUFFIXES)}"
        raise FormatError(f"{what}. Rename the file, or read a motion with gmr.read", file=name)
    return read_gltf_character(bytes(data), name=name, strict=strict)


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
