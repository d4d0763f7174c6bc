"""How commands that evaluate tell what was left out, and what could not be written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import click

from gmr.cli.progress import Phases
from gmr.errors import GmrError
from gmr.listing import listed

__all__ = [
    "alike",
    "at_place",
    "left_out",
    "refuse_inside",
    "refuse_one_place",
    "trouble_with_files",
    "within",
]


def left_out(failed: Mapping[str, str]) -> Iterator[str]:
    """A sentence for each reason for which files were left out."""
    for why, files in alike(failed).items():
        named = len(files) == 1 and files[0] in why
        yield f"left out {why}" if named else f"left out {listed(files, 5)}: {why}"


def alike(failed: Mapping[str, str]) -> dict[str, list[str]]:
    """Those of one reason, by the reason."""
    found: dict[str, list[str]] = {}
    for name, why in failed.items():
        found.setdefault(why, []).append(name)
    return found


def within(place: Path, folder: Path) -> bool:
    """Whether a place is a folder, or in it."""
    return folder.resolve() in (place.resolve(), *place.resolve().parents)


def refuse_inside(out: Path, dataset: Path, option: str) -> None:
    """Refuses a folder for clips that is part of the dataset which they come from, or is the dataset."""
    if within(out, dataset):
        where = "is the dataset itself" if within(dataset, out) else f"lies in {dataset}"
        raise click.UsageError(
            f"{out} {where}, and would be read as a part of it the next time; "
            f"give {option} a place elsewhere."
        )


def refuse_one_place(one: tuple[str, Path], other: tuple[str, Path]) -> None:
    """Refuses two options, each with its folder, of which one would write into what the other has written."""
    (option, place), (second, elsewhere) = one, other
    inside, around = within(place, elsewhere), within(elsewhere, place)
    if inside or around:
        where = f"are both {place}" if inside and around else f"are {place} and {elsewhere}, one in the other"
        raise click.UsageError(
            f"{option} and {second} {where}: what one writes the other would overwrite or add to; give them "
            "folders apart from each other."
        )


@contextmanager
def at_place(place: Path) -> Iterator[None]:
    """An error of a disk names no file, or one that was only there while writing: it is given ``place``."""
    try:
        yield
    except OSError as error:
        error.filename = str(place)
        raise


@contextmanager
def trouble_with_files(phases: Phases) -> Iterator[None]:
    """A file that cannot be written, on a full disk or elsewhere, is one sentence."""
    try:
        yield
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        raise GmrError(
            f"{place}{error.strerror or error} (while {phases.current}); no file was left half-written"
        ) from error
