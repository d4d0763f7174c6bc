"""The paper's grid of constant trials, from the database to the logs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import gmr
from gmr.bench.harness import Contest
from gmr.bench.inputs import LARGE_FRAME_COUNT, data_folder
from gmr.demo import demo_folder
from gmr.evaluation.scenario import DEFAULT_SPEEDS, DEFAULT_TURN_RATES_DEG
from gmr.matching import Database, Profile, run_trials

__all__ = ["constant_trials"]


def constant_trials(frame_count: int) -> Iterator[Contest]:
    """Runs 81 trials of 30 s: on the clips of Bandai-Namco below GMR_DATA, else on the shipped ones."""
    takes = gmr.read_folder(data_folder("locomotion") or demo_folder())
    database = Database.build(takes)
    record = 30.0 if frame_count >= LARGE_FRAME_COUNT else 1.0
    profiles = [
        Profile.constant(speed, turn_rate, record=record)
        for speed in DEFAULT_SPEEDS
        for turn_rate in np.radians(DEFAULT_TURN_RATES_DEG).tolist()
    ]
    for threads, cores in ((1, "one core"), (0, "all cores")):
        yield Contest(
            work=f"{len(profiles)} trials of {record:g} s, {len(database):,} frames, {cores}",
            unit="trials/s",
            amount=len(profiles),
            ours=lambda threads=threads: run_trials(database, profiles, threads=threads),  # type: ignore[misc]
            all_cores=threads == 0,
        )
