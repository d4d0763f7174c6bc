"""``gmr complete``: a dataset is evaluated, its holes are filled, and it is evaluated again, on one page."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from gmr.cli.choosing import (
    check_choosing,
    choosing_options,
    completion_summary,
    completion_words,
    earlier_clips,
    noticed,
    read_clips,
    refused_clips,
)
from gmr.cli.common import say
from gmr.cli.evaluation_options import evaluation_options
from gmr.cli.outcome import at_place, left_out, refuse_inside, trouble_with_files
from gmr.cli.progress import Phases
from gmr.cli.weights import weight_option

if TYPE_CHECKING:
    from gmr.matching.schema import Schema

__all__ = ["complete"]

EXAMPLES: Final = """
\b
Examples:
  gmr complete takes/                  completed/index.html, its tables, and completed/clips/ beside you
  gmr complete takes/ -o filled/ --variation 0.5 --seed 3
  gmr complete takes/ --speeds 0.5:3:0.5 --turn-rates -90:90:30
  gmr complete takes/ --from archive/  clips of another folder, those that take away most per second
  gmr complete takes/ --from archive/ --at-most 60 --made --retarget
  gmr complete takes/ --json > found.json

\b
Exit codes: 0 done, also where nothing was missing; 1 some files or all could not be used (they are
named), 2 wrong usage, 130 interrupted.
"""


@click.command(short_help="Fill the holes of a dataset, and show what that does.", epilog=EXAMPLES)
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option(
    "-o",
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("completed"),
    show_default=True,
    help="Folder for the page (index.html), the tables, and the clips that were made or chosen (clips/).",
)
@click.option(
    "--from",
    "source",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Choose clips of this folder: as they are, mirrored, or 0.8 to 1.25 times as fast.",
)
@choosing_options
@click.option(
    "--seconds",
    type=click.FloatRange(2, 60),
    default=8.0,
    show_default=True,
    help="Length of a clip that is made.",
)
@click.option(
    "--variation",
    type=click.FloatRange(0, 1),
    default=0.2,
    show_default=True,
    help="How far the clips stray from the plain action: 0 not at all, 1 as far as bodies do.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of the variation.")
@evaluation_options
@weight_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of the words.")
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def complete(
    folder: Path,
    out: Path,
    source: Path | None,
    at_most: float | None,
    made: bool,
    retarget: bool,
    seconds: float,
    variation: float,
    seed: int,
    speeds: tuple[float, ...] | None,
    turn_rates: tuple[float, ...] | None,
    mirror: bool,
    names: dict[str, str],
    unit: float | None,
    threads: int | None,
    schema: Schema,
    as_json: bool,
    quiet: bool,
) -> int:
    """Fill the holes of a dataset of locomotion clips, and show what that does.

    The clips in FOLDER are evaluated as by gmr evaluate. For each speed and turn rate that they do not do,
    a clip is synthesised from actionlets on their own skeleton, or, with --from, clips of another folder
    are chosen; then the same trials are run again with both. The page shows before and after, also where
    it got worse. FOLDER is left as it is.
    """
    from gmr.completion import complete as completed
    from gmr.completion import complete_from, synthesised, write_completion
    from gmr.replacing import check_place

    check_choosing(source, at_most, made, retarget, "--from")
    fill = synthesised(seconds=seconds, variation=variation, seed=seed)
    settings: dict[str, Any] = {
        "dataset": folder.resolve().name,
        "speeds": speeds,
        "turn_rates_deg": turn_rates,
        "mirror": mirror,
        "names": names,
        "unit": unit,
        "threads": threads,
        "schema": schema,
    }
    refuse_inside(out / "clips", folder, "--out")
    phases = Phases(quiet)
    with phases, trouble_with_files(phases):
        with at_place(out):
            check_place(out / "index.html")
        takes = read_clips(folder, threads, phases)
        failed = dict(takes.failed)
        if source is None:
            found = completed(takes.motions, fill, progress=phases.tell, **settings)
            found = replace(found, noticed=(*noticed([takes], found.before.failed), *found.before.notes))
        else:
            others = read_clips(source, threads, phases)
            failed |= {str(source / path): why for path, why in others.failed.items()}
            found = complete_from(
                takes.motions,
                others.motions,
                source=source.resolve().name,
                at_most=at_most,
                fill=fill if made else None,
                lay=retarget,
                progress=phases.tell,
                **settings,
            )
            of_takes = (f"{found.dataset}: {note}" for note in found.before.notes)
            of_files = noticed([takes, others], found.before.failed)
            found = replace(found, noticed=(*of_files, *of_takes, *found.noticed))
        with at_place(out):
            written = write_completion(found, out, source=source, progress=phases.tell)
    failed |= found.before.failed
    if as_json:
        summary = {**completion_summary(found, failed), "page": str(written)}
        click.echo(json.dumps(summary, indent=2, ensure_ascii=False))
    else:
        click.echo("\n".join([completion_words(found), "", f"Page: {written}"]))
    for sentence in (*left_out(failed), *refused_clips(found), *earlier_clips(found, out)):
        say(sentence)
    return 1 if failed or found.refused else 0
