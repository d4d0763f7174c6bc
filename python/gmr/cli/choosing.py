"""What ``gmr complete --from`` and ``gmr evaluate --complete-from`` share: their options, files and words."""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

import click

from gmr.cli.common import options_given
from gmr.cli.outcome import alike, at_place, left_out
from gmr.cli.paragraphs import listed_sentences, paragraph
from gmr.cli.plain_rows import plain_rows
from gmr.cli.progress import Phases
from gmr.listing import listed

if TYPE_CHECKING:
    from gmr.completion import Completion
    from gmr.evaluation import Evaluation
    from gmr.evaluation.reading import Read
    from gmr.motion import Motion
    from gmr.pages.section import Section

__all__ = [
    "Completed",
    "Completing",
    "check_choosing",
    "check_completing",
    "choosing_options",
    "complete_folder",
    "completing_options",
    "completion_summary",
    "completion_words",
    "earlier_clips",
    "noticed",
    "read_clips",
    "read_dataset",
    "refused_clips",
]

Command = TypeVar("Command", bound=Callable[..., Any])

_OPTIONS: Final = (
    click.option(
        "--at-most",
        type=click.FloatRange(min=0, min_open=True),
        help="Seconds that the chosen clips may last together.  [default: as long as one helps]",
    ),
    click.option(
        "--made",
        is_flag=True,
        help="Let clips that are synthesised for the holes compete with those of the other folder.",
    ),
    click.option(
        "--retarget",
        is_flag=True,
        help="Lay clips of the other folder on the dataset's skeleton where theirs is another; else they are "
        "refused.",
    ),
)


def choosing_options(command: Command) -> Command:
    """``at_most``, ``made`` and ``retarget`` as :func:`gmr.completion.complete_from` has them."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


@dataclass(frozen=True, slots=True)
class Completing:
    """What ``gmr evaluate --complete-from`` asks for."""

    source: Path
    out: Path
    at_most: float | None
    made: bool
    retarget: bool


def completing_options(command: Command) -> Command:
    """``completing``: a :class:`Completing`, or None."""

    @functools.wraps(command)
    def gathered(
        *args: Any,
        complete_from: Path | None,
        complete_out: Path,
        at_most: float | None,
        made: bool,
        retarget: bool,
        **others: Any,
    ) -> Any:
        check_choosing(complete_from, at_most, made, retarget, "--complete-from")
        if complete_from is None and options_given("complete_out"):
            raise click.UsageError("--complete-out is where --complete-from FOLDER writes; give both.")
        wanted = None
        if complete_from is not None:
            wanted = Completing(complete_from, complete_out, at_most, made, retarget)
        return command(*args, completing=wanted, **others)

    found: Any = choosing_options(gathered)
    for option in reversed(_PLACES):
        found = option(found)
    return cast("Command", found)


_PLACES: Final = (
    click.option(
        "--complete-from",
        type=click.Path(exists=True, file_okay=False, path_type=Path),
        help="Fill the holes from the clips of this folder; the report shows before and after.",
    ),
    click.option(
        "--complete-out",
        type=click.Path(file_okay=False, path_type=Path),
        default=Path("completed"),
        show_default=True,
        help="Folder for the chosen clips, their tables, and the report of the completed dataset.",
    ),
)


def check_choosing(
    source: Path | None, at_most: float | None, made: bool, retarget: bool, option: str
) -> None:
    """Options of a choice need something to choose from."""
    if source is None and (at_most is not None or made or retarget):
        raise click.UsageError(f"--at-most, --made and --retarget go with {option} FOLDER.")


def read_clips(folder: Path, threads: int | None, phases: Phases) -> Read:
    """All motions of a folder; one without any is an error."""
    from gmr.evaluation.reading import read_clips as read

    return read(
        folder, threads=threads, progress=lambda done, of: phases.tell(f"reading {folder.name}", done, of)
    )


def read_dataset(folder: Path, threads: int | None, phases: Phases) -> Read:
    """The clips to be evaluated, read as :func:`gmr.evaluate` does."""
    from gmr.evaluation.reading import read_clips as read

    return read(folder, threads=threads, progress=lambda done, of: phases.tell("reading", done, of))


def noticed(reads: Iterable[Read], excluded: Collection[str] = ()) -> tuple[str, ...]:
    """What was odd about files, and which could not be used: not read, or ``excluded`` later."""
    from gmr.evaluation.words import count, some_of

    reads = tuple(reads)
    notes = [note for read in reads for note in read.notes]
    failed = [*(path for read in reads for path in read.failed), *excluded]
    if failed:
        verb = "was" if len(failed) == 1 else "were"
        notes.append(
            f"{count(len(failed), 'file')} could not be used and {verb} left out: {some_of(failed, 5)}."
        )
    return tuple(notes)


@dataclass(frozen=True, slots=True)
class Completed:
    """What was chosen, where it was written, and which files of the other folder cannot be read and why."""

    found: Completion
    folder: Path
    failed: Mapping[str, str]

    def words(self) -> str:
        """For a terminal."""
        clips = f"Chosen clips: {self.folder / 'clips'}" if self.found.added else f"Tables: {self.folder}"
        return "\n".join(["", completion_words(self.found), "", clips])

    def section(self) -> Section:
        """For the report."""
        from gmr.completion import completion_section

        return completion_section(self.found)

    @property
    def lacking(self) -> bool:
        """Whether some of the other folder's files or all could not be used."""
        return bool(self.failed or self.found.refused)

    def told(self) -> Iterator[str]:
        """What could not be used, and what else lies where the clips were written, in sentences."""
        yield from left_out(self.failed)
        yield from refused_clips(self.found)
        yield from earlier_clips(self.found, self.folder)

    @property
    def nothing(self) -> str | None:
        """Why no clip could be tried; None where some could, or nothing was missing."""
        of = self.found
        if of.added or of.considered or not of.refused:
            return None
        return f"no clip of {of.source} can be used: {next(iter(of.refused.values()))}"

    def summary(self) -> dict[str, Any]:
        """For a machine: plain values."""
        return {**completion_summary(self.found, self.failed), "folder": str(self.folder)}


