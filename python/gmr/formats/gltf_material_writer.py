"""Materials and textures of a character as a .glb holds them."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any, Final

from gmr.errors import FormatWarning
from gmr.formats.gltf_blob import Blob
from gmr.skinning.appearance import Material, Texture, TextureUse
from gmr.skinning.character import Character
from gmr.skinning.part import Part

__all__ = ["MaterialWriter"]

_PICTURES: Final = ("image/png", "image/jpeg")
"""What a glTF file may hold without extensions."""

_USES: Final = (
    "base_color_texture",
    "metallic_roughness_texture",
    "normal_texture",
    "occlusion_texture",
    "emissive_texture",
)


class MaterialWriter:
    """Collects materials, textures, pictures and samplers; those of the character first, in its order.

    Args:
        character: whose they are.
        blob: takes the bytes of pictures.

    Warns:
        FormatWarning: a picture is neither PNG nor JPEG, so that its texture is left out.
    """

    def __init__(self, character: Character, blob: Blob) -> None:
        self.model = blob.model
        self.blob = blob
        self.images: list[Any] = []
        self.samplers: list[Any] = []
        self.textures: list[Any] = []
        self.extensions: set[str] = set()
        self._known: dict[Any, int] = {}
        self._places = [self._texture(texture) for texture in character.textures]
        self._plain = character.materials
        self.materials = [self._material(material) for material in character.materials]

    def material_of(self, part: Part) -> int | None:
        """The material of a part: the character's, or a copy without what the part has no coordinates for."""
        if part.material is None:
            return None
        sets = len(part.more_texture_coordinates) + (part.texture_coordinates is not None)
        material = self._plain[part.material]
        uses = {key: getattr(material, key) for key in _USES}
        useless = [key for key, use in uses.items() if use is not None and use.coordinates >= sets]
        if not useless:
            return part.material
        key = (part.material, tuple(useless))
        without: Any = dict.fromkeys(useless)
        if key not in self._known:
            self._known[key] = len(self.materials)
            self.materials.append(self._material(replace(material, **without)))
        return self._known[key]

    def _texture(self, texture: Texture) -> int | None:
        if texture.mime_type not in _PICTURES:
            warnings.warn(
                FormatWarning(
                    f"texture '{texture.name}' is {texture.mime_type}, but a .glb holds PNG and JPEG; it is "
                    "left out. Convert the picture"
                ),
                stacklevel=6,
            )
            return None
        image = self._once(
            (texture.data, texture.mime_type),
            self.images,
            lambda: self.model.Image(bufferView=self.blob.view(texture.data), mimeType=texture.mime_type),
        )
        name = texture.name or None
        self.textures.append(self.model.Texture(sampler=self._sampler(texture), source=image, name=name))
        return len(self.textures) - 1

    def _sampler(self, texture: Texture) -> int | None:
        """How a texture is sampled; None where nothing differs from the standard."""
        values = (texture.mag_filter, texture.min_filter, texture.wrap_s, texture.wrap_t)
        if values == (None, None, 10497, 10497):
            return None
        keys = ("magFilter", "minFilter", "wrapS", "wrapT")
        return self._once(
            values, self.samplers, lambda: self.model.Sampler(**dict(zip(keys, values, strict=True)))
        )

    def _once(self, key: Any, entries: list[Any], make: Any) -> int:
        if key not in self._known:
            self._known[key] = len(entries)
            entries.append(make())
        return self._known[key]

    def _material(self, material: Material) -> Any:
        model = self.model
        self.extensions.update(material.extensions)
        surface = model.PbrMetallicRoughness(
            baseColorFactor=_parts(material, "base_color"),
            metallicFactor=_parts(material, "metallic")[0],
            roughnessFactor=_parts(material, "roughness")[0],
            baseColorTexture=self._use(material.base_color_texture, model.TextureInfo),
            metallicRoughnessTexture=self._use(material.metallic_roughness_texture, model.TextureInfo),
        )
        return model.Material(
            name=material.name or None,
            pbrMetallicRoughness=surface,
            normalTexture=self._use(material.normal_texture, model.NormalMaterialTexture, "scale"),
            occlusionTexture=self._use(material.occlusion_texture, model.OcclusionTextureInfo, "strength"),
            emissiveTexture=self._use(material.emissive_texture, model.TextureInfo),
            emissiveFactor=_parts(material, "emissive"),
            alphaMode=material.alpha_mode,
            alphaCutoff=material.alpha_cutoff if material.alpha_mode == "MASK" else None,
            doubleSided=material.double_sided,
            extensions=dict(material.extensions),
        )

    def _use(self, use: TextureUse | None, kind: Any, strength: str | None = None) -> Any:
        place = None if use is None else self._places[use.texture]
        if use is None or place is None:
            return None
        self.extensions.update(use.extensions)
        value = min(max(use.strength, 0.0), 1.0) if strength == "strength" else use.strength
        more = {} if strength is None else {strength: value}
        return kind(index=place, texCoord=use.coordinates, extensions=dict(use.extensions), **more)


def _parts(material: Material, key: str) -> list[float]:
    """The components of a factor, from 0 to 1 as the standard asks."""
    value = getattr(material, key)
    found = list(value) if isinstance(value, tuple) else [value]
    cut = [min(max(component, 0.0), 1.0) for component in found]
    if cut != found:
        what = f"material '{material.name}' has the {key.replace('_', ' ')} {value}; it is cut to 0 to 1"
        warnings.warn(FormatWarning(f"{what}."), stacklevel=8)
    return cut
