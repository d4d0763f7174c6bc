"""``gmr evaluate``: what a folder of locomotion clips can do, as a report."""

from __future__ import annotations

import json
import math
import shutil
import textwrap
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

import click

from gmr.cli.common import Unit, say
from gmr.cli.progress import Phases
from gmr.errors import GmrError
from gmr.listing import listed

if TYPE_CHECKING:
    from gmr.evaluation import Evaluation
    from gmr.matching.trial import Tracking

VALUES: Final = "START:STOP:STEP|A,B,C"
MOST_VALUES: Final = 10_000

EXAMPLES: Final = """
\b
Examples:
  gmr evaluate takes/                          report.html beside you
  gmr evaluate takes/ --mirror -o walks.html   with the mirror image of every clip
  gmr evaluate takes/ --tables figures/        every number as CSV and Parquet too
  gmr evaluate takes/ --speeds 0.5:4:0.5 --turn-rates -180:180:45
  gmr evaluate takes/ --preset mig2022         the pacing of the paper's authors
  gmr evaluate takes/ --name left_foot=foot_l --name right_foot=foot_r
  gmr evaluate takes/ --json > found.json      for a machine

\b
Exit codes: 0 all files were evaluated, 1 some or all could not be (they are named),
2 wrong usage, 130 interrupted.
"""


def _values(
    context: click.Context, option: click.Parameter, text: str | tuple[float, ...] | None
) -> tuple[float, ...] | None:
    """Numbers typed as START:STOP:STEP, both ends included, or with commas."""
    if not isinstance(text, str):
        return text
    try:
        if ":" not in text:
            return tuple(float(part) for part in text.split(","))
        start, stop, step = (float(part) for part in text.split(":"))
    except ValueError:
        raise click.BadParameter(f"{text!r} is neither START:STOP:STEP nor numbers with commas.") from None
    steps = (stop - start) / step if step else math.nan
    if not 0 <= steps < MOST_VALUES:
        raise click.BadParameter(f"from {start:g} to {stop:g} in steps of {step:g} is no list of numbers.")
    return tuple(round(start + index * step, 9) for index in range(math.floor(steps + 1e-9) + 1))


def _roles(context: click.Context, option: click.Parameter, pairs: tuple[str, ...] | None) -> dict[str, str]:
    """Joints typed as ROLE=JOINT."""
    roles: dict[str, str] = {}
    for text in pairs or ():
        role, _, joint = text.partition("=")
        if not (role and joint):
            raise click.BadParameter(f"{text!r} is not ROLE=JOINT, as in left_foot=foot_l.")
        if role in roles:
            raise click.BadParameter(f"'{role}' is named twice, {roles[role]} and {joint}; say which it is.")
        roles[role] = joint
    if roles:
        from gmr.body.naming import ROLES

        if unknown := [role for role in roles if role not in ROLES]:
            raise click.BadParameter(f"no role is called '{unknown[0]}'; the roles are {', '.join(ROLES)}.")
    return roles


