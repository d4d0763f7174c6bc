"""Puts clips into a motion database, one after another, each followed by its mirror image."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.errors import DatasetError, GmrError
from gmr.matching.prepare import in_metres_upright
from gmr.matching.root import RootTrack, root_track
from gmr.matching.schema import Schema
from gmr.matching.survey import Survey
from gmr.motion import Motion

__all__ = ["Assembly", "Tags", "assemble"]

Tags = Mapping[str, ArrayLike]
"""For each clip's name the bits of all its frames (one number), or of each (one number a frame of the
file)."""


@dataclass(frozen=True, slots=True)
class Take:
    """A clip in metres, Y up, at the database's rate."""

    name: str
    motion: Motion
    positions: NDArray[np.float32]
    """(F, J, 3) world positions."""
    root: RootTrack
    tags: NDArray[np.uint32] | None
    """(F,) bits; None: all clear."""
    start: float
    """Second of the file at which it begins."""
    mirrored: bool = False

    def mirror_image(self) -> Take:
        """The take seen in a mirror, left for right."""
        image = self.motion.mirror()
        return replace(
            self,
            name=f"{self.name} (mirrored)",
            motion=image,
            positions=image.positions(dtype=np.float32),
            root=self.root.mirrored(),
            mirrored=True,
        )


@dataclass
class Assembly:
    """A database in the making."""

    builder: _core.DatabaseBuilder
    translated: NDArray[np.int32]
    """(T,) the joints that any clip translates."""
    excluded: dict[str, str]
    clip_names: list[str] = field(default_factory=list)
    mirrored: list[bool] = field(default_factory=list)
    starts: list[float] = field(default_factory=list)

    def add(self, take: Take) -> None:
        """Adds a clip after those there are.

        Raises:
            ValueError: it holds numbers that are not finite.
        """
        motion = take.motion
        self.builder.add_clip(
            take.positions,
            motion.rotations,
            self._translations(motion),
            motion.skeleton.offsets,
            take.root.ground,
            take.root.heading,
            take.tags,
        )
        self.clip_names.append(take.name)
        self.mirrored.append(take.mirrored)
        self.starts.append(take.start)

    def _translations(self, motion: Motion) -> NDArray[np.float64]:
        """(F, T, 3) of all joints that any clip translates; where this one does not, its offsets."""
        if np.array_equal(motion.translated, self.translated):
            return motion.translations
        column = {joint: k for k, joint in enumerate(motion.translated.tolist())}
        rest = np.broadcast_to(motion.skeleton.offsets, (motion.frame_count, *motion.skeleton.offsets.shape))
        found = [
            motion.translations[:, column[joint]] if joint in column else rest[:, joint]
            for joint in self.translated.tolist()
        ]
        return np.ascontiguousarray(np.stack(found, axis=1))


def assemble(seen: Survey, schema: Schema, rate: float, mirror: bool, tags: Tags | None) -> Assembly:
    """All clips of a survey in a builder that is ready to finish.

    A clip that fails is left out by name; the others are not touched by it.

    Raises:
        DatasetError: no clip is left, tags fit no clip, or the schema asks for a joint that is not there.
    """
    _check_tags(seen, tags or {})
    translated = np.unique(np.concatenate([motion.translated for motion in seen.motions.values()]))
    groups = schema.resolve(seen.skeleton, seen.joints.roles, rate)
    try:
        builder = _core.DatabaseBuilder(seen.skeleton.topology, translated.tolist(), groups, rate)
    except ValueError as error:
        raise DatasetError(str(error)) from error
    assembly = Assembly(builder, translated.astype(np.int32), dict(seen.excluded))
    for name in seen.motions:
        name_of_next = name
        try:
            take = _take(seen, name, rate, (tags or {}).get(name))
            assembly.add(take)
            if mirror:
                name_of_next = f"{name} (mirrored)"
                assembly.add(take.mirror_image())
        except (GmrError, ValueError) as error:
            assembly.excluded[name_of_next] = str(error)
    if not assembly.clip_names:
        reasons = "; ".join(f"'{name}': {why}" for name, why in list(assembly.excluded.items())[:5])
        raise DatasetError(f"no clip could be used ({reasons})")
    return assembly


def _take(seen: Survey, name: str, rate: float, tags: ArrayLike | None) -> Take:
    """One clip of a survey, prepared."""
    motion, skipped = seen.motions[name], seen.skipped.get(name, 0)
    prepared = in_metres_upright(motion, seen.units[name], seen.up).resample(rate)
    positions = prepared.positions(dtype=np.float32)
    root = root_track(prepared, positions, seen.joints, seen.root)
    bits = None if tags is None else _bits(np.asarray(tags, np.uint32), motion, prepared, skipped)
    return Take(name, prepared, positions, root, bits, skipped * motion.frame_time)


def _bits(tags: NDArray[np.uint32], motion: Motion, prepared: Motion, skipped: int) -> NDArray[np.uint32]:
    """(F,) tag bits at the database's rate: those of the nearest frame of the file."""
    if tags.ndim == 0:
        return np.full(prepared.frame_count, tags, np.uint32)
    seconds = np.arange(prepared.frame_count) * prepared.frame_time
    nearest = np.minimum(np.round(seconds / motion.frame_time).astype(int), motion.frame_count - 1)
    return np.ascontiguousarray(tags[skipped + nearest])


def _check_tags(seen: Survey, tags: Tags) -> None:
    for name, given in tags.items():
        if name in seen.excluded:
            continue
        if name not in seen.motions:
            raise DatasetError(f"tags are given for '{name}', but no clip has this name")
        frames = seen.motions[name].frame_count + seen.skipped.get(name, 0)
        shape = np.shape(np.asarray(given))
        if shape not in ((), (frames,)):
            raise DatasetError(
                f"tags of '{name}' have the shape {shape}; give one number, or one for each of the file's "
                f"{frames} frames"
            )
