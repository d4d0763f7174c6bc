"""``gmr evaluate FOLDER --tune``: whether other weights of the features do better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import click

from gmr.cli.paragraphs import listed_sentences, paragraph
from gmr.cli.plain_rows import plain_row, plain_rows

if TYPE_CHECKING:
    from gmr.evaluation import Evaluation
    from gmr.evaluation.tuning import Tuning
    from gmr.pages.section import Section

__all__ = ["Tuned", "tune_evaluation", "tuning_option"]

Command = TypeVar("Command", bound=Callable[..., Any])


@dataclass(frozen=True)
class Tuned:
    """What was found."""

    found: Tuning

    def words(self) -> str:
        """For a terminal."""
        from gmr.evaluation.tuning.words import headline, sentences

        lines = ["", *paragraph(headline(self.found)), "", *listed_sentences(sentences(self.found))]
        return "\n".join(lines)

    def section(self) -> Section:
        """For the report."""
        from gmr.evaluation.tuning.section import tuning_section

        return tuning_section(self.found)

    def summary(self) -> dict[str, Any]:
        """For a machine: plain values."""
        from gmr.evaluation.tuning.words import headline, sentences

        found = self.found
        return {
            "headline": headline(found),
            "sentences": list(sentences(found)),
            "improves": found.improves,
            "beyond_chance": found.beyond_chance,
            "weights": dict(found.weights),
            "gain": plain_row(found.gain._asdict()),
            "trials": plain_rows(found.trials),
            "search": plain_rows(found.search),
        }


def tuning_option(command: Command) -> Command:
    """``tune``."""
    return click.option(
        "--tune",
        is_flag=True,
        help="Search for better weights of the features on half of the grid; prove them on the rest.",
    )(command)


def tune_evaluation(
    evaluation: Evaluation, *, threads: int | None, progress: Callable[[str, int, int], object]
) -> Tuned:
    """Tune the weights for what was evaluated.

    Raises:
        GmrError: too few constant trials were asked for.
    """
    from gmr.errors import GmrError
    from gmr.evaluation.tuning import tune

    try:
        return Tuned(tune(evaluation, threads=threads, progress=progress))
    except ValueError as error:
        raise GmrError(str(error)) from error
