"""A GMR binary file to a motion whose frames stay in the file until they are asked for.

The header and the small arrays are read and checked; the frames are views of the file's memory. So nobody has
looked whether their numbers are finite, unless ``strict``. The format: docs/gmr-format.md.
"""

from __future__ import annotations

import json
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.channels import ChannelLayout
from gmr.configurations import arranged
from gmr.errors import FormatError, GmrError
from gmr.formats.gmr_content import check, off_length
from gmr.formats.numerals import number
from gmr.formats.safetensors import Container, read_container
from gmr.formats.text import named
from gmr.frames import Pose, Rows
from gmr.motion import Motion
from gmr.skeleton import End, Skeleton

__all__ = ["read_gmr_binary"]

VERSION = "1"


def read_gmr_binary(data: bytes | memoryview, *, name: str | None = None, strict: bool = False) -> Motion:
    """Motion of a GMR binary file.

    Args:
        data: the file's bytes, or its map in memory, which the motion then holds on to.
        name: the file's name, for errors and for the motion.
        strict: look at every number, and raise where one is not finite, or a quaternion not of length 1.

    Raises:
        FormatError: the file cannot be read; the message says why, and what to do.
    """
    reader = _Reader(read_container(data, name), name)
    motion = reader.motion()
    if strict:
        check(motion)
        if isinstance(motion.source, Pose) and (off := off_length(motion.source)):
            raise FormatError(f"{off}. Divide them by their lengths.", file=name)
    return motion


