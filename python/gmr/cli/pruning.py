"""``gmr evaluate FOLDER --prune ...``: the smaller dataset beside the report."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from gmr.cli.outcome import at_place
from gmr.cli.paragraphs import listed_sentences, paragraph
from gmr.cli.plain_rows import plain_rows
from gmr.cli.progress import Phases

if TYPE_CHECKING:
    from gmr.evaluation import Evaluation
    from gmr.pages.section import Section
    from gmr.pruning import Pruning, Written

__all__ = ["Pruned", "check_pruning", "prune_folder", "pruning_options"]

Command = TypeVar("Command", bound=Callable[..., Any])


@dataclass(frozen=True)
class Pruned:
    """What was found and where it was written."""

    found: Pruning
    written: Written

    def words(self) -> str:
        """For a terminal."""
        from gmr.pruning.manifest import files_words
        from gmr.pruning.words import headline, sentences

        first = paragraph(headline(self.found, self.written))
        told = listed_sentences([*sentences(self.found), files_words(self.written)])
        return "\n".join(["", *first, "", *told, "", f"Smaller dataset: {self.written.folder}"])

    def section(self) -> Section:
        """For the report."""
        from gmr.pruning.section import pruning_section

        return pruning_section(self.found, self.written)

    def summary(self) -> dict[str, Any]:
        """For a machine: plain values."""
        from gmr.pruning.manifest import scores_of
        from gmr.pruning.words import headline, sentences

        return {
            "headline": headline(self.found, self.written),
            "sentences": sentences(self.found),
            "curve": plain_rows(self.found.curve.table),
            "importance": plain_rows(self.found.importance),
            "folder": str(self.written.folder),
            "seconds": self.written.part.seconds,
            "identical": self.written.identical,
            "runs": scores_of(self.written),
        }


def pruning_options(command: Command) -> Command:
    """``prune`` and ``prune_out``."""
    options = (
        click.option(
            "--prune", metavar="SHARE|lossless", callback=_goal,
            help="Write a smaller dataset: without this share of the seconds (30%), or without what no trial "
            "needs.",
        ),
        click.option(
            "--prune-out", type=click.Path(file_okay=False, path_type=Path), default=Path("pruned"),
            show_default=True, help="The new folder for it.",
        ),
    )  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


def _goal(context: click.Context, option: click.Parameter, text: str | None) -> float | str | None:
    if text is None:
        return None
    from gmr.pruning.prune import goal_of

    try:
        return goal_of(text)
    except ValueError as error:
        raise click.BadParameter(f"{error}.") from None


def check_pruning(out: Path, phases: Phases) -> None:
    """Learn before all the work that the folder cannot be made."""
    from gmr.pruning.writing import check_new_folder
    from gmr.replacing import check_place

    phases.current = "looking where to write"
    check_new_folder(out)
    with at_place(out):
        check_place(out / "manifest.json")


def prune_folder(
    evaluation: Evaluation,
    folder: Path,
    goal: float | str,
    out: Path,
    phases: Phases,
    *,
    threads: int | None,
    workers: int | None,
    cluster: str | None,
    names: Mapping[str, str],
    unit: float | None,
) -> Pruned:
    """Find the smaller dataset, and write it."""
    from gmr.pruning import prune, write_pruned
    from gmr.pruning.rerun import elsewhere

    rerun = None if workers is None and cluster is None else elsewhere(workers, cluster)
    found = prune(evaluation, goal, threads=threads or 0, rerun=rerun, progress=phases.tell)
    with at_place(out):
        written = write_pruned(found, folder, out, names=names, unit=unit, progress=phases.tell)
    return Pruned(found, written)
