"""Several datasets in words: what all of them can do, what only one can, and what none does."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.regions import Grid, Limits, held_rectangle
from gmr.evaluation.result import Evaluation, Verdict
from gmr.evaluation.verdict import what_counts
from gmr.evaluation.words import count, duration, listing, span, turning

__all__ = ["all_of", "comparison_verdict", "grids_of"]

_NUMBERS: Final = {2: "both", 3: "all three", 4: "all four", 5: "all five"}


def comparison_verdict(evaluations: Sequence[Evaluation]) -> Verdict:
    """Put several evaluations of the same trials into words."""
    names = [evaluation.dataset for evaluation in evaluations]
    grids = grids_of(evaluations)
    held = np.stack([grid.held for grid in grids])
    return Verdict(
        _headline(names, held),
        (
            what_counts(grids[0]),
            _shared(grids[0], held),
            *_alone(names, grids[0], held),
            _none(grids[0], held),
            *_closest(names, grids, held),
            _amounts(evaluations),
        ),
    )


def grids_of(evaluations: Sequence[Evaluation]) -> list[Grid]:
    """The trials that the verdict judges, as a grid for each dataset."""
    return [Grid.of(each.measured.trials, each.measured.coverage, Limits()) for each in evaluations]


def all_of(number: int) -> str:
    """ "both", "all three", ..."""
    return _NUMBERS.get(number, f"all {number}")


def _headline(names: Sequence[str], held: NDArray[np.bool_]) -> str:
    done = held.sum(axis=(1, 2))
    order = np.argsort(-done, kind="stable").tolist()
    first, *others = order
    total = count(int(held[0].size), "trial")
    said = [
        f"{names[first]} does {done[first]} of {total} as asked",
        *(f"{names[k]} {done[k]}" for k in others),
    ]
    either = int(held.any(axis=0).sum())
    return f"{listing(said)}; {either} {'is' if either == 1 else 'are'} done by at least one of them."


def _shared(grid: Grid, held: NDArray[np.bool_]) -> str:
    shared: NDArray[np.bool_] = np.all(held, axis=0)
    all_ = all_of(len(held))
    number = int(shared.sum())
    if number == 0:
        return f"There is no trial that {all_} do as asked."
    return f"What {all_} can do: {count(number, 'trial')}, {_largest(grid, shared)}."


def _alone(names: Sequence[str], grid: Grid, held: NDArray[np.bool_]) -> Iterator[str]:
    nothing = []
    for place, name in enumerate(names):
        others: NDArray[np.bool_] = np.any(np.delete(held, place, axis=0), axis=0)
        only = held[place] & ~others
        number = int(only.sum())
        if number:
            more = (
                "" if (others & ~held[place]).any() else f" All that the other{_s(held)} can, {name} can too."
            )
            yield f"Only {name} does {count(number, 'trial')}: {_largest(grid, only)}.{more}"
        else:
            nothing.append(name)
    if nothing:
        verb = "does" if len(nothing) == 1 else "do"
        rival = "the other cannot" if len(held) == 2 else "no other can"
        yield f"{listing(nothing)} {verb} nothing that {rival}."


def _s(held: NDArray[np.bool_]) -> str:
    return "" if len(held) == 2 else "s"


def _none(grid: Grid, held: NDArray[np.bool_]) -> str:
    missing: NDArray[np.bool_] = ~np.any(held, axis=0)
    number = int(missing.sum())
    if number == 0:
        return "Every trial is done by one of them."
    return (
        f"{'Neither' if len(held) == 2 else 'None'} does {count(number, 'trial')}: {_largest(grid, missing)}."
    )


def _largest(grid: Grid, cells: NDArray[np.bool_]) -> str:
    """The largest block of some cells, in words, and how many of them lie in it."""
    block = held_rectangle(replace(grid, held=cells))
    if block is None:
        return "none"
    where = f"{turning(*block.turn_rates_deg)} at {span(*block.speeds, 'm/s')}"
    rest = int(cells.sum()) - block.trials
    if rest == 0:
        return where
    if block.trials == 1:
        return "here and there on the grid"
    return f"{block.trials} of them {where}, {'one elsewhere' if rest == 1 else 'the others here and there'}"


def _closest(names: Sequence[str], grids: Sequence[Grid], held: NDArray[np.bool_]) -> Iterator[str]:
    shared = held.all(axis=0)
    if not shared.any() or not all(grid.timed for grid in grids):
        return
    off = [100 * float(grid.offset[shared].mean()) for grid in grids]
    told = [f"{each:.0f} cm" for each in off]
    order = np.argsort(off, kind="stable").tolist()
    alike = [names[place] for place in order if told[place] == told[order[0]]]
    who = f"{names[order[0]]} keeps closest to its path"
    if len(alike) > 1:
        who = f"{listing(alike)} keep equally close to their path"
    rest = [f"{names[place]} {told[place]}" for place in order[len(alike) :]]
    yield (
        f"In the trials that {all_of(len(names))} do, {who}: {told[order[0]]} off on average"
        f"{f', {listing(rest)}' if rest else ''}."
    )


def _amounts(evaluations: Sequence[Evaluation]) -> str:
    said = [f"{each.dataset} {duration(each.summary.seconds)}" for each in evaluations]
    copies = any(each.summary.mirrored_count for each in evaluations)
    return f"How much motion they are{', mirrored copies counted' if copies else ''}: {listing(said)}."
