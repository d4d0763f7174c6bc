"""A dataset completed from other clips: those that take most away from what its failing trials cost.

See :mod:`gmr.completion.choosing` for how clips are chosen.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.completion.candidates import Candidate
from gmr.completion.choosing import Choice, Contest, choose, on_plan, shortlisted
from gmr.completion.complete import Completion, Filler, Progress, completed_name, with_straight
from gmr.completion.holes import holes
from gmr.completion.offer import Kind, Offer, offer_of
from gmr.completion.shortfall import shortfalls
from gmr.errors import DatasetError
from gmr.evaluation.compare import renamed
from gmr.evaluation.evaluate import evaluate
from gmr.evaluation.result import Evaluation
from gmr.evaluation.simulation import Simulation
from gmr.matching.naming import recording_of
from gmr.matching.trial import Tracking, TrialLog
from gmr.motion import Motion
from gmr.threads import thread_count

__all__ = ["complete_from"]

_AS_EVALUATED: Final = (
    *("preset", "scenarios", "mirror", "tracking", "speeds", "turn_rates_deg"),
    *("switched_speed", "switch_every"),
)

_ON_THE_GRID: Final = ("constant", "switching")
"""Scenarios of which the holes are known by speed and turn rate; others are not run again."""


def complete_from(
    motions: Mapping[str, Motion],
    others: Mapping[str, Motion],
    *,
    source: str = "other clips",
    dataset: str = "motions",
    at_most: float | None = None,
    fill: Filler | None = None,
    lay: bool = False,
    before: Evaluation | None = None,
    progress: Progress | None = None,
    names: Mapping[str, str | int] | None = None,
    unit: float | str | None = None,
    threads: int | None = None,
    **settings: Any,
) -> Completion:
    """Complete a dataset from other clips: as they are, mirrored, or played 0.8 to 1.25 times as fast.

    Clips with another up axis than the dataset are turned to the dataset's, and clips whose ground lies
    higher or lower are moved to its ground, for a folder has one of each.

    The clips are ranked and tried with the features scaled as in the dataset by itself; the second evaluation
    scales them anew over both, as whoever evaluates the completed dataset will see it.

    Args:
        motions: the dataset's clips by name, on one skeleton.
        others: the clips to choose from, by name.
        source: what these are called together.
        dataset: what the dataset is called.
        at_most: seconds that the chosen clips may last together; no limit where left out.
        fill: lets clips that it makes for the holes compete; see :func:`gmr.completion.synthesised`.
        lay: lay clips of another skeleton on the dataset's (:func:`gmr.skinning.retarget`); else they are
            refused.
        before: the dataset's evaluation, where it is there already, with the settings that it was made with.
        progress: called with the name of a phase, how much of it is done, and of how much.
        names, unit, threads, settings: of :func:`gmr.evaluate`, for both evaluations; trials at one speed
            only by default.

    Returns:
        Both evaluations, the clips chosen with what each took away, and the clips refused with why.

    Raises:
        DatasetError: as :func:`gmr.evaluate`; or there are no other clips, or none that can be used.
    """
    if not others:
        raise DatasetError(f"{source} holds no clip to complete the dataset from")
    tell = progress or (lambda phase, done, of: None)

    def phase(name: str) -> Progress:
        return lambda what, done, of: tell(f"{name}: {what}", done, of)

    reading: dict[str, Any] = {"names": names, "unit": unit, "threads": threads}
    if before is None or before.simulation is None:
        settings = {"scenarios": "constant", **settings}
        before = renamed(evaluate(motions, progress=phase("before"), **reading, **settings), dataset)
    else:
        settings = {name: before.summary.settings[name] for name in _AS_EVALUATED}
        grid = [name for name in settings["scenarios"] if name in _ON_THE_GRID]
        settings["scenarios"] = grid or "constant"
        settings["schema"] = before.simulation.database.schema
    assert before.simulation is not None
    hunt = _Hunt(before, motions, {"names": names, "unit": unit}, thread_count(threads), tell)
    found = hunt.found(others, source, fill, lay, at_most)
    after = before
    if found.clips:
        both = evaluate({**motions, **found.clips}, progress=phase("after"), **reading, **settings)
        after = renamed(both, completed_name(dataset))
    if left_out := sorted(set(after.failed) & set(found.clips)):
        raise DatasetError(
            f"{left_out[0]} cannot be evaluated beside the dataset's own clips: {after.failed[left_out[0]]}"
        )
    return Completion(
        dataset,
        before,
        after,
        found.clips,
        {},
        (),
        source=source,
        choices=found.choices,
        refused=found.refused,
        considered=len(set(others) - set(found.refused)) if holes(before) else 0,
        held_before=found.held,
        noticed=tuple(f"{source}: {note}" for note in found.notes),
    )


@dataclass(frozen=True, slots=True)
class _Found:
    """What was chosen.

    Attributes:
        held: how many trials held before the first choice.
        choices: in their order.
        clips: those that were chosen, by name.
        refused: clips that cannot be used, and why.
        notes: what was noticed about the other folder, in sentences.
    """

    held: int
    choices: tuple[Choice, ...] = ()
    clips: Mapping[str, Motion] = field(default_factory=dict)
    refused: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


class _Hunt:
    """The steps from clips to choices, which share the dataset, how it is read, and who is told."""

    def __init__(
        self,
        before: Evaluation,
        motions: Mapping[str, Motion],
        reading: Mapping[str, Any],
        threads: int,
        tell: Progress,
    ) -> None:
        assert before.simulation is not None
        self.before, self.simulation = before, before.simulation
        usable = {name: motion for name, motion in motions.items() if name not in before.failed}
        self.kind = Kind(before.simulation.database, usable, reading)
        self.threads, self.tell = threads, tell

    def found(
        self,
        others: Mapping[str, Motion],
        source: str,
        fill: Filler | None,
        lay: bool,
        at_most: float | None,
    ) -> _Found:
        """Choose among other clips."""
        tracking, trials = _steady(self.simulation)
        log = self.simulation.logs[tracking]
        held = shortfalls(log)[trials] == 0
        if held.all():
            return _Found(int(held.sum()))
        offer = offer_of(self.kind, others, source, lay=lay, make=lambda like: self._made(fill, like))
        listed = self._listed(offer, log, trials[~held], at_most)
        if not listed:
            return _Found(int(held.sum()), refused=offer.refused, notes=offer.notes)
        named: dict[str, Candidate] = {}
        for candidate in listed:
            named[_unused(candidate.name, {*self.kind.motions, *named})] = candidate
        clips = {name: offer.clip(candidate) for name, candidate in named.items()}
        contest = self._contest(clips, named, offer.refused, tracking, trials)
        choices, before = choose(
            contest, at_most=at_most, progress=lambda done, of: self.tell("choosing", done, of)
        )
        self.tell("choosing", len(named), len(named))
        chosen = {choice.name: clips[choice.name] for choice in choices}
        notes = offer.told(choice.candidate for choice in choices)
        return _Found(before, choices, chosen, offer.refused, notes)

    def _listed(
        self, offer: Offer, log: TrialLog, failing: NDArray[np.intp], at_most: float | None
    ) -> list[Candidate]:
        """The candidates that are worth trying, best first."""
        if not offer.rows:
            return []
        self.tell("ranking", 0, 1)
        asked = on_plan(self.kind.whole, log, failing, self.threads)
        short = {
            name: part for name, part in offer.rows.items() if at_most is None or part.seconds <= at_most
        }
        listed = shortlisted(short, asked, self.threads)
        self.tell("ranking", 1, 1)
        return listed

    def _made(self, fill: Filler | None, like: Motion) -> dict[str, Motion]:
        made: dict[str, Motion] = {}
        if fill is None:
            return made
        wanted = with_straight(holes(self.before))
        for number, ask in enumerate(wanted):
            self.tell("making clips", number, len(wanted))
            if (motion := fill(ask, like)) is not None:
                made[_unused(f"made_{ask.name}.bvh", made)] = motion
        self.tell("making clips", len(wanted), len(wanted))
        return made

    def _contest(
        self,
        clips: Mapping[str, Motion],
        named: Mapping[str, Candidate],
        refused: dict[str, str],
        tracking: Tracking,
        trials: NDArray[np.intp],
    ) -> Contest:
        """The dataset and the candidates that are tried, side by side."""
        self.tell("preparing candidates", 0, 1)
        own, mirror = self.kind.motions, bool(self.kind.whole.mirrored.any())
        database = self.kind.build({**own, **clips}, mirror=mirror)
        # A candidate that is a clip of the dataset's adds nothing; the dataset's own is the one that stays.
        known = {recording_of(first) for name, first in database.duplicates.items() if name in own}
        if known & set(clips):
            left = {name: clip for name, clip in clips.items() if name not in known}
            database = self.kind.build({**own, **left}, mirror=mirror)
        refused.update({name: why for name, why in database.excluded.items() if name in clips})
        self.tell("preparing candidates", 1, 1)
        there = set(database.clip_names)
        usable = {name: candidate for name, candidate in named.items() if name in there}
        profiles = self.simulation.profiles
        return Contest(
            database,
            usable,
            tuple(profiles[trial] for trial in trials.tolist()),
            tracking,
            self.threads,
        )


def _steady(simulation: Simulation) -> tuple[Tracking, NDArray[np.intp]]:
    """The trials that tell the holes: at one speed where there are such, timed where there are such."""
    tracking: Tracking = "time" if "time" in simulation.logs else next(iter(simulation.logs))
    steady = np.flatnonzero([trial.scenario == "constant" for trial in simulation.trials])
    return tracking, steady if len(steady) else np.arange(len(simulation.trials))


def _unused(name: str, taken: Any) -> str:
    """The name, or the first of "name_2.bvh", ... that is not taken."""
    stem, dot, suffix = name.rpartition(".")
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{stem}_{number}{dot}{suffix}"
    return free
