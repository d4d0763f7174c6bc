"""``gmr roots``: which joints of a motion are roots, and another choice of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gmr.cli.common import STDIO, naming, read_noting, say, write_output

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["Joints", "roots"]


class Joints(click.ParamType[tuple[str, ...]]):
    """Names of joints, with commas between them."""

    name = "A,B,C"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, ...]:
        """The names."""
        if isinstance(value, tuple):
            return value
        names = tuple(name.strip() for name in value.split(","))
        if not all(names):
            self.fail(f"'{value}' has an empty name in it; write names with single commas", param, ctx)
        return names


@click.command(short_help="Show or choose the roots of a motion.")
@click.argument("file", metavar="FILE")
@click.option("--set", "chosen", type=Joints(), help="Make just these joints roots, whatever they are now.")
@click.option("--split", "splits", type=Joints(), help="Make these joints roots too.")
@click.option("--join", "joins", type=Joints(), help="Hang these roots on their old parents again.")
@click.option("--shift", "shifts", type=Joints(), help="Turn the trees of these joints over to them.")
@click.option("--out", metavar="OUT", help="Where to write the motion; beside FILE, as .gmr, by default.")
@click.option("--json", "as_json", is_flag=True, help="Print the forest as JSON.")
@click.option("--strict", is_flag=True, help="Refuse what is otherwise read with a note.")
def roots(
    file: str,
    chosen: tuple[str, ...] | None,
    splits: tuple[str, ...] | None,
    joins: tuple[str, ...] | None,
    shifts: tuple[str, ...] | None,
    out: str | None,
    as_json: bool,
    strict: bool,
) -> int:
    """Show which joints of a motion are roots, or choose others.

    A root has its place in the world in every frame; all other joints hang on one. Any joint can be a root,
    and several at once: all joints stay where they are, and all bones turn as they did.

    Without a choice, FILE's forest is printed as it is. With one, the motion is written to OUT (by suffix;
    BVH has one root, so trees are joined for it), and its forest is printed. FILE - is standard input, OUT -
    standard output. Choices are followed in this order: set, split, join, shift.

    \b
    Examples:
      gmr roots walk.bvh                                    what there is: roots, links, dummies
      gmr roots walk.bvh --set Hips,LeftHand,RightHand      hands with places of their own
      gmr roots walk.bvh --shift Neck --out neck.bvh        the same walk, hanging on its neck
      gmr roots walk.gmr --join LeftHand --out again.gmr
      gmr roots walk.bvh --split Head --out - | gmr roots - --json

    Exit codes: 0 done, 1 the file could not be read, changed so or written, 2 wrong usage, 130 interrupted.
    """
    is_chosen = any((chosen, splits, joins, shifts))
    if out is not None and not is_chosen:
        raise click.UsageError("nothing to write: choose roots with --set, --split, --join or --shift")
    target = _target(file, out) if is_chosen else None
    if target == STDIO and as_json:
        raise click.UsageError("the motion goes to standard output, so the forest cannot; leave out --json")
    motion, warnings = read_noting(file, strict=strict)
    for warning in warnings:
        say(warning)
    with naming(motion):
        if chosen:
            motion = motion.with_roots(chosen)
        for joint in splits or ():
            motion = motion.split(joint)
        for root in joins or ():
            motion = motion.join(root)
        for joint in shifts or ():
            motion = motion.shift_root(joint)
    if target is not None:
        for second in write_output(motion, target, "gmr" if target == STDIO else None):
            say(f"the skeleton is in {second}")
    if target != STDIO:
        _print(motion, file, target, as_json)
    return 0


def _target(file: str, out: str | None) -> Path | str:
    """Where the motion goes to."""
    from gmr.errors import FormatError
    from gmr.formats.registry import format_of_file

    if out is None:
        if file == STDIO:
            return STDIO
        beside = Path(file).with_suffix(".gmr")
        if beside == Path(file):
            raise click.UsageError(f"'{file}' would be replaced; say where to write with --out")
        out = str(beside)
    if out == STDIO:
        return STDIO
    try:
        format_of_file(out, written=True)
    except FormatError as error:
        raise click.UsageError(str(error)) from error
    return Path(out)


def _print(motion: Motion, file: str, target: Path | str | None, as_json: bool) -> None:
    from gmr.forest_outline import described, drawn

    if as_json:
        click.echo(json.dumps({"file": file, **described(motion)}, indent=2))
        return
    click.echo(drawn(motion))
    if target is not None:
        click.echo(f"written to {target}", err=True)
