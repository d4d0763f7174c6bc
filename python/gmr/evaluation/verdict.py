"""The evaluation in words that someone who plans a motion capture session can act on.

What the dataset holds, where it fails and why, which clips carry it, which are never played, what to capture
next. Every sentence is computed and carries its figures; the limits it speaks of are stated in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.blending_sentences import blending_sentences, lead_in_sentences
from gmr.evaluation.clip_sentences import clip_sentences
from gmr.evaluation.elsewhere_sentences import elsewhere_sentences
from gmr.evaluation.failure_sentences import capture_sentences, failure_sentences
from gmr.evaluation.path_sentences import path_sentences
from gmr.evaluation.regions import Grid, Limits, failures, held_rectangle
from gmr.evaluation.result import Verdict
from gmr.evaluation.scenario_sentences import scenario_sentences
from gmr.evaluation.seen_sentences import seen_sentences
from gmr.evaluation.words import STANDS, count, duration, listing, percent, some_of, span, switching, turning
from gmr.table import Table

__all__ = ["verdict", "what_counts"]

STRAIGHT_WITHIN_DEG: Final = 12.5
"""Turns slower than this, degrees per second, count as going straight: half a step of the paper's grid."""

DOES: Final = "This dataset does what it is asked in"

LOPSIDED: Final = 0.5
"""One side is called short when it has less than this share of the other side's seconds."""


def verdict(
    trials: Table,
    coverage: Table,
    clips: Table,
    usage: Table,
    *,
    poses: Table | None = None,
    segments: Table | None = None,
    notes: Sequence[str] = (),
    failed: Mapping[str, str] | None = None,
    limits: Limits | None = None,
) -> Verdict:
    """Put an evaluation into words.

    Args:
        trials, coverage, clips, usage: the tables of the evaluation.
        poses: its ``pose_coverage``; nothing is said of blending without it.
        segments: that of the stretches of switching trials, where there are any.
        notes: what was noticed or assumed on the way, one sentence each.
        failed: files that could not be used -> why.
        limits: within which a trial is said to hold.
    """
    grid = Grid.of(trials, coverage, limits or Limits())
    mirrored = bool(clips["mirrored"].any())
    regions = failures(grid)
    return Verdict(
        _headline(grid),
        (
            what_counts(grid),
            *_straight_sentences(grid),
            *_bridged_turns(grid),
            *failure_sentences(grid),
            *scenario_sentences(trials, coverage, segments, grid.limits),
            *path_sentences(trials, coverage, grid.limits),
            *seen_sentences(trials),
            *_side_sentences(coverage, mirrored),
            *clip_sentences(clips, usage),
            *elsewhere_sentences(grid, coverage, clips),
            *(blending_sentences(poses, mirrored=mirrored) if poses is not None else ()),
            *capture_sentences(grid, regions, mirrored),
            *(lead_in_sentences(poses, grid) if poses is not None else ()),
            *notes,
            *_failed_sentences(failed or {}),
        ),
    )


def _headline(grid: Grid) -> str:
    held, trials = int(grid.held.sum()), grid.held.size
    best = held_rectangle(grid)
    if best is None:
        return f"{DOES} none of {count(trials, 'trial')}: it cannot follow any path of this grid."
    where = f"{turning(*best.turn_rates_deg)} at {span(*best.speeds, 'm/s')}{_while(grid)}"
    if held == trials:
        return f"{DOES} {'the one trial' if trials == 1 else f'all {trials} trials'}: {where}."
    share = percent(held / trials)
    return f"{DOES} {held} of {count(trials, 'trial')} ({share}); it is good for {where}."


def _while(grid: Grid) -> str:
    """What else the trials are asked for, where they switch speeds."""
    return "" if grid.switching is None else f" while {switching(*grid.switching)}"


def what_counts(grid: Grid) -> str:
    """When a trial is said to be done as asked."""
    limits = grid.limits
    near = f"the character is within {limits.offset:g} m of where the planned path has it at that time, its"
    speed = "the speed" if grid.switching is None else "each of the two speeds"
    whose = near if grid.timed else "the character's"
    return (
        f"What is asked counts as done when, on average, {whose} speed is within "
        f"{percent(limits.speed)} of {speed} asked for, and its turn rate within "
        f"{limits.turn_rate_deg:g} degrees/s."
    )


def _straight_sentences(grid: Grid) -> Iterator[str]:
    column = np.flatnonzero(grid.turn_rates_deg == 0)
    if not len(column):
        return
    holds = grid.held[:, column[0]]
    ahead = f"Straight ahead{_while(grid)} it keeps"
    if holds.all():
        yield f"{ahead} {span(grid.speeds[0], grid.speeds[-1], 'm/s')} throughout."
    elif not holds.any():
        yield f"{ahead} no speed of the grid."
    else:
        kept, lost = _speeds(grid.speeds[holds]), _speeds(grid.speeds[~holds])
        yield f"{ahead} {kept} m/s, but not {lost} m/s."
    bridged = grid.speeds[holds & (grid.seconds[:, column[0]] < grid.limits.covered)]
    if len(bridged):
        yield (
            f"It keeps {_speeds(bridged)} m/s straight ahead only by switching between slower and faster "
            f"clips: they hold less than {duration(grid.limits.covered)} of such movement."
        )


def _bridged_turns(grid: Grid) -> Iterator[str]:
    """Turns that hold although the clips hardly have them."""
    bridged = grid.held & (grid.seconds < grid.limits.covered) & (grid.turn_rates_deg != 0)
    block = held_rectangle(replace(grid, held=bridged))
    if block is None:
        return
    number = int(bridged.sum())
    among = "" if block.trials == number else f"{block.trials} of them "
    yield (
        f"{number} of the {count(int(grid.held.sum()), 'trial')} that it does "
        f"{'is a turn' if number == 1 else 'are turns'} of which the clips hold less than "
        f"{duration(grid.limits.covered)} ({among}{turning(*block.turn_rates_deg)} at "
        f"{span(*block.speeds, 'm/s')}): it puts them together from pieces of other movements."
    )


def _speeds(speeds: NDArray[np.float64]) -> str:
    return listing([f"{speed:g}" for speed in speeds])


def _side_sentences(coverage: Table, mirrored: bool) -> Iterator[str]:
    turn, weight = coverage["turn_rate_deg"], coverage["weight"]
    goes = float(weight[coverage["speed"] >= STANDS].sum())
    if goes < 1:
        yield (
            f"The clips stand: {duration(goes)} of their {duration(float(weight.sum()))} go {STANDS:g} m/s "
            "or more. Where they show walking, they were exported in place: export them with the root's way "
            "over the ground."
        )
        return
    left = float(weight[turn > STRAIGHT_WITHIN_DEG].sum())
    right = float(weight[turn < -STRAIGHT_WITHIN_DEG].sum())
    if left + right < 1:
        yield (
            f"The clips only go straight: {duration(left + right)} of their {duration(float(weight.sum()))} "
            f"turn by more than {STRAIGHT_WITHIN_DEG:g} degrees/s."
        )
    elif not mirrored and min(left, right) < LOPSIDED * max(left, right):
        more, less = ("left", "right") if left > right else ("right", "left")
        yield (
            f"The clips turn {more} for {duration(max(left, right))} but {less} for only "
            f"{duration(min(left, right))}."
        )


def _failed_sentences(failed: Mapping[str, str]) -> Iterator[str]:
    if failed:
        verb = "was" if len(failed) == 1 else "were"
        files = some_of(list(failed), 5)
        yield f"{count(len(failed), 'file')} could not be used and {verb} left out: {files}."
