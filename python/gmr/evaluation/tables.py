"""The tables of an evaluation, and the columns of each.

Metres, seconds and degrees throughout; a column's name never changes once released.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from gmr.table import Table

__all__ = ["PATH_COLUMNS", "Tables"]

PATH_COLUMNS: Final = (
    *("dataset", "scenario", "tracking", "path", "seconds"),
    *("planned_x", "planned_z", "walked_x", "walked_z"),
)


@dataclass(frozen=True, slots=True)
class Tables:
    """The tables of an evaluation. The columns of each, in order; those after the bar may be added to.

    Attributes:
        trials: one row a trial: dataset scenario tracking speed turn_rate_deg
            speed_error turn_rate_error_deg speed_deviation turn_rate_deviation_deg
            offset_mean offset_rms offset_p95 offset_max offset_final
            transitions_per_second search_cost_mean pose_discontinuity_mean
            | speed_mean turn_rate_mean_deg speed_deviation_1s turn_rate_deviation_1s_deg
            offset_sum along_track_mean along_track_rms cross_track_mean cross_track_rms
            inter_clip_per_second intra_clip_per_second forced_end_per_second
            search_cost_pose_mean search_cost_trajectory_mean clip_count seconds
            speed_error_share switched_speed switch_every path slowest_speed
            drift_deg facing_error_deg
            foot_slide_mm foot_slide_own_mm stances_per_second jerk_at_jumps jerk_between_jumps.
            ``path`` names a trial that is no cell of the grid, whose speed and turn rate are means.
            ``speed_error_share`` is the error at each speed asked for over that speed, of two the larger.
        coverage: one row a one-second window of the clips: dataset clip frame speed turn_rate_deg
            | seconds forward_speed left_speed weight.
            ``frame`` is the middle of the window, ``seconds`` its time in the file, ``weight`` the seconds
            of the dataset that the row stands for (a sum of weights is a duration).
        usage: one row a frame of the dataset, also of those never played (count 0):
            dataset scenario clip frame count | seconds tracking
        transitions: one row a pair of frames jumped between:
            dataset scenario from_clip from_frame to_clip to_frame kind count
            | from_seconds to_seconds discontinuity_mean tracking foot_slide_added_mm jerk_mean.
            ``kind`` is "inter-clip", "intra-clip" or "forced end".
        clips: one row a clip: dataset clip seconds frames mirrored speed_mean turn_rate_mean_deg
            played_seconds played_share used_share
            foot_slide_mm stances jerk_mean stance_seconds.
            See :mod:`gmr.evaluation.seen` for feet and jerk: the slide is measured over a twelfth of a
            second, the jerk from third differences at the evaluation's 60 frames a second, over six frames.
            ``played_share`` is of the time of all trials, ``used_share`` of the clip's own frames.

        pose_coverage: one row a cell of 0.1 m/s by 5 degrees/s that the clips reach:
            dataset speed turn_rate_deg seconds clips nearest_mean nearest_p95 entropy
            | feature_distance_mean kind.
            ``nearest_mean`` is metres to the nearest pose of another clip there; see
            :func:`gmr.evaluation.pose_coverage.pose_coverage`.
        coverage_symmetry: one row a cell of 0.25 m/s by 10 degrees/s in which the clips turn:
            dataset speed turn_rate_deg left_seconds right_seconds symmetry.
        segments: one row a stretch at one speed of a trial whose speed switches: dataset scenario tracking
            speed turn_rate_deg segment from_speed to_speed start seconds
            speed_error turn_rate_error_deg speed_deviation turn_rate_deviation_deg offset_mean
            rise_time overshoot settling_time.
            ``start`` counts from where recording begins; ``from_speed`` and the last three, which measure
            how a new speed is taken up, are NaN in the first stretch; ``settling_time`` is 0 only where the
            character is at the new speed from the switch on; see
            :class:`gmr.evaluation.step_response.StepResponse`.
        timeline: one row a quarter of a second of a trial: dataset scenario tracking speed turn_rate_deg
            seconds asked_speed played_speed played_turn_rate_deg offset
            search_cost search_cost_pose search_cost_trajectory jumps
        error_bins: one row a bin of the errors of a trial: dataset scenario tracking speed turn_rate_deg
            error_of from to share. ``error_of`` is "speed" or "turn_rate_deg".
        error_fits: one row for either error of a trial: dataset scenario tracking speed turn_rate_deg
            error_of components share_1 mean_1 deviation_1 share_2 mean_2 deviation_2.
            The one or two normal distributions that tell the errors best.
        graph: one row an edge of the transition graph: dataset scenario tracking from_clip to_clip count
            share inter_clip intra_clip forced_end discontinuity_mean.
            ``share`` is of all jumps out of ``from_clip``.
        paths: one row a quarter of a second of a recorded trial that is no cell of the grid: dataset scenario
            tracking path seconds planned_x planned_z walked_x walked_z.

    A mirrored copy of a clip is named "<clip> (mirrored)".
    """

    trials: Table
    coverage: Table
    usage: Table
    transitions: Table
    clips: Table
    pose_coverage: Table
    coverage_symmetry: Table
    segments: Table
    timeline: Table
    error_bins: Table
    error_fits: Table
    graph: Table
    paths: Table = field(default_factory=lambda: Table({name: [] for name in PATH_COLUMNS}))
