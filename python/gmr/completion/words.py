"""A completion in words: what was filled, what was lost, and what is still missing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.completion.choice_words import from_folder
from gmr.completion.complete import Completion
from gmr.completion.holes import Ask, grid_of
from gmr.evaluation.failure_sentences import capture_sentences
from gmr.evaluation.figures.wording import asked, metres
from gmr.evaluation.regions import failures
from gmr.evaluation.words import count, duration, percent, some_of

__all__ = ["change_sentence", "headline", "sentences"]

_MATTERS: Final = 0.1
"""Metres of mean offset below which a trial counts as no better and no worse."""

_SHOWN: Final = 4


def headline(of: Completion) -> str:
    """What the completion comes to, in a sentence."""
    before, after = _held(of, "before"), _held(of, "after")
    total = len(before)
    if before.all():
        all_of_them = "the one trial" if total == 1 else f"all {total} trials"
        return f"Nothing is missing: {of.dataset} does {all_of_them} that it is asked for."
    if of.source and not of.added and not of.considered:
        return (
            f"No clip of {of.source} could be tried: {of.dataset} does {int(before.sum())} of {total} trials."
        )
    if of.source and not of.added:
        return f"Nothing in {of.source} helps: {of.dataset} does {int(before.sum())} of {total} trials."
    filled, lost = int((after & ~before).sum()), int((before & ~after).sum())
    told = f"{count(filled, 'hole is', 'holes are')} filled" + (
        f", {count(lost, 'trial is', 'trials are')} lost" if lost else ", none is lost"
    )
    return (
        f"With {count(len(of.added), _clip(of))} it does {int(after.sum())} of {total} trials "
        f"({percent(float(after.mean()))}) where it did {int(before.sum())}: {told}."
    )


def sentences(of: Completion) -> tuple[str, ...]:
    """What stands behind the headline, in reading order."""
    how = from_folder(of) if of.source else _made(of)
    return tuple(filter(None, (*how, _open(of), _to_capture(of), _worse(of), *_played(of), *of.noticed)))


def change_sentence(of: Completion) -> str:
    """What the map of the changes shows."""
    if not of.added:
        return "Nothing was added, so no trial has changed."
    change = _change(of)
    better, worse = int((change <= -_MATTERS).sum()), int((change >= _MATTERS).sum())
    closer = count(better, "trial comes", "trials come") if better else "No trial comes"
    farther = count(worse, "strays", "stray") if worse else "none strays"
    told = f"{closer} closer to the plan by {metres(_MATTERS)} or more, {farther} farther from it by as much"
    if not better:
        return f"{told}."
    best = int(np.nanargmin(change))
    return (
        f"{told}; the greatest gain is at {_asked(of, best)}, from {metres(_offset(of, 'before')[best])} to "
        f"{metres(_offset(of, 'after')[best])}."
    )


def _made(of: Completion) -> Iterator[str]:
    if of.added:
        seconds = float(of.clips["seconds"].sum())
        missing = count(int((~_held(of, "before")).sum()), "hole")
        yield (
            f"{count(len(of.added), 'clip was', 'clips were')} made for {missing}, "
            f"{duration(seconds)} in all, beside {duration(of.before.summary.seconds)} that were there."
        )
    if of.not_made:
        yield f"Nothing could be made for {_listed(of.not_made)}: no action reaches so far."


def _open(of: Completion) -> str:
    still = np.flatnonzero(~_held(of, "before") & ~_held(of, "after"))
    if not len(still):
        return "" if _held(of, "before").all() else "No hole is left open."
    return f"Still open: {_places(of, still)}."


def _to_capture(of: Completion) -> str:
    """What the completed dataset still lacks, as its own verdict has it."""
    if not of.added or _held(of, "after").all():
        return ""
    grid = grid_of(of.after)
    first = next(capture_sentences(grid, failures(grid), of.after.summary.mirrored_count > 0))
    return f"Even so, {first[0].lower()}{first[1:]}"


def _worse(of: Completion) -> str:
    if not of.added:
        return ""
    before, after = _held(of, "before"), _held(of, "after")
    lost = np.flatnonzero(before & ~after)
    change = _change(of)
    farther = np.flatnonzero(before & after & (change >= _MATTERS))
    if not len(lost) and not len(farther):
        return f"It got worse nowhere: no trial that held is lost, none strays {metres(_MATTERS)} farther."
    parts = []
    if len(lost):
        parts.append(f"{_places(of, lost)} held before and {'does' if len(lost) == 1 else 'do'} not now")
    if len(farther):
        worst = farther[np.argmax(change[farther])]
        parts.append(
            f"{count(len(farther), 'trial that still holds strays', 'trials that still hold stray')} "
            f"{metres(_MATTERS)} or more farther, most at {_asked(of, int(worst))} "
            f"({metres(_offset(of, 'before')[worst])} before, {metres(_offset(of, 'after')[worst])} now)"
        )
    return f"It got worse, too: {'; '.join(parts)}."


def _played(of: Completion) -> Iterator[str]:
    if not of.added:
        return
    played = of.clips["played_seconds"]
    total = float(of.after.measured.clips["played_seconds"].sum())
    if total > 0:
        clips = f"{_clip(of)} is" if len(of.added) == 1 else f"{_clip(of)}s are"
        yield f"The {clips} played {percent(float(played.sum()) / total)} of the time."
    idle = of.clips["clip"][played == 0].tolist()
    if idle:
        told = count(len(idle), f"{_clip(of)} is", f"{_clip(of)}s are")
        yield f"{told} never played: {some_of(idle, _SHOWN)}."


def _clip(of: Completion) -> str:
    return "chosen clip" if of.source else "made clip"


def _held(of: Completion, when: str) -> NDArray[np.bool_]:
    return np.asarray(of.trials[f"held_{when}"], bool)


def _offset(of: Completion, when: str) -> NDArray[np.float64]:
    return np.asarray(of.trials[f"offset_{when}"], np.float64)


def _change(of: Completion) -> NDArray[np.float64]:
    return _offset(of, "after") - _offset(of, "before")


def _asked(of: Completion, row: int) -> str:
    return asked(float(of.trials["speed"][row]), float(of.trials["turn_rate_deg"][row]))


def _places(of: Completion, rows: NDArray[np.intp]) -> str:
    return some_of([_asked(of, int(row)) for row in rows], _SHOWN)


def _listed(asks: Sequence[Ask]) -> str:
    return some_of([asked(ask.speed, ask.turn_rate_deg) for ask in asks], _SHOWN)
