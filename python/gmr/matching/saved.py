"""A motion database in a file.

The core writes and maps the arrays, with what every program needs to know of them. What only Python knows of
a database stands beside that as JSON: skeleton, schema in seconds, roles of the joints, units, notes.
"""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from gmr import _core
from gmr.arrays import read_only
from gmr.body.joints import Joints
from gmr.errors import FormatError
from gmr.matching.schema import Group, Schema
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.matching.database import Database

__all__ = ["contents", "save"]

_NOTE = "python"
"""The name under which the core keeps what only Python knows."""


def save(database: Database, path: str | os.PathLike[str]) -> None:
    """See :meth:`gmr.matching.Database.save`."""
    known = {
        "skeleton": _described(database.skeleton),
        "schema": [
            {
                "name": group.name,
                "measure": group.measure,
                "joint": group.joint,
                "times": list(group.times),
                "weight": group.weight,
            }
            for group in database.schema.groups
        ],
        "roles": dict(database.joints.roles),
        "found_by": database.joints.found_by,
        "mirrored": database.mirrored.tolist(),
        "units": dict(database.units),
        "notes": list(database.notes),
        "excluded": dict(database.excluded),
        "duplicates": dict(database.duplicates),
        "starts": database.starts.tolist(),
    }
    _core.save_database(
        database.core,
        os.fspath(path),
        list(database.skeleton.names),
        list(database.clip_names),
        {_NOTE: json.dumps(known)},
    )


def contents(path: str | os.PathLike[str], check: bool) -> dict[str, Any]:
    """The fields of the :class:`gmr.matching.Database` in a file, whose index may be held against its rows.

    Raises:
        FormatError: it is no saved database, one that no Python program saved, or one that fails the check.
    """
    try:
        core, names, clip_names, notes = _core.open_database(os.fspath(path))
        if check:
            _core.check_database(core)
    except ValueError as error:
        raise FormatError(str(error).removeprefix(f"{os.fspath(path)}: "), file=os.fspath(path)) from error
    try:
        known = json.loads(notes[_NOTE])
        fields = {
            "core": core,
            "schema": Schema(tuple(_group(group) for group in known["schema"])),
            "skeleton": _skeleton(known["skeleton"], tuple(names)),
            "joints": Joints(dict(known["roles"]), known["found_by"]),
            "clip_names": tuple(clip_names),
            "mirrored": read_only(np.array(known["mirrored"], bool)),
            "units": dict(known["units"]),
            "notes": tuple(known["notes"]),
            "excluded": dict(known["excluded"]),
            # Databases saved before duplicates were left out have none to tell of.
            "duplicates": dict(known.get("duplicates", {})),
            "starts": read_only(np.array(known["starts"], np.float64)),
        }
        _check(fields)
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise FormatError(
            f"what Python keeps of the database is missing or damaged ({error!r:.200}). Save it again from "
            "Python; from Rust it can be opened as it is.",
            file=os.fspath(path),
        ) from error
    return fields


def _check(fields: dict[str, Any]) -> None:
    """ValueError: what Python knows is of another database than the arrays."""
    core, skeleton, clips = fields["core"], fields["skeleton"], len(fields["clip_names"])
    counts = {
        "clips mirrored": (len(fields["mirrored"]), clips),
        "clips with a start": (len(fields["starts"]), clips),
        "features": (fields["schema"].dims, core.features.shape[1]),
        "joints": (len(skeleton.names), core.positions.shape[1]),
        "slots": (skeleton.slot_count, core.rotations.shape[1]),
    }
    for what, (found, needed) in counts.items():
        if found != needed:
            raise ValueError(f"{found} {what} are told of, where there are {needed}")
    if any(not 0 <= joint < len(skeleton.names) for joint in fields["joints"].roles.values()):
        raise ValueError("a role is that of a joint which is not there")


def _described(skeleton: Skeleton) -> dict[str, Any]:
    return {
        "parents": skeleton.parents.tolist(),
        "offsets": skeleton.offsets.tolist(),
        "slots": skeleton.slots.tolist(),
        "slot_count": skeleton.slot_count,
        "ends": skeleton.ends.tolist(),
        "home": None if skeleton.home is None else _described(skeleton.home),
    }


def _skeleton(told: dict[str, Any], names: tuple[str, ...]) -> Skeleton:
    home = told["home"]
    return Skeleton(
        names=names,
        parents=np.array(told["parents"], np.int32),
        offsets=np.array(told["offsets"], np.float64).reshape(-1, 3),
        slots=np.array(told["slots"], np.int32),
        slot_count=told["slot_count"],
        ends=np.array(told["ends"], np.uint8),
        home=None if home is None else _skeleton(home, names),
    )


def _group(told: dict[str, Any]) -> Group:
    return Group(told["name"], told["measure"], told["joint"], tuple(told["times"]), told["weight"])
