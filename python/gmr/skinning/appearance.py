"""How the parts of a character look: materials, and textures with the bytes of their pictures.

The model is that of glTF 2.0 (metallic-roughness); what an OBJ says is told in its words. Source: glTF 2.0
specification, 3.9 "Materials" and 3.8 "Texture Data".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

__all__ = ["Material", "Texture", "TextureUse"]

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Texture:
    """A picture, and how it is sampled."""

    data: bytes = field(repr=False)
    """The bytes of the picture's file."""
    mime_type: str
    """What they are: "image/png" or "image/jpeg"; others where a file has them."""
    name: str = ""
    mag_filter: int | None = None
    """As OpenGL and glTF number it (9729: linear); None: the program's choice."""
    min_filter: int | None = None
    wrap_s: int = 10497
    """What is left and right of the picture (10497: it repeats, 33071: its edge, 33648: mirrored)."""
    wrap_t: int = 10497


@dataclass(frozen=True)
class TextureUse:
    """A texture in its place in a material."""

    texture: int
    """Which of the character's textures."""
    coordinates: int = 0
    """Which of the part's sets of texture coordinates."""
    strength: float = 1.0
    """Of a normal or occlusion texture."""
    extensions: Mapping[str, Any] = field(default_factory=dict)
    """``KHR_texture_transform`` as the file has it."""


@dataclass(frozen=True)
class Material:
    """A surface; colours are linear, from 0 to 1."""

    name: str = ""
    base_color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    metallic: float = 1.0
    roughness: float = 1.0
    emissive: Colour = (0.0, 0.0, 0.0)
    alpha_mode: Literal["OPAQUE", "MASK", "BLEND"] = "OPAQUE"
    alpha_cutoff: float = 0.5
    """Below it nothing is drawn, where the mode is "MASK"."""
    double_sided: bool = False
    base_color_texture: TextureUse | None = None
    metallic_roughness_texture: TextureUse | None = None
    normal_texture: TextureUse | None = None
    occlusion_texture: TextureUse | None = None
    emissive_texture: TextureUse | None = None
    extensions: Mapping[str, Any] = field(default_factory=dict)
    """Those that hold numbers alone (``KHR_materials_unlit``, ``KHR_materials_emissive_strength``), as the
    file has them."""
