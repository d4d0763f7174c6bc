"""Where each input of ``gmr convert`` goes: told, and checked, before anything is read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gmr.cli.common import STDIO, files_of
from gmr.listing import quoted

if TYPE_CHECKING:
    from gmr.formats.registry import Format

__all__ = ["Job", "Written", "jobs_of"]


@dataclass(frozen=True, slots=True)
class Job:
    """One input and the place that it goes to.

    Args:
        source: a file, or ``-``.
        out: a file, or ``-``.
        format: the name of the format to write, whatever the suffix of ``out``; None: the suffix tells it.
    """

    source: Path | str
    out: Path | str
    format: str | None = None


class Written(click.ParamType["Format"]):
    """A format that gmr writes, by its name or suffix."""

    name = "FORMAT"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Format:
        """The format."""
        from gmr.errors import GmrError
        from gmr.formats.registry import FORMATS, named_format

        others = ", ".join(known.name.lower() for known in FORMATS if known.writer)
        try:
            found = named_format(value)
        except GmrError:
            self.fail(f"there is no format '{value}'; write one of: {others}", param, ctx)
        if found.writer is None:
            self.fail(f"gmr reads {found.name} but does not write it; write one of: {others}", param, ctx)
        return found


def jobs_of(source: str, target: str, to: Format | None) -> list[Job]:
    """Each input with the place that it goes to.

    Args:
        source: a file, a folder or ``-``.
        target: the same, the folder for a folder.
        to: the format to write; None: that of the place, and in a folder that of each input.

    Raises:
        UsageError: source and target do not go together, two inputs would become one file, or one would
            replace another.
        GmrError: a folder without motions.
    """
    if source != STDIO and Path(source).is_dir():
        _check_folder(source, target)
        jobs = [
            Job(path, _place(Path(target, Path(path).relative_to(source)), to)) for path in files_of(source)
        ]
        _check_places(jobs)
        return jobs
    asked = None if to is None else to.name
    if target == STDIO:
        return [Job(source, target, asked)]
    if Path(target).is_dir():
        if source == STDIO:
            raise click.UsageError(f"'{target}' is a folder; name the file to write")
        return [Job(source, _place(Path(target, Path(source).name), to))]
    _check_suffix(target, to)
    return [Job(source, target, asked)]


def _place(path: Path, to: Format | None) -> Path:
    """The path with the suffix of the format that is to be written; as it is where it has one of these."""
    if to is None or path.suffix.lower() in to.suffixes:
        return path
    return path.with_suffix(to.suffixes[0])


def _check_folder(source: str, target: str) -> None:
    from gmr.formats.registry import FORMATS

    known = [suffix for each in FORMATS for suffix in each.suffixes]
    if target == STDIO or Path(target).is_file():
        raise click.UsageError(f"'{source}' is a folder, so OUT must be a folder too, not '{target}'")
    if not Path(target).exists() and Path(target).suffix.lower() in known:
        raise click.UsageError(
            f"'{source}' is a folder, so OUT must be a folder too, but '{target}' is called like a file; "
            "give a name without the suffix"
        )


def _check_suffix(target: str, to: Format | None) -> None:
    """Refuses a place whose suffix is of another format than the one asked for; or, where none is asked for,
    of none that gmr writes."""
    from gmr.errors import FormatError
    from gmr.formats.registry import FORMATS, format_of_file

    told = any(Path(target).suffix.lower() in known.suffixes for known in FORMATS)
    if to is not None and not told:
        return
    try:
        found = format_of_file(target, written=True)
    except FormatError as error:
        raise click.UsageError(str(error)) from error
    if to not in (None, found):
        raise click.UsageError(f"--to asks for {to.name}, but '{target}' is called like {found.name}")


def _check_places(jobs: list[Job]) -> None:
    """Refuses to write one file twice, and to write over a file that another input needs."""
    taken: dict[Path, Path | str] = {}
    folders = {Path(job.source).parent.resolve() for job in jobs}
    for job in jobs:
        for place in _written(job):
            first = taken.setdefault(place, job.source)
            if first != job.source:
                both = quoted([str(first), str(job.source)], 2)
                advice = "rename one, or convert each kind from a folder of its own"
                raise click.UsageError(f"{both} would both be written to '{place}'; {advice}")
            if place.exists() and place.parent.resolve() in folders and not _is_own(job, place):
                what = f"'{job.source}' would be written over '{place}', which lies among the inputs"
                raise click.UsageError(f"{what}; name another folder as OUT")


def _written(job: Job) -> Iterator[Path]:
    """All files that a job writes."""
    from gmr.formats.registry import format_of_file

    out = Path(job.out)
    yield out
    second = format_of_file(str(out)).place_beside(out)
    if second is not None:
        yield second


def _is_own(job: Job, place: Path) -> bool:
    """Whether a place is the job's input, or the second file of it."""
    return any(place.samefile(own) for own in _written(Job(job.source, job.source)) if own.exists())
