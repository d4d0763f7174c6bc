"""Animations as a .glb holds them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.formats.gltf_blob import Blob
from gmr.skinning.keyframes import Animation, Channel

__all__ = ["animation_of"]

_UNIT = 1e-4
"""How far a quaternion may be from length 1 and be written as it is."""


def animation_of(animation: Animation, blob: Blob) -> Any:
    """The ``pygltflib.Animation`` of a clip; one that begins before 0 is moved to begin there."""
    model = blob.model
    shift = np.float32(max(0.0, -animation.start))
    samplers, channels = [], []
    for channel in animation.channels:
        times = blob.array(_ascending(channel.times + shift), bounds=True)
        values = _unit_turns(channel)
        output = blob.array(values.reshape(-1, values.shape[-1]))
        samplers.append(
            model.AnimationSampler(input=times, output=output, interpolation=channel.interpolation)
        )
        target = model.AnimationChannelTarget(node=channel.node, path=channel.path)
        channels.append(model.AnimationChannel(sampler=len(samplers) - 1, target=target))
    return model.Animation(name=animation.name, samplers=samplers, channels=channels)


def _ascending(times: NDArray[np.float32]) -> NDArray[np.float32]:
    """Times of which none is the one before it: of two keys at one time the second comes a moment later."""
    if (np.diff(times) > 0).all():
        return times
    found = times.copy()
    for k in range(1, len(found)):
        if found[k] <= found[k - 1]:
            found[k] = np.nextafter(found[k - 1], np.float32(np.inf))
    return found


def _unit_turns(channel: Channel) -> NDArray[np.float32]:
    """The values, rotations of length 1."""
    if channel.path != "rotation":
        return channel.values
    found = channel.values.astype(np.float64)
    turns = found[:, 1] if channel.interpolation == "CUBICSPLINE" else found
    lengths = np.linalg.norm(turns, axis=-1, keepdims=True)
    off = (np.abs(lengths - 1) > _UNIT)[:, 0]
    if not off.any():
        return channel.values
    turns[off] /= lengths[off]
    return found.astype(np.float32)
