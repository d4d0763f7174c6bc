"""From motions to an evaluation: read, build the database, run the trials, measure, judge."""

from __future__ import annotations

import numbers
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any, Literal, TypeAlias

import numpy as np

from gmr.errors import DatasetError
from gmr.evaluation.elsewhere import simulated_elsewhere
from gmr.evaluation.measured import measured
from gmr.evaluation.reading import Read, read_clips
from gmr.evaluation.regions import Limits
from gmr.evaluation.replay import replay_of, worst_trial
from gmr.evaluation.replays import replays_of
from gmr.evaluation.result import Evaluation, Summary
from gmr.evaluation.scenario import (
    DEFAULT_SPEEDS,
    DEFAULT_TURN_RATES_DEG,
    SWITCH_EVERY,
    SWITCHED_SPEED,
    Switching,
)
from gmr.evaluation.scenarios.asked import Asked, asked_trials, scenarios_of
from gmr.evaluation.scenarios.on_grid import OnGrid
from gmr.evaluation.simulation import frames_of, simulated
from gmr.evaluation.verdict import verdict
from gmr.evaluation.words import some_of
from gmr.matching.database import Database
from gmr.matching.naming import named
from gmr.matching.prepare import unit_text
from gmr.matching.schema import LOCOMOTION, Schema
from gmr.matching.trial import Tracking
from gmr.motion import Motion
from gmr.threads import thread_count

__all__ = ["Source", "evaluate"]

Source: TypeAlias = "str | os.PathLike[str] | Read | Iterable[Motion] | Mapping[str, Motion]"
Progress: TypeAlias = Callable[[str, int, int], object]


def evaluate(
    source: Source,
    *,
    preset: str | None = None,
    scenarios: Asked | Sequence[Asked] = ("constant", "switching"),
    mirror: bool = False,
    tracking: Tracking | Sequence[Tracking] = "time",
    speeds: Sequence[float] | None = None,
    turn_rates_deg: Sequence[float] | None = None,
    switched_speed: float = SWITCHED_SPEED,
    switch_every: float = SWITCH_EVERY,
    seed: int = 0,
    threads: int | None = None,
    workers: int | None = None,
    cluster: str | None = None,
    progress: Progress | None = None,
    names: Mapping[str, str | int] | None = None,
    unit: float | str | None = None,
    schema: Schema = LOCOMOTION,
    errors: Literal["raise", "collect"] = "collect",
) -> Evaluation:
    """Measure what a set of locomotion clips can do.

    A character made of the clips is sent along paths of constant turn rate, at one speed or at two in turn,
    by motion matching; the tables say how well it kept to them, which frames it used, and which speeds and
    turn rates the clips hold.

    Args:
        source: a folder of motion files, or motions, by name or with names of their own; or a folder that is
            read already (:func:`gmr.evaluation.reading.read_clips`).
        preset: pacing of the trials: "mig2022" for the durations of the paper's authors; by default every
            trial has 3 s of run-up, 2 s to settle and 30 s that are recorded.
        scenarios: "constant": each trial keeps its speed; "switching": the speed alternates with
            ``switched_speed``; both by default. Further "start-stop", "slalom", "splines", a CSV file of path
            points, or any :class:`gmr.evaluation.Scenario`. The constant one, by which a dataset is judged,
            is run beside these where neither it nor the switching one is named.
        mirror: add the mirror image of each clip.
        tracking: "time": the character is steered to where the path has it at each time; "velocity": it is
            only asked for the speed and turn rate; or both, each in trials of its own.
        speeds: metres per second; 1 to 3 in steps of 0.25 by default.
        turn_rates_deg: degrees per second, positive to the left; -100 to 100 in steps of 25 by default.
        switched_speed: the other speed of switching trials, metres per second.
        switch_every: seconds from one switch to the next.
        seed: of the random splines.
        threads: how many to use, all cores by default (or 0); the result does not depend on it.
        workers: run the trials on so many processes instead; the result does not depend on it.
        cluster: run them on a Dask cluster: the address of its scheduler, or "local" for one of this
            machine's; the result does not depend on it.
        progress: called with the name of a phase ("reading", "preparing", "simulating", "measuring"), how
            much of it is done, and of how much; what it raises ends the evaluation.
        names: joints by role where they are not found by themselves: ``{"left_foot": "foot_l"}``.
        unit: metres per file unit (or "cm", ...) of files that do not say; guessed from the body by default.
        schema: the features by which frames are compared, with their weights: ``LOCOMOTION.weighed({"hips
            velocity": 2.0})``, or :attr:`gmr.evaluation.Tuning.chosen`.
        errors: "collect": files that cannot be used are left out and named in ``failed``; "raise": the first
            of them ends the evaluation.

    Returns:
        The evaluation; the same motions and settings give the same tables.

    Raises:
        DatasetError: there is no motion, none is usable, or hips, legs or feet are not found.
        FormatError: there is no such folder; or a file cannot be read and ``errors`` is "raise"; or a file of
            path points is none.
        GmrError: the cluster cannot be reached; or the extra ``cluster`` is not installed.
        ValueError: a speed, turn rate, preset, scenario, tracking, schema or number of threads that makes no
            sense.
    """
    trackings = _trackings(tracking)
    if names is not None and not isinstance(names, Mapping):
        raise TypeError(f"names are joints by role, as in {{'left_foot': 'foot_l'}}, not {names!r:.60}")
    _check_schema(schema)
    thread_total = thread_count(threads)
    switching = Switching(*_numbers("switched_speed and switch_every", (switched_speed, switch_every)))
    grid = OnGrid(
        speeds=DEFAULT_SPEEDS if speeds is None else _numbers("speeds", speeds),
        turn_rates_deg=(
            DEFAULT_TURN_RATES_DEG if turn_rates_deg is None else _numbers("turn_rates_deg", turn_rates_deg)
        ),
        preset=preset or "even",
        switching=switching,
    )
    grid.trials()
    asked = scenarios_of(scenarios, grid, seed)
    trials = asked_trials(asked)
    tell = progress or _silent
    dataset, read = _read(source, thread_total, errors, tell)
    motions = read.motions
    tell("preparing", 0, 1)
    database = Database.build(motions, mirror=mirror, schema=schema, names=names, unit=unit)
    if database.excluded and errors == "raise":
        name, why = next(iter(database.excluded.items()))
        raise DatasetError(f"{name}: {why}")
    tell("preparing", 1, 1)
    run = partial(simulated, threads=thread_total)
    if workers is not None or cluster is not None:
        run = partial(simulated_elsewhere, workers=workers, cluster=cluster)
    simulation = run(database, trials, trackings, progress=lambda done, of: tell("simulating", done, of))
    tell("measuring", 0, 1)
    settings = {
        "preset": preset or "even",
        "scenarios": [scenario.name for scenario in asked],
        "seed": seed,
        "mirror": mirror,
        "tracking": list(trackings),
        "speeds": sorted(map(float, grid.speeds)),
        "turn_rates_deg": sorted(map(float, grid.turn_rates_deg)),
        "switched_speed": switching.speed,
        "switch_every": switching.every,
        "weights": {group.name: float(group.weight) for group in schema.groups},
        "limits": asdict(Limits()),
    }
    frames = frames_of(database)
    tables = measured(dataset, simulation, frames, thread_total)
    noted = (note for scenario in asked for note in getattr(scenario, "notes", ()))
    notes, failed = (*read.notes, *database.notes, *noted), {**read.failed, **database.excluded}
    found = Evaluation(
        dataset=dataset,
        measured=tables,
        summary=_summary(dataset, database, motions, unit, settings),
        verdict=verdict(
            tables.trials,
            tables.coverage,
            tables.clips,
            tables.usage,
            poses=tables.pose_coverage,
            segments=tables.segments,
            notes=notes,
            failed=failed,
        ),
        replay=replay_of(simulation, frames, worst_trial(tables.trials)),
        notes=notes,
        failed=failed,
        simulation=simulation,
        replays=replays_of(simulation, frames),
    )
    tell("measuring", 1, 1)
    return found


