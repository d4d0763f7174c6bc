"""Characters on the command line: what ``gmr info`` says of them."""

from __future__ import annotations

import warnings
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from gmr.errors import FormatWarning
from gmr.listing import listed, quoted

if TYPE_CHECKING:
    from gmr.skinning.description import AnimationDescription, CharacterDescription

__all__ = ["character_json", "character_page", "described_character", "holds_character"]

FEW: Final = 6
"""Names that a line lists; the others it counts."""


def holds_character(path: Path | str) -> bool:
    """Whether a file is of a format that holds characters, by its suffix."""
    return Path(path).suffix.lower() in (".glb", ".gltf")


def described_character(path: Path | str, *, strict: bool) -> CharacterDescription:
    """What is in the file of a character.

    Raises:
        FormatError: it cannot be read.
    """
    from gmr.formats import read_character
    from gmr.skinning.description import describe_character

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", FormatWarning)
        character = read_character(path, strict=strict)
    said = [str(warning.message) for warning in caught if issubclass(warning.category, FormatWarning)]
    return describe_character(character, [one.removeprefix(f"{path}:").strip() for one in said])


def character_page(path: str, of: CharacterDescription) -> str:
    """The description for people: a line for each thing, oddities last."""
    lines = [
        ("joints", f"{len(of.joints)} of {of.nodes} nodes; roots: {listed(of.roots, FEW) or 'none'}"),
        ("meshes", _meshes(of)),
        ("skin", _skin(of)),
        ("materials", _materials(of)),
        *(("animation", _animation(clip)) for clip in of.animations[:FEW]),
        ("", f"{len(of.animations) - FEW} animations more" if len(of.animations) > FEW else ""),
        ("size", _size(of)),
        *(("odd", oddity) for oddity in of.oddities),
    ]
    body = "\n".join(f"  {key:<9} {text}" for key, text in lines if text)
    return f"{click.style(path, bold=True)}\n{body}"


def character_json(of: CharacterDescription) -> dict[str, Any]:
    """The description as JSON has it."""
    return {**asdict(of), "joint_count": len(of.joints)}


def _meshes(of: CharacterDescription) -> str:
    if not of.meshes:
        return "none"
    counted = f"{of.vertices:,} vertices, {of.faces:,} triangles in {of.parts} parts"
    return f"{len(of.meshes)}: {quoted(of.meshes, FEW)}; {counted}"


def _skin(of: CharacterDescription) -> str:
    if not of.influences:
        return "none"
    skins = "1 skin" if of.skins == 1 else f"{of.skins} skins"
    return f"{skins}, up to {of.influences} joints a vertex"


def _materials(of: CharacterDescription) -> str:
    pictures = [f"{count} {mime.removeprefix('image/').upper()}" for mime, count in of.textures.items()]
    said = f"; textures: {listed(pictures, FEW)}, {of.texture_bytes:,} bytes" if pictures else ""
    named = quoted([name for name in of.materials if name], FEW)
    return f"{len(of.materials)}{f': {named}' if named else ''}{said}" if of.materials else "none"


def _animation(clip: AnimationDescription) -> str:
    ways = ", ".join(f"{way.lower()} ({count})" for way, count in clip.interpolation.items())
    return f"'{clip.name}', {clip.seconds:.2f} s, keys at {clip.fps:.6g} fps; channels: {ways}"


def _size(of: CharacterDescription) -> str:
    if of.extent is None:
        return ""
    x, y, z = of.extent
    return f"joints at rest: {x:.3g} x {y:.3g} x {z:.3g} m (y is up)"
