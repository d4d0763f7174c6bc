"""The option of ``gmr evaluate`` that weighs the features anew."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from gmr.matching.schema import Schema

__all__ = ["weight_option"]

Command = TypeVar("Command", bound=Callable[..., Any])


def weight_option(command: Command) -> Command:
    """``schema`` as :func:`gmr.evaluate` has it."""
    return click.option(
        "--weight",
        "schema",
        metavar="GROUP=WEIGHT",
        multiple=True,
        callback=_schema,
        help="Weigh a group of features anew: foot position, foot velocity, hips velocity, trajectory "
        "position, trajectory facing. Repeatable.  [default: 0.75, 1, 1, 1, 1.5]",
    )(command)


def _schema(context: click.Context, option: click.Parameter, pairs: tuple[str, ...]) -> Schema:
    from gmr.errors import DatasetError
    from gmr.matching.schema import LOCOMOTION

    weights: dict[str, float] = {}
    for text in pairs:
        group, _, weight = text.partition("=")
        try:
            weights[group] = float(weight)
        except ValueError:
            raise click.BadParameter(f"{text!r} is not GROUP=WEIGHT, as in 'hips velocity=2'.") from None
    try:
        return LOCOMOTION.weighed(weights)
    except DatasetError as error:
        raise click.BadParameter(f"{error}.") from None
