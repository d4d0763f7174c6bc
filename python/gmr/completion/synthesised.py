"""What is missing, synthesised from actionlets on the dataset's own skeleton."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from gmr.completion.complete import Filler
from gmr.completion.holes import Ask

if TYPE_CHECKING:
    from gmr.actionlets import Action
    from gmr.motion import Motion

__all__ = ["synthesised"]

_ACTIONS: Final = ("walk", "run")
"""Tried in this order: the first whose parameters reach the speed and the turn rate."""

_STRAIGHT: Final = 0.25
"""Share of a clip's time that goes straight before it turns: what leads into a turn is asked for too."""

_TURNING_IN: Final = 0.5
"""Seconds from straight to the full turn rate."""


def synthesised(
    *,
    seconds: float = 8.0,
    fps: float | None = None,
    variation: float = 0.2,
    seed: int = 0,
    actions: tuple[str, ...] = _ACTIONS,
) -> Filler:
    """Makes clips of walking and running at any speed and turn rate that these actions reach.

    Args:
        seconds: length of a clip; a turn begins straight.
        fps: of the clips; the dataset's where left out.
        variation, seed: see :meth:`gmr.actionlets.Action.perform`; each clip has a seed of its own.
        actions: of the library, tried in this order.

    Returns:
        A filler for :func:`gmr.completion.complete`. Its clips are laid on the skeleton by
        :func:`gmr.skinning.retarget`, after being made for a body of that skeleton's proportions.
    """
    from gmr.actionlets import library

    known = library()
    chosen = {name: known[name] for name in actions}

    def fill(ask: Ask, like: Motion) -> Motion | None:
        action = _reaching(chosen, ask)
        if action is None:
            return None
        from gmr.actionlets import Body
        from gmr.skinning.driving.other_skeleton import retarget

        take = action.take(
            seconds,
            fps or like.fps,
            seed=_seed_of(seed, ask),
            body=Body.like(like),
            variation=variation,
            speed=ask.speed,
            turn_rate=_turning_in(ask.turn_rate_deg, seconds),
        )
        return retarget(take.motion, like).motion

    return fill


def _reaching(actions: Mapping[str, Action], ask: Ask) -> Action | None:
    for action in actions.values():
        speed, turn = action.parameters["speed"], action.parameters["turn_rate"]
        if speed.low <= ask.speed <= speed.high and turn.low <= ask.turn_rate_deg <= turn.high:
            return action
    return None


def _turning_in(turn_rate_deg: float, seconds: float) -> list[tuple[float, float]] | float:
    """(seconds, degrees/s) points of the turn rate over time."""
    if turn_rate_deg == 0:
        return 0.0
    begin = _STRAIGHT * seconds
    return [(0.0, 0.0), (begin, 0.0), (begin + _TURNING_IN, turn_rate_deg), (seconds, turn_rate_deg)]


def _seed_of(seed: int, ask: Ask) -> int:
    """One for each clip, whatever other clips are made; the same for left as for right."""
    return seed * 1_000_003 + round(1000 * ask.speed) * 1_009 + round(10 * abs(ask.turn_rate_deg))
