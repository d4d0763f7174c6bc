"""Which weights of the features let a dataset follow its paths best, and whether that is more than chance.

The grid's trials are split like a checkerboard. On the one colour weights are searched; on the other, which
the search never sees, they are proved. Both halves have all speeds and turn rates, and the mirror image of a
cell is of its colour, so that mirrored clips do not carry over what was learned. Poses stay as they are: only
the distances of features are weighted anew.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation import metrics
from gmr.evaluation.evaluate import Source, evaluate
from gmr.evaluation.intervals import Interval, mean_interval
from gmr.evaluation.log import Log
from gmr.evaluation.regions import Limits
from gmr.evaluation.result import Evaluation
from gmr.evaluation.scenario import Trial
from gmr.evaluation.simulation import log_of
from gmr.evaluation.trials import speed_error_share
from gmr.evaluation.tuning.descent import Descent, Factors, descend
from gmr.evaluation.words import count
from gmr.matching.database import Database
from gmr.matching.schema import Schema
from gmr.matching.trial import Profile, run_trials
from gmr.table import Table

__all__ = ["Tuning", "tune"]

TRAINING: Final = "training"
HELD_OUT: Final = "held out"

WORTHWHILE: Final = 0.02
"""Share of the objective below which a gain is not worth other weights, however sure it is."""


@dataclass(frozen=True, slots=True)
class Tuning:
    """Weights that were tuned, and what they are worth.

    Attributes:
        dataset: its name.
        schema: the features, with the weights as they were.
        weights: what the search found, by the names of the schema's groups.
        smoothness: seconds: how much a metre of jumping a second counts beside a metre of offset.
        trials: one row a cell: set ("training" or "held out") speed turn_rate_deg, then offset_mean
            discontinuity_per_second objective held (whether the trial does what it is asked, as the verdict
            has it) with the weights as they were, and the same names with ``_tuned``.
        search: one row a step of the search: objective (over the training cells), best (whether it was the
            best so far), and the weight of each set of groups.
        gain: by how much the mean objective of the held-out cells falls, with its 95 % confidence interval
            over the cells (positive: better).
    """

    dataset: str
    schema: Schema
    weights: Mapping[str, float]
    smoothness: float
    trials: Table
    search: Table
    gain: Interval

    @property
    def beyond_chance(self) -> bool:
        """Whether the tuned weights do better on the cells that were held out, by more than chance."""
        return bool(self.gain.low > 0)

    @property
    def worthwhile(self) -> float:
        """Metres from which on a gain is worth other weights: a fiftieth of the objective of the cells held
        out, with the weights as they were."""
        return WORTHWHILE * self.mean(HELD_OUT, "objective")

    @property
    def loses_trials(self) -> bool:
        """Whether fewer of the cells that were held out hold with the tuned weights than did before."""
        before, after = self.holding(HELD_OUT)
        return after < before

    @property
    def improves(self) -> bool:
        """Whether they do better by more than chance, by so much that it is worth it, and lose no trial."""
        return self.beyond_chance and bool(self.gain.mean >= self.worthwhile) and not self.loses_trials

    @property
    def chosen(self) -> Schema:
        """The features with the weights to use: tuned where that improves, else as they were."""
        return self.schema.weighed(self.weights) if self.improves else self.schema

    @property
    def named(self) -> dict[str, tuple[float, float]]:
        """By the names of the search, of groups that share one, the weight as it was and as found."""
        best = int(np.flatnonzero(self.search["best"])[-1])
        return {
            name: (float(self.search[name][0]), float(self.search[name][best]))
            for name in self.search.column_names
            if name not in ("objective", "best")
        }

    def holding(self, which: str) -> tuple[int, int]:
        """How many cells of one set do what they are asked with the weights as they were, and tuned."""
        chosen = self.trials["set"] == which
        return int(self.trials["held"][chosen].sum()), int(self.trials["held_tuned"][chosen].sum())

    def mean(self, which: str, column: str) -> float:
        """The mean of a column of :attr:`trials` over the cells of one set."""
        return float(self.trials[column][self.trials["set"] == which].mean())


def tune(
    source: Evaluation | Source,
    *,
    smoothness: float = 1.0,
    most: int = 80,
    threads: int | None = None,
    progress: Callable[[str, int, int], object] | None = None,
    **settings: Any,
) -> Tuning:
    """Tune the weights of the feature groups.

    The objective is the mean over cells of ``offset + smoothness * jump``: the mean distance from where the
    path has the character at that time (m), and the distance that its joints jump by in a second (m/s:
    transitions a second times their mean pose discontinuity). Only ratios of weights matter, so the first
    group of the path ahead keeps its weight; left and right share one. The search is coordinate descent in
    the logarithm from the weights as they are, up to a factor of 16.

    Args:
        source: an evaluation with constant trials on a timed path, or what :func:`gmr.evaluate` takes.
        smoothness: seconds, 0 or more.
        most: runs of all training trials, at most.
        threads: how many to use, all cores by default; the result does not depend on it.
        progress: called with "tuning", how many runs are done, and of how many at most.
        **settings: of :func:`gmr.evaluate`, where a source is given that is no evaluation.

    Raises:
        ValueError: a smoothness that makes no sense; or the evaluation has lost its simulation, or has too
            few constant trials to hold some out.
        DatasetError: as :func:`gmr.evaluate`.
    """
    if not (0 <= smoothness < np.inf and most >= 2):
        raise ValueError(f"smoothness {smoothness:g} and {most} runs: give 0 or more, and two runs at least")
    if not isinstance(source, Evaluation):
        source = evaluate(source, scenarios="constant", threads=threads, progress=progress, **settings)
    cells = _Cells.of(source)
    tied = _tied(cells.database.schema)

    def on(which: NDArray[np.bool_], factors: Factors) -> Table:
        return cells.measured(which, _multipliers(cells.database.schema, tied, factors), smoothness, threads)

    runs = itertools.count(1)

    def objective(factors: Factors) -> float:
        found = float(on(cells.training, factors)["objective"].mean())
        if progress:
            progress("tuning", next(runs), most)
        return found

    kept = _kept(cells.database.schema, tied)
    descent = descend(objective, len(tied), [place for place in range(len(tied)) if place != kept], most)
    if progress:
        progress("tuning", most, most)
    ways = ((1.0,) * len(tied), descent.factors)
    trials = _joined(cells, [on(which, factors) for which in cells.sets for factors in ways])
    held_out = trials["set"] == HELD_OUT
    return Tuning(
        dataset=source.dataset,
        schema=cells.database.schema,
        weights=_weights(cells.database.schema, tied, descent.factors),
        smoothness=smoothness,
        trials=trials,
        search=_search(cells.database.schema, tied, descent),
        gain=mean_interval((trials["objective"] - trials["objective_tuned"])[held_out]),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Cells:
    """The grid's constant trials on a timed path.

    Attributes:
        database: what they run on.
        profiles: what the core runs.
        trials: what is asked for.
        speed, turn_rate_deg: (T,) of the cells.
        training: (T,) which of them the search sees.
    """

    database: Database
    profiles: tuple[Profile, ...]
    trials: tuple[Trial, ...]
    speed: NDArray[np.float64]
    turn_rate_deg: NDArray[np.float64]
    training: NDArray[np.bool_]

    @classmethod
    def of(cls, evaluation: Evaluation) -> _Cells:
        if evaluation.simulation is None:
            raise ValueError(
                "this evaluation was pickled and has lost its simulation; evaluate again to tune"
            )
        simulation = evaluation.simulation
        chosen = [place for place, trial in enumerate(simulation.trials) if trial.scenario == "constant"]
        speed = np.array([simulation.trials[place].speed for place in chosen])
        turn = np.array([simulation.trials[place].turn_rate_deg for place in chosen])
        training = _checkerboard(speed, turn)
        if min(training.sum(), (~training).sum()) < 2:
            raise ValueError(
                f"{count(len(chosen), 'constant trial')} cannot be split; evaluate at least four, "
                "in the constant scenario"
            )
        profiles = tuple(simulation.profiles[place] for place in chosen)
        trials = tuple(simulation.trials[place] for place in chosen)
        return cls(simulation.database, profiles, trials, speed, turn, training)

    @property
    def sets(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """The cells of training, and those held out."""
        return self.training, ~self.training

    def measured(
        self,
        which: NDArray[np.bool_],
        multipliers: NDArray[np.float32],
        smoothness: float,
        threads: int | None,
    ) -> Table:
        """Run some of the cells with weights, and measure them."""
        places = np.flatnonzero(which).tolist()
        profiles, trials = [self.profiles[at] for at in places], [self.trials[at] for at in places]
        log = log_of(run_trials(self.database, profiles, weights=multipliers, threads=threads or 0))
        offset = metrics.mean_where(metrics.offset(log), log.recorded)
        jumped = _jumped_per_second(log)
        turn_error = np.degrees(metrics.static_error(metrics.turn_rate(log), log.ref_turn_rate, log.moving))
        held = Limits().held(speed_error_share(trials, log), turn_error, offset, timed=True)
        return Table(
            {
                "offset_mean": offset,
                "discontinuity_per_second": jumped,
                "objective": offset + smoothness * jumped,
                "held": held,
            }
        )


def _jumped_per_second(log: Log) -> NDArray[np.float64]:
    """(T,) metres a second that the joints jump by: the mean distance at each jump, of all jumps."""
    jumps = np.where(log.moving & ~np.isnan(log.discontinuity), log.discontinuity, 0.0)
    return np.asarray(jumps.sum(axis=1) * log.rate / np.maximum(log.moving.sum(axis=1), 1))


def _checkerboard(speed: NDArray[np.float64], turn_rate: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(T,) the cells of the one colour, that of the slowest at the smallest turn."""
    row = np.unique(speed, return_inverse=True)[1]
    column = np.unique(np.abs(turn_rate), return_inverse=True)[1]
    return np.asarray((row + column) % 2 == 0)


