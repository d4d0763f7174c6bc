"""What ``gmr complete --from`` and ``gmr evaluate --complete-from`` share: their options, files and words."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from gmr.cli.outcome import at_place
from gmr.cli.progress import Phases

if TYPE_CHECKING:
    from gmr.completion import Completion
    from gmr.evaluation import Evaluation
    from gmr.formats.folder import Takes

__all__ = [
    "check_choosing",
    "choosing_options",
    "complete_folder",
    "completion_words",
    "read_clips",
]

Command = TypeVar("Command", bound=Callable[..., Any])

_OPTIONS: Final = (
    click.option(
        "--at-most",
        type=click.FloatRange(min=0, min_open=True),
        help="Seconds that the chosen clips may last together.  [default: as long as one helps]",
    ),
    click.option("--made", is_flag=True, help="Let clips compete that are synthesised for the holes."),
    click.option(
        "--retarget",
        is_flag=True,
        help="Lay clips of another skeleton on the dataset's; else they are refused.",
    ),
)


def choosing_options(command: Command) -> Command:
    """``at_most``, ``made`` and ``retarget`` as :func:`gmr.completion.complete_from` has them."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def check_choosing(
    source: Path | None, at_most: float | None, made: bool, retarget: bool, option: str
) -> None:
    """Options of a choice need something to choose from."""
    if source is None and (at_most is not None or made or retarget):
        raise click.UsageError(f"--at-most, --made and --retarget go with {option} FOLDER.")


def read_clips(folder: Path, threads: int | None, phases: Phases) -> Takes:
    """All motions of a folder; one without any is an error."""
    from gmr.errors import DatasetError
    from gmr.formats import read_folder

    takes = read_folder(
        folder,
        threads=threads,
        errors="collect",
        progress=lambda done, of: phases.tell(f"reading {folder.name}", done, of),
    )
    if not takes:
        raise DatasetError(f"{folder} holds no motion that can be read; give the folder with the clips")
    return takes


def complete_folder(
    evaluation: Evaluation,
    folder: Path,
    source: Path,
    out: Path,
    phases: Phases,
    *,
    at_most: float | None,
    made: bool,
    retarget: bool,
    **reading: Any,
) -> tuple[Completion, Path]:
    """Complete an evaluated folder from another one, and write the page, the tables and the clips."""
    from gmr.completion import complete_from, synthesised, write_completion

    threads = reading.get("threads")
    found = complete_from(
        dict(read_clips(folder, threads, phases)),
        dict(read_clips(source, threads, phases)),
        source=source.resolve().name,
        dataset=evaluation.dataset,
        at_most=at_most,
        fill=synthesised() if made else None,
        lay=retarget,
        before=evaluation,
        progress=phases.tell,
        **reading,
    )
    with at_place(out):
        return found, write_completion(found, out, source=source, progress=phases.tell)


def completion_words(found: Completion, written: Path) -> str:
    """For a terminal."""
    from gmr.completion.words import headline, sentences

    width = min(shutil.get_terminal_size((100, 24)).columns, 100)
    lines = [*textwrap.wrap(headline(found), width), ""]
    for sentence in sentences(found):
        lines += textwrap.wrap(sentence, width, initial_indent="- ", subsequent_indent="  ")
    return "\n".join([*lines, "", f"Page: {written}"])
