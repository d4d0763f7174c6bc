"""Materials and textures of a glTF file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, cast

from gmr.errors import FormatError
from gmr.formats.gltf_buffers import Buffers
from gmr.formats.gltf_document import Document
from gmr.formats.pictures import picture_type
from gmr.formats.text import named
from gmr.skinning.appearance import Material, Texture, TextureUse

__all__ = ["read_materials"]

_ALPHA_MODES = ("OPAQUE", "MASK", "BLEND")


def read_materials(document: Document, buffers: Buffers) -> tuple[tuple[Material, ...], tuple[Texture, ...]]:
    """All materials of the file in its order, and the textures whose pictures are there.

    Raises:
        FormatError: an index is out of range, or a factor has the wrong number of components.
    """
    reader = _Materials(document, buffers, {}, [])
    reader.read_textures()
    materials = tuple(reader.material(entry, k) for k, entry in enumerate(document.content.materials))
    return materials, tuple(reader.textures)


@dataclass
class _Materials:
    """Reads materials; textures are numbered without those whose pictures are not there."""

    document: Document
    buffers: Buffers
    places: dict[int, int | None]
    """Texture of the file -> texture of the character, None where its picture is not there."""
    textures: list[Texture]

    def read_textures(self) -> None:
        for index in range(len(self.document.content.textures)):
            texture = self._texture(index)
            self.places[index] = None if texture is None else len(self.textures)
            self.textures += [] if texture is None else [texture]

    def material(self, entry: Any, k: int) -> Material:
        place = f"materials[{k}]"
        surface = entry.pbrMetallicRoughness
        plain: dict[str, Any] = {}
        if surface is not None:
            plain = {
                "base_color": self._factor(surface.baseColorFactor, 4, f"{place}.baseColorFactor"),
                "metallic": 1.0 if surface.metallicFactor is None else surface.metallicFactor,
                "roughness": 1.0 if surface.roughnessFactor is None else surface.roughnessFactor,
                "base_color_texture": self._use(surface.baseColorTexture, place),
                "metallic_roughness_texture": self._use(surface.metallicRoughnessTexture, place),
            }
        mode = entry.alphaMode or "OPAQUE"
        if mode not in _ALPHA_MODES:
            self.document.wrong(f"{place}.alphaMode is {named(mode)}; use {', '.join(_ALPHA_MODES)}")
        return Material(
            name=entry.name or "",
            emissive=cast(
                tuple[float, float, float], self._factor(entry.emissiveFactor, 3, f"{place}.emissiveFactor")
            ),
            alpha_mode=cast(Literal["OPAQUE", "MASK", "BLEND"], mode),
            alpha_cutoff=0.5 if entry.alphaCutoff is None or mode != "MASK" else entry.alphaCutoff,
            double_sided=bool(entry.doubleSided),
            normal_texture=self._use(entry.normalTexture, place, "scale"),
            occlusion_texture=self._use(entry.occlusionTexture, place, "strength"),
            emissive_texture=self._use(entry.emissiveTexture, place),
            extensions=entry.extensions or {},
            **plain,
        )

    def _factor(self, found: list[float], count: int, place: str) -> tuple[float, ...]:
        if len(found) != count:
            self.document.wrong(f"{place} has {len(found)} numbers; it must have {count}")
        return tuple(found)

    def _use(self, entry: Any, place: str, strength: str | None = None) -> TextureUse | None:
        if entry is None:
            return None
        self.document.at("textures", entry.index, place)
        if entry.texCoord is not None and entry.texCoord < 0:
            self.document.wrong(f"{place} has the texCoord {entry.texCoord}; it must be 0 or more")
        texture_place = self.places[entry.index]
        if texture_place is None:
            return None
        said = None if strength is None else getattr(entry, strength)
        return TextureUse(
            texture_place, entry.texCoord or 0, 1.0 if said is None else said, entry.extensions or {}
        )

    def _texture(self, index: int) -> Texture | None:
        entry = self.document.content.textures[index]
        place = f"textures[{index}]"
        if entry.source is None:
            self.document.odd(f"{place} has no picture that gmr knows; it is left out")
            return None
        image = self.document.at("images", entry.source, place)
        place = f"images[{entry.source}]"
        try:
            data, mime = self._picture(image, place)
        except FormatError as error:
            if self.document.strict:
                raise
            self.document.odd(f"{error.what}; the texture is left out")
            return None
        if not data:
            self.document.odd(f"{place} has no bytes; the texture is left out")
            return None
        sampler = (
            None
            if entry.sampler is None
            else self.document.at("samplers", entry.sampler, f"textures[{index}]")
        )
        options: dict[str, Any] = {}
        if sampler is not None:
            options = {
                "mag_filter": sampler.magFilter,
                "min_filter": sampler.minFilter,
                "wrap_s": sampler.wrapS,
                "wrap_t": sampler.wrapT,
            }
        return Texture(data, mime, entry.name or image.name or "", **options)

    def _picture(self, image: Any, place: str) -> tuple[bytes, str]:
        """The bytes of a picture, and what they are."""
        if image.bufferView is not None:
            data, said = self.buffers.view_bytes(image.bufferView, place), None
        elif image.uri is not None:
            data, said = self.buffers.resource(image.uri, place)
        else:
            self.document.wrong(f"{place} has neither a uri nor a bufferView; export the file again")
        return data, picture_type(data, image.mimeType or said, image.uri or "")