def _tied(schema: Schema) -> dict[str, list[int]]:
    """The groups that share a weight, by a name for all of them: those of the left and the right."""
    tied: dict[str, list[int]] = {}
    for place, group in enumerate(schema.groups):
        name = " ".join(word for word in group.name.split() if word not in ("left", "right"))
        alike = next((key for key in (name,) if key in tied and _alike(schema, tied[key][0], place)), None)
        tied.setdefault(alike or (name if name not in tied else group.name), []).append(place)
    return tied


def _alike(schema: Schema, one: int, other: int) -> bool:
    first, second = schema.groups[one], schema.groups[other]
    return (first.measure, first.weight) == (second.measure, second.weight)


def _kept(schema: Schema, tied: Mapping[str, Sequence[int]]) -> int:
    """The set of groups that keeps its weight: the first of the path ahead, else the first."""
    ahead = [schema.groups[places[0]].measure == "root_position" for places in tied.values()]
    return ahead.index(True) if any(ahead) else 0


def _weights(schema: Schema, tied: Mapping[str, Sequence[int]], factors: Factors) -> dict[str, float]:
    return {
        group.name: group.weight * factor
        for group, factor in zip(schema.groups, _by_group(schema, tied, factors), strict=True)
    }


def _multipliers(schema: Schema, tied: Mapping[str, Sequence[int]], factors: Factors) -> NDArray[np.float32]:
    """(D,) what squared differences are multiplied by where weights are multiplied by the factors."""
    names = [group.name for group in schema.groups]
    return schema.spread(
        {name: factor**2 for name, factor in zip(names, _by_group(schema, tied, factors), strict=True)}
    )


