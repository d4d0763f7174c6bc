"""gmr against its peers, on this machine, as ratios: one file a topic, one function a claim."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

from gmr.bench import (
    amc_text,
    bvh_text,
    forward_kinematics,
    gmr_files,
    operations,
    roots,
    search,
    skinning,
    synthesis,
    trials,
)
from gmr.bench.harness import Contest, Row, one_core, run_contest
from gmr.bench.inputs import LARGE_FRAME_COUNT

__all__ = ["CLAIMS", "Contest", "Row", "run"]

CLAIMS: Final[dict[str, Callable[[int], Iterator[Contest]]]] = {
    "bvh-load": bvh_text.load,
    "bvh-write": bvh_text.write,
    "bvh-folder": bvh_text.load_folder,
    "amc-load": amc_text.load,
    "amc-write": amc_text.write,
    "gmr-open": gmr_files.open_large,
    "fk": forward_kinematics.positions,
    "fk-rows": forward_kinematics.positions_from_rows,
    "fk-frames": forward_kinematics.frame_cost,
    "roots": roots.roots,
    "operations": operations.operations,
    "skin-linear": skinning.linear,
    "skin-dual": skinning.dual_quaternions,
    "search": search.near,
    "search-hard": search.hard,
    "search-many": search.near_among_many,
    "search-many-hard": search.hard_among_many,
    "search-weights": search.weighted,
    "search-rows": search.growth,
    "search-calls": search.calls,
    "search-build": search.build,
    "trials": trials.constant_trials,
    "synthesis": synthesis.takes,
}
"""What can be measured, by the name that the command line takes."""


def run(claims: Sequence[str] = (), *, smoke: bool = False) -> Iterator[Row]:
    """Measures the claims one after the other, on one processor.

    Args:
        claims: names from :data:`CLAIMS`; none means all of them.
        smoke: small inputs and one round: shows that everything runs, measures nothing.

    Yields:
        The rows of the table, as each claim is done.
    """
    frame_count, rounds, seconds = (500, 1, 0.0) if smoke else (LARGE_FRAME_COUNT, 15, 8.0)
    for name in claims or CLAIMS:
        for contest in CLAIMS[name](frame_count):
            if contest.all_cores:
                yield from run_contest(contest, rounds=rounds, seconds=seconds)
            else:
                with one_core():
                    yield from run_contest(contest, rounds=rounds, seconds=seconds)