class _Reader:
    def __init__(self, held: Container, name: str | None) -> None:
        self.held = held
        self.name = name

    def motion(self) -> Motion:
        found, version = self.held.metadata.get("format"), self.held.metadata.get("version", "none")
        if found != "gmr":
            self.wrong(
                "this safetensors file holds no motion: its metadata has no format 'gmr'. Check what it is."
            )
        if version != VERSION:
            self.wrong(f"the version is {named(version)}, but this gmr reads {VERSION}. Install a newer gmr.")
        names = self.names()
        home_parents = self.joints("home_parents" if self.is_moved else "parents", len(names))
        layout = self.layout(home_parents)
        skeleton = self.skeleton(names, home_parents, layout)
        source = self.source(skeleton, layout)
        frame_time = self.seconds_or_metres("frame_time")
        unit = self.seconds_or_metres("unit") if "unit" in self.held.metadata else None
        try:
            return Motion(skeleton, frame_time, source, unit, self.name)
        except GmrError as error:
            self.wrong(f"{error!s:.300}.")

    @property
    def is_moved(self) -> bool:
        """Whether this is another configuration than that at home."""
        return any(key.startswith("home_") for key in self.held.tensors)

    def wrong(self, what: str) -> NoReturn:
        raise FormatError(what, file=self.name)

    def names(self) -> list[str]:
        names = self.json("names")
        if not isinstance(names, list) or not names or not all(isinstance(one, str) for one in names):
            self.wrong("names in the metadata is no JSON list of strings. Write the name of each joint.")
        return names

    def layout(self, parents: NDArray[np.int32]) -> ChannelLayout | None:
        """The channels of the post-rotation file that this one came from."""
        if "post" not in self.held.metadata:
            return None
        post = self.json("post")
        listed = post.get("channels") if isinstance(post, dict) else None
        if (
            not isinstance(listed, list)
            or not all(isinstance(own, list) and all(isinstance(one, str) for one in own) for own in listed)
            or post.get("positions") not in ("replace", "add")
        ):
            self.wrong(
                "post in the metadata has no lists of channels, or positions that neither replace nor add."
            )
        try:
            channels = tuple(tuple(own) for own in listed)
            return ChannelLayout(channels, tuple(parents.tolist()), post["positions"] == "add")
        except GmrError as error:
            self.wrong(f"post in the metadata: {error!s:.300}.")

    def skeleton(
        self, names: list[str], home_parents: NDArray[np.int32], layout: ChannelLayout | None
    ) -> Skeleton:
        count = len(names)
        prefix = "home_" if self.is_moved else ""
        ends = self.small("ends", ("U8",), (count,))
        if (ends > max(End)).any():
            self.wrong("ends holds other numbers than 0 (joint), 1 (end site) and 2 (tip). Correct them.")
        offsets = self.small(f"{prefix}offsets", ("F64", "F32"), (count, 3))
        if not np.isfinite(offsets).all():
            self.wrong(f"{prefix}offsets holds numbers that are not finite. Correct them.")
        slots = self.joints(f"{prefix}slots", count)
        used = max(int(slots.max(initial=-1)) + 1, 0 if layout is None else len(layout.slot_joints))
        try:
            home = Skeleton(tuple(names), home_parents, offsets, slots, used, ends)
        except GmrError as error:
            self.wrong(f"{error!s:.300}. Correct the arrays.")
        if layout is not None and not layout.fits(home):
            self.wrong(
                f"{prefix}slots are not those of the channels in post. Leave out post, or correct them."
            )
        return self.configured(home) if self.is_moved else home

    def configured(self, home: Skeleton) -> Skeleton:
        """The configuration, which is wholly told by the parents; the rest must be as it says."""
        parents = self.joints("parents", home.joint_count)
        try:
            found = arranged(home, _core.Forest(home.topology, parents))
        except ValueError as error:
            self.wrong(f"parents is no configuration of home_parents: {error!s:.300}.")
        slots = self.small("slots", ("I32",), (home.joint_count,))
        offsets = self.small("offsets", ("F64", "F32"), (home.joint_count, 3))
        for key, given, wanted in (("slots", slots, found.slots), ("offsets", offsets, found.offsets)):
            wrong = np.flatnonzero((given != wanted).reshape(home.joint_count, -1).any(axis=1))
            if len(wrong):
                joint = int(wrong[0])
                told = f"is {given[joint]}, but the arrays of home and parents make it {wanted[joint]}"
                self.wrong(f"{key} of joint {named(home.names[joint])} {told}. Correct it.")
        return found

    def source(self, skeleton: Skeleton, layout: ChannelLayout | None) -> Rows | Pose:
        floats = ("F64", "F32")
        if "rows" in self.held.tensors:
            if layout is None or skeleton.home is not None or "rotations" in self.held.tensors:
                self.wrong("rows need post in the metadata, and neither rotations nor a home. Remove one.")
            if not layout.column_count and self.held.tensors["rows"].shape[:1] != (0,):
                self.wrong("rows has frames, but no column. Write rotations and translations.")
            return Rows(self.array("rows", floats, (None, layout.column_count)), layout)
        moving = self.array("translated", ("I32",), (None,)).tolist()
        lacking = set(skeleton.roots) - set(moving)
        if lacking or len(set(moving)) < len(moving) or not set(moving) <= set(range(skeleton.joint_count)):
            self.wrong("translated must hold all roots, no joint twice, and only joints. Correct it.")
        rotations = self.array("rotations", floats, (None, skeleton.slot_count, 4))
        translations = self.array("translations", floats, (len(rotations), len(moving), 3))
        return Pose(rotations, np.array(moving, np.int32), translations, layout)

    def joints(self, key: str, count: int) -> NDArray[np.int32]:
        """(count,) indices below ``count``, -1 for none."""
        found: NDArray[np.int32] = self.small(key, ("I32",), (count,))
        if ((found < -1) | (found >= count)).any():
            self.wrong(f"{key} holds numbers below -1 or above {count - 1}, but there are {count} joints.")
        return found

    def small(self, key: str, dtypes: tuple[str, ...], shape: tuple[int | None, ...]) -> NDArray[Any]:
        """A copy of an array, which does not keep the file mapped."""
        return read_only(self.array(key, dtypes, shape).copy())

    def array(self, key: str, dtypes: tuple[str, ...], shape: tuple[int | None, ...]) -> NDArray[Any]:
        """The array, if it has the type and shape that are wanted; None: any number of frames or joints."""
        tensor = self.held.tensors.get(key)
        if tensor is None:
            self.wrong(f"there is no array {key}. Write it.")
        fits = len(tensor.shape) == len(shape) and all(
            wanted in (None, found) for wanted, found in zip(shape, tensor.shape, strict=True)
        )
        if tensor.dtype not in dtypes or not fits:
            wanted = ", ".join("any" if n is None else str(n) for n in shape)
            self.wrong(
                f"{key} is {tensor.dtype} of the shape {list(tensor.shape)}; it must be {dtypes[0]} of "
                f"[{wanted}]. Correct it."
            )
        return self.held.array(key)

    def seconds_or_metres(self, key: str) -> float:
        text = self.held.metadata.get(key, "")
        value = number(text.encode(errors="replace"))
        if value is None:
            self.wrong(f"{key} in the metadata is {named(text)}. Write a decimal number.")
        return value

    def json(self, key: str) -> Any:
        try:
            return json.loads(self.held.metadata[key])
        except KeyError:
            self.wrong(f"there is no {key} in the metadata. Write them as a JSON text.")
        except (ValueError, RecursionError):
            self.wrong(f"{key} in the metadata is no JSON. Correct it.")
