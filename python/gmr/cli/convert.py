"""``gmr convert``: motions in, motions out."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import click

from gmr.cli.common import (
    STDIO,
    Failures,
    Rate,
    Unit,
    naming,
    progress,
    read_noting,
    reading_options,
    say,
    write_output,
)
from gmr.cli.markers import Fitting, fitting_options
from gmr.cli.roots import Joints
from gmr.cli.targets import Job, Written, jobs_of

if TYPE_CHECKING:
    from gmr.formats.registry import Format
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


@dataclass
class _Report:
    """What became of the inputs, for people and for programs."""

    written: list[dict[str, Any]] = field(default_factory=list)
    beside: list[str] = field(default_factory=list)
    guessed: dict[str, list[str]] = field(default_factory=dict)
    fitted: bool = False

    def add(self, job: Job, motion: Motion, beside: list[str]) -> None:
        """One input is written."""
        place = {"file": str(job.source), "out": str(job.out)}
        self.written.append({**place, "beside": beside, "frames": motion.frame_count, "fps": motion.fps})
        self.beside += beside

    def say(self, failures: Failures, inputs: int) -> None:
        """The end of the work in sentences: what was taken for granted, and what failed."""
        for guess, names in self.guessed.items():
            say(f"{_several(names)} taken to be in {guess}; state another unit with --from-unit")
        if self.beside:
            several = f"{len(self.beside)} .asf files beside"
            say(f"the skeleton is in {self.beside[0] if len(self.beside) == 1 else several}")
        if failures.errors and inputs > 1:
            say(f"{len(failures.errors)} of {inputs} files failed: {', '.join(failures.errors)}")

    def as_json(self, failures: Failures) -> str:
        """The same for programs."""
        failed = [{"file": name, "error": error} for name, error in failures.errors.items()]
        return json.dumps({"written": self.written, "failed": failed}, indent=2, allow_nan=False)


@click.command(short_help="Convert motions: format, rate, unit, mirror image, dummies.")
@click.argument("source", metavar="IN")
@click.argument("target", metavar="OUT")
@click.option(
    "--to",
    type=Written(),
    help="The format to write: bvh, amc, gmr, glb, ...; told by the suffix otherwise, and in a folder kept.",
)
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
    to: Format | None,
    fps: float | None,
    unit: float | None,
    from_unit: float | None,
    mirror: bool,
    drop_dummies: bool,
    roots: tuple[str, ...] | None,
    positions: str,
    asf: str | None,
    amc_fps: float | None,
    animation: str | None,
    strict: bool,
    fitting: Fitting,
) -> int:
    """Convert a motion, or a folder of them.

    IN is a file, a folder (then OUT is one too, and gets the same tree) or - for standard input; OUT - is
    standard output. Without options every value is written as it was read. A file is replaced when its
    successor is whole. With an .amc its .asf is written beside it. Files of a folder that cannot be converted
    are named, and the others written.

    \b
    Examples:
      gmr convert walk.bvh walk60.bvh --fps 60
      gmr convert takes/ mirrored/ --mirror
      gmr convert takes/ out/ --to bvh      every .amc, .bvh, .gmr and .gmrb, below too, becomes a .bvh
      gmr convert cmu.bvh metres.bvh --from-unit cmu --unit m
      gmr convert walk.bvh lean.bvh --drop-dummies
      gmr convert walk.bvh walk.amc
      gmr convert walk.bvh walk.gmr         GMR's own format: text, or binary as .gmrb
      gmr convert walk.bvh walk.glb --unit m    glTF, which is in metres: nodes that move
      gmr convert walk.bvh neck.bvh --roots Neck
      gmr convert - - --fps 30 < walk.bvh > walk30.bvh
      gmr convert walk.bvh walk.x3d         a humanoid of H-Anim that X3D browsers play
      gmr convert walk.c3d walk.bvh         a motion from markers; see gmr info walk.c3d first

    Exit codes: 0 done, 1 some files could not be converted (they are named), 2 wrong usage, 130 interrupted.
    """
    if fitting.as_json and target == STDIO:
        raise click.UsageError(
            "--json is printed on standard output, where the motion goes; name a file as OUT"
        )
    changes = _Changes(fps, unit, from_unit, drop_dummies, mirror, roots)
    failures, report = Failures(), _Report()
    jobs = jobs_of(source, target, to)
    if from_unit is not None and unit is None and not any(_is_in_metres(job) for job in jobs):
        raise click.UsageError("--from-unit says what --unit converts from; give --unit too")
    with progress(jobs, "Converting") as watched:
        for job in watched:
            with failures.of(str(job.source)):
                found, warnings = read_noting(
                    job.source, positions=positions, asf=asf, fps=amc_fps, animation=animation, strict=strict
                )
                for warning in warnings:
                    say(warning)
                motion = _fitted(found, fitting, report)
                with naming(motion):
                    motion = _changed(motion, changes, report.guessed)
                    if _is_in_metres(job):
                        motion = _in_known_unit(motion, changes.from_unit, report.guessed)
                report.add(job, motion, write_output(motion, job.out, job.format))
    report.say(failures, len(jobs))
    if fitting.as_json and not report.fitted:
        click.echo(report.as_json(failures))
    return failures.exit_code()


def _is_in_metres(job: Job) -> bool:
    """Whether what is written is in metres, so that the unit of the motion must be known."""
    from gmr.formats.registry import FORMATS, format_of_file, named_format

    if job.format is not None:
        return named_format(job.format).in_metres
    return (FORMATS[0] if job.out == STDIO else format_of_file(str(job.out))).in_metres


def _fitted(found: Motion | Markers, fitting: Fitting, report: _Report) -> Motion:
    """The motion that was read, or that is made of the markers that were.

    Raises:
        UsageError: a motion was read, and options for markers are given.
    """
    from gmr.markers import Markers

    if not isinstance(found, Markers):
        fitting.check_unneeded(found)
        return found
    report.fitted = True
    return fitting.motion(found)


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
