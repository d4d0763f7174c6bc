"""How near poses are to those of other clips, cell by cell, and what is said of it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gmr.evaluation.blending_sentences import blending_sentences, lead_in_sentences
from gmr.evaluation.coverage import coverage_table, density, symmetry
from gmr.evaluation.coverage_cells import Bins, cells_of
from gmr.evaluation.coverage_symmetry import SYMMETRY_CELLS, coverage_symmetry, symmetry_of
from gmr.evaluation.frames import Frames
from gmr.evaluation.pose_clusters import clustered, entropy
from gmr.evaluation.pose_coverage import (
    ALONE,
    BLENDABLE,
    REDUNDANT,
    UNBLENDABLE,
    BlendLimits,
    Poses,
    kinds_of,
    pose_coverage,
)
from gmr.evaluation.regions import Grid, Limits
from gmr.table import Table
from locomotion import Arc, frames_of

JOINTS = 3


def poses_like(frames: Frames, place: dict[str, float]) -> Poses:
    """Poses of which every joint and every feature lies at ``place`` of their clip, a metre a unit."""
    at = np.array([place[name] for name in frames.clip_names], np.float32)[frames.clip]
    recording = (np.cumsum(~frames.mirrored) - 1)[frames.clip]
    positions = np.zeros((len(at), JOINTS, 3), np.float32)
    positions[:, :, 1] = at[:, None]
    return Poses(np.stack([at, np.zeros_like(at)], axis=1), positions, recording)


def covered(arcs: dict[str, Arc], place: dict[str, float]) -> Table:
    frames = frames_of(arcs)
    return pose_coverage(coverage_table("set", frames), frames, poses_like(frames, place))


def test_a_cell_tells_the_metres_to_the_nearest_pose_of_another_clip() -> None:
    walk = Arc(4.0, 1.05)
    table = covered({"a": walk, "b": walk, "c": walk}, {"a": 0.0, "b": 0.01, "c": 0.5})
    assert len(table) == 1
    assert table["clips"].tolist() == [3]
    np.testing.assert_allclose(table["nearest_mean"], (0.01 + 0.01 + 0.49) / 3, rtol=1e-5)
    np.testing.assert_allclose(table["nearest_p95"], 0.49, rtol=1e-5)
    np.testing.assert_allclose(table["seconds"], 12.0)
    assert table["kind"].tolist() == [UNBLENDABLE]


@pytest.mark.parametrize(
    ("apart", "kind"), [(0.0, REDUNDANT), (0.015, REDUNDANT), (0.05, BLENDABLE), (0.2, UNBLENDABLE)]
)
def test_dense_and_redundant_is_told_from_dense_but_unblendable(apart: float, kind: str) -> None:
    table = covered({"a": Arc(4.0, 1.05), "b": Arc(4.0, 1.05)}, {"a": 0.0, "b": apart})
    assert table["kind"].tolist() == [kind]


def test_neither_a_clip_nor_its_mirrored_copy_is_another_clip() -> None:
    arcs = {"a": Arc(4.0, 1.05), "a (mirrored)": Arc(4.0, 1.05, mirrored=True)}
    table = covered(arcs, dict.fromkeys(arcs, 0.0))
    assert np.isnan(table["nearest_mean"]).all()
    assert table["kind"].tolist() == [ALONE]
    assert table["clips"].tolist() == [1]


def test_neighbouring_cells_count_and_those_beyond_do_not() -> None:
    place = {"a": 0.0, "b": 0.03}
    near = covered({"a": Arc(3.0, 1.05, 1.0), "b": Arc(3.0, 1.15, 6.0)}, place)
    np.testing.assert_allclose(near["nearest_mean"], [0.03, 0.03], rtol=1e-5)
    for speed, turn in ((1.25, 1.0), (1.05, 11.0)):
        far = covered({"a": Arc(3.0, 1.05, 1.0), "b": Arc(3.0, speed, turn)}, place)
        assert np.isnan(far["nearest_mean"]).all()


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), clips=st.integers(1, 5))
def test_the_nearest_pose_is_that_of_a_plain_search(seed: int, clips: int) -> None:
    random = np.random.default_rng(seed)
    names = [f"c{number}" for number in range(clips)]
    arcs = {name: Arc(1.5, random.uniform(1, 1.3), random.uniform(-8, 8)) for name in names}
    frames = frames_of(arcs)
    features = random.standard_normal((len(frames), 4)).astype(np.float32)
    positions = random.standard_normal((len(frames), JOINTS, 3)).astype(np.float32)
    recording = frames.clip.astype(np.int64)
    coverage = coverage_table("set", frames)
    table = pose_coverage(coverage, frames, Poses(features, positions, recording))

    row = np.array(
        [frames.starts[names.index(c)] + f for c, f in zip(coverage["clip"], coverage["frame"], strict=True)]
    )
    cell = np.stack([coverage["speed"] // 0.1, np.floor(coverage["turn_rate_deg"] / 5 + 0.5)], axis=1)
    about = np.abs(cell[:, None] - cell[None]).max(axis=2) <= 1
    other = recording[row][:, None] != recording[row][None]
    cost = ((features[row][:, None].astype(float) - features[row][None]) ** 2).sum(axis=2)
    cost[~(about & other)] = np.inf
    nearest = cost.argmin(axis=1)
    metres = np.linalg.norm(positions[row].astype(float) - positions[row[nearest]], axis=2).mean(axis=1)
    metres[~np.isfinite(cost.min(axis=1))] = np.nan
    expected = {
        tuple(key): metres[(cell == key).all(axis=1)].mean() for key in np.unique(cell, axis=0).tolist()
    }
    np.testing.assert_allclose(table["nearest_mean"], list(expected.values()), rtol=1e-6)


def test_entropy_is_zero_for_one_pose_and_the_logarithm_of_equal_shares() -> None:
    same = clustered(np.ones((50, 3), np.float32))
    assert entropy(same, np.ones(50)) == 0
    corners = np.repeat(np.eye(4, dtype=np.float32) * 9, 8, axis=0)
    assert entropy(clustered(corners), np.ones(32)) == pytest.approx(2.0)
    assert entropy(np.array([0, 1]), np.array([3.0, 1.0])) == pytest.approx(2 - 0.75 * np.log2(3))


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(0, 200))
def test_every_row_is_in_one_of_the_clusters_and_the_same_rows_give_the_same(seed: int, rows: int) -> None:
    features = np.random.default_rng(seed).standard_normal((rows, 5)).astype(np.float32)
    cluster = clustered(features, 8)
    assert cluster.shape == (rows,)
    assert np.all((cluster >= 0) & (cluster < 8))
    np.testing.assert_array_equal(cluster, clustered(features.copy(), 8))


def test_cells_hold_every_window_once() -> None:
    table = coverage_table("set", frames_of({"a": Arc(3.0, 1.02, 33.0), "b": Arc(2.0, 2.52, -12.4)}))
    cells = cells_of(table, Bins())
    assert sorted(np.concatenate(list(cells)).tolist()) == list(range(len(table)))
    assert [len(about) for _, about in cells.with_neighbours()] == [len(cell) for cell in cells]
    np.testing.assert_allclose(cells.speed, [1.05, 2.55])
    np.testing.assert_allclose(cells.turn_rate_deg, [35.0, -10.0])


def test_symmetry_tells_the_seconds_of_both_sides() -> None:
    arcs = {
        "l": Arc(6.0, 1.1, 60.0),
        "r": Arc(3.0, 1.1, -60.0),
        "s": Arc(5.0, 2.0, 1.0),
        "o": Arc(2.0, 2.1, -31.0),
    }
    coverage = coverage_table("set", frames_of(arcs))
    rows = list(coverage_symmetry("set", coverage).rows())
    assert [(row["speed"], row["turn_rate_deg"]) for row in rows] == [(1.125, 60.0), (2.125, 30.0)]
    assert [row["symmetry"] for row in rows] == [pytest.approx(0.5), 0.0]
    assert rows[0]["left_seconds"] == pytest.approx(6.0)
    assert rows[1]["right_seconds"] == pytest.approx(2.0)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.tuples(st.floats(0.5, 3), st.floats(-90, 90)), min_size=1, max_size=4))
def test_the_one_figure_of_symmetry_is_that_of_the_map(movements: list[tuple[float, float]]) -> None:
    arcs = {f"c{number}": Arc(1.5, *movement) for number, movement in enumerate(movements)}
    coverage = coverage_table("set", frames_of(arcs))
    of_map = symmetry(density(coverage, SYMMETRY_CELLS))
    assert symmetry_of(coverage_symmetry("set", coverage)) == pytest.approx(of_map, nan_ok=True)


def cells(*rows: tuple[float, float, float, float]) -> Table:
    """Cells of (speed, turn rate, seconds, metres to the nearest pose)."""
    speed, turn, seconds, nearest = (np.array(column, float) for column in zip(*rows, strict=True))
    return Table(
        {
            "speed": speed,
            "turn_rate_deg": turn,
            "seconds": seconds,
            "clips": np.full(len(rows), 2),
            "nearest_mean": nearest,
            "kind": kinds_of(seconds, nearest, BlendLimits()),
        }
    )


def test_words_tell_what_repeats_and_what_cannot_be_blended() -> None:
    told = " ".join(blending_sentences(cells((1.25, 0, 6, 0.01), (1.35, 30, 2, 0.2), (1.5, 0, 0.2, 0.9))))
    assert "Dense and redundant are 6 seconds (75%" in told
    assert "Dense but unblendable are 2 seconds (25% of what is dense enough to judge)" in told
    assert "place is turning left by 30 degrees/s at 1.35 m/s (2 seconds of 2 clips, 20 cm" in told
    assert not list(blending_sentences(cells((1.5, 0, 0.2, 0.9))))


def test_seconds_that_count_mirrored_copies_are_said_to() -> None:
    (told,) = blending_sentences(cells((0.05, 0, 6, 0.2)), mirrored=True)
    assert "6 seconds (100% of what is dense enough to judge, mirrored copies counted)" in told
    assert "Most of it in one place is standing (6 seconds of 2 clips" in told


def test_what_fails_although_it_is_there_needs_a_take_that_leads_into_it() -> None:
    def told(held: bool, nearest: float, seconds: float = 4.0) -> list[str]:
        grid = Grid(
            speeds=np.array([1.25]),
            turn_rates_deg=np.array([0.0, 30.0]),
            offset=np.zeros((1, 2)),
            speed_error=np.zeros((1, 2)),
            speed_error_share=np.zeros((1, 2)),
            turn_rate_error_deg=np.zeros((1, 2)),
            held=np.array([[True, held]]),
            seconds=np.array([[9.0, seconds]]),
            limits=Limits(),
            timed=True,
        )
        return list(lead_in_sentences(cells((1.2, 30, 3, nearest), (1.25, 0, 9, 0.9)), grid))

    (sentence,) = told(held=False, nearest=0.2)
    assert (
        "lead from other movements into 1.25 m/s turning left by 30 degrees/s (4 seconds of it, 20 cm"
        in sentence
    )
    assert not told(held=True, nearest=0.2)
    assert not told(held=False, nearest=0.05)
    assert not told(held=False, nearest=0.2, seconds=0.5)
