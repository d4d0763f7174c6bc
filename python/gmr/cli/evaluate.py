"""``gmr evaluate``: what a folder of locomotion clips can do, as a report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

import click

from gmr.cli.afterwards import Afterwards
from gmr.cli.choosing import (
    Completed,
    Completing,
    check_completing,
    complete_folder,
    completing_options,
    read_dataset,
)
from gmr.cli.cluster_options import check_workers, cluster_options
from gmr.cli.common import INTERRUPTED, options_given, say
from gmr.cli.evaluation_options import evaluation_options
from gmr.cli.evaluation_results import as_object, in_words
from gmr.cli.outcome import at_place, left_out, refuse_inside, refuse_one_place, trouble_with_files, within
from gmr.cli.progress import Phases
from gmr.cli.pruning import check_pruning, prune_folder, pruning_options
from gmr.cli.scenarios import check_scenarios, scenario_options
from gmr.cli.tuning import tune_evaluation, tuning_option
from gmr.cli.weights import weight_option

if TYPE_CHECKING:
    from gmr.evaluation import Comparison, Evaluation
    from gmr.evaluation.reading import Read
    from gmr.evaluation.scenarios.asked import Asked
    from gmr.matching.schema import Schema
    from gmr.matching.trial import Tracking
    from gmr.pages.section import Section

EXAMPLES: Final = """
\b
Examples:
  gmr evaluate takes/                          report.html beside you
  gmr evaluate takes/ --mirror -o walks.html   with the mirror image of every clip
  gmr evaluate takes/ others/ -o both.html     several datasets in one report, on the same axes
  gmr evaluate takes/ --tables tables/         every number as CSV and Parquet too
  gmr evaluate takes/ --figures figures/       every figure as SVG too
  gmr evaluate takes/ --speeds 0.5:4:0.5 --turn-rates -180:180:45
  gmr evaluate takes/ --preset mig2022         the pacing of the paper's authors
  gmr evaluate takes/ --tracking both          closed loop and open loop
  gmr evaluate takes/ --scenario slalom --scenario splines --scenario my_path.csv
  gmr evaluate takes/ --name left_foot=foot_l --name right_foot=foot_r
  gmr evaluate takes/ --prune 30% --prune-out smaller/     and the same in less
  gmr evaluate takes/ --prune lossless         without what no trial needs
  gmr evaluate takes/ --prune 30% --cluster tcp://10.0.0.1:8786
  gmr evaluate takes/ --complete-from archive/ and what clips of another folder would bring
  gmr evaluate takes/ --tune                   would other weights of the features do better?
  gmr evaluate takes/ --weight "hips velocity=2" --weight "trajectory facing=1"
  gmr evaluate takes/ --json > found.json      for a machine