def _by_group(schema: Schema, tied: Mapping[str, Sequence[int]], factors: Factors) -> list[float]:
    """One factor for each group."""
    found = {place: factor for places, factor in zip(tied.values(), factors, strict=True) for place in places}
    return [found[place] for place in range(len(schema.groups))]


def _joined(cells: _Cells, measured: Sequence[Table]) -> Table:
    """The table of trials from training as it was, training tuned, held out as it was, held out tuned."""
    order = np.concatenate([np.flatnonzero(which) for which in cells.sets])
    names = np.repeat([TRAINING, HELD_OUT], [int(which.sum()) for which in cells.sets]).astype(object)
    before, after = Table.joined(measured[0::2]), Table.joined(measured[1::2])
    return Table(
        {
            "set": names,
            "speed": cells.speed[order],
            "turn_rate_deg": cells.turn_rate_deg[order],
            **dict(before),
            **{f"{name}_tuned": column for name, column in dict(after).items()},
        }
    )


def _search(schema: Schema, tied: Mapping[str, Sequence[int]], descent: Descent) -> Table:
    steps = descent.steps
    return Table(
        {
            "objective": np.array([step.value for step in steps]),
            "best": np.array([step.better for step in steps]),
            **{
                name: np.array([schema.groups[places[0]].weight * step.factors[number] for step in steps])
                for number, (name, places) in enumerate(tied.items())
            },
        }
    )
