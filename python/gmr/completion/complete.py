"""A dataset is evaluated, what it cannot do is made, and it is evaluated again: with what got worse.

The clips are judged by what the character does with them, not
by what they hold: the second evaluation runs every trial of the first again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gmr.completion.candidates import SYNTHESISED
from gmr.completion.choosing import Choice
from gmr.completion.holes import Ask, grid_of, holes
from gmr.completion.offer import Kind
from gmr.errors import DatasetError
from gmr.evaluation.compare import renamed
from gmr.evaluation.evaluate import evaluate
from gmr.evaluation.result import Evaluation
from gmr.motion import Motion
from gmr.table import Table

__all__ = ["Completion", "Filler", "Progress", "complete", "completed_name", "with_straight"]

Filler: TypeAlias = Callable[[Ask, Motion], Motion | None]
"""Makes a clip of a movement on the skeleton of another motion; None where it cannot."""

_SUFFIX = ".bvh"
"""Made clips are named as the files that they may be written to."""

Progress: TypeAlias = Callable[[str, int, int], object]


@dataclass(frozen=True, eq=False)
class Completion:
    """A dataset before and after its holes were filled.

    Attributes:
        dataset: its name.
        before, after: the two evaluations, of the same trials.
        added: the clips that were made or chosen, by name.
        asked: what each of them was made for, where it was made for something.
        not_made: holes that nothing could be made for.
        source: what the clips were chosen from; "" where all were made.
        choices: the chosen clips, in the order of the choice.
        refused: clips that could not be chosen, and why.
        considered: how many clips could have been chosen.
        held_before: how many trials held before the first choice, with the features scaled as for choosing.
        noticed: what was noticed about the files that all this was read from, in sentences.
    """

    dataset: str
    before: Evaluation
    after: Evaluation
    added: Mapping[str, Motion]
    asked: Mapping[str, Ask]
    not_made: tuple[Ask, ...]
    source: str = ""
    choices: tuple[Choice, ...] = ()
    refused: Mapping[str, str] = field(default_factory=dict)
    considered: int = 0
    held_before: int = 0
    noticed: tuple[str, ...] = ()

    @cached_property
    def trials(self) -> Table:
        """One row a trial: what was asked, whether it held before and after, and the mean offset, speed error
        and turn rate error of both; metres, m/s and degrees/s."""
        before, after = grid_of(self.before), grid_of(self.after)
        speeds, turns = np.meshgrid(before.speeds, before.turn_rates_deg, indexing="ij")
        columns: dict[str, NDArray[Any]] = {"speed": speeds.ravel(), "turn_rate_deg": turns.ravel()}
        for name, grid in (("before", before), ("after", after)):
            columns[f"held_{name}"] = grid.held.ravel()
            columns[f"offset_{name}"] = grid.offset.ravel()
            columns[f"speed_error_{name}"] = grid.speed_error.ravel()
            columns[f"turn_rate_error_deg_{name}"] = grid.turn_rate_error_deg.ravel()
        return Table(columns)

    @cached_property
    def clips(self) -> Table:
        """One row a clip that was added: what it was made for (a chosen one for nothing: NaN), its
        ``seconds``, how long it is played in all trials (``played_seconds``), whether the trial that it was
        made for now ``holds``; the clip that it comes from (``source``), and what was done to that
        (``how``)."""
        played = dict(
            zip(self.after.measured.clips["clip"], self.after.measured.clips["played_seconds"], strict=True)
        )
        held = {(row["speed"], row["turn_rate_deg"]): row["held_after"] for row in self.trials.rows()}
        asks = [self.asked.get(name, _NOTHING) for name in self.added]
        origin = {choice.name: choice.candidate for choice in self.choices}
        return Table(
            {
                "clip": np.array(list(self.added), object),
                "speed": np.array([ask.speed for ask in asks], np.float64),
                "turn_rate_deg": np.array([ask.turn_rate_deg for ask in asks], np.float64),
                "seconds": np.array([m.frame_count * m.frame_time for m in self.added.values()], np.float64),
                "played_seconds": np.array([float(played.get(name, 0.0)) for name in self.added], np.float64),
                "holds": np.array([bool(held.get((a.speed, a.turn_rate_deg), False)) for a in asks], bool),
                "source": _text(origin[name].source if name in origin else name for name in self.added),
                "how": _text(origin[name].how if name in origin else SYNTHESISED for name in self.added),
            }
        )

    @cached_property
    def chosen(self) -> Table:
        """One row a choice, in order.

        The clip, where it comes from (``source``) and what was done to it (``how``); its ``seconds``; the
        ``bound`` that it was ranked by; what all trials lack of holding without it and with it
        (``cost_before``, ``cost_after``), and what it took away per second recorded (``gain``); how many
        trials hold with it; and how many clips were tried in its round.
        """
        rows = self.choices
        return Table(
            {
                "clip": _text(row.name for row in rows),
                "source": _text(row.candidate.source for row in rows),
                "how": _text(row.candidate.how for row in rows),
                **{
                    name: np.array([getattr(row, name) for row in rows], np.float64)
                    for name in ("seconds", "bound", "cost_before", "cost_after", "gain")
                },
                "held": np.array([row.held for row in rows], np.int64),
                "tried": np.array([row.tried for row in rows], np.int64),
            }
        )


_NOTHING: Final = Ask(math.nan, math.nan)


def _text(values: Iterable[str]) -> NDArray[np.object_]:
    return np.array(list(values), object)


def complete(
    motions: Mapping[str, Motion],
    fill: Filler,
    *,
    dataset: str = "motions",
    progress: Progress | None = None,
    **settings: Any,
) -> Completion:
    """Evaluate a dataset, fill its holes, evaluate it again.

    Args:
        motions: the clips by name, on one skeleton.
        fill: makes what is missing; see :func:`gmr.completion.synthesised`.
        dataset: what the whole is called.
        progress: called with the name of a phase, how much of it is done, and of how much.
        settings: of :func:`gmr.evaluate`, for both evaluations; trials at one speed only by default, for they
            tell the holes.

    Returns:
        Both evaluations and what was added. A dataset without holes is given back with nothing added.

    Raises:
        DatasetError: as :func:`gmr.evaluate`; or clips are missing that the first evaluation could use.
    """
    tell = progress or (lambda phase, done, of: None)

    def phase(name: str) -> Progress:
        return lambda what, done, of: tell(f"{name}: {what}", done, of)

    settings = {"scenarios": "constant", **settings}
    before = renamed(evaluate(motions, progress=phase("before"), **settings), dataset)
    like = _like(before, motions, settings)
    added: dict[str, Motion] = {}
    asked: dict[str, Ask] = {}
    not_made: list[Ask] = []
    wanted = with_straight(holes(before))
    for number, ask in enumerate(wanted):
        tell("making clips", number, len(wanted))
        made = fill(ask, like)
        if made is None:
            not_made.append(ask)
            continue
        name = _unused(f"made_{ask.name}", {*motions, *added}) + _SUFFIX
        added[name], asked[name] = made, ask
    tell("making clips", len(wanted), len(wanted))
    after = before
    if added:
        both = evaluate({**motions, **added}, progress=phase("after"), **settings)
        after = renamed(both, completed_name(dataset))
    if left_out := sorted(set(after.failed) - set(before.failed)):
        raise DatasetError(
            f"{left_out[0]} cannot be evaluated beside the dataset's own clips: {after.failed[left_out[0]]}"
        )
    return Completion(dataset, before, after, added, asked, tuple(not_made))


def _like(before: Evaluation, motions: Mapping[str, Motion], settings: Mapping[str, Any]) -> Motion:
    """A clip on whose skeleton others can be laid: one that stands as most of the dataset does."""
    assert before.simulation is not None
    usable = {name: motion for name, motion in motions.items() if name not in before.failed}
    reading = {name: settings.get(name) for name in ("names", "unit")}
    return Kind(before.simulation.database, usable, reading).like()


def completed_name(dataset: str) -> str:
    """What a dataset is called with what was added."""
    return f"{dataset}, completed"


def with_straight(asks: Iterable[Ask]) -> tuple[Ask, ...]:
    """With each speed straight ahead too, for that is how a trial gets to it."""
    asks = list(asks)
    return tuple(dict.fromkeys(sorted([*asks, *(ask.straight for ask in asks)])))


def _unused(name: str, taken: Container[str]) -> str:
    while name + _SUFFIX in taken:
        name += "_"
    return name
