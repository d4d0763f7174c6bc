"""What was played, and the jumps between."""

from __future__ import annotations

import numpy as np
import pytest

from gmr.evaluation.scenario import constant_trials
from gmr.evaluation.transitions import transitions_of, transitions_table
from gmr.evaluation.trials import trials_table
from gmr.evaluation.usage import clips_table, play_counts, usage_table
from locomotion import RATE, Arc, frames_of, walked

CLIPS = {"a.bvh": Arc(4.0, 1.0), "b.bvh": Arc(3.0, 2.0, 30.0), "b.bvh (mirrored)": Arc(3.0, 2.0, -30.0, True)}
FRAMES = frames_of(CLIPS)
TRIALS = constant_trials((1.0,), (0.0, 25.0))
STEPS = 35 * 60 + 1


def shown(*stretches: tuple[int, int]) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """Rows of both trials: stretches (first row, frames), then the first frames of clip a over and over."""
    rows = np.concatenate([np.arange(first, first + length) for first, length in stretches])
    rest = np.arange(STEPS - len(rows)) % 200
    return np.tile(np.concatenate([rows, rest]), (2, 1))


def test_usage_has_every_frame_and_counts_every_recorded_step() -> None:
    log = walked(TRIALS, FRAMES, rows=shown((0, 100)))
    table = usage_table("set", "constant", "time", play_counts(log, FRAMES), FRAMES)
    assert len(table) == len(FRAMES) == 241 + 181 + 181
    assert table["count"].sum() == 2 * 30 * RATE
    assert table["count"][250:].max() == 0
    np.testing.assert_allclose(table["seconds"], table["frame"] / RATE)


def test_clips_tell_their_share_of_the_time_and_of_their_frames() -> None:
    log = walked(TRIALS, FRAMES, rows=shown((0, 300), (241, 90)))
    clips = clips_table("set", play_counts(log, FRAMES), FRAMES)
    assert clips["clip"].tolist() == list(CLIPS)
    assert clips["mirrored"].tolist() == [False, False, True]
    np.testing.assert_allclose(clips["seconds"], [4, 3, 3])
    np.testing.assert_allclose(clips["speed_mean"], [1, 2, 2])
    np.testing.assert_allclose(clips["turn_rate_mean_deg"], [0, 30, -30], atol=1e-9)
    np.testing.assert_allclose(clips["played_share"], [1 - 90 / 1800, 90 / 1800, 0])
    np.testing.assert_allclose(clips["played_seconds"].sum(), 60)
    np.testing.assert_allclose(clips["used_share"], [200 / 241, 90 / 181, 0])


def test_a_jump_is_told_by_its_frames_and_its_kind() -> None:
    # Recording starts at step 300: 60 steps of a, to the middle of b, back within b, off its end into a.
    log = walked(TRIALS[:1], FRAMES, rows=shown((0, 241), (0, 120), (261, 50), (251, 171), (5, 100))[:1])
    table = transitions_table("set", "constant", "time", transitions_of(log, FRAMES), FRAMES)
    pairs = {
        (row["from_clip"], row["from_frame"], row["to_clip"], row["to_frame"]): (row["kind"], row["count"])
        for row in table.rows()
    }
    assert pairs.pop(("a.bvh", 119, "b.bvh", 20)) == ("inter-clip", 1)
    assert pairs.pop(("b.bvh", 69, "b.bvh", 10)) == ("intra-clip", 1)
    assert pairs.pop(("b.bvh", 180, "a.bvh", 5)) == ("forced end", 1)
    assert pairs.pop(("a.bvh", 104, "a.bvh", 0)) == ("intra-clip", 1)
    assert pairs == {("a.bvh", 199, "a.bvh", 0): ("intra-clip", (STEPS - 683) // 200)}
    np.testing.assert_allclose(table["discontinuity_mean"], 0.03)
    np.testing.assert_allclose(table["from_seconds"], table["from_frame"] / RATE)


def test_playing_into_the_next_clips_first_row_is_a_transition() -> None:
    log = walked(TRIALS[:1], FRAMES, rows=shown((0, 241), (60, 542))[:1])
    jumps = transitions_of(log, FRAMES)
    pairs = list(zip(jumps.from_row.tolist(), jumps.to_row.tolist(), strict=True))
    assert pairs[:2] == [(240, 241), (421, 422)]


def test_transitions_per_second_are_the_sum_of_their_kinds() -> None:
    log = walked(TRIALS, FRAMES, rows=shown((0, 241), (0, 120), (261, 50), (251, 171)))
    transitions = transitions_of(log, FRAMES)
    table = trials_table("set", TRIALS, "time", log, transitions, FRAMES)
    kinds = [table[f"{kind}_per_second"] for kind in ("inter_clip", "intra_clip", "forced_end")]
    np.testing.assert_allclose(table["transitions_per_second"], sum(kinds))
    assert table["transitions_per_second"].sum() * 30 == pytest.approx(len(transitions.trial))
    np.testing.assert_allclose(table["search_cost_mean"], 0.75)
    np.testing.assert_allclose(table["search_cost_pose_mean"], 0.25)
    np.testing.assert_allclose(table["pose_discontinuity_mean"], 0.03)
    assert table["clip_count"].tolist() == [2, 2]


def test_without_a_jump_the_table_is_empty_and_has_its_columns() -> None:
    frames = frames_of({"long.bvh": Arc(40.0, 1.0)})
    log = walked(TRIALS, frames)
    table = transitions_table("set", "constant", "time", transitions_of(log, frames), frames)
    assert len(table) == 0
    assert table.column_names[:8] == (
        *("dataset", "scenario", "from_clip", "from_frame", "to_clip", "to_frame", "kind", "count"),
    )
