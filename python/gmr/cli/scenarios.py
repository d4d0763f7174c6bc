"""The options of ``gmr evaluate`` that say what the character is asked to do."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from gmr.evaluation.scenario import Switching
    from gmr.evaluation.scenarios.asked import Asked

__all__ = ["check_scenarios", "scenario_options"]

Command = TypeVar("Command", bound=Callable[..., Any])


def scenario_options(command: Command) -> Command:
    """``scenarios``, ``seed``, ``switched_speed`` and ``switch_every`` as :func:`gmr.evaluate` has them."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def check_scenarios(
    scenarios: tuple[Asked, ...],
    speeds: tuple[float, ...] | None,
    turn_rates: tuple[float, ...] | None,
    preset: str | None,
    seed: int,
    switching: Switching,
) -> None:
    """Learn before all the work what cannot be asked for.

    Raises:
        click.UsageError: names it.
    """
    from gmr.evaluation.scenario import DEFAULT_SPEEDS, DEFAULT_TURN_RATES_DEG
    from gmr.evaluation.scenarios.asked import asked_trials, scenarios_of
    from gmr.evaluation.scenarios.on_grid import OnGrid

    grid = OnGrid(
        speeds=speeds or DEFAULT_SPEEDS,
        turn_rates_deg=turn_rates or DEFAULT_TURN_RATES_DEG,
        preset=preset or "even",
        switching=switching,
    )
    try:
        grid.trials()
        asked_trials(scenarios_of(scenarios, grid, seed))
    except ValueError as error:
        raise click.UsageError(f"{error}.") from error


def _chosen(context: click.Context, option: click.Parameter, names: tuple[str, ...]) -> tuple[str, ...]:
    """The names, "both" being the two of the grid."""
    both = ("constant", "switching")
    each = [one for name in names or ("both",) for one in (both if name == "both" else (name,))]
    return tuple(dict.fromkeys(each))


_OPTIONS = (
    click.option(
        "--scenario",
        "scenarios",
        metavar="NAME|FILE",
        multiple=True,
        callback=_chosen,
        help="What is asked for: constant, switching, both, start-stop, slalom, strafe (sideways and "
        "backwards), splines (random paths), or a CSV file of path points (x,z or x,z,t or x,z,speed). "
        "Repeatable.  [default: both]",
    ),
    click.option("--seed", type=click.IntRange(min=0), default=0, help="Of the random paths.  [default: 0]"),
    click.option(
        "--switched-speed",
        type=float,
        default=4.0,
        show_default=True,
        help="The other speed of switching trials, metres per second.",
    ),
    click.option(
        "--switch-every",
        type=float,
        default=5.0,
        show_default=True,
        help="Seconds from one switch of the speed to the next.",
    ),
)
