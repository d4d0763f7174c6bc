"""Puts clips into a motion database, one after another, each followed by its mirror image."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.errors import DatasetError, GmrError, SkeletonError
from gmr.matching.mirroring import Mirror, find_mirror
from gmr.matching.naming import image_of
from gmr.matching.oddities import no_facing
from gmr.matching.posed import Posed, posed, translated_joints
from gmr.matching.prepare import in_metres_upright
from gmr.matching.schema import Schema
from gmr.matching.survey import Survey
from gmr.motion import Motion
from gmr.sides import pair_joints

__all__ = ["Assembly", "Tags", "assemble"]

Tags = Mapping[str, ArrayLike]
"""For each clip's name the bits of all its frames (one number), or of each (one number a frame of the
file)."""


_MIRROR_SAMPLES = 16
"""Clips whose poses decide how the joints' frames are mirrored."""

_FASTEST = 15.0
"""Metres a second that no hips move at: a sprinter reaches 12."""


@dataclass(frozen=True, slots=True)
class Take:
    """A clip in metres, Y up, at the database's rate, as the core takes it."""

    name: str
    clip: Posed
    tags: NDArray[np.uint32] | None
    """(F,) bits; None: all clear."""
    start: float
    """Second of the file at which it begins."""
    mirrored: bool = False

    def image(self, mirror: Mirror, translated: NDArray[np.int32]) -> Take:
        """The take seen in a mirror, left for right."""
        return replace(
            self,
            name=image_of(self.name),
            clip=mirror.image(self.clip, translated),
            mirrored=True,
        )


@dataclass
class Assembly:
    """A database in the making."""

    builder: _core.DatabaseBuilder
    schema: Schema
    excluded: dict[str, str]
    clip_names: list[str] = field(default_factory=list)
    mirrored: list[bool] = field(default_factory=list)
    starts: list[float] = field(default_factory=list)

    def add(self, take: Take) -> None:
        """Adds a clip after those there are.

        Raises:
            ValueError: it holds numbers that are not finite.
        """
        clip = take.clip
        pose = (clip.positions, clip.rotations, clip.translations, clip.offsets)
        self.builder.add_clip(*pose, clip.root.ground, clip.root.heading, take.tags)
        self.clip_names.append(take.name)
        self.mirrored.append(take.mirrored)
        self.starts.append(take.start)


def assemble(
    seen: Survey,
    schema: Schema,
    rate: float,
    mirror: bool,
    pairs: Mapping[str, str] | None,
    tags: Tags | None,
) -> Assembly:
    """All clips of a survey in a builder that is ready to finish; see :meth:`gmr.matching.Database.build`.

    A clip that fails is left out by name; the others are not touched by it.

    Raises:
        DatasetError: no clip is left, tags fit no clip, or the schema asks for a joint that is not there.
    """
    _check_tags(seen, tags or {})
    pair = _pairs(seen, pairs) if mirror else None
    translated = translated_joints(seen, pair)
    image = None if pair is None else _mirror(seen, pair, translated)
    groups = schema.resolve(seen.skeleton, seen.joints.roles, rate)
    try:
        builder = _core.DatabaseBuilder(seen.skeleton.topology, translated.tolist(), groups, rate)
    except ValueError as error:
        raise DatasetError(str(error)) from error
    # The survey's own, so that its notes do not speak of what is left out here.
    assembly = Assembly(builder, schema, seen.excluded)
    for name in seen.motions:
        try:
            take = _take(seen, name, rate, translated, (tags or {}).get(name))
            assembly.add(take)
            if image is not None:
                assembly.add(take.image(image, translated))
        except (GmrError, ValueError) as error:
            assembly.excluded[name] = str(error)
    if not assembly.clip_names:
        first, why = next(iter(assembly.excluded.items()))
        raise DatasetError(
            f"none of the {len(assembly.excluded)} clips could be used; the first, '{first}': {why}"
        )
    return assembly


def _pairs(seen: Survey, pairs: Mapping[str, str] | None) -> NDArray[np.int32]:
    """(J,) the mirror image of each joint.

    Raises:
        DatasetError: a joint of one side has no partner on the other.
    """
    try:
        return pair_joints(seen.skeleton, pairs)
    except SkeletonError as error:
        raise DatasetError(
            f"the clips cannot be mirrored: {error} Or build without mirrored copies."
        ) from error


def _mirror(seen: Survey, pair: NDArray[np.int32], translated: NDArray[np.int32]) -> Mirror:
    """How the dataset's clips are mirrored; those that show no facing tell nothing of it.

    Raises:
        DatasetError: none shows one.
    """
    names = list(seen.samples)[:: max(1, len(seen.samples) // _MIRROR_SAMPLES)]
    clips, why = [], ""
    for name in names:
        try:
            motion = in_metres_upright(seen.samples[name], seen.units[name], seen.up)
            clips.append(_posed(seen, name, motion, translated))
        except ValueError as error:
            why = f"'{name}': {error}"
    if not clips:
        raise DatasetError(f"the clips cannot be mirrored ({why})")
    return find_mirror(seen.skeleton, pair, clips, translated)


def _take(
    seen: Survey, name: str, rate: float, translated: NDArray[np.int32], tags: ArrayLike | None
) -> Take:
    """One clip of a survey, prepared.

    Raises:
        DatasetError: its hips jump, or it stands along another axis than the others and shows no facing.
        ValueError: it shows no facing.
    """
    motion, skipped = seen.motions[name], seen.skipped.get(name, 0)
    prepared = in_metres_upright(motion, seen.units[name], seen.up).resample(rate)
    clip = _posed(seen, name, prepared, translated)
    _check_speed(clip.positions[:, seen.joints["hips"]], rate)
    bits = None if tags is None else _bits(np.asarray(tags, np.uint32), motion, prepared, skipped)
    return Take(name, clip, bits, skipped * motion.frame_time)


def _posed(seen: Survey, name: str, motion: Motion, translated: NDArray[np.int32]) -> Posed:
    """A clip of a survey, or some frames of it, as arrays.

    Raises:
        DatasetError: it shows no facing, for it stands along another axis than the others.
        ValueError: it shows no facing.
    """
    try:
        return posed(seen, motion, translated)
    except ValueError as error:
        sample = np.asarray(seen.samples[name].positions(dtype=np.float64))
        if (why := no_facing(sample, seen.joints.roles, seen.up)) is not None:
            raise DatasetError(why) from error
        raise


def _check_speed(hips: NDArray[np.float32], rate: float) -> None:
    """Raises where a recording has a hole: nobody's hips are that fast."""
    steps = np.linalg.norm(np.diff(hips, axis=0), axis=1)
    worst = int(np.argmax(steps)) if len(steps) else 0
    if len(steps) and steps[worst] * rate > _FASTEST:
        raise DatasetError(
            f"its hips jump {steps[worst]:.2f} m within a frame, {worst / rate:.2f} s after its beginning; "
            "cut the recording there"
        )


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