def _trackings(tracking: Tracking | Sequence[Tracking]) -> tuple[Tracking, ...]:
    asked: tuple[Tracking, ...] = (tracking,) if isinstance(tracking, str) else tuple(tracking)
    for each in asked:
        if each not in ("time", "velocity"):
            raise ValueError(f"unknown tracking {each!r}; known are time, velocity")
    if not asked or len(set(asked)) < len(asked):
        raise ValueError("give each tracking once, and at least one; known are time, velocity")
    return asked


def _check_schema(schema: Schema) -> None:
    if not isinstance(schema, Schema):
        raise TypeError(f"a schema is a gmr.matching.Schema, not {schema!r:.60}")
    if all(group.joint is None for group in schema.groups):
        raise ValueError(
            "the schema has no feature of a joint; poses are compared by such: give at least one"
        )


def _numbers(name: str, values: Sequence[float]) -> tuple[float, ...]:
    """The numbers of a list of such."""
    found = tuple(values) if isinstance(values, Iterable) else (None,)
    if not all(isinstance(value, numbers.Real) for value in found):
        raise TypeError(f"{name} is a list of numbers, not {values!r:.60}")
    return found


def _read(
    source: Source, threads: int, errors: Literal["raise", "collect"], tell: Progress
) -> tuple[str, Read]:
    """The dataset's name, and what there is of it."""
    if isinstance(source, Read):
        return source.name, source
    if not isinstance(source, str | os.PathLike):
        motions = named(source)
        if not motions:
            raise DatasetError("there is no motion to evaluate; give at least one")
        return "motions", Read(motions, {}, ())

    def read_so_far(done: int, of: int) -> None:
        tell("reading", done, of)

    read = read_clips(source, threads=threads, errors=errors, progress=read_so_far)
    return read.name, read


def _summary(
    dataset: str,
    database: Database,
    motions: Mapping[str, Motion],
    unit: float | str | None,
    settings: Mapping[str, Any],
) -> Summary:
    copies = int(database.mirrored.sum())
    guessed = unit is None and any(motions[name].unit is None for name in database.units)
    units = some_of([unit_text(metres) for metres in sorted(set(database.units.values()))], 5)
    return Summary(
        dataset=dataset,
        clip_count=len(database.clip_names) - copies,
        mirrored_count=copies,
        frame_count=len(database),
        seconds=float(np.maximum(np.bincount(database.clips) - 1, 0).sum() / database.rate),
        rate=database.rate,
        joint_count=len(database.skeleton.names),
        joints=database.joints.described(database.skeleton),
        unit=units + (", guessed from the length of the legs" if guessed else ""),
        settings=settings,
    )


def _silent(phase: str, done: int, of: int) -> None:
    """Tell nobody."""
