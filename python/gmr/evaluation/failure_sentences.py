"""Where a dataset fails and why, and what to capture next, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.regions import EITHER, LEFT, LEFT_ONLY, RIGHT, RIGHT_ONLY, STRAIGHT, Grid, Region
from gmr.evaluation.words import GAITS, circles, count, duration, gait_of, listing, number, span

__all__ = ["capture_sentences", "failure_sentences"]

MOST_REGIONS: Final = 3

SMALLEST_SHARE: Final = 0.03
"""Regions with a smaller share of the trials are counted, not described."""


def failure_sentences(grid: Grid, regions: Sequence[Region]) -> Iterator[str]:
    """Say of the largest regions what is asked there, what the clips have of it, and what goes wrong."""
    told = [_filled(grid, region) for region in _worth_telling(grid, regions)]
    for region in told:
        away = f" (mean distance from the path {_range(grid.offset[tuple(region.cells.T)])} m)"
        yield (
            f"It fails when {_movement(grid, region)} ({_trials(grid, region)}): "
            f"{_clips_there(grid, region)}, and the character {_symptom(grid, region)}"
            f"{away if grid.timed else ''}."
        )
    untold = ~grid.held
    for region in told:
        untold[tuple(region.cells.T)] = False
    others = int(untold.sum())
    if others:
        verb = "fails" if others == 1 else "fail"
        yield f"{count(others, 'more trial')} {verb} here and there on the grid."


def _worth_telling(grid: Grid, regions: Sequence[Region]) -> list[Region]:
    """The largest regions; small ones about the rim of others would only repeat them."""
    least = SMALLEST_SHARE * grid.held.size
    large = [region for region in regions if region.side == STRAIGHT or len(region.cells) >= least]
    return (large or list(regions))[:MOST_REGIONS]


def _movement(grid: Grid, region: Region) -> str:
    speeds = grid.speeds[region.cells[:, 0]]
    turns = np.abs(grid.turn_rates_deg[region.cells[:, 1]])
    at = f"at {span(speeds.min(), speeds.max(), 'm/s')}"
    if region.side == STRAIGHT:
        return f"going straight {at}"
    by = span(turns.min(), turns.max(), "degrees/s")
    return f"turning {region.side} by {by} {at}"


def _trials(grid: Grid, region: Region) -> str:
    """How many trials fail, out of those within the speeds and turn rates that the region spans."""
    failing, among = len(region.cells), int(_spanned(grid, region).sum())
    return count(failing, "trial") if failing == among else f"{failing} of {count(among, 'trial')}"


def _filled(grid: Grid, region: Region) -> Region:
    """The region with all else that fails within what it spans, which the words about it speak of, too."""
    return Region(region.side, np.argwhere(_spanned(grid, region) & ~grid.held))


def _spanned(grid: Grid, region: Region) -> NDArray[np.bool_]:
    """(V, W) the trials within the speeds and turn rates of a region, on its side or sides."""
    speeds, turns = grid.speeds[region.cells[:, 0]], grid.turn_rates_deg[region.cells[:, 1]]
    sides = np.isin(np.sign(grid.turn_rates_deg), np.sign(turns))
    steep = np.abs(grid.turn_rates_deg)
    turning = sides & (steep >= np.abs(turns).min()) & (steep <= np.abs(turns).max())
    fast = (grid.speeds >= speeds.min()) & (grid.speeds <= speeds.max())
    return np.asarray(fast[:, None] & turning)


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
    lacking = [_lacking(grid, region) for region in regions]
    lacking = sorted(
        (region for region in lacking if len(region.cells)), key=lambda region: -len(region.cells)
    )
    told = _worth_telling(grid, lacking)
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
