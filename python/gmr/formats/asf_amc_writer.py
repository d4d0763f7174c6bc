"""A motion to ASF and AMC bytes: bones, axes, degrees of freedom and limits as they were read."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.acclaim import INCH, Acclaim, Bone
from gmr.dof_rows import DofRows
from gmr.dofs_of_pose import dof_rows_of
from gmr.errors import FormatError
from gmr.formats.amc_reader import USUAL_FPS
from gmr.formats.asf_bone import why_no_name
from gmr.motion import Motion

__all__ = ["amc_chunks", "asf_chunks"]

_CHUNK_VALUES = 1 << 18


def asf_chunks(motion: Motion) -> list[bytes]:
    """The skeleton of a motion as an ASF file; frames are not in it.

    Raises:
        FormatError: a name or a value that ASF has no way to write.
        SkeletonError: several roots that cannot be joined, or another joint than the root moves.
    """
    rows = dof_rows_of(motion)
    acclaim = rows.acclaim
    _check_names(motion, acclaim)
    _check_bones(motion, acclaim)
    lines = [f"#{note}" for note in acclaim.notes]
    lines += [f":version {acclaim.version}", f":name {acclaim.name}"]
    lines += [":units", f"  mass {_text(acclaim.mass)}", f"  length {_text(_length(motion, acclaim))}"]
    lines += [f"  angle {'rad' if acclaim.radians else 'deg'}"]
    if acclaim.documentation:
        lines += [":documentation", *acclaim.documentation]
    root = acclaim.root
    lines += [":root", f"  order {' '.join(root.order)}", f"  axis {root.axis_order}"]
    lines += [f"  position {_texts(root.position)}", f"  orientation {_texts(root.orientation)}"]
    lines += [":bonedata"]
    for bone in acclaim.bones:
        lines += _bone_lines(bone)
    lines += [":hierarchy", "  begin", *_hierarchy(acclaim), "  end"]
    return [("\n".join(lines) + "\n").encode()]


def amc_chunks(motion: Motion) -> Iterator[bytes]:
    """The frames of a motion as an AMC file, piece by piece; its ASF is :func:`asf_chunks`.

    Values that were read are written as they are, in the shortest decimals that read back bit-identical,
    bones in the order of the file. All is checked before the first piece comes out.

    Raises:
        FormatError: a name or a value that AMC has no way to write; bone and frame are named.
        SkeletonError: several roots that cannot be joined, or another joint than the root moves.
    """
    rows = dof_rows_of(motion)
    _check_names(motion, rows.acclaim)
    _check_values(motion, rows)
    return _frames(rows, _head(motion, rows))


def _head(motion: Motion, rows: DofRows) -> bytes:
    lines = [f"#{note}" for note in rows.notes]
    lines.append(":FULLY-SPECIFIED")
    if rows.rate_known or motion.frame_time != 1 / USUAL_FPS:
        lines.append(f":SAMPLES-PER-SECOND {_text(_rate(motion.frame_time))}")
    lines.append(":RADIANS" if rows.radians else ":DEGREES")
    return ("\n".join(lines) + "\n").encode()


def _rate(frame_time: float) -> float:
    """The frames a second whose inverse is the frame time, to the bit where there is one; 0 for none."""
    if not frame_time:
        return 0.0
    rate = 1 / frame_time
    near = (rate, math.nextafter(rate, 0), math.nextafter(rate, math.inf))
    return next((found for found in near if found and 1 / found == frame_time), rate)


def _frames(rows: DofRows, head: bytes) -> Iterator[bytes]:
    acclaim = rows.acclaim
    listed = set(rows.listed)
    order = [*rows.listed, *(joint for joint in range(len(acclaim.channels)) if joint not in listed)]
    starts = acclaim.starts
    columns = np.concatenate([np.arange(starts[joint], starts[joint + 1]) for joint in order])
    names = [acclaim.skeleton.names[joint].encode() for joint in order]
    counts = [len(acclaim.channels[joint]) for joint in order]
    yield head
    step = max(1, _CHUNK_VALUES // max(1, acclaim.column_count))
    for start in range(0, len(rows), step):
        values = rows.values[start : start + step].take(columns, axis=1)
        yield _core.format_frames(values, names, counts, rows.first + start)


def _bone_lines(bone: Bone) -> list[str]:
    lines = [
        "  begin",
        f"    id {bone.number}",
        f"    name {bone.name}",
        f"    direction {_texts(bone.direction)}",
        f"    length {_text(bone.length)}",
        f"    axis {_texts(bone.axis)} {bone.axis_order}",
    ]
    lines += [f"    {note}" for note in bone.notes]
    if bone.dofs:
        lines.append(f"    dof {' '.join(bone.dofs)}")
        pairs = [f"({_limit(low)} {_limit(high)})" for low, high in bone.limits]
        lines += [f"    {'limits' if k == 0 else '      '} {pair}" for k, pair in enumerate(pairs)]
    return [*lines, "  end"]


def _hierarchy(acclaim: Acclaim) -> Iterator[str]:
    """A line for each joint on which bones hang."""
    names = acclaim.skeleton.names
    for joint, children in enumerate(acclaim.skeleton.children):
        if children:
            yield " ".join(["   ", names[joint], *(names[child] for child in children)])


def _length(motion: Motion, acclaim: Acclaim) -> float:
    """File units of an inch."""
    if motion.unit == acclaim.unit:
        return acclaim.length
    return 1.0 if motion.unit is None else INCH / motion.unit


def _text(number: float) -> str:
    return _core.format_rows(np.array([[number]])).decode().strip()


def _texts(numbers: Sequence[float]) -> str:
    return _core.format_rows(np.array([numbers], np.float64)).decode().strip()


def _limit(number: float) -> str:
    return _text(number) if math.isfinite(number) else "inf" if number > 0 else "-inf"


def _check_names(motion: Motion, acclaim: Acclaim) -> None:
    """Raises for a name that would not read back."""
    names = [bone.name for bone in acclaim.bones]
    counts = Counter(names)
    for name in names:
        why = why_no_name(name)
        if counts[name] > 1:
            why = "several joints share it"
        elif name == "root":
            why = "it is that of the root there"
        if why is not None:
            what = f"the joint's name {name!r:.80} cannot stand in an ASF file: {why}. Rename it."
            raise FormatError(what, file=motion.name)


def _check_bones(motion: Motion, acclaim: Acclaim) -> None:
    """Raises for a length or direction that is no decimal number."""
    for bone in acclaim.bones:
        if not all(math.isfinite(value) for value in (*bone.direction, bone.length, *bone.axis)):
            what = f"bone '{bone.name}' has no finite offset, which ASF cannot say. Correct it."
            raise FormatError(what, file=motion.name)


def _check_values(motion: Motion, rows: DofRows) -> None:
    """Raises for a value that is no decimal number."""
    values: NDArray[np.float64] = rows.values
    if np.isfinite(values).all():
        return
    frame, column = np.argwhere(~np.isfinite(values))[0].tolist()
    joint = int(np.searchsorted(rows.acclaim.starts, column, side="right")) - 1
    channel = rows.acclaim.channels[joint][column - int(rows.acclaim.starts[joint])]
    name = rows.acclaim.skeleton.names[joint]
    what = f"bone '{name}', {channel} is {values[frame, column]} in frame {frame}, which AMC cannot say"
    raise FormatError(f"{what}. Fill the gap, or cut the frame out.", file=motion.name)