\b
Exit codes: 0 all files were evaluated, 1 some or all could not be (they are named), or --prune, --tune
or --complete-from came to nothing (the report is written all the same), 2 wrong usage, 130 interrupted
(the report is written if the trials were done).
"""


@click.command(short_help="What a folder of locomotion clips can do, as a report.", epilog=EXAMPLES)
@click.argument(
    "folders",
    metavar="FOLDER...",
    nargs=-1,
    required=True,
    type=click.Path(exists=True, file_okay=False, path_type=Path),
)
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
@click.option(
    "--figures",
    type=click.Path(file_okay=False, path_type=Path),
    help="Write all figures into this folder, as SVG; of several datasets, each into a folder in it.",
)
@click.option(
    "--tracking",
    type=click.Choice(["time", "velocity", "both"]),
    default="time",
    show_default=True,
    help="Steer to where the path has the character at each time, or only ask for speed and turn rate.",
)
@scenario_options
@click.option(
    "--preset", type=click.Choice(["mig2022"]), help="Pace the trials as the authors of the paper did."
)
@evaluation_options
@weight_option
@pruning_options
@cluster_options
@completing_options
@tuning_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of the verdict.")
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def evaluate(
    folders: tuple[Path, ...],
    out: Path,
    no_report: bool,
    tables: Path | None,
    figures: Path | None,
    mirror: bool,
    tracking: str,
    scenarios: tuple[Asked, ...],
    seed: int,
    switched_speed: float,
    switch_every: float,
    speeds: tuple[float, ...] | None,
    turn_rates: tuple[float, ...] | None,
    preset: str | None,
    names: dict[str, str],
    unit: float | None,
    threads: int | None,
    schema: Schema,
    prune: float | str | None,
    prune_out: Path,
    workers: int | None,
    cluster: str | None,
    completing: Completing | None,
    tune: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """Measure what a folder of locomotion clips can do, and write a report.

    A character made of the clips in FOLDER (and the folders in it) is sent along circles and straight
    lines at many speeds by motion matching. The verdict says which speeds and turns the clips cover, where
    they fail and why, which clips carry them, which are never played, and what to capture next. The report
    shows it all; it is one HTML file that opens without a network. Of several folders each is a dataset of
    its own: all are sent through the same trials, and first comes what one does that the others cannot.
    """
    import gmr
    from gmr.evaluation.scenario import Switching

    switching = Switching(switched_speed, switch_every)
    check_scenarios(scenarios, speeds, turn_rates, preset, seed, switching)
    if len(folders) > 1 and prune is not None:
        raise click.UsageError("--prune makes one dataset smaller; give one folder.")
    if prune is None and options_given("prune_out"):
        raise click.UsageError("--prune-out is where --prune writes; say how much shall go: --prune 30%.")
    check_workers(workers, cluster)
    if len(folders) > 1 and completing is not None:
        raise click.UsageError("--complete-from completes one dataset; give one folder.")
    if len(folders) > 1 and tune:
        raise click.UsageError("--tune finds the weights of one dataset; give one folder.")
    _check_apart(
        completing.out if completing is not None else None,
        prune_out if prune is not None else None,
        {"--tables": tables, "--figures": figures, "--out": None if no_report else out},
    )
    phases = Phases(quiet)
    with phases, trouble_with_files(phases):
        _check_places(None if no_report else out, tables, figures, phases)
        if prune is not None:
            check_pruning(prune_out, phases)
            refuse_inside(prune_out, folders[0], "--prune-out")
        if completing is not None:
            refuse_inside(completing.out / "clips", folders[0], "--complete-out")
            check_completing(completing, phases)
        reading: dict[str, Any] = {"threads": threads, "names": names, "unit": unit}
        # Read once: a completion needs the clips themselves too.
        read = read_dataset(folders[0], threads, phases) if completing is not None else None
        found = _evaluated(
            folders if read is None else [read],
            preset=preset,
            mirror=mirror,
            scenarios=scenarios,
            seed=seed,
            switched_speed=switched_speed,
            switch_every=switch_every,
            tracking=("time", "velocity") if tracking == "both" else cast("Tracking", tracking),
            speeds=speeds,
            turn_rates_deg=turn_rates,
            workers=workers,
            cluster=cluster,
            schema=schema,
            progress=phases.tell,
            **reading,
        )
        later = Afterwards(phases)
        if prune is not None:
            assert isinstance(found, gmr.Evaluation)
            asked = partial(prune_folder, found, folders[0], prune, prune_out, phases, **reading)
            later.add("pruned", "--prune", partial(asked, workers=workers, cluster=cluster))
        if tune:
            assert isinstance(found, gmr.Evaluation)
            later.add(
                "tuned", "--tune", partial(tune_evaluation, found, threads=threads, progress=phases.tell)
            )
        if completing is not None:
            assert isinstance(found, gmr.Evaluation)
            assert read is not None
            given = partial(complete_folder, found, read.motions, completing, phases, **reading)
            later.add("completed", "--complete-from", partial(given, report=not no_report))
        chosen = later.added.get("completed")
        completed = chosen if isinstance(chosen, Completed) else None
        if completed is not None and completed.nothing is not None:
            later.failed["--complete-from"] = completed.nothing
        sections = [each.section() for each in later.added.values()]
        written = _write(found, None if no_report else out, tables, figures, phases, sections)
    click.echo(as_object(found, written, later) if as_json else in_words(found, written))
    for each in later.added.values() if not as_json else ():
        click.echo(each.words())
    for sentence in (*left_out(found.failed), *(completed.told() if completed else ()), *later.told()):
        say(sentence)
    if later.interrupted:
        return INTERRUPTED
    return 1 if found.failed or later.failed or (completed and completed.lacking) else 0


def _evaluated(sources: Sequence[Path | Read], **settings: Any) -> Evaluation | Comparison:
    import gmr

    return gmr.evaluate(sources[0], **settings) if len(sources) == 1 else gmr.compare(sources, **settings)


def _check_apart(completed: Path | None, pruned: Path | None, places: Mapping[str, Path | None]) -> None:
    """Refuse places of which one result would overwrite the other, or be taken for a part of it.

    Args:
        completed: the folder of a completion, if there is to be one.
        pruned: that of a pruning.
        places: of all else that is written, by the option.
    """
    if completed is not None and pruned is not None:
        refuse_one_place(("--complete-out", completed), ("--prune-out", pruned))
    for option, place in places.items():
        if place is None:
            continue
        if pruned is not None and within(place, pruned):
            raise click.UsageError(
                f"{option} is {place}, where --prune-out writes a dataset, which has nothing else in its "
                f"folder; give {option} a place elsewhere."
            )
        if completed is not None:
            _check_beside_completion(option, place, completed)


def _check_beside_completion(option: str, place: Path, completed: Path) -> None:
    if place.resolve() == completed.resolve():
        each = ", and each writes a trials.csv and a clips.csv" if option == "--tables" else ""
        raise click.UsageError(f"--complete-out and {option} are both {place}{each}; give them two folders.")
    for own, what in (("clips", "the clips"), ("after.html", "the report of the completed dataset")):
        if within(place, completed / own):
            raise click.UsageError(
                f"{option} is {place}, where --complete-out writes {what}; give {option} another place."
            )


def _check_places(out: Path | None, tables: Path | None, figures: Path | None, phases: Phases) -> None:
    """Learn before all the work that its results cannot be kept."""
    from gmr.replacing import check_place

    phases.current = "looking where to write"
    if tables is not None:
        with at_place(tables):
            check_place(tables / "trials.csv")
    if figures is not None:
        from gmr.evaluation.figures.svg_files import check_svg

        check_svg()
        with at_place(figures):
            check_place(figures / "figure.svg")
    if out is not None:
        with at_place(out):
            check_place(out)


def _write(
    found: Evaluation | Comparison,
    out: Path | None,
    tables: Path | None,
    figures: Path | None,
    phases: Phases,
    sections: Sequence[Section],
) -> dict[str, Any]:
    """Write what was asked for; the answer says where it lies."""
    from gmr.evaluation.comparison import Comparison

    written: dict[str, Any] = {}
    if tables is not None:
        phases.tell("writing tables", 0, 1)
        columnar = "parquet" if _has_pyarrow() else "json"
        with at_place(tables):
            written["tables"] = [str(path) for path in found.write_tables(tables, ("csv", columnar))]
        phases.tell("writing tables", 1, 1)
    if figures is not None:
        phases.tell("writing figures", 0, 1)
        with at_place(figures):
            alone = not isinstance(found, Comparison)
            drawn = found.write_figures(figures, *sections) if alone else found.write_figures(figures)
            written["figures"] = [str(path) for path in drawn]
        phases.tell("writing figures", 1, 1)
    if out is not None:
        phases.tell("writing the report", 0, 1)
        with at_place(out):
            out.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(found, Comparison):
                found.report(out)
            else:
                found.report(out, *sections)
        written["report"] = str(out)
        phases.tell("writing the report", 1, 1)
    return written


def _has_pyarrow() -> bool:
    from importlib.util import find_spec

    return find_spec("pyarrow") is not None
