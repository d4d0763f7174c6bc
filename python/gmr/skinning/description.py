"""What is in a character, and what is odd about it, as plain values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from gmr.skinning.character import Character
    from gmr.skinning.part import Part

__all__ = ["AnimationDescription", "CharacterDescription", "describe_character"]


@dataclass(frozen=True)
class AnimationDescription:
    """A clip of a character; times in seconds."""

    name: str
    seconds: float
    fps: float
    """At which it is sampled where nobody asks for another rate."""
    channels: int
    interpolation: dict[str, int]
    """How many channels are interpolated in which way."""


@dataclass(frozen=True)
class CharacterDescription:
    """A character in words and numbers; lengths in metres."""

    name: str
    joints: tuple[str, ...]
    roots: tuple[str, ...]
    """Joints that hang on no other."""
    nodes: int
    meshes: tuple[str, ...]
    parts: int
    unskinned: int
    """Parts that nothing carries."""
    vertices: int
    faces: int
    influences: int
    """Joints that carry a vertex, at most."""
    skins: int
    """Different sets of inverse bind matrices."""
    materials: tuple[str, ...]
    textures: dict[str, int]
    """How many there are of each type of picture."""
    texture_bytes: int
    animations: tuple[AnimationDescription, ...]
    extent: tuple[float, ...] | None
    """Of the joints at rest, along x, y and z; None where there are none."""
    oddities: tuple[str, ...]


def describe_character(character: Character, warnings: Sequence[str] = ()) -> CharacterDescription:
    """What is in ``character`` and what is odd about it.

    Args:
        character: any.
        warnings: what reading it warned of; these come first among the oddities.
    """
    parts = character.parts
    places = character.rest_pose()[:, :3, 3]
    binds = {part.inverse_bind.tobytes() for part in parts if part.inverse_bind is not None}
    names = zip(character.joint_names, character.joint_parents.tolist(), strict=True)
    return CharacterDescription(
        name=character.name,
        joints=character.joint_names,
        roots=tuple(name for name, parent in names if parent < 0),
        nodes=len(character.nodes),
        meshes=tuple(dict.fromkeys(part.name for part in parts)),
        parts=len(parts),
        unskinned=sum(not part.is_skinned for part in parts),
        vertices=sum(len(part.vertices) for part in parts),
        faces=sum(len(part.faces) for part in parts),
        influences=max((_influences(part) for part in parts), default=0),
        skins=len(binds),
        materials=tuple(material.name for material in character.materials),
        textures=dict(Counter(texture.mime_type for texture in character.textures)),
        texture_bytes=sum(len(data) for data in {texture.data for texture in character.textures}),
        animations=tuple(
            AnimationDescription(
                clip.name,
                clip.end - clip.start,
                clip.fps,
                len(clip.channels),
                dict(Counter(channel.interpolation for channel in clip.channels)),
            )
            for clip in character.animations
        ),
        extent=tuple(np.ptp(places, axis=0).tolist()) if len(places) else None,
        oddities=(*warnings, *_oddities(character)),
    )


def _influences(part: Part) -> int:
    return int((part.weights > 0).sum(axis=1).max(initial=0))


def _oddities(character: Character) -> list[str]:
    found = []
    if twice := [name for name, count in Counter(character.joint_names).items() if count > 1]:
        found.append(f"several joints share a name: {', '.join(twice[:6])}")
    if not any(part.is_skinned for part in character.parts):
        found.append("no mesh is carried by joints; give read_character a skeleton to bind what there is")
    elif loose := [part.name for part in character.parts if not part.is_skinned]:
        found.append(f"meshes that nothing carries: {', '.join(loose[:6])}")
    if not character.animations:
        found.append("no animation: a character at rest")
    return found
