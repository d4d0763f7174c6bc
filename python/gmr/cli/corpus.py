"""``gmr synthesize ... --variations N``: a corpus of labelled takes."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from gmr.cli.common import say
from gmr.cli.takes_line import TakesLine, duration, speed
from gmr.listing import listed

if TYPE_CHECKING:
    from gmr.actionlets.actions.library import Library
    from gmr.actionlets.corpus import Plan, Written

__all__ = ["Several", "corpus", "corpus_options", "refuse_corpus_options"]


_OF_A_CORPUS: Final = {
    "suffix": "--format",
    "workers": "--workers",
    "cluster": "--cluster",
    "as_json": "--json",
}


class Several(click.ParamType[Any]):
    """One value; with ``--variations`` a choice of values (:mod:`gmr.actionlets.corpus.choices`) as text.

    Args:
        one: the type of one value.
    """

    def __init__(self, one: click.ParamType[Any]) -> None:
        self.one = one
        self.name = one.name

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The value, or the text."""
        if ctx is not None and isinstance(ctx.params.get("variations"), int):
            return str(value)
        return self.one.convert(value, param, ctx)


def corpus_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options that only a corpus has; ``variations`` is known before all others."""
    options = (
        click.option(
            "--variations", type=click.IntRange(min=1), is_eager=True,
            help="Make a corpus: so many takes of each action.",
        ),
        click.option("--percentile", type=Several(click.FLOAT), help="Of the stature, in place of a height."),
        click.option("--body", type=click.Choice(["detailed", "paper"]), default="detailed",
                     show_default=True, help="With 40 degrees of freedom, or the paper's 22."),
        click.option("--format", "suffix", type=click.Choice(["gmrb", "gmr", "bvh", "glb"]), default="gmrb",
                     show_default=True, help="Of a corpus's motions."),
        click.option("--workers", type=click.IntRange(min=1), help="Processes.  [default: one a core]"),
        click.option("--cluster", metavar="ADDRESS|local",
                     help="The scheduler of a Dask cluster, or one of its own on this machine."),
        click.option("--json", "as_json", is_flag=True, help="Tell of a corpus in one JSON object."),
        click.option("-q", "--quiet", is_flag=True, help="No progress."),
    )  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


def refuse_corpus_options() -> None:
    """Refuses, for a single motion, what only a corpus can be told."""
    context = click.get_current_context()
    for name, flag in _OF_A_CORPUS.items():
        if context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE:
            raise click.UsageError(f"{flag} tells of a corpus; give --variations N too, or leave it out")


def corpus(
    actions: Sequence[str],
    variations: int,
    out: Path,
    suffix: str,
    files: Sequence[str],
    *,
    seed: int,
    fps: float,
    body: str,
    settings: Sequence[str],
    speed: str | None,
    turn_rate: str | None,
    workers: int | None,
    cluster: str | None,
    quiet: bool,
    as_json: bool,
    **choices: str | None,
) -> int:
    """Writes the corpus, says how it goes and what became of it, and gives the exit code."""
    from gmr.actionlets.actions.library import contents, library
    from gmr.actionlets.corpus import planned

    if workers and cluster not in (None, "local"):
        raise click.UsageError(f"the cluster at {cluster} has workers of its own; leave --workers out")
    named = (("speed", speed), ("turn_rate", turn_rate))
    pairs = [*settings, *(f"{name}={values}" for name, values in named if values is not None)]
    known = library(*files)
    plan = planned(
        known,
        actions,
        variations,
        seed=seed,
        fps=fps,
        format=suffix,
        body=body,
        settings={name: values for name, values in choices.items() if values is not None},
        parameters=_by_name(pairs),
        contents=contents(*files),
    )
    return _write(plan, known, out, workers, cluster, quiet=quiet, as_json=as_json)


def _write(
    plan: Plan,
    library: Library,
    out: Path,
    workers: int | None,
    cluster: str | None,
    *,
    quiet: bool,
    as_json: bool,
) -> int:
    from gmr.actionlets.corpus import write_corpus

    began = time.perf_counter()
    try:
        with TakesLine(listed(plan.actions, 3), quiet) as line:
            written = write_corpus(plan, library, out, workers=workers, cluster=cluster, progress=line.tell)
    except KeyboardInterrupt:
        say(f"what was made is in '{out}'; the same command goes on from there")
        raise
    elapsed = time.perf_counter() - began
    click.echo(_as_json(written, out, elapsed) if as_json else _in_words(written, out, elapsed))
    for why, files in _by_reason(written.failed).items():
        say(f"{listed(files, 3)} could not be made: {why}")
    return 1 if written.failed else 0


def _by_name(pairs: Sequence[str]) -> dict[str, str]:
    """What ``--set NAME=VALUES`` says, by name."""
    found: dict[str, str] = {}
    for text in pairs:
        name, equals, values = text.partition("=")
        if not (name and equals and values):
            raise click.UsageError(f"--set {text}: write NAME=VALUES, as in speed=0.8..1.6")
        if name in found:
            raise click.UsageError(f"--set {text}: '{name}' is set twice; say which it is")
        found[name] = values
    return found


def _in_words(written: Written, out: Path, elapsed: float) -> str:
    if not written.made:
        return f"{out}: {written.there:,} takes, all there already"
    before = f" {written.there:,} were there already." if written.there else ""
    return (
        f"{out}: {written.made:,} takes, {duration(written.seconds)} of motion, made in {duration(elapsed)}: "
        f"{speed(written.made, written.seconds, elapsed)}.{before}"
    )


def _as_json(written: Written, out: Path, elapsed: float) -> str:
    found = {
        "corpus": str(out),
        "there": written.there,
        "made": written.made,
        "seconds_of_motion": written.seconds,
        "seconds": elapsed,
        "failed": written.failed,
    }
    return json.dumps(found, indent=2, ensure_ascii=False)


def _by_reason(failed: Mapping[str, str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for file, why in failed.items():
        found.setdefault(why, []).append(file)
    return found
