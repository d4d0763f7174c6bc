"""What was chosen from other clips, in words, and what could not be."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Final

import numpy as np

from gmr.completion.choosing import Choice
from gmr.completion.complete import Completion
from gmr.evaluation.words import count, duration, percent, some_of

__all__ = ["from_folder"]

_TOLD: Final = 5


def from_folder(of: Completion) -> Iterator[str]:
    """Say which clips were chosen, what each took away, by what scale, and which were refused."""
    missing = count(int((~np.asarray(of.trials["held_before"], bool)).sum()), "hole")
    if of.choices:
        seconds = sum(choice.seconds for choice in of.choices)
        yield (
            f"{count(len(of.choices), 'clip was', 'clips were')} chosen from {of.source} for {missing}, "
            f"{duration(seconds)} in all, beside {duration(of.before.summary.seconds)} that were there: "
            f"{_kinds(of.choices)}."
        )
        yield _in_order(of.choices)
        yield _scales(of)
    elif of.considered:
        yield (f"No clip of {of.source} takes away 1% of what the trials lack without losing a trial.")
    yield from _refused(of)


def _kinds(choices: tuple[Choice, ...]) -> str:
    kinds = Counter(choice.candidate.how for choice in choices).most_common()
    return "; ".join(f"{how} ({times})" if len(kinds) > 1 else how for how, times in kinds)


def _in_order(choices: tuple[Choice, ...]) -> str:
    told = [
        f"{choice.name} ({duration(choice.seconds)}, {count(choice.held, 'trial holds', 'trials hold')})"
        for choice in choices[:_TOLD]
    ]
    more = f" and {len(choices) - _TOLD} more" if len(choices) > _TOLD else ""
    which = "It" if len(choices) == 1 else "In this order each"
    return (
        f"{which} took away most per second recorded: {', '.join(told)}{more}; what the trials "
        f"lack of holding fell by {percent(1 - choices[-1].cost_after / choices[0].cost_before)}."
    )


def _scales(of: Completion) -> str:
    anew = int(np.asarray(of.trials["held_after"], bool).sum())
    kept = of.choices[-1].held
    if anew == kept:
        return (
            "With the features scaled as in the dataset by itself, by which the clips were chosen, as many "
            "trials hold as with the features scaled anew over both."
        )
    return (
        f"With the features scaled as in the dataset by itself, by which the clips were chosen, {kept} "
        f"trials hold; scaled anew over both, as the completed folder will be seen, {anew}."
    )


def _refused(of: Completion) -> Iterator[str]:
    whys: dict[str, list[str]] = {}
    for name, why in of.refused.items():
        whys.setdefault(why, []).append(name)
    for why, names in whys.items():
        verb = "was" if len(names) == 1 else "were"
        who = f"{count(len(names), 'clip')} of {of.source}"
        yield f"{who} {verb} not considered ({some_of(names, 3)}): {why}."
