"""``gmr info``: what is in a motion, and what is odd about it."""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gmr.cli.common import STDIO, Failures, files_of, progress, read_noting

if TYPE_CHECKING:
    from gmr.description import Description

__all__ = ["info"]


@click.command(short_help="What is in a file, and what is odd about it.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--json", "as_json", is_flag=True, help="Print JSON: an object for one file, a list for more.")
@click.option("--strict", is_flag=True, help="Refuse what is otherwise read with a note.")
@click.option(
    "--positions", type=click.Choice(["replace", "add"]), default="replace", show_default=True,
    help="What position channels do to a joint's OFFSET.",
)  # fmt: skip
def info(files: tuple[str, ...], as_json: bool, strict: bool, positions: str) -> int:
    """Tell what is in motion files, and what is odd about them.

    FILE is a file, a folder (all motions in it and below) or - for standard input. Units and the axis that
    points up are guessed from the body, and said to be guesses.

    \b
    Examples:
      gmr info walk.bvh
      gmr info takes/                       a few lines for each
      gmr info --json takes/ | jq '.[] | select(.oddities != []) | .file'
      cat walk.bvh | gmr info -
    """
    failures = Failures()
    paths: list[Path | str] = []
    for file in files:
        with failures.of(file):
            paths += files_of(file)
    found: list[dict[str, Any]] = []
    with progress(paths, "Reading") as watched:
        for path in watched:
            with failures.of(str(path)):
                description = _described(path, strict=strict, positions=positions)
                if as_json:
                    found.append({"file": str(path), **_plain(description)})
                else:
                    click.echo(_page(str(path), description))
    if as_json:
        found += [{"file": file, "error": error} for file, error in failures.errors.items()]
        alone = len(files) == 1 and len(found) == 1 and (files[0] == STDIO or not Path(files[0]).is_dir())
        click.echo(json.dumps(found[0] if alone else found, indent=2, allow_nan=False))
    return failures.exit_code()


def _described(path: Path | str, **options: Any) -> Description:
    from gmr.description import describe

    motion, warnings = read_noting(path, **options)
    return describe(motion, [_without_place(warning, motion.name) for warning in warnings])


def _without_place(warning: str, name: str | None) -> str:
    """The warning without the file's name, which stands above it, and with its line in words."""
    return re.sub(r"^(\d+)(:\d+)?:", r"line \1:", warning.removeprefix(f"{name}:").strip())


def _plain(description: Description) -> dict[str, Any]:
    """The description as JSON has it."""
    plain = asdict(description)
    plain["joint_count"] = len(description.joints)
    return plain


def _page(path: str, of: Description) -> str:
    """The description for people: a line for each thing, oddities last."""
    lines = [
        ("frames", _frames(of)),
        ("joints", _joints(of)),
        ("roots", ", ".join(of.roots) or "none"),
        ("dummies", ", ".join(of.dummies) or "none"),
        ("channels", f"{of.channels} a frame: {_channels(of)}"),
        ("moving", f"position channels below the root: {_few(of.moving)}" if of.moving else ""),
        ("size", _size(of)),
        ("up", _up(of)),
        *(("odd", oddity) for oddity in of.oddities),
    ]
    body = "\n".join(f"  {key:<9} {text}" for key, text in lines if text)
    return f"{click.style(path, bold=True)}\n{body}\n"


def _frames(of: Description) -> str:
    if not of.fps:
        return f"{of.frames:,}, without a rate"
    return f"{of.frames:,} at {of.fps:.6g} fps: {of.seconds:.2f} s"


def _joints(of: Description) -> str:
    ends = f", {of.ends} of them end sites" if of.ends else ""
    return f"{len(of.joints)}{ends}"


def _channels(of: Description) -> str:
    counted = [f"{_short(order)} ({count})" for order, count in of.orders.items()]
    return _few(counted, 4) if counted else "none"


def _short(order: str) -> str:
    """ "Xposition Yposition Zrotation" as "XY positions, Z rotations"."""
    parts: list[tuple[str, str]] = []
    for channel in order.split():
        kind = channel[1:].lower()
        if parts and parts[-1][1] == kind:
            parts[-1] = (parts[-1][0] + channel[0], kind)
        else:
            parts.append((channel[0], kind))
    return " ".join(f"{axes} {kind}" for axes, kind in parts)


def _size(of: Description) -> str:
    if of.height is None:
        return "unknown: no frames"
    tall = f"{of.height:.4g} file units tall"
    if of.unit is not None:
        return f"{tall}, {of.height * of.unit:.2f} m"
    if of.unit_guess is None:
        return f"{tall}; no unit makes that a human's height"
    guess = of.unit_guess
    return f"{tall}; {guess.body_metres:.2f} m if the unit is {guess.name} ({guess.metres:.4g} m): a guess"


def _up(of: Description) -> str:
    if of.up_guess is None:
        return ""
    reason = "from feet to head" if of.up_guess.sure else "the body's longest side: a weak guess"
    return f"{of.up_guess.axis}, {reason}"


def _few(names: tuple[str, ...] | list[str], limit: int = 6) -> str:
    shown = ", ".join(names[:limit])
    return shown if len(names) <= limit else f"{shown} and {len(names) - limit} more"
