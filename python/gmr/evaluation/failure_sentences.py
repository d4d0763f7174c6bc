"""Where a dataset fails and why, and what to capture next, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.failing_blocks import APART, Block, failing_blocks
from gmr.evaluation.regions import EITHER, LEFT, LEFT_ONLY, RIGHT, RIGHT_ONLY, STRAIGHT, Grid, Region
from gmr.evaluation.symptoms import symptom
from gmr.evaluation.words import GAITS, circles, count, duration, ends, gait_of, listing, span, switching

__all__ = ["capture_sentences", "failure_sentences"]

MOST_REGIONS: Final = 3

SMALLEST_SHARE: Final = 0.03
"""Regions with a smaller share of the trials are not told; they would only repeat the others."""


def failure_sentences(grid: Grid) -> Iterator[str]:
    """Say where most of the failing trials lie, what the clips have of it, and what goes wrong.

    Every failing trial is counted once: in the sentence that names what is asked of it, or among the rest.
    """
    blocks = failing_blocks(grid)
    for place, block in enumerate(blocks):
        trials = _trials(block, blocks[:place], blocks[place + 1 :])
        yield (
            f"It fails when {_movement(grid, block)} ({trials}): {_clips_there(grid, block)}, "
            f"and the character {symptom(grid, block)}."
        )
    others = int((~grid.held).sum()) - sum(len(block.cells) for block in blocks)
    if others:
        verb = "fails" if others == 1 else "fail"
        yield f"{count(others, 'more trial')} {verb} here and there."


def _movement(grid: Grid, block: Block) -> str:
    speeds = grid.speeds[block.cells[:, 0]]
    turns = grid.turn_rates_deg[block.cells[:, 1]]
    at = f"at {span(speeds.min(), speeds.max(), 'm/s')}"
    if grid.switching is not None:
        at += " while " + switching(*grid.switching)
    if block.side == STRAIGHT:
        return f"going straight {at}"
    if block.side == APART:
        left, right = turns[turns > 0], -turns[turns < 0]
        by_left, by_right = (ends(side.min(), side.max()) for side in (left, right))
        each = f"left by {by_left} and right by {by_right} degrees/s"
        return f"turning {each} {at}"
    steep = np.abs(turns)
    return f"turning {block.side} by {span(steep.min(), steep.max(), 'degrees/s')} {at}"


def _trials(block: Block, above: Sequence[Block], below: Sequence[Block]) -> str:
    """How many trials fail in this way, out of those within the speeds and turn rates that are named."""
    failing = len(block.cells)
    among = "" if failing == block.spanned else f" of {block.spanned}"
    trials = "trial" if failing == block.spanned == 1 else "trials"
    other = {LEFT: "right", RIGHT: "left"}.get(block.side)
    alone = ""
    if other and 2 * block.one_sided >= failing:
        alone = f"; for {block.one_sided} of the {failing} the same turn to the {other} holds"
    return f"{failing}{among} {trials}{_otherwise(block, above, below)}{alone}"


def _otherwise(block: Block, above: Sequence[Block], below: Sequence[Block]) -> str:
    """How many others within the span fail, and how many of these other sentences tell."""
    others = len(block.otherwise)
    if not others:
        return ""
    told = {"above": _among(block.otherwise, above), "below": _among(block.otherwise, below)}
    ways = "in another way" if others == 1 else "in other ways"
    more, elsewhere = f", {others} more {ways}", sum(told.values())
    if not elsewhere:
        return more
    some = "" if elsewhere == others else f"{elsewhere} of them "
    return f"{more}, {some}as told {listing([place for place, number in told.items() if number])}"


def _among(cells: NDArray[np.int64], blocks: Sequence[Block]) -> int:
    """How many trials some blocks tell."""
    told = {tuple(cell) for block in blocks for cell in block.cells.tolist()}
    return sum(tuple(cell) in told for cell in cells.tolist())


def _clips_there(grid: Grid, block: Block) -> str:
    seconds = grid.seconds[tuple(block.cells.T)]
    like = "like that"
    if grid.switching is not None:
        speeds = grid.speeds[block.cells[:, 0]]
        like += f" at {span(speeds.min(), speeds.max(), 'm/s')}"
    empty = int((seconds < grid.limits.covered).sum())
    if seconds.sum() < 0.05:
        return f"no clip moves {like}"
    total = f"{duration(float(seconds.sum()))} of the clips move {like}"
    if empty == 0:
        return total
    if empty == len(seconds):
        return f"only {total}"
    return f"{total}, under {duration(grid.limits.covered)} in {empty} of the trials"


def capture_sentences(grid: Grid, regions: Sequence[Region], mirrored: bool) -> Iterator[str]:
    """Say what to capture next: the failing movements that the clips hardly contain."""
    lacking = [_lacking(grid, region) for region in regions]
    lacking = sorted(
        (region for region in lacking if len(region.cells)), key=lambda region: -len(region.cells)
    )
    told = _worth_capturing(grid, lacking)
    to_mirror = [region for region in told if region.side in (LEFT_ONLY, RIGHT_ONLY) and not mirrored]
    to_capture = [region for region in told if region not in to_mirror]
    if to_capture:
        yield f"Capture next: {'; '.join(_to_capture(grid, region, mirrored) for region in to_capture)}."
    if not mirrored and any(region.side == EITHER for region in to_capture):
        yield "With mirrored copies of the clips (--mirror), turns to one side are enough."
    if to_mirror:
        yield (
            "Turns that fail to one side only need no capture: mirrored copies of the clips (--mirror) bring "
            "what the other side has."
        )
    if told:
        return
    if regions:
        yield (
            "Every movement that fails is in the clips already, so more of the same may not help: the replay "
            "of the worst trial shows what breaks, and takes that lead from one movement into the next are "
            "the likely cure."
        )
    else:
        yield "Nothing on this grid needs another capture."


def _worth_capturing(grid: Grid, regions: Sequence[Region]) -> list[Region]:
    """The largest regions; small ones about the rim of others would only repeat them."""
    least = SMALLEST_SHARE * grid.held.size
    large = [region for region in regions if region.side == STRAIGHT or len(region.cells) >= least]
    return (large or list(regions))[:MOST_REGIONS]


def _lacking(grid: Grid, region: Region) -> Region:
    return Region(region.side, region.cells[grid.seconds[tuple(region.cells.T)] < grid.limits.covered])


def _to_capture(grid: Grid, region: Region, mirrored: bool) -> str:
    speeds = grid.speeds[region.cells[:, 0]]
    turns = np.radians(np.abs(grid.turn_rates_deg[region.cells[:, 1]]))
    what = {
        STRAIGHT: "straight lines",
        EITHER: f"turns to the left {'or' if mirrored else 'and'} to the right",
        **dict.fromkeys((LEFT, LEFT_ONLY), "turns to the left"),
        **dict.fromkeys((RIGHT, RIGHT_ONLY), "turns to the right"),
    }[region.side]
    ways = []
    for gait in GAITS:
        chosen = np.array([gait_of(speed) == gait for speed in speeds.tolist()])
        if chosen.any():
            at = span(speeds[chosen].min(), speeds[chosen].max(), "m/s")
            radii = speeds[chosen] / turns[chosen] if region.side != STRAIGHT else None
            on = "" if radii is None else f", {circles(radii.min(), radii.max())}"
            ways.append(f"{gait} ({at}{on})")
    return f"{what} at {listing(ways)}"
