"""What an ASF file says of a skeleton: bones with axes, degrees of freedom and limits.

A bone runs from the end of the bone above it along ``direction`` for ``length``. Its degrees of freedom turn
it about axes of its own: with ``C`` the rotation that ``axis`` tells, ``A`` that of the frame's angles and
``t`` the bone's vector at rest, its end is ``M = M_parent C A C^-1 T(t)``. That is the pre-rotation form,
every bone with a slot of its own; the joints are the root and each bone's end. Angles are listed in the order
in which they are applied: ``rx ry rz`` is ``A = Rz Ry Rx``.
Source: Acclaim's description of its format, where ``L = C^-1 M C B`` is for row vectors; compared with the
same takes as BVH.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.skeleton import Skeleton

__all__ = ["INCH", "UNLIMITED", "Acclaim", "Bone", "Root"]

Vector = tuple[float, float, float]
Limits = tuple[float, float]

INCH: Final = 0.0254
"""Metres of an inch, in which ASF counts: a length in the file divided by ``units length``."""

UNLIMITED: Final[Limits] = (-math.inf, math.inf)
"""What a degree of freedom may do of which nobody said more."""

_NUMBER: Final = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_MIRRORED_LENGTHS = (-1.0, 1.0, 1.0)
_MIRRORED_ANGLES = {"x": 1.0, "y": -1.0, "z": -1.0}


@dataclass(frozen=True, slots=True)
class Root:
    """The root of an ASF.

    Args:
        order: the values of a frame, TX TY TZ RX RY RZ or some of them.
        axis_order: the axes of the three numbers of ``orientation``, in the order in which they turn.
        position: what the frames' translations are added to, in file units.
        orientation: of the axes that the root turns about, in the file's angles.
    """

    order: tuple[str, ...] = ("TX", "TY", "TZ", "RX", "RY", "RZ")
    axis_order: str = "XYZ"
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Bone:
    """A bone of an ASF.

    Args:
        name: the joint at its end has it too.
        direction: from the end of the bone above, at rest.
        length: in file units; ``direction`` times this is the joint's offset.
        axis: orientation of the axes that it turns about, in the file's angles.
        axis_order: the axes of the three numbers of ``axis``, in the order in which they turn.
        dofs: "rx", "ry", "rz" or some of them, in the order in which frames list and apply them.
        limits: least and greatest value of each of ``dofs`` in the file's angles.
        number: its ``id``, as the file has it.
        notes: lines that gmr makes no use of, kept for writing: ``bodymass``, and ``cofmass``, the place of
            the centre of mass along the bone in file units.
    """

    name: str
    direction: Vector
    length: float
    axis: Vector = (0.0, 0.0, 0.0)
    axis_order: str = "XYZ"
    dofs: tuple[str, ...] = ()
    limits: tuple[Limits, ...] = ()
    number: str = "0"
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Acclaim:
    """The contents of an ASF: J - 1 bones and a root make J joints, the root first.

    Args:
        root: the root.
        bones: the others, as the file lists them.
        parents: (J - 1,) the joint that each bone begins at; 0 is the root, k + 1 the end of bone k.
        length: file units of an inch, as ``units length`` says; 1: nobody said.
        mass: as ``units mass`` says.
        radians: the file's angles are radians, else degrees.
        name: as ``:name`` says.
        version: as ``:version`` says.
        documentation: the lines of ``:documentation``.
        notes: the comments at the beginning.
    """

    root: Root
    bones: tuple[Bone, ...]
    parents: tuple[int, ...]
    length: float = 1.0
    mass: float = 1.0
    radians: bool = False
    name: str = "gmr"
    version: str = "1.10"
    documentation: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def unit(self) -> float | None:
        """Metres per file unit; None where ``length`` is 1, as in files whose writer never thought of it."""
        return None if self.length == 1 else INCH / self.length

    @property
    def limits(self) -> Mapping[str, Mapping[str, Limits]]:
        """Least and greatest value by bone and degree of freedom: ``limits["lfemur"]["rx"]``, in the file's
        angles."""
        return {bone.name: dict(zip(bone.dofs, bone.limits, strict=True)) for bone in self.bones}

    @cached_property
    def skeleton(self) -> Skeleton:
        """The joints; the root turns with slot 0, a bone with degrees of freedom with a slot of its own."""
        count = len(self.bones) + 1
        offsets = np.zeros((count, 3))
        for k, bone in enumerate(self.bones):
            offsets[k + 1] = np.multiply(bone.direction, bone.length)
        turns = np.array([True, *(bool(bone.dofs) for bone in self.bones)])
        return Skeleton(
            names=("root", *(bone.name for bone in self.bones)),
            parents=np.array([-1, *self.parents], np.int32),
            offsets=offsets,
            slots=np.where(turns, np.cumsum(turns) - 1, -1).astype(np.int32),
            slot_count=int(turns.sum()),
            ends=np.zeros(count, np.uint8),
        )

    @cached_property
    def channels(self) -> tuple[tuple[str, ...], ...]:
        """(J,) the names of each joint's values, in lower case."""
        return (tuple(name.lower() for name in self.root.order), *(bone.dofs for bone in self.bones))

    @cached_property
    def starts(self) -> NDArray[np.int32]:
        """(J + 1,) int32: a joint's values are the columns from its entry to the next one's."""
        counts = [0, *(len(names) for names in self.channels)]
        return read_only(np.cumsum(counts, dtype=np.int32))

    @property
    def column_count(self) -> int:
        """C, the values of a frame."""
        return int(self.starts[-1])

    @cached_property
    def turns(self) -> NDArray[np.bool_]:
        """(C,) bool: the column is an angle, else a length."""
        return read_only(np.array([name[0] == "r" for names in self.channels for name in names], bool))

    @cached_property
    def rotation_columns(self) -> NDArray[np.int32]:
        """(S, 3) int32: per slot the columns of its angles in composing order, -1 for none."""
        return read_only(self._steps[0])

    @cached_property
    def rotation_axes(self) -> NDArray[np.uint8]:
        """(S, 3) uint8: per slot the axes of its angles in composing order."""
        return read_only(self._steps[1])

    @cached_property
    def _steps(self) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
        joints = self.slot_joints
        columns = np.full((len(joints), 3), -1, np.int32)
        axes = np.zeros((len(joints), 3), np.uint8)
        for slot, joint in enumerate(joints):
            listed = [(k, name) for k, name in enumerate(self.channels[joint]) if name[0] == "r"]
            for step, (k, name) in enumerate(reversed(listed)):
                columns[slot, step] = self.starts[joint] + k
                axes[slot, step] = "xyz".index(name[1])
        return columns, axes

    @cached_property
    def slot_joints(self) -> tuple[int, ...]:
        """(S,) the joint at the end of the bone that each slot turns."""
        return (0, *(k + 1 for k, bone in enumerate(self.bones) if bone.dofs))

    @cached_property
    def translation_columns(self) -> tuple[int, int, int]:
        """The columns of the root's x, y and z; -1 for none."""
        names = self.channels[0]
        x, y, z = (names.index(name) if name in names else -1 for name in ("tx", "ty", "tz"))
        return x, y, z

    @cached_property
    def frames(self) -> NDArray[np.float64]:
        """(S, 4) float64 xyzw: the rotation ``C`` of the axes that each slot turns about."""
        told = [(self.root.orientation, self.root.axis_order)]
        told += [(bone.axis, bone.axis_order) for bone in self.bones if bone.dofs]
        angles = np.array([numbers for numbers, _ in told], np.float64).reshape(1, -1)
        columns = np.arange(angles.size, dtype=np.int32).reshape(-1, 3)[:, ::-1]
        axes = np.array([["XYZ".index(axis) for axis in reversed(order)] for _, order in told], np.uint8)
        found = np.empty((1, len(told), 4))
        degrees = np.degrees(angles) if self.radians else angles
        _core.euler_to_quaternions(degrees, np.ascontiguousarray(columns), axes, found)
        return read_only(found[0])

    def scaled(self, factor: float) -> Acclaim:
        """The same skeleton in a unit in which every length, ``cofmass`` too, is ``factor`` times the number
        that it was."""
        x, y, z = (factor * value for value in self.root.position)
        return replace(
            self,
            root=replace(self.root, position=(x, y, z)),
            bones=tuple(
                replace(
                    bone,
                    length=bone.length * factor,
                    notes=tuple(_scaled_note(note, factor) for note in bone.notes),
                )
                for bone in self.bones
            ),
            length=self.length if self.length == 1 else self.length * factor,
        )

    def mirrored(self, pair: Sequence[int]) -> Acclaim:
        """The mirror image across x = 0: each bone as its partner's image, under its own name.

        Args:
            pair: (J,) the image of each joint.
        """
        bones = []
        for k, bone in enumerate(self.bones):
            image = self.bones[pair[k + 1] - 1]
            signs = [_MIRRORED_ANGLES[dof[1]] for dof in image.dofs]
            mirrored = replace(
                image,
                name=bone.name,
                number=bone.number,
                direction=_signed(image.direction, _MIRRORED_LENGTHS),
                axis=_mirrored_angles(image.axis, image.axis_order),
                limits=tuple(
                    (low, high) if sign > 0 else (-high, -low)
                    for (low, high), sign in zip(image.limits, signs, strict=True)
                ),
            )
            bones.append(mirrored)
        root = replace(
            self.root,
            position=_signed(self.root.position, _MIRRORED_LENGTHS),
            orientation=_mirrored_angles(self.root.orientation, self.root.axis_order),
        )
        return replace(self, root=root, bones=tuple(bones))


def _scaled_note(note: str, factor: float) -> str:
    """The line in the new unit: ``cofmass`` is a distance along the bone; what is no number stays."""
    word, _, told = note.partition(" ")
    if word.lower() != "cofmass" or not _NUMBER.fullmatch(told):
        return note
    return f"{word} {_core.format_rows(np.array([[float(told) * factor]])).decode().strip()}"


def _mirrored_angles(angles: Vector, order: str) -> Vector:
    """The angles of the mirror image of a rotation: those about y and z change their sign."""
    return _signed(angles, [_MIRRORED_ANGLES[axis.lower()] for axis in order])


def _signed(numbers: Vector, signs: Sequence[float]) -> Vector:
    # A negative zero would be written as one.
    x, y, z = (sign * number + 0.0 for sign, number in zip(signs, numbers, strict=True))
    return x, y, z
