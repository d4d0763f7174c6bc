"""A pruning in words: what can go, what it costs, which clips matter most."""

from __future__ import annotations

import math
from collections.abc import Iterator

from gmr.evaluation.words import count, duration, listing, number, percent
from gmr.pruning.curve import Point
from gmr.pruning.part import recordings_of
from gmr.pruning.prune import Pruning

__all__ = ["curve_sentence", "headline", "held_sentence", "importance_sentence", "sentences"]

MOST_NAMES = 3


def headline(of: Pruning) -> str:
    """What can go and what it costs, in one sentence."""
    share = percent(_gone(of, of.chosen))
    if of.chosen.lossless:
        return f"{share} of the seconds can go, and every trial stays the same, bit by bit."
    return f"{share} of the seconds can go; {_cost(of, of.chosen)}."


def sentences(of: Pruning) -> list[str]:
    """What stands behind it, in reading order."""
    return [_lossless(of), curve_sentence(of), importance_sentence(of), *_what_counts(of)]


def _what_counts(of: Pruning) -> Iterator[str]:
    if not math.isnan(of.outcomes.score.offset):
        yield (
            "The mean offset is how far the character is from where the path has it at that time, over all "
            f"trials{' of constant speed and turn rate' if of.outcomes.steady.any() else ''}."
        )


def _lossless(of: Pruning) -> str:
    whole, left = of.curve.points[0].part, of.lossless
    clips = recordings_of(of.simulation.database)
    kept = [each.name for each in clips if left.ranges[each.name]]
    cut = [name for name in kept if left.ranges[name] != whole.ranges[name]]
    if not cut and len(kept) == len(clips):
        return f"No half second of the {duration(whole.seconds)} can go without a change to a trial."
    return (
        f"No trial needs {duration(whole.seconds - left.seconds)} of {duration(whole.seconds)} "
        f"({percent(1 - left.seconds / whole.seconds)}): {count(len(clips) - len(kept), 'clip')} of "
        f"{len(clips)} as a whole, and parts of {len(cut) or 'none'}. Without them "
        f"{count(of.outcomes.score.runs, 'trial')} were run again, and all are the same in every bit."
    )


def curve_sentence(of: Pruning) -> str:
    """What the curve of quality for size shows."""
    points = [point for point in of.curve.points if not point.lossless]
    if not points:
        return "Nothing else was taken away."
    last = points[-1]
    parts = [f"with {percent(_gone(of, last))} gone {_cost(of, last)}"]
    if of.chosen in points and of.chosen is not last:
        parts.insert(0, f"with {percent(_gone(of, of.chosen))} gone {_cost(of, of.chosen)}")
    said = "; ".join(parts)
    return f"From there on it costs: {said}."


def held_sentence(of: Pruning) -> str:
    """How long all trials go on that hold on the whole."""
    before, kept = of.outcomes.score, [p for p in of.curve.points if p.score.held >= of.outcomes.score.held]
    smallest = min(kept, key=lambda point: point.part.seconds)
    return (
        f"As many trials hold as on the whole dataset ({before.held} of {before.runs}) down to "
        f"{percent(1 - _gone(of, smallest))} of the seconds."
    )


def importance_sentence(of: Pruning) -> str:
    """Which clips matter most, left out alone."""
    rows = list(of.importance.rows())
    harmless = [row for row in rows if row["loss"] == 0]
    mattering = [row for row in rows if not row["loss"] <= 0][:MOST_NAMES]
    helped = [row for row in rows if row["loss"] < 0]
    if not mattering:
        first = "No clip is missed when it is left out alone."
    else:
        named = listing([f"{row['clip']} ({_change(row)})" for row in mattering])
        first = f"Left out alone, the clips that are missed most are {named}."
    return " ".join([first, *_others(len(harmless), len(helped), len(rows))])


def _others(harmless: int, helped: int, every: int) -> Iterator[str]:
    if harmless:
        yield f"{harmless} of {every} change neither."
    if helped:
        yield f"Without {count(helped, 'clip')}, each alone, the character does better."


def _change(row: dict[str, float]) -> str:
    if math.isnan(row["loss"]):
        return "nothing would be left to play"
    parts = []
    if math.isfinite(row["offset_change"]):
        sign = "-" if row["offset_change"] < 0 else "+"
        parts.append(f"{sign}{number(abs(row['offset_change']))} m")
    if row["held_change"]:
        parts.append(f"{row['held_change']:+.0f} trials")
    return ", ".join(parts)


def _gone(of: Pruning, point: Point) -> float:
    return 1 - point.part.seconds / of.curve.points[0].part.seconds


def _cost(of: Pruning, point: Point) -> str:
    """What a point costs, as a clause."""
    before, after = of.outcomes.score, point.score
    held = f"{after.held} of {count(after.runs, 'trial')} hold where {before.held} did"
    if math.isnan(after.offset):
        return held
    return f"the mean offset is {after.offset:.3f} m where it was {before.offset:.3f} m, and {held}"
