"""Where a dataset fails and why, and what to capture next, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from gmr.evaluation.regions import EITHER, LEFT, RIGHT, STRAIGHT, Grid, Region
from gmr.evaluation.words import circles, count, duration, gait, listing, number, span

__all__ = ["capture_sentences", "failure_sentences"]

MOST_REGIONS: Final = 3


def failure_sentences(grid: Grid, regions: Sequence[Region]) -> Iterator[str]:
    """Say of the largest regions what is asked there, what the clips have of it, and what goes wrong."""
    for region in regions[:MOST_REGIONS]:
        cells = tuple(region.cells.T)
        yield (
            f"It fails when {_movement(grid, region)} ({count(len(region.cells), 'trial')}): "
            f"{_clips_there(grid, region)}, and the character {_symptom(grid, region)} "
            f"(mean distance from the path {_range(grid.offset[cells])} m)."
        )
    if others := regions[MOST_REGIONS:]:
        trials = sum(len(region.cells) for region in others)
        verb = "fails" if trials == 1 else "fail"
        yield f"{count(trials, 'more trial')} {verb} here and there on the grid."


def _movement(grid: Grid, region: Region) -> str:
    speeds = grid.speeds[region.cells[:, 0]]
    turns = np.abs(grid.turn_rates_deg[region.cells[:, 1]])
    at = f"at {span(speeds.min(), speeds.max(), 'm/s')}"
    if region.side == STRAIGHT:
        return f"going straight {at}"
    by = span(turns.min(), turns.max(), "degrees/s")
    way = {EITHER: "either way", LEFT: "left, though not right,", RIGHT: "right, though not left,"}[
        region.side
    ]
    return f"turning {way} by {by} {at}"


def _clips_there(grid: Grid, region: Region) -> str:
    seconds = grid.seconds[tuple(region.cells.T)]
    empty = int((seconds < grid.limits.covered).sum())
    if seconds.sum() < 0.05:
        return "no clip moves like that"
    total = f"{duration(float(seconds.sum()))} of the clips move like that"
    if empty == 0:
        return total
    if empty == len(seconds):
        return f"only {total}"
    few = f"less than {duration(grid.limits.covered)}"
    return f"{total}, with {few} for {empty} of the {count(len(seconds), 'trial')}"


def _symptom(grid: Grid, region: Region) -> str:
    cells = tuple(region.cells.T)
    speed_error = float(grid.speed_error[cells].mean())
    asked = float(grid.speeds[region.cells[:, 0]].mean())
    turn = grid.turn_rates_deg[region.cells[:, 1]]
    turn_error = float((grid.turn_rate_error_deg[cells] * np.where(turn < 0, -1, 1)).mean())
    wrong = []
    if abs(speed_error) > grid.limits.speed * asked / 2:
        wrong.append(f"goes {number(abs(speed_error))} m/s too {'slowly' if speed_error < 0 else 'fast'}")
    if abs(turn_error) > grid.limits.turn_rate_deg / 2:
        wrong.append(
            f"turns {number(abs(turn_error))} degrees/s too {'slowly' if turn_error < 0 else 'fast'}"
        )
    return listing(wrong) or "keeps its speed and turn rate but strays from its path"


def _range(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> str:
    low, high = number(float(values.min())), number(float(values.max()))
    return low if low == high else f"{low} to {high}"


def capture_sentences(grid: Grid, regions: Sequence[Region], mirrored: bool) -> Iterator[str]:
    """Say what to capture next: the failing movements that the clips hardly contain."""
    lacking = [
        Region(region.side, region.cells[grid.seconds[tuple(region.cells.T)] < grid.limits.covered])
        for region in regions
    ]
    lacking = sorted(filter(lambda region: len(region.cells), lacking), key=lambda region: -len(region.cells))
    if lacking:
        yield f"Capture next: {'; '.join(_to_capture(grid, region) for region in lacking[:MOST_REGIONS])}."
        if not mirrored and any(region.side == EITHER for region in lacking[:MOST_REGIONS]):
            yield "One side of the turns is enough when mirrored copies are used (--mirror)."
    elif regions:
        yield (
            "Every movement that fails is in the clips already, so more of the same may not help: the replay "
            "of the worst trial shows what breaks, and takes that lead from one movement into the next are "
            "the likely cure."
        )
    else:
        yield "Nothing on this grid needs another capture."


def _to_capture(grid: Grid, region: Region) -> str:
    speeds = grid.speeds[region.cells[:, 0]]
    turns = np.abs(grid.turn_rates_deg[region.cells[:, 1]])
    how = f"at {span(speeds.min(), speeds.max(), 'm/s')} ({gait(speeds.min(), speeds.max())}"
    if region.side == STRAIGHT:
        return f"straight lines {how})"
    way = {EITHER: "left and right", LEFT: "left", RIGHT: "right"}[region.side]
    radii = speeds / np.radians(turns)
    return f"{way} turns {how}, on {circles(radii.min(), radii.max())})"
