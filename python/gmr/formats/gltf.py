"""glTF 2.0, text (.gltf) and binary (.glb): characters and their animations."""

from __future__ import annotations

import numpy as np

from gmr.errors import FormatError, GmrError
from gmr.formats.gltf_motion_writer import glb_of_motion
from gmr.formats.gltf_reader import read_gltf_character
from gmr.formats.oddity import say
from gmr.listing import quoted
from gmr.motion import Motion
from gmr.skinning.as_motion import joint_motion
from gmr.skinning.character import Character

__all__ = ["glb_of_motion", "read_gltf", "read_gltf_character"]

_SHOWN = 6


def read_gltf(
    data: bytes,
    *,
    name: str | None = None,
    strict: bool = False,
    animation: str | int | None = None,
    fps: float | None = None,
) -> Motion:
    """The motion of the joints in an animation of a glTF file; without frames where there is none.

    Joints and world positions are those of the file, in metres; how a joint is turned counts from the rest
    pose of the nodes: see :func:`gmr.skinning.as_motion.joint_motion`.

    Args:
        data: the file's bytes.
        name: the file's path.
        strict: raise where a warning would do.
        animation: name or index; the first where left out.
        fps: frames a second; the rate of the animation's keys where left out.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``).
        FormatError: as :func:`read_gltf_character`; or nothing in the file could be a joint, or there is no
            such animation.

    Warns:
        FormatWarning: as :func:`read_gltf_character`; and where the file has several animations and none is
            chosen, or joints are stretched.
    """
    character = read_gltf_character(data, name=name, strict=strict)
    if not len(character.joints):
        what = "there are neither skins nor animations, so nothing here is a joint; read it as a character"
        raise FormatError(what, file=name)
    if not character.animations:
        if animation is not None:
            raise FormatError("the file has no animation; leave animation= out", file=name)
        empty = np.zeros((0, len(character.joints), 4, 4))
        return joint_motion(character, empty, 0.0).motion.with_name(name)
    if animation is None and len(character.animations) > 1:
        _say_which(character, name, strict)
    try:
        chosen = character.find_animation(0 if animation is None else animation)
        poses = character.animation(character.animations.index(chosen), fps)
    except GmrError as error:
        raise FormatError(str(error), file=name) from error
    rate = chosen.fps if fps is None else fps
    found = joint_motion(character, poses, 1 / rate)
    if found.deformed:
        what = f"animation '{chosen.name}' stretches or shears joints ({quoted(found.deformed, _SHOWN)})"
        say(f"{what}; a motion keeps where they are and how they turn", name, strict)
    return found.motion.with_name(name)


def _say_which(character: Character, name: str | None, strict: bool) -> None:
    """Names the animations where nobody chose one."""
    names = [clip.name for clip in character.animations]
    say(
        f"{len(names)} animations: {quoted(names, _SHOWN)}; the first is read, animation= says which",
        name,
        strict,
    )
