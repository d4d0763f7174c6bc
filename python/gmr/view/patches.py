"""A skin in patches of one colour each, for the browser draws a mesh in one colour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.listing import quoted
from gmr.view.colours import LEVELS, SKIN, level_colours, srgb

if TYPE_CHECKING:
    from gmr.skinning.character import Character

__all__ = ["Patch", "joint_weights", "plain_patches", "weight_patches"]

Colour = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class Patch:
    """Triangles of one colour."""

    colour: Colour
    vertices: NDArray[np.intp]
    """(P,) which of the character's skinned vertices it needs."""
    faces: NDArray[np.uint32]
    """(T, 3) into those P."""


def plain_patches(character: Character) -> list[Patch]:
    """A patch for each colour of the materials; textures are left out."""
    colours: list[Colour] = []
    for part in character.skinned_parts:
        material = None if part.material is None else character.materials[part.material]
        # A texture's colour is not that of its material, which only multiplies it.
        bare = material is None or material.base_color_texture is not None
        colours.append(SKIN if bare or material is None else srgb(material.base_color))
    counts = [len(part.faces) for part in character.skinned_parts]
    of_face = np.repeat(np.arange(len(counts)), counts)
    distinct = list(dict.fromkeys(colours))
    groups = np.array([distinct.index(colour) for colour in colours], np.intp)[of_face]
    return _patches(character, groups, distinct)


def weight_patches(character: Character, joint: str) -> list[Patch]:
    """Patches that show how much each triangle follows a joint: :data:`gmr.view.colours.LEVELS` steps from
    weight 0 to weight 1, of the mean of its corners.

    Raises:
        GmrError: the character has no such joint.
    """
    weights = joint_weights(character, joint)[character.faces].mean(axis=1)
    groups = np.clip((weights * LEVELS).astype(np.intp), 0, LEVELS - 1)
    colours = [(int(red), int(green), int(blue)) for red, green, blue in level_colours()]
    return _patches(character, groups, colours)


def joint_weights(character: Character, joint: str) -> NDArray[np.float32]:
    """(V,) how much each skinned vertex follows a joint.

    Raises:
        GmrError: the character has no such joint.
    """
    if joint not in character.joint_names:
        known = quoted(character.joint_names, 8)
        raise GmrError(f"character '{character.name}' has no joint '{joint}'; it has {known}")
    merged = character.merged
    # With several skins the kernels number joint j of skin s as s * J + j.
    own = merged.joints % len(character.joints) == character.joint_names.index(joint)
    return np.asarray((merged.weights * own).sum(axis=1), np.float32)


def _patches(character: Character, groups: NDArray[np.intp], colours: list[Colour]) -> list[Patch]:
    """(T,) groups of the faces, as patches; empty ones are left out."""
    same = _welded(character)
    faces = same[character.faces]
    made = []
    for group in np.unique(groups):
        used, local = np.unique(faces[groups == group], return_inverse=True)
        made.append(Patch(colours[int(group)], used, local.reshape(-1, 3).astype(np.uint32)))
    return made


def _welded(character: Character) -> NDArray[np.intp]:
    """(V,) the first vertex in the same place that also looks and moves the same.

    Files part vertices where a texture has a seam; the browser, which makes normals itself, would draw it.
    """
    merged = character.merged
    keys = [merged.vertices, merged.joints.astype(np.float32), merged.weights]
    keys += [] if merged.normals is None else [merged.normals.round(3)]
    _, first, inverse = np.unique(
        np.concatenate(keys, axis=1), axis=0, return_index=True, return_inverse=True
    )
    return np.asarray(first[inverse.reshape(-1)], np.intp)