@click.command(short_help="What a folder of locomotion clips can do, as a report.", epilog=EXAMPLES)
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option(
    "-o",
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("report.html"),
    show_default=True,
    help="Where the report goes.",
)
@click.option("--no-report", is_flag=True, help="Write no report.")
@click.option(
    "--tables",
    type=click.Path(file_okay=False, path_type=Path),
    help="Write all numbers into this folder, as CSV and as Parquet (as JSON where pyarrow is missing).",
)
@click.option("--mirror", is_flag=True, help="Add the mirror image of every clip.")
@click.option(
    "--tracking",
    type=click.Choice(["time", "velocity"]),
    default="time",
    show_default=True,
    help="Steer to where the path has the character at each time, or only ask for speed and turn rate.",
)
@click.option("--speeds", metavar=VALUES, callback=_values, help="Metres per second.  [default: 1:3:0.25]")
@click.option(
    "--turn-rates",
    metavar=VALUES,
    callback=_values,
    help="Degrees per second, positive to the left.  [default: -100:100:25]",
)
@click.option(
    "--preset", type=click.Choice(["mig2022"]), help="Pace the trials as the authors of the paper did."
)
@click.option(
    "--name",
    "names",
    metavar="ROLE=JOINT",
    multiple=True,
    callback=_roles,
    help="Say which joint is the hips, left_up_leg, right_up_leg, left_foot or right_foot. Repeatable.",
)
@click.option(
    "--unit", type=Unit(), help="Unit of length of the files: m, cm, mm, in, ft, cmu, or metres per unit."
)
@click.option("--threads", type=click.IntRange(min=1), help="How many to use.  [default: all cores]")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of the verdict.")
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def evaluate(
    folder: Path,
    out: Path,
    no_report: bool,
    tables: Path | None,
    mirror: bool,
    tracking: str,
    speeds: tuple[float, ...] | None,
    turn_rates: tuple[float, ...] | None,
    preset: str | None,
    names: dict[str, str],
    unit: float | None,
    threads: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Measure what a folder of locomotion clips can do, and write a report.

    A character made of the clips in FOLDER (and the folders in it) is sent along circles and straight
    lines at many speeds by motion matching. The verdict says which speeds and turns the clips cover, where
    they fail and why, which clips carry them, which are never played, and what to capture next. The report
    shows it all; it is one HTML file that opens without a network.
    """
    import gmr
    from gmr.evaluation.scenario import DEFAULT_SPEEDS, DEFAULT_TURN_RATES_DEG, constant_trials

    try:
        constant_trials(speeds or DEFAULT_SPEEDS, turn_rates or DEFAULT_TURN_RATES_DEG, preset or "even")
    except ValueError as error:
        raise click.UsageError(f"{error}.") from error
    phases = Phases(quiet)
    with phases, _trouble_with_files(phases):
        _check_places(None if no_report else out, tables, phases)
        found = gmr.evaluate(
            folder,
            preset=preset,
            mirror=mirror,
            tracking=cast("Tracking", tracking),
            speeds=speeds,
            turn_rates_deg=turn_rates,
            threads=threads,
            names=names,
            unit=unit,
            progress=phases.tell,
        )
        written = _write(found, None if no_report else out, tables, phases)
    click.echo(_summary(found, written) if as_json else _verdict(found, written))
    for sentence in _left_out(found.failed):
        say(sentence)
    return 1 if found.failed else 0


def _left_out(failed: Mapping[str, str]) -> Iterator[str]:
    """A sentence for each reason for which files were left out."""
    files: dict[str, list[str]] = {}
    for file, why in failed.items():
        files.setdefault(why, []).append(file)
    for why, alike in files.items():
        named = len(alike) == 1 and alike[0] in why
        yield f"left out {why}" if named else f"left out {listed(alike, 5)}: {why}"


def _check_places(out: Path | None, tables: Path | None, phases: Phases) -> None:
    """Learn before all the work that its results cannot be kept."""
    from gmr.replacing import check_place

    phases.current = "looking where to write"
    if tables is not None:
        with _naming(tables):
            check_place(tables / "trials.csv")
    if out is not None:
        with _naming(out):
            check_place(out)


def _write(found: Evaluation, out: Path | None, tables: Path | None, phases: Phases) -> dict[str, Any]:
    """Write what was asked for; the answer says where it lies."""
    written: dict[str, Any] = {}
    if tables is not None:
        phases.tell("writing tables", 0, 1)
        columnar = "parquet" if _has_pyarrow() else "json"
        with _naming(tables):
            written["tables"] = [str(path) for path in found.write_tables(tables, ("csv", columnar))]
        phases.tell("writing tables", 1, 1)
    if out is not None:
        phases.tell("writing the report", 0, 1)
        with _naming(out):
            out.parent.mkdir(parents=True, exist_ok=True)
            found.report(out)
        written["report"] = str(out)
        phases.tell("writing the report", 1, 1)
    return written


def _has_pyarrow() -> bool:
    from importlib.util import find_spec

    return find_spec("pyarrow") is not None


def _verdict(found: Evaluation, written: Mapping[str, Any]) -> str:
    width = min(shutil.get_terminal_size((100, 24)).columns, 100)
    lines = [*textwrap.wrap(found.verdict.headline, width), ""]
    for sentence in found.verdict.sentences:
        lines += textwrap.wrap(sentence, width, initial_indent="- ", subsequent_indent="  ")
    if written:
        lines.append("")
    if "tables" in written:
        lines.append(f"Tables: {Path(written['tables'][0]).parent}")
    if "report" in written:
        lines.append(f"Report: {written['report']}")
    return "\n".join(lines)


def _summary(found: Evaluation, written: Mapping[str, Any]) -> str:
    summary = found.summary
    return json.dumps(
        {
            "dataset": found.dataset,
            "verdict": {"headline": found.verdict.headline, "sentences": found.verdict.sentences},
            "clips": summary.clip_count,
            "mirrored_clips": summary.mirrored_count,
            "frames": summary.frame_count,
            "seconds": summary.seconds,
            "rate": summary.rate,
            "joints": dict(summary.joints),
            "unit": summary.unit,
            "settings": dict(summary.settings),
            "trials": [_finite(row) for row in found.measured.trials.rows()],
            "notes": found.notes,
            "failed": dict(found.failed),
            "written": dict(written),
        },
        indent=2,
        ensure_ascii=False,
    )


def _finite(row: Mapping[str, Any]) -> dict[str, Any]:
    """JSON has no NaN: what is not known is null."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in row.items()
    }


@contextmanager
def _naming(place: Path) -> Iterator[None]:
    """An error of a disk names no file, or one that was only there while writing: it is given ``place``."""
    try:
        yield
    except OSError as error:
        error.filename = str(place)
        raise


@contextmanager
def _trouble_with_files(phases: Phases) -> Iterator[None]:
    """A file that cannot be written, on a full disk or elsewhere, is one sentence."""
    try:
        yield
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        raise GmrError(
            f"{place}{error.strerror or error} (while {phases.current}); no file was left half-written"
        ) from error
