"""``gmr complete``: a dataset is evaluated, its holes are filled, and it is evaluated again, on one page."""

from __future__ import annotations

import json
import shutil
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from gmr.cli.common import say
from gmr.cli.evaluation_options import evaluation_options
from gmr.cli.outcome import at_place, left_out, trouble_with_files
from gmr.cli.progress import Phases

if TYPE_CHECKING:
    from gmr.completion import Completion
    from gmr.formats.folder import Takes

__all__ = ["complete"]

EXAMPLES: Final = """
\b
Examples:
  gmr complete takes/                  completed/index.html, its tables, and completed/clips/ beside you
  gmr complete takes/ -o filled/ --variation 0.5 --seed 3
  gmr complete takes/ --speeds 0.5:3:0.5 --turn-rates -90:90:30
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
    help="Folder for the page (index.html), the tables, and the clips that were made (clips/).",
)
@click.option(
    "--seconds", type=click.FloatRange(2, 60), default=8.0, show_default=True, help="Length of a clip."
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
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of the words.")
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def complete(
    folder: Path,
    out: Path,
    seconds: float,
    variation: float,
    seed: int,
    speeds: tuple[float, ...] | None,
    turn_rates: tuple[float, ...] | None,
    mirror: bool,
    names: dict[str, str],
    unit: float | None,
    threads: int | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Fill the holes of a dataset of locomotion clips, and show what that does.

    The clips in FOLDER are evaluated as by gmr evaluate. For each speed and turn rate that they do not do,
    a clip is synthesised from actionlets on their own skeleton; then the same trials are run again with
    both. The page shows before and after, also where it got worse. FOLDER is left as it is.
    """
    from gmr.completion import complete as completed
    from gmr.completion import synthesised, write_completion
    from gmr.replacing import check_place

    phases = Phases(quiet)
    with phases, trouble_with_files(phases):
        with at_place(out):
            check_place(out / "index.html")
        takes = _read(folder, threads, phases)
        found = completed(
            dict(takes),
            synthesised(seconds=seconds, variation=variation, seed=seed),
            dataset=folder.resolve().name,
            progress=phases.tell,
            speeds=speeds,
            turn_rates_deg=turn_rates,
            mirror=mirror,
            names=names,
            unit=unit,
            threads=threads,
        )
        with at_place(out):
            written = write_completion(found, out, progress=phases.tell)
    failed = {**{path: str(error) for path, error in takes.failed.items()}, **found.before.failed}
    click.echo(_summary(found, written) if as_json else _words(found, written))
    for sentence in left_out(failed):
        say(sentence)
    return 1 if failed else 0


def _read(folder: Path, threads: int | None, phases: Phases) -> Takes:
    from gmr.errors import DatasetError
    from gmr.formats import read_folder

    takes = read_folder(
        folder,
        threads=threads,
        errors="collect",
        progress=lambda done, of: phases.tell("reading", done, of),
    )
    if not takes:
        raise DatasetError(f"{folder} holds no motion that can be read; give the folder with the clips")
    return takes


def _words(found: Completion, written: Path) -> str:
    from gmr.completion.words import headline, sentences

    width = min(shutil.get_terminal_size((100, 24)).columns, 100)
    lines = [*textwrap.wrap(headline(found), width), ""]
    for sentence in sentences(found):
        lines += textwrap.wrap(sentence, width, initial_indent="- ", subsequent_indent="  ")
    return "\n".join([*lines, "", f"Page: {written}"])


def _summary(found: Completion, written: Path) -> str:
    from gmr.completion.words import headline, sentences

    content: dict[str, Any] = {
        "dataset": found.before.dataset,
        "headline": headline(found),
        "sentences": sentences(found),
        "trials": list(found.trials.rows()),
        "clips": list(found.clips.rows()),
        "not_made": [{"speed": a.speed, "turn_rate_deg": a.turn_rate_deg} for a in found.not_made],
        "page": str(written),
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
