"""Options of the commands that evaluate a dataset: the grid of trials, and how clips are to be understood."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final, TypeVar

import click

from gmr.cli.common import Unit

__all__ = ["evaluation_options"]

Command = TypeVar("Command", bound=Callable[..., Any])

VALUES: Final = "START:STOP:STEP|A,B,C"
MOST_VALUES: Final = 10_000


def evaluation_options(command: Command) -> Command:
    """``speeds``, ``turn_rates``, ``mirror``, ``names``, ``unit`` and ``threads`` as :func:`gmr.evaluate` has
    them."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def _values(
    context: click.Context, option: click.Parameter, text: str | tuple[float, ...] | None
) -> tuple[float, ...] | None:
    """Numbers typed as START:STOP:STEP, both ends included, or with commas."""
    if not isinstance(text, str):
        return text
    try:
        if ":" not in text:
            return tuple(float(part) for part in text.split(","))
        start, stop, step = (float(part) for part in text.split(":"))
    except ValueError:
        raise click.BadParameter(f"{text!r} is neither START:STOP:STEP nor numbers with commas.") from None
    steps = (stop - start) / step if step else math.nan
    if not 0 <= steps < MOST_VALUES:
        raise click.BadParameter(f"from {start:g} to {stop:g} in steps of {step:g} is no list of numbers.")
    return tuple(round(start + index * step, 9) for index in range(math.floor(steps + 1e-9) + 1))


def _roles(context: click.Context, option: click.Parameter, pairs: tuple[str, ...] | None) -> dict[str, str]:
    """Joints typed as ROLE=JOINT."""
    roles: dict[str, str] = {}
    for text in pairs or ():
        role, _, joint = text.partition("=")
        if not (role and joint):
            raise click.BadParameter(f"{text!r} is not ROLE=JOINT, as in left_foot=foot_l.")
        if role in roles:
            raise click.BadParameter(f"'{role}' is named twice, {roles[role]} and {joint}; say which it is.")
        roles[role] = joint
    if roles:
        from gmr.body.naming import ROLES

        if unknown := [role for role in roles if role not in ROLES]:
            raise click.BadParameter(f"no role is called '{unknown[0]}'; the roles are {', '.join(ROLES)}.")
    return roles


_OPTIONS: Final = (
    click.option(
        "--speeds", metavar=VALUES, callback=_values, help="Metres per second.  [default: 1:3:0.25]"
    ),
    click.option(
        "--turn-rates",
        metavar=VALUES,
        callback=_values,
        help="Degrees per second, positive to the left.  [default: -100:100:25]",
    ),
    click.option("--mirror", is_flag=True, help="Add the mirror image of every clip."),
    click.option(
        "--name",
        "names",
        metavar="ROLE=JOINT",
        multiple=True,
        callback=_roles,
        help="Say which joint is the hips, left_up_leg, right_up_leg, left_foot or right_foot. Repeatable.",
    ),
    click.option(
        "--unit", type=Unit(), help="Unit of length of the files: m, cm, mm, in, ft, cmu, or metres per unit."
    ),
    click.option("--threads", type=click.IntRange(min=1), help="How many to use.  [default: all cores]"),
)
