"""``gmr info``: what is in a motion, and what is odd about it."""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from gmr.cli.characters import character_json, character_page, described_character, holds_character
from gmr.cli.common import Failures, files_of, progress, read_noting, reading_options
from gmr.cli.markers import marker_json, marker_page
from gmr.cli.pages import overview, page

if TYPE_CHECKING:
    from gmr.description import Description
    from gmr.markers.description import MarkerDescription
    from gmr.motion import Motion
    from gmr.skinning.description import CharacterDescription

__all__ = ["info"]

FEW: Final = 3
"""Files that get a page each; more get a line each."""


@click.command(short_help="What is in a file, and what is odd about it.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--json", "as_json", is_flag=True, help="Print JSON: an object for one file, a list for more.")
@click.option(
    "--relation", metavar="NAME|FILE",
    help="C3D: which marker is on which part: ior, plug_in_gait or a file; told by the labels otherwise.",
)  # fmt: skip
@reading_options
def info(
    files: tuple[str, ...],
    as_json: bool,
    relation: str | None,
    positions: str,
    asf: str | None,
    amc_fps: float | None,
    animation: str | None,
    strict: bool,
) -> int:
    """Tell what is in files of motions, markers and characters, and what is odd about them.

    FILE is a file, a folder (all motions in it and below) or - for standard input. Units and the axis that
    points up are guessed from the body, and said to be guesses.

    \b
    Examples:
      gmr info walk.bvh
      gmr info takes/                       a line for each, and what is odd about which
      gmr info 07_01.amc --asf actor.asf
      gmr info --json takes/ | jq '.[] | select(.oddities != []) | .file'
      cat walk.bvh | gmr info -
      gmr info walk.c3d                     markers, gaps, flickering and exchanged ones
      gmr info fox.glb                      joints, meshes, materials, animations

    Exit codes: 0 done, 1 some files could not be read (they are named), 2 wrong usage, 130 interrupted.
    """
    failures = Failures()
    paths: list[Path | str] = []
    for file in files:
        with failures.of(file):
            paths += files_of(file)
    found: dict[str, Description] = {}
    recordings: dict[str, MarkerDescription] = {}
    characters: dict[str, CharacterDescription] = {}
    with progress(paths, "Reading") as watched:
        for path in watched:
            with failures.of(str(path)):
                if holds_character(path):
                    characters[str(path)] = described_character(path, strict=strict)
                    continue
                options = {"strict": strict, "positions": positions, "asf": asf, "fps": amc_fps}
                _describe(path, found, recordings, relation, animation=animation, **options)
    others = [*found, *characters]
    if relation is not None and others and not recordings:
        raise click.UsageError(
            f"--relation is for recordings of markers (C3D) only, but '{others[0]}' is none; leave it out."
        )
    if as_json:
        alone = len(files) == 1 and not Path(files[0]).is_dir()
        told = {path: marker_json(of) for path, of in recordings.items()}
        told |= {path: character_json(of) for path, of in characters.items()}
        click.echo(_as_json(found, told, failures.errors, alone))
        return failures.exit_code()
    pages = [overview(found)] if len(found) > FEW else [page(path, of) for path, of in found.items()]
    pages += [marker_page(path, of) for path, of in recordings.items()]
    pages += [character_page(path, of) for path, of in characters.items()]
    if pages:
        click.echo("\n\n".join(pages))
    return failures.exit_code()


def _as_json(
    found: dict[str, Description],
    others: dict[str, dict[str, Any]],
    errors: dict[str, str],
    alone: bool,
) -> str:
    """All that was found and what failed, as JSON."""
    entries = [{"file": path, **_plain(description)} for path, description in found.items()]
    entries += [{"file": path, **plain} for path, plain in others.items()]
    entries += [{"file": path, "error": error} for path, error in errors.items()]
    return json.dumps(entries[0] if alone else entries, indent=2, allow_nan=False)


def _describe(
    path: Path | str,
    found: dict[str, Description],
    recordings: dict[str, MarkerDescription],
    relation: str | None,
    **options: Any,
) -> None:
    """Puts the description of a file where it belongs."""
    from gmr.description import describe
    from gmr.markers import Markers
    from gmr.markers.description import describe_markers

    read: Motion | Markers
    read, warnings = read_noting(path, **options)
    odd = [_without_place(warning, read.name) for warning in warnings]
    if isinstance(read, Markers):
        recordings[str(path)] = describe_markers(read, odd, relation)
    else:
        found[str(path)] = describe(read, odd, _skeleton_of(read, options["asf"]))


def _skeleton_of(motion: Motion, asf: str | None) -> str | None:
    """The ASF that the skeleton of an AMC was read from; None for other motions, and for an ASF alone."""
    from gmr.dof_rows import DofRows
    from gmr.formats.asf_finder import asf_beside

    if not isinstance(motion.source, DofRows) or not motion.frame_count:
        return None
    return str(asf_beside(motion.name)) if asf is None else asf


def _without_place(warning: str, name: str | None) -> str:
    """The warning without the file's name, which stands above it, and with its line in words."""
    return re.sub(r"^(\d+)(:\d+)?:", r"line \1:", warning.removeprefix(f"{name}:").strip())


def _plain(description: Description) -> dict[str, Any]:
    """The description as JSON has it."""
    plain = asdict(description)
    plain["joint_count"] = len(description.joints)
    return plain
