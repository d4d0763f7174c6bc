"""An evaluated dataset made smaller: what can go at no cost, what a clip is worth, quality for size."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from gmr.evaluation.elsewhere import Runs
from gmr.evaluation.result import Evaluation
from gmr.evaluation.simulation import Simulation
from gmr.pruning.curve import Curve, Point, curve_of
from gmr.pruning.importance import importance_table
from gmr.pruning.lossless import lossless_part, prove, simulation_of
from gmr.pruning.outcomes import Outcomes, joined, outcomes_of
from gmr.pruning.part import Part
from gmr.pruning.rerun import Rerun, here
from gmr.table import Table

__all__ = ["LOSSLESS", "Pruning", "goal_of", "prune"]

LOSSLESS = "lossless"

USUAL_END = 0.5
"""Share of the seconds to which the curve goes where less is asked for."""

Progress = Callable[[str, int, int], object]


@dataclass(frozen=True, eq=False)
class Pruning:
    """What can go from a dataset, and what that costs.

    Attributes:
        dataset: its name.
        goal: the share of the seconds that was to go, or "lossless".
        simulation: the trials on all of it.
        outcomes: what became of them.
        lossless: what must be left for every trial to stay the same; proved.
        importance: one row a clip; see :func:`gmr.pruning.importance_table`.
        curve: quality for size.
        chosen: the point of the curve that the goal picks.
        failed: files that could not be evaluated, and why.
    """

    dataset: str
    goal: float | str
    simulation: Simulation
    outcomes: Outcomes
    lossless: Part
    importance: Table
    curve: Curve
    chosen: Point
    failed: Mapping[str, str]


def prune(
    evaluation: Evaluation,
    goal: float | str = LOSSLESS,
    *,
    until: float = USUAL_END,
    threads: int = 0,
    rerun: Rerun | None = None,
    progress: Progress | None = None,
) -> Pruning:
    """Find a smaller dataset that does as well, or nearly.

    Args:
        evaluation: as :func:`gmr.evaluate` gives it, of this process.
        goal: the share of the seconds that shall go (0.3, or "30%"), or "lossless".
        until: the share to which the curve goes at least.
        threads: 0 for all cores; the result does not depend on it.
        rerun: where trials are run again; on threads of this process by default.
        progress: called with the name of a phase, how much of it is done, and of how much.

    Returns:
        The lossless part, the importance of each clip, the curve, and the point that the goal picks.

    Raises:
        GmrError: the evaluation holds no trials; or so much cannot go, for nothing would be left to play.
        ValueError: a goal that is no share.
    """
    share = goal_of(goal)
    tell = progress or (lambda phase, done, of: None)
    again = rerun or here(threads)
    simulation = simulation_of(evaluation)
    outcomes = joined([outcomes_of(log, simulation.trials) for log in simulation.logs.values()])
    tell("proving what can go", 0, 1)
    left = lossless_part(simulation.database, outcomes)
    prove(simulation, left, threads)
    tell("proving what can go", 1, 1)
    asked = Runs.of(simulation)
    importance = importance_table(
        asked, outcomes, again, lambda done, of: tell("leaving out each clip", done, of)
    )
    aim = 0.0 if isinstance(share, str) else share
    curve = curve_of(asked, outcomes, again, tell, aim, until)
    chosen = curve.lossless if isinstance(share, str) else curve.reached(share)
    return Pruning(
        dataset=evaluation.dataset,
        goal=share,
        simulation=simulation,
        outcomes=outcomes,
        lossless=left,
        importance=importance,
        curve=curve,
        chosen=chosen,
        failed=evaluation.failed,
    )


def goal_of(goal: float | str) -> float | str:
    """A goal as a share, or "lossless".

    Raises:
        ValueError: it is neither.
    """
    if goal == LOSSLESS:
        return LOSSLESS
    try:
        text = str(goal)
        share = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        share = float("nan")
    if not 0 < share < 1:
        raise ValueError(
            f"{goal!r} is no share of a dataset that can go; give more than 0% and less than 100%, "
            f"as in 30%, or {LOSSLESS}"
        )
    return share