def check_completing(completing: Completing, phases: Phases) -> None:
    """Learn before all the work that the folder cannot be written to."""
    from gmr.replacing import check_place

    phases.current = "looking where to write"
    with at_place(completing.out):
        check_place(completing.out / "manifest.json")


def complete_folder(
    evaluation: Evaluation,
    motions: Mapping[str, Motion],
    completing: Completing,
    phases: Phases,
    *,
    report: bool,
    threads: int | None,
    **reading: Any,
) -> Completed:
    """Complete an evaluated dataset from another one, and write the clips and the tables.

    Args:
        evaluation: of the dataset.
        motions: the dataset's clips, as they were evaluated.
        completing: what is asked for.
        phases: told of progress.
        report: also write the report of the completed dataset, ``after.html``.
        threads: how many to use.
        reading: ``names`` and ``unit`` of the evaluation.
    """
    from gmr.completion import complete_from, synthesised, write_added

    others = read_clips(completing.source, threads, phases)
    found = complete_from(
        motions,
        others.motions,
        source=completing.source.resolve().name,
        dataset=evaluation.dataset,
        at_most=completing.at_most,
        fill=synthesised() if completing.made else None,
        lay=completing.retarget,
        before=evaluation,
        progress=phases.tell,
        threads=threads,
        **reading,
    )
    found = replace(found, noticed=(*noticed([others]), *found.noticed))
    with at_place(completing.out):
        write_added(found, completing.out, source=completing.source, progress=phases.tell)
        if report and found.added:
            found.after.report(completing.out / "after.html")
    failed = {str(completing.source / path): why for path, why in others.failed.items()}
    return Completed(found, completing.out, failed)


def completion_words(found: Completion) -> str:
    """For a terminal."""
    from gmr.completion.words import headline, sentences

    return "\n".join([*paragraph(headline(found)), "", *listed_sentences(sentences(found))])


def refused_clips(found: Completion) -> Iterator[str]:
    """A sentence for each reason for which clips could not be chosen."""
    for why, names in alike(found.refused).items():
        yield f"left out {listed(names, 5)} of {found.source}: {why}"


def earlier_clips(found: Completion, folder: Path) -> Iterator[str]:
    """What else lies where the clips were written, in a sentence."""
    from gmr.completion.writing import clips_of_before
    from gmr.evaluation.words import count, some_of

    if earlier := clips_of_before(found, folder):
        is_ = "is" if len(earlier) == 1 else "are"
        yield (
            f"{count(len(earlier), 'file')} in {folder / 'clips'} {is_} no part of this, but there from "
            f"before: {some_of(earlier, 3)}"
        )


def completion_summary(found: Completion, failed: Mapping[str, str]) -> dict[str, Any]:
    """For a machine: plain values; ``failed``: files that cannot be used, and why."""
    from gmr.completion.words import headline, sentences

    return {
        "dataset": found.before.dataset,
        "headline": headline(found),
        "sentences": sentences(found),
        "trials": plain_rows(found.trials),
        "clips": plain_rows(found.clips),
        "chosen": plain_rows(found.chosen),
        "refused": dict(found.refused),
        "failed": dict(failed),
        "not_made": [{"speed": a.speed, "turn_rate_deg": a.turn_rate_deg} for a in found.not_made],
    }
