"""Which ASF file an AMC file moves."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path, PurePath

from gmr.errors import FormatError

__all__ = ["asf_beside", "asf_contents", "find_asf", "serving_asf"]


def find_asf(amc: str, beside: Iterable[str]) -> str | None:
    """The name of the ASF of an AMC, of the names of the files beside it; None where none suits.

    In this order, letters of any case: the same name (``walk.amc``, ``walk.asf``); the name up to an
    underscore, the longest first (``07_01.amc``, ``07.asf``, the habit of the CMU database); the only one.
    """
    return _chosen(amc, _by_stem(beside))


def _chosen(amc: str, found: dict[str, str]) -> str | None:
    """The one of ``found`` that suits ``amc``."""
    for stem in _stems(PurePath(amc).stem.lower()):
        if stem in found:
            return found[stem]
    return next(iter(found.values())) if len(found) == 1 else None


def _by_stem(names: Iterable[str]) -> dict[str, str]:
    """The ASF files among ``names`` by their names without suffix, in lower case."""
    return {PurePath(name).stem.lower(): name for name in sorted(names) if _is_asf(name)}


def serving_asf(names: Iterable[str]) -> set[str]:
    """Of the names of the files in one folder, the ASF files that are the skeleton of an AMC there."""
    held = list(names)
    skeletons = _by_stem(held)
    served = {_chosen(name, skeletons) for name in held if name.lower().endswith(".amc")} if skeletons else ()
    return {name for name in served if name is not None}


def asf_contents(asf: str | os.PathLike[str] | bytes | None, amc: str | None) -> tuple[str | None, bytes]:
    """The name and the bytes of the ASF that was given, or that is found beside ``amc``.

    Raises:
        FormatError: there is none; what was tried is said.
    """
    if isinstance(asf, bytes | bytearray | memoryview):
        return None, bytes(asf)
    path = asf_beside(amc) if asf is None else Path(asf)
    try:
        return str(path), path.read_bytes()
    except OSError as error:
        what = f"the ASF of {amc or 'this motion'} cannot be read: {error.strerror}"
        raise FormatError(what, file=str(path)) from error


def asf_beside(amc: str | None) -> Path:
    """The ASF that is found beside ``amc``.

    Raises:
        FormatError: there is none; what was tried is said.
    """
    if amc is None:
        raise FormatError("an AMC needs its skeleton: give its ASF, a path or bytes, as asf=...")
    folder = Path(amc).parent
    try:
        beside = [entry.name for entry in os.scandir(folder)]
    except OSError as error:
        what = f"its skeleton cannot be looked for in '{folder}': {error.strerror}. Give its ASF as asf=..."
        raise FormatError(what, file=amc) from error
    name = find_asf(amc, beside)
    if name is not None:
        return folder / name
    count = sum(map(_is_asf, beside))
    tried = [f"{stem}.asf" for stem in _stems(PurePath(amc).stem)]
    there = (
        "no other .asf is there" if not count else f"there are {count} others, none of them surely its own"
    )
    what = f"no skeleton beside it: looked for {' and '.join(tried)} in '{folder}', and {there}"
    raise FormatError(f"{what}. Put its .asf there, or give it as asf=...", file=amc)


def _stems(stem: str) -> list[str]:
    """The names that are looked for, the longest first."""
    found = []
    while stem:
        found.append(stem)
        stem = stem.rpartition("_")[0]
    return found


def _is_asf(name: str) -> bool:
    return name.lower().endswith(".asf")
