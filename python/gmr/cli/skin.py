"""``gmr skin``: a motion drives a character, which is written as a moving GLB."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gmr.cli.common import Rate, naming, read_noting, reading_options, say
from gmr.cli.progress import Phases
from gmr.errors import FormatWarning

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skinning.character import Character
    from gmr.skinning.driving import Driven

__all__ = ["skin"]


@click.command(short_help="Let a motion drive a character; write it as GLB.")
@click.argument("character", metavar="CHARACTER")
@click.argument("motion", metavar="MOTION")
@click.argument("out", metavar="[OUT.glb]", required=False)
@click.option(
    "--compare",
    metavar="FOLDER",
    type=click.Path(file_okay=False),
    help="Write a page that compares ways of skinning, its pictures, film and tables.",
)
@click.option("--no-film", is_flag=True, help="Leave the film out of --compare: it takes longest to draw.")
@click.option(
    "--map",
    "names",
    metavar="FILE",
    type=click.Path(),
    help="Who follows whom, TOML or JSON: docs/driving.md.",
)
@click.option("--fps", type=Rate(), help="Frames a second of OUT; the motion's otherwise.")
@click.option("--rest", type=int, metavar="FRAME", help="The frame in which MOTION stands upright.")
@click.option(
    "--scale",
    type=click.FloatRange(0, min_open=True),
    help="Metres of way for each of MOTION's; legs tell it otherwise.",
)
@click.option("--no-ground", is_flag=True, help="Leave the feet where the turns of the bones put them.")
@click.option("--bind", is_flag=True, help="Bind a CHARACTER without a skin to MOTION's skeleton.")
@click.option("--json", "as_json", is_flag=True, help="Print the report as JSON.")
@reading_options
def skin(
    character: str,
    motion: str,
    out: str | None,
    compare: str | None,
    no_film: bool,
    names: str | None,
    fps: float | None,
    rest: int | None,
    scale: float | None,
    no_ground: bool,
    bind: bool,
    as_json: bool,
    positions: str,
    asf: str | None,
    amc_fps: float | None,
    animation: str | None,
    strict: bool,
) -> int:
    """Let a motion drive a character, and write the moving character.

    CHARACTER is a .glb or .gltf with a skin, or, with --bind, any mesh that stands in metres where MOTION's
    skeleton stands at rest; MOTION is a .bvh, an .amc, a .glb or any other motion. Their joints may have
    other names, their bones other lengths, and they may rest in other poses: what follows what is found by
    names, or by the shape of the body, and said. Vertices are bent by whoever shows OUT.glb; what linear
    blending, dual quaternions and centres of rotation make of them, --compare shows.

    \b
    Examples:
      gmr skin figure.glb walk.bvh walking.glb
      gmr skin figure.glb 07_01.amc walking.glb --fps 30 --json
      gmr skin figure.glb take.bvh moving.glb --map names.toml
      gmr skin figure.glb take.bvh moving.glb --rest 0    where the file has no rest pose of its own
      gmr skin body.obj walk.bvh walking.glb --bind
      gmr skin figure.glb walk.bvh --compare compared/    a page: what each way of skinning does

    Exit codes: 0 done, 1 a file could not be read, driven or written, 2 wrong usage, 130 interrupted.
    """
    _check(out, compare, no_film)
    from gmr.formats import write_character
    from gmr.skinning.driving import drive

    played, said = read_noting(
        motion, positions=positions, asf=asf, fps=amc_fps, animation=animation, strict=strict
    )
    if bind:
        with naming(played):
            played = _in_metres(played).to_post_rotation()
    shown, more = _character(character, played if bind else None, strict)
    for warning in [*said, *more]:
        say(warning)
    with naming(played):
        driven = drive(played, shown, names=names, fps=fps, root_scale=scale, ground=not no_ground, rest=rest)
    if out is not None:
        write_character(shown, out, driven.poses, driven.frame_time)
    page = None if compare is None else _compared(shown, driven, Path(motion).stem, compare, not no_film)
    frames = len(driven.poses)
    if as_json:
        written = {"character": character, "motion": motion, "out": out, "page": page, "frames": frames}
        click.echo(json.dumps({**written, **driven.report.as_dict()}, indent=2, allow_nan=False))
    else:
        click.echo(f"{out or motion}: {frames} frames, {frames * driven.frame_time:.2f} s\n{driven.report}")
        if page is not None:
            click.echo(f"compared: {page}")
    return 0


def _check(out: str | None, compare: str | None, no_film: bool) -> None:
    if out is None and compare is None:
        raise click.UsageError("nothing is asked for; name OUT.glb, or --compare FOLDER, or both")
    if out is not None and Path(out).suffix.lower() != ".glb":
        raise click.UsageError(f"'{out}': a moving character is written as .glb; name OUT so")
    if no_film and compare is None:
        raise click.UsageError("--no-film leaves out the film of --compare, which is not asked for")


def _compared(character: Character, driven: Driven, motion: str, folder: str, with_film: bool) -> str:
    """Writes the comparison, says what it comes to, and gives the page's path."""
    from gmr.skinning import comparison

    compared = comparison.compare(character, driven.poses, driven.frame_time, motion=motion)
    with Phases() as phases:
        page = comparison.write_comparison(compared, folder, with_film=with_film, progress=phases.tell)
    say(comparison.headline(compared))
    return str(page)


def _character(path: str, motion: Motion | None, strict: bool) -> tuple[Character, list[str]]:
    """The character, bound to a motion's skeleton where one is given, and oddities of its file."""
    from gmr.formats import read_character

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", FormatWarning)
        character = read_character(path, motion, strict=strict)
    return character, [str(one.message) for one in caught if issubclass(one.category, FormatWarning)]


def _in_metres(motion: Motion) -> Motion:
    from gmr.editing.scene import scene_of

    metres = 1 / scene_of(motion).unit.per_metre("--bind")
    return motion.with_unit(metres).to_unit("m")
