"""A pruning in words: what can go, what it costs, which clips matter most."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gmr.evaluation.words import count, duration, hold, listing, number, percent
from gmr.matching.duplicates import duplicates_clause
from gmr.pruning.curve import Point
from gmr.pruning.outcomes import Score
from gmr.pruning.prune import Pruning

if TYPE_CHECKING:
    from gmr.pruning.writing import Written

__all__ = [
    *("asked_sentence", "curve_sentence", "headline", "held_sentence", "importance_sentence"),
    *("opening_sentences", "sentences", "twice_sentence"),
]

MOST_NAMES = 3


def headline(of: Pruning, written: Written | None = None) -> str:
    """What can go and what it costs, in one sentence; two where the features' scale decides.

    Args:
        of: the pruning.
        written: the files, where they were: then the cost is what an evaluation of the new folder shows.
    """
    can_go = f"{percent(_gone(of, written or of.chosen))} of the seconds can go"
    if not of.chosen.lossless or not (written is None or written.identical):
        return f"{can_go}; {_cost(of, of.chosen) if written is None else f'the new folder {_does(written)}'}."
    free = f"{can_go}, and every trial stays the same, bit by bit."
    if written is None or written.own_scale == written.whole:
        return free
    return (
        f"{free} With the features scaled by what is left, as an evaluation of the new folder has them, it "
        f"{_does(written)}."
    )


def sentences(of: Pruning) -> list[str]:
    """What stands behind it, in reading order."""
    return [*opening_sentences(of), curve_sentence(of), importance_sentence(of), *_what_counts(of)]


def opening_sentences(of: Pruning) -> list[str]:
    """Those of them that no figure says."""
    return [*asked_sentence(of), _lossless(of), *twice_sentence(of)]


def asked_sentence(of: Pruning) -> Iterator[str]:
    """How much was asked for, where more goes."""
    if isinstance(of.goal, str):
        return
    asked, taken = percent(of.goal), percent(_gone(of, of.chosen))
    if asked != taken:
        yield f"{asked} was asked for; the smallest step that reaches it takes {taken}."


def _what_counts(of: Pruning) -> Iterator[str]:
    if not math.isnan(of.outcomes.score.offset):
        yield (
            "The mean offset is how far the character is from where the path has it at that time, over all "
            f"trials{' of constant speed and turn rate' if of.outcomes.steady.any() else ''}."
        )


def _lossless(of: Pruning) -> str:
    whole, left = of.curve.points[0].part, of.lossless
    kept = [name for name in whole.ranges if left.ranges[name]]
    cut = [name for name in kept if left.ranges[name] != whole.ranges[name]]
    clips = len(whole.ranges)
    if not cut and len(kept) == clips:
        return f"No half second of the {duration(whole.seconds)} can go without a change to a trial."
    parts = f"parts of {len(cut)}" if cut else "no part of another"
    return (
        f"No trial needs {duration(whole.seconds - left.seconds)} of {duration(whole.seconds)} "
        f"({percent(1 - left.seconds / whole.seconds)}): {count(clips - len(kept), 'clip')} of "
        f"{clips} as a whole, and {parts}. Without them "
        f"{count(of.outcomes.score.runs, 'trial')} were run again, and all are the same in every bit."
    )


def twice_sentence(of: Pruning) -> Iterator[str]:
    """Which of them go because another is the same motion, where there are such."""
    if twice := of.simulation.database.duplicates:
        yield f"{duplicates_clause(twice)} and went first."


def curve_sentence(of: Pruning) -> str:
    """What the curve of quality for size shows."""
    points = [point for point in of.curve.points if not point.lossless]
    if not points:
        return "Nothing else was taken away."
    last = points[-1]
    parts = [f"with {percent(_gone(of, last))} gone {_cost(of, last)}"]
    if of.chosen in points and of.chosen is not last:
        parts.insert(0, f"with {percent(_gone(of, of.chosen))} gone {_cost(of, of.chosen)}")
    told = [last] if len(parts) == 1 else [of.chosen, last]
    costs = [_costs(of, point) for point in told]
    beyond = "it costs" if all(costs) else "trials change"
    if not any(costs):
        beyond += ", yet on the whole not for the worse"
    return f"Beyond what no trial needs, {beyond}: {'; '.join(parts)}."


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
        most = "clip that is missed most is" if len(mattering) == 1 else "clips that are missed most are"
        first = f"Left out alone, the {most} {named}."
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
        trials = "trial" if abs(row["held_change"]) == 1 else "trials"
        parts.append(f"{row['held_change']:+.0f} {trials}")
    return ", ".join(parts)


def _gone(of: Pruning, point: Point | Written) -> float:
    return 1 - point.part.seconds / of.curve.points[0].part.seconds


def _costs(of: Pruning, point: Point) -> bool:
    """Whether a point does worse than the whole in either figure, as they are told."""
    before, after = of.outcomes.score, point.score
    return after.held < before.held or _metres(after) > _metres(before)


def _metres(score: Score) -> float:
    """The mean offset as it is told."""
    return round(score.offset, 3)


def _cost(of: Pruning, point: Point) -> str:
    """What a point costs, as a clause."""
    before, after = of.outcomes.score, point.score
    held = f"{after.held} of {count(after.runs, 'trial')} {hold(after.held)}"
    held += ", as before" if after.held == before.held else f" where {before.held} did"
    if math.isnan(after.offset):
        return held
    if _metres(after) == _metres(before):
        return f"the mean offset stays {before.offset:.3f} m, and {held}"
    return f"the mean offset is {after.offset:.3f} m where it was {before.offset:.3f} m, and {held}"


def _does(written: Written) -> str:
    """What the new folder does by itself, beside the whole dataset, as a clause without its subject."""
    before, after = written.whole, written.own_scale
    as_many = after.held == before.held
    held = ", as many as the whole dataset" if as_many else f" where the whole dataset does {before.held}"
    said = f"does {after.held} of {count(after.runs, 'trial')}{held}"
    if math.isnan(after.offset):
        return said
    far = f"its mean offset is {after.offset:.3f} m where that of the whole is {before.offset:.3f} m"
    return f"{said}, and {far}"
