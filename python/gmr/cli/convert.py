"""``gmr convert``: motions in, motions out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gmr.cli.common import (
    STDIO,
    Failures,
    Rate,
    Unit,
    files_of,
    naming,
    progress,
    read_noting,
    reading_options,
    say,
    write_output,
)
from gmr.cli.markers import Fitting, fitting_options
from gmr.cli.roots import Joints

if TYPE_CHECKING:
    from gmr.markers import Markers
    from gmr.motion import Motion

__all__ = ["convert"]


@dataclass(frozen=True)
class _Changes:
    """What is to be done to each motion."""

    fps: float | None
    unit: float | None
    from_unit: float | None
    drop_dummies: bool
    mirror: bool
    roots: tuple[str, ...] | None


@click.command(short_help="Convert motions: rate, unit, mirror image, dummies.")
@click.argument("source", metavar="IN")
@click.argument("target", metavar="OUT")
@click.option("--fps", type=Rate(), help="Resample to this rate: rotations by slerp.")
@click.option("--unit", type=Unit(), help="Convert to this unit: m, cm, mm, in, ft, cmu or metres per unit.")
@click.option(
    "--from-unit",
    type=Unit(),
    help="The unit that IN is in; guessed from the body, and said, otherwise.",
)
@click.option("--mirror", is_flag=True, help="Write the mirror image, left for right.")
@click.option(
    "--drop-dummies", is_flag=True, help="Leave out zero-length joints, all but those that BVH needs."
)
@click.option("--roots", type=Joints(), help="Make just these joints roots: see gmr roots.")
@reading_options
@fitting_options
def convert(
    source: str,
    target: str,
    fps: float | None,
    unit: float | None,
    from_unit: float | None,
    mirror: bool,
    drop_dummies: bool,
    roots: tuple[str, ...] | None,
    positions: str,
    asf: str | None,
    amc_fps: float | None,
    strict: bool,
    fitting: Fitting,
) -> int:
    """Convert a motion, or a folder of them.

    IN is a file, a folder (then OUT is one too, and gets the same tree) or - for standard input; OUT - is
    standard output. Without options every value is written as it was read. A file is replaced when its
    successor is whole. With an .amc its .asf is written beside it.

    \b
    Examples:
      gmr convert walk.bvh walk60.bvh --fps 60
      gmr convert takes/ mirrored/ --mirror
      gmr convert cmu.bvh metres.bvh --from-unit cmu --unit m
      gmr convert walk.bvh lean.bvh --drop-dummies
      gmr convert walk.bvh walk.amc
      gmr convert walk.bvh walk.gmr         GMR's own format: text, or binary as .gmrb
      gmr convert walk.bvh neck.bvh --roots Neck
      gmr convert - - --fps 30 < walk.bvh > walk30.bvh
      gmr convert walk.c3d walk.bvh         a motion from markers; see gmr info walk.c3d first
    """
    if from_unit is not None and unit is None:
        raise click.UsageError("--from-unit says what --unit converts from; give --unit too")
    changes = _Changes(fps, unit, from_unit, drop_dummies, mirror, roots)
    failures = Failures()
    guessed: dict[str, list[str]] = {}
    beside: list[str] = []
    with progress(_jobs(source, target), "Converting") as watched:
        for path, out in watched:
            with failures.of(str(path)):
                motion, warnings = read_noting(path, positions=positions, asf=asf, fps=amc_fps, strict=strict)
                for warning in warnings:
                    say(warning)
                motion = _fitted(motion, fitting)
                with naming(motion):
                    motion = _changed(motion, changes, guessed)
                beside += write_output(motion, out)
    for guess, names in guessed.items():
        say(f"{_several(names)} taken to be in {guess}; state another unit with --from-unit")
    if beside:
        say(f"the skeleton is in {beside[0] if len(beside) == 1 else f'{len(beside)} .asf files beside'}")
    return failures.exit_code()


def _jobs(source: str, target: str) -> list[tuple[Path | str, Path | str]]:
    """Each input with the place that it goes to."""
    from gmr.formats.registry import suffixes

    if source != STDIO and Path(source).is_dir():
        if target == STDIO or Path(target).is_file():
            raise click.UsageError(f"'{source}' is a folder, so OUT must be a folder too, not '{target}'")
        if not Path(target).exists() and Path(target).suffix.lower() in suffixes():
            raise click.UsageError(
                f"'{source}' is a folder, so OUT must be a folder too, but '{target}' is called like a file; "
                "give a name without the suffix"
            )
        return [(path, Path(target, Path(path).relative_to(source))) for path in files_of(source)]
    if target != STDIO and Path(target).is_dir():
        if source == STDIO:
            raise click.UsageError(f"'{target}' is a folder; name the file to write")
        return [(source, Path(target, Path(source).name))]
    if target != STDIO:
        _check_suffix(target)
    return [(source, target)]


def _check_suffix(target: str) -> None:
    """Refuses a place that no format has the suffix of before anything is read."""
    from gmr.errors import FormatError
    from gmr.formats.registry import format_of_file

    try:
        format_of_file(target)
    except FormatError as error:
        raise click.UsageError(str(error)) from error


def _fitted(found: Motion | Markers, fitting: Fitting) -> Motion:
    """The motion that was read, or that is made of the markers that were."""
    from gmr.markers import Markers

    return fitting.motion(found) if isinstance(found, Markers) else found


def _changed(motion: Motion, changes: _Changes, guessed: dict[str, list[str]]) -> Motion:
    """The motion after all that was asked for; a unit that had to be guessed is noted in ``guessed``."""
    if changes.mirror:
        motion = motion.mirror()
    if changes.drop_dummies:
        motion = motion.drop_dummies()
    if changes.roots is not None:
        motion = motion.with_roots(changes.roots)
    if changes.fps is not None:
        motion = motion.resample(changes.fps)
    if changes.unit is not None:
        motion = _in_known_unit(motion, changes.from_unit, guessed).to_unit(changes.unit)
    return motion


def _in_known_unit(motion: Motion, stated: float | None, guessed: dict[str, list[str]]) -> Motion:
    """The motion with the unit that was stated, or is guessed from the body."""
    from gmr.errors import GmrError
    from gmr.guesses import guess_body

    if stated is not None:
        return motion.with_unit(stated)
    if motion.unit is not None:
        return motion
    guess = guess_body(motion).unit
    if guess is None:
        raise GmrError(f"{motion.name}: no unit makes this body a human's; state it with --from-unit")
    said = f"{guess.name} ({guess.metres:.4g} m), in which the body is a human's"
    guessed.setdefault(said, []).append(str(motion.name))
    return motion.with_unit(guess.metres)


def _several(names: list[str]) -> str:
    """One name, or a count of several."""
    return names[0] if len(names) == 1 else f"{len(names)} motions ({names[0]}, ...)"
