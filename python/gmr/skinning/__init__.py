"""Characters: meshes carried by joints, how they are bound and how they are moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gmr.lazily import lazily

if TYPE_CHECKING:
    from gmr.skinning.appearance import Material, Texture, TextureUse
    from gmr.skinning.binding import Binding, BindingReport, BindMethod, bind
    from gmr.skinning.blending import Hemisphere, Method, Skin
    from gmr.skinning.character import Character
    from gmr.skinning.driving import Driven, DrivingReport, Retargeted, drive, retarget
    from gmr.skinning.keyframes import Animation, Channel
    from gmr.skinning.nodes import Nodes
    from gmr.skinning.part import Part

__all__ = [
    "Animation",
    "BindMethod",
    "Binding",
    "BindingReport",
    "Channel",
    "Character",
    "Driven",
    "DrivingReport",
    "Hemisphere",
    "Material",
    "Method",
    "Nodes",
    "Part",
    "Retargeted",
    "Skin",
    "Texture",
    "TextureUse",
    "bind",
    "drive",
    "retarget",
]

# Imported when first used: a reader of files needs no kernels, and a kernel no files.
_HOMES = {
    "Animation": "gmr.skinning.keyframes",
    "BindMethod": "gmr.skinning.binding",
    "Binding": "gmr.skinning.binding",
    "BindingReport": "gmr.skinning.binding",
    "Channel": "gmr.skinning.keyframes",
    "Character": "gmr.skinning.character",
    "Driven": "gmr.skinning.driving",
    "DrivingReport": "gmr.skinning.driving",
    "Hemisphere": "gmr.skinning.blending",
    "Material": "gmr.skinning.appearance",
    "Method": "gmr.skinning.blending",
    "Nodes": "gmr.skinning.nodes",
    "Part": "gmr.skinning.part",
    "Retargeted": "gmr.skinning.driving",
    "Skin": "gmr.skinning.blending",
    "Texture": "gmr.skinning.appearance",
    "TextureUse": "gmr.skinning.appearance",
    "bind": "gmr.skinning.binding",
    "drive": "gmr.skinning.driving",
    "retarget": "gmr.skinning.driving",
}

__getattr__ = lazily(__name__, _HOMES)
