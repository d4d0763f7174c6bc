"""The figures of an evaluation, each a Vega-Lite chart with one computed sentence that reads it."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from gmr.evaluation.figures.clip_circles import clip_circles
from gmr.evaluation.figures.clip_usage import clip_usage
from gmr.evaluation.figures.cost_over_time import cost_over_time
from gmr.evaluation.figures.coverage_density import coverage_density
from gmr.evaluation.figures.coverage_scatter import coverage_scatter
from gmr.evaluation.figures.error_distributions import error_distributions
from gmr.evaluation.figures.frame_usage import frame_usage
from gmr.evaluation.figures.holds_map import holds_map
from gmr.evaluation.figures.measures import MEASURES
from gmr.evaluation.figures.planned_paths import planned_paths
from gmr.evaluation.figures.pose_distance import pose_distance
from gmr.evaluation.figures.speed_switches import speed_switches
from gmr.evaluation.figures.svg_files import write_svg
from gmr.evaluation.figures.transition_kinds import transition_kinds
from gmr.evaluation.figures.transition_matrix import transition_matrix
from gmr.evaluation.figures.trial_maps import trial_map, trial_sets
from gmr.evaluation.figures.turn_symmetry import turn_symmetry
from gmr.evaluation.path_sentences import path_sets
from gmr.evaluation.result import Evaluation
from gmr.pages.figure import Figure
from gmr.pages.section import Section

__all__ = ["Figure", "figures", "svg"]


def figures(evaluation: Evaluation) -> Iterator[Figure]:
    """Every figure of the report, in its order."""
    yield coverage_scatter(evaluation)
    yield coverage_density(evaluation)
    yield pose_distance(evaluation)
    yield turn_symmetry(evaluation)
    for scenario, tracking in trial_sets(evaluation):
        yield holds_map(evaluation, scenario, tracking)
        for measure in MEASURES:
            yield trial_map(evaluation, measure, scenario, tracking)
    yield from speed_switches(evaluation)
    yield cost_over_time(evaluation)
    yield from error_distributions(evaluation)
    for scenario, tracking in path_sets(evaluation.measured.trials):
        yield planned_paths(evaluation, scenario, tracking)
    yield clip_usage(evaluation)
    yield frame_usage(evaluation)
    yield transition_kinds(evaluation)
    yield transition_matrix(evaluation)
    yield clip_circles(evaluation)


def svg(
    evaluation: Evaluation, folder: str | os.PathLike[str], added: Iterable[Section] = ()
) -> tuple[Path, ...]:
    """Write every figure as SVG: all of the files, or none of them.

    Args:
        evaluation: what to draw.
        folder: where to; made where it is missing.
        added: sections of what was done with the evaluation, whose figures are drawn too.

    Returns:
        The files written, ``<figure>.svg`` each.

    Raises:
        MissingExtraError: vl-convert-python is not installed.
        OSError: the folder may not be written to, or the disk is full.
    """
    every = [*figures(evaluation), *(figure for section in added for figure in section.figures)]
    return write_svg({Path(folder) / f"{figure.name}.svg": figure for figure in every})
