"""Characters from files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from gmr.errors import FormatError
from gmr.formats.reading import Source, contents

if TYPE_CHECKING:
    from gmr.skinning.character import Character

__all__ = ["read_character"]

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
