"""The animations of a glTF file, key by key.

Source: glTF 2.0 specification, 3.11 "Animations".
"""

from __future__ import annotations

from typing import Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from gmr.formats.gltf_accessors import Accessors
from gmr.formats.gltf_document import Document
from gmr.formats.text import named
from gmr.skinning.keyframes import Animation, Channel, Interpolation, Path
from gmr.skinning.nodes import Nodes

__all__ = ["read_animations"]

_PATHS: Final = {"translation": ("VEC3",), "rotation": ("VEC4",), "scale": ("VEC3",)}
_MODES: Final = ("STEP", "LINEAR", "CUBICSPLINE")


def read_animations(document: Document, accessors: Accessors, nodes: Nodes) -> tuple[Animation, ...]:
    """All animations that move nodes; those without a name are called "animation_0" after their place.

    Raises:
        FormatError: an index is out of range, times go backwards, or values are too few or not finite.
    """
    reader = _Reader(document, accessors, nodes)
    found = [reader.animation(entry, k) for k, entry in enumerate(document.content.animations)]
    return tuple(one for one in found if one.channels)


class _Reader:
    def __init__(self, document: Document, accessors: Accessors, nodes: Nodes) -> None:
        self.document = document
        self.accessors = accessors
        self.nodes = nodes
        self._checked: set[int] = set()

    def animation(self, entry: Any, k: int) -> Animation:
        place = f"animations[{k}]"
        channels: dict[tuple[int, str], Channel] = {}
        morphs = 0
        for c, found in enumerate(entry.channels):
            target = found.target
            if target is None:
                self.document.wrong(f"{place}.channels[{c}] has no target; export the file again")
            if target.path == "weights":
                morphs += 1
            elif target.node is not None:
                channel = self._channel(entry, found, f"{place}.channels[{c}]")
                if channels.setdefault((channel.node, channel.path), channel) is not channel:
                    self.document.wrong(
                        f"{place}.channels[{c}] moves the {channel.path} of nodes[{channel.node}], which "
                        "another channel moves; export the file again"
                    )
        if morphs:
            self.document.odd(f"{place} has {morphs} channels for morph targets, which are left out")
        return Animation(entry.name or f"animation_{k}", tuple(channels.values()))

    def _channel(self, entry: Any, found: Any, place: str) -> Channel:
        document, target = self.document, found.target
        document.at("nodes", target.node, place)
        if target.path not in _PATHS:
            document.wrong(
                f"{place} moves {named(str(target.path))}; it must be one of {', '.join(_PATHS)} and weights"
            )
        if target.node in self.nodes.matrices:
            document.wrong(
                f"{place} moves the {target.path} of nodes[{target.node}], which is given by a matrix; "
                "export it with translation, rotation and scale"
            )
        if found.sampler is None or not 0 <= found.sampler < len(entry.samplers):
            document.wrong(f"{place} refers to a sampler that is not there; export the file again")
        sampler = entry.samplers[found.sampler]
        mode = sampler.interpolation or "LINEAR"
        if mode not in _MODES:
            document.wrong(f"{place} interpolates by {named(mode)}; use {', '.join(_MODES)}")
        times = self._times(sampler.input, place)
        values = self._values(sampler.output, target.path, place)
        each = 3 if mode == "CUBICSPLINE" else 1
        if len(values) < each * len(times):
            document.wrong(
                f"{place} has {len(times):,} times but {len(values):,} values; it needs {each} for each time"
            )
        values = values[: each * len(times)]
        if each == 3:
            values = values.reshape(len(times), 3, values.shape[1])
        if target.path == "rotation":
            self._check_turns(values[:, 1] if each == 3 else values, place)
        return Channel(target.node, cast(Path, target.path), times, values, cast(Interpolation, mode))

    def _times(self, index: int | None, place: str) -> NDArray[np.float32]:
        times = self.accessors.floats(index, f"{place}.input", ("SCALAR",))
        assert index is not None
        if index not in self._checked:
            if not np.isfinite(times).all():
                self.document.wrong(f"{place}: a time is not finite; export the file again")
            if len(back := np.flatnonzero(np.diff(times) < 0)):
                at = int(back[0])
                self.document.wrong(
                    f"{place}: key {at + 1} is at {times[at + 1]:g} s, before key {at} at {times[at]:g} s; "
                    "times must ascend"
                )
            self._checked.add(index)
        return times

    def _values(self, index: int | None, path: str, place: str) -> NDArray[np.float32]:
        values = self.accessors.floats(index, f"{place}.output", _PATHS[path])
        if not np.isfinite(values).all():
            self.document.wrong(f"{place}: a value is not finite; export the file again")
        return values

    def _check_turns(self, turns: NDArray[np.float32], place: str) -> None:
        """Refuses quaternions without a direction."""
        lengths = np.linalg.norm(turns, axis=1)
        if len(bad := np.flatnonzero(lengths < 1e-6)):
            self.document.wrong(f"{place}: the rotation of key {bad[0]} is 0 0 0 0; export the file again")
