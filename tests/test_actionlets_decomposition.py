"""Decomposition: the way back from curves to scores, its parts against independent ones, and real walks."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

import gmr
from gmr.actionlets import Actionlet, Body, Track, decompose, decompose_curve, decompose_curves, mutate
from gmr.actionlets.bell import share, share_by_skew
from gmr.actionlets.decomposition.chain import solved
from gmr.actionlets.decomposition.cutting import COARSE, Candidates, cheapest
from gmr.demo import demo_folder
from gmr.tpose import without_leading_tpose
from plain_cuts import plain_fit

Floats = NDArray[np.float64]
unit = st.floats(-1, 1, allow_nan=False, allow_subnormal=False)


def made(rng: np.random.Generator) -> Track:
    """A track as a person would move: ways of 10 to 70 degrees in 0.2 to 1.2 seconds, and silences."""
    angle = rng.uniform(-1, 1)
    pieces: list[Actionlet] = []
    for _ in range(rng.integers(1, 9)):
        seconds = rng.uniform(0.2, 1.2)
        if rng.random() < 0.2 and not (pieces and pieces[-1].is_silence):
            pieces.append(Actionlet.silence(angle, seconds))
            continue
        end = angle + rng.choice([-1, 1]) * rng.uniform(0.17, 1.2)
        pieces.append(Actionlet(angle, end, seconds, rng.uniform(0.2, 0.8)))
        angle = end
    return Track(tuple(pieces))


def sampled(track: Track, fps: float = 120) -> tuple[Floats, Floats]:
    times = np.linspace(0, track.duration, round(track.duration * fps) + 1)
    return times, track.angle(times)


@pytest.mark.parametrize("seed", range(24))
def test_what_was_composed_is_found_again(seed: int) -> None:
    track = made(np.random.default_rng(seed))
    found = decompose_curve(*sampled(track), tolerance_deg=0.2)
    assert len(found.pieces) == len(track.pieces)
    np.testing.assert_allclose(found.times, track.times, atol=0.01)
    np.testing.assert_allclose(np.degrees(found.extremes), np.degrees(track.extremes), atol=0.5)
    for one, other in zip(found.pieces, track.pieces, strict=True):
        assert one.is_silence == other.is_silence
        if isinstance(one, Actionlet) and isinstance(other, Actionlet) and not one.is_silence:
            assert one.skew == pytest.approx(other.skew, abs=0.02)


@settings(max_examples=20)
@given(st.integers(0, 2**32), st.sampled_from([0.3, 1.0, 2.0]))
def test_no_dearer_track_is_found_than_the_one_that_made_the_curve(seed: int, tolerance_deg: float) -> None:
    track = made(np.random.default_rng(seed))
    times, angles = sampled(track)
    found = decompose_curve(times, angles, tolerance_deg)
    price = 0.5 * tolerance_deg**2
    error = np.mean(np.degrees(found.angle(times) - angles) ** 2) * track.duration
    assert error + price * len(found.pieces) <= price * len(track.pieces) * 1.05 + 1e-3


@pytest.mark.parametrize("fps", [30, 60, 240])
def test_the_rate_of_the_samples_matters_little(fps: float) -> None:
    track = Track.through([(0, 0.1), (0.5, 0.9, 0.3), (0.9, 0.2, 0.6), (1.3, 0.2), (2.0, 1.0, 0.5)])
    found = decompose_curve(*sampled(track, fps))
    np.testing.assert_allclose(found.times, track.times, atol=0.01)
    np.testing.assert_allclose(found.extremes, track.extremes, atol=0.01)


def test_a_curve_that_holds_still_is_one_silence_however_long() -> None:
    times = np.arange(0, 60, 1 / 30)
    (piece,) = decompose_curve(times, np.full(len(times), 0.3)).pieces
    assert piece.is_silence
    assert piece.start == pytest.approx(0.3)
    assert piece.duration == pytest.approx(times[-1])


def test_two_samples_are_enough() -> None:
    found = decompose_curve([0.0, 0.02], [0.1, 0.3])
    assert found.duration == pytest.approx(0.02)


def test_many_curves_at_once_are_the_same_as_one_by_one() -> None:
    rng = np.random.default_rng(3)
    tracks = [made(rng) for _ in range(4)]
    shortest = min(track.duration for track in tracks)
    times = np.arange(0, shortest, 1 / 120)
    angles = np.stack([track.angle(times) for track in tracks], axis=1)
    for alone, among in zip(angles.T, decompose_curves(times, angles), strict=True):
        np.testing.assert_allclose(among.angle(times), decompose_curve(times, alone).angle(times), atol=2e-3)


@given(st.integers(1, 9), st.integers(0, 2**32))
def test_the_chain_is_solved_as_a_dense_system_is(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    root = np.zeros((3 * count, 3 * count))
    for link in range(count):
        here = slice(3 * link, 3 * link + 3)
        root[here, here] = rng.normal(size=(3, 3)) + 3 * np.eye(3)
        if link:
            root[here, 3 * link - 3 : 3 * link] = rng.normal(size=(3, 3))
    dense = root @ root.T + 0.1 * np.eye(3 * count)
    blocks = dense.reshape(count, 3, count, 3).swapaxes(1, 2)
    links = np.arange(count)
    right = rng.normal(size=(count, 3))
    found = solved(blocks[links, links], blocks[links[:-1], links[1:]], right)
    np.testing.assert_allclose(found.ravel(), np.linalg.solve(dense, right.ravel()), atol=1e-6)


@given(st.floats(0.001, 0.999), st.floats(0.05, 0.95))
def test_the_share_changes_with_the_skew_as_its_derivative_says(u: float, skew: float) -> None:
    step = 1e-6
    at, moved = np.array([u]), np.array([skew - step, skew + step])
    low, high = share(at, moved)
    found = share_by_skew(at, skew)[0]
    assert found == pytest.approx((high - low) / (2 * step), abs=1e-4)


@settings(max_examples=30)
@given(arrays(np.float64, 7, elements=unit), arrays(np.float64, (5, 2), elements=unit), st.floats(0, 0.05))
def test_the_cheapest_track_is_the_best_of_all_that_there_are(
    samples: Floats, levels: Floats, price: float
) -> None:
    times, instants = np.linspace(0, 1, 7), np.linspace(0, 1, 5)
    candidates = Candidates(instants, levels)
    found = cheapest(times, samples, candidates, price, 0.0, 2.0)
    best = min(
        _weighed(times, samples, cuts, chosen, levels, price)
        for size in range(4)
        for inner in itertools.combinations(range(1, 4), size)
        for cuts in [(0, *inner, 4)]
        for chosen in itertools.product(range(2), repeat=len(cuts))
    )
    cuts = tuple(np.searchsorted(instants, found.times).tolist())
    chosen = tuple(int(np.argmin(np.abs(levels[c] - a))) for c, a in zip(cuts, found.angles, strict=True))
    assert _weighed(times, samples, cuts, chosen, levels, price) == pytest.approx(best, abs=1e-9)


def _weighed(
    times: Floats,
    samples: Floats,
    cuts: tuple[int, ...],
    chosen: tuple[int, ...],
    levels: Floats,
    price: float,
) -> float:
    """Cost of a track over the lattice: each piece with the skew that correlates best with the samples."""
    u = (np.arange(24) + 0.5) / 24
    total = price * (len(cuts) - 1)
    for (c0, k0), (c1, k1) in itertools.pairwise(zip(cuts, chosen, strict=True)):
        x = np.interp((c0 + (c1 - c0) * u) / 4, times, samples)
        shapes = [share(u, skew) for skew in COARSE]
        fits = [np.sum((x - x.mean()) * (s - s.mean())) ** 2 / np.sum((s - s.mean()) ** 2) for s in shapes]
        s = shapes[int(np.argmax(fits))]
        a, b = levels[c0, k0], levels[c1, k1]
        total += np.sum((x - a - (b - a) * s) ** 2) / 24 * (c1 - c0) / 4
    return float(total)


WALKS = ("07_01", "08_01")


@pytest.mark.parametrize("take", WALKS)
def test_real_walks_are_met_better_than_by_cutting_at_the_extremes_with_fewer_pieces(take: str) -> None:
    motion = gmr.read(demo_folder() / f"{take}.bvh")
    bones = ["LeftUpLeg", "LeftLeg", "RightUpLeg", "RightLeg", "LeftArm", "LeftForeArm", "RightArm", "Spine1"]
    found = decompose(motion, joints=bones)
    plain = [plain_fit(curve, np.radians(1)) for curve in found.recorded.angles.T]
    plain_rms = [
        np.degrees(np.sqrt(np.mean((fit - curve) ** 2)))
        for (fit, _), curve in zip(plain, found.recorded.angles.T, strict=True)
    ]
    assert found.median_rms_deg < min(1.0, float(np.median(plain_rms)))
    assert found.p90_rms_deg < min(2.0, float(np.percentile(plain_rms, 90)))
    assert found.score.piece_count < sum(count for _, count in plain)
    assert found.ratio > 5


def test_a_take_composed_again_moves_as_it_did() -> None:
    motion = gmr.read(demo_folder() / "07_01.bvh")
    found = decompose(motion, tolerance_deg=0.5)
    again, shown = found.motion(), without_leading_tpose(motion)
    assert again.frame_count == shown.frame_count
    metres = 0.0254 / 0.45
    apart = np.linalg.norm(again.positions() - shown.positions(), axis=-1) * metres
    assert apart.mean() < 0.012
    assert apart.max() < 0.08


def test_a_take_is_varied_through_its_score() -> None:
    motion = gmr.read(demo_folder() / "09_01.bvh")
    found = decompose(motion, joints=["LeftUpLeg", "RightUpLeg", "LeftLeg", "RightLeg"])
    varied = mutate(found.score, np.random.default_rng(5), 0.5)
    made_anew = found.motion(varied)
    assert made_anew.frame_count == len(varied.times(found.recorded.fps))
    assert made_anew.skeleton == motion.skeleton
    layout = made_anew.layout
    assert layout is not None
    column = int(layout.starts[made_anew.skeleton.names.index("LeftUpLeg")]) + 2
    angle = made_anew.rows[:, column]
    np.testing.assert_allclose(
        np.radians(angle), varied["LeftUpLeg.Xrotation"].angle(varied.times(found.recorded.fps)), atol=1e-9
    )


def test_the_degrees_of_freedom_of_an_amc_are_decomposed_too(data: Path) -> None:
    motion = gmr.read(data / "amc" / "07_01.amc")
    found = decompose(motion, joints=["lfemur", "ltibia"])
    assert found.score.dofs == ("lfemur.rx", "lfemur.ry", "lfemur.rz", "ltibia.rx")
    again = found.motion()
    assert again.acclaim == motion.acclaim


def test_what_does_not_move_is_a_silence_and_is_counted_apart() -> None:
    found = decompose(gmr.read(demo_folder() / "07_01.bvh"))
    still = [dof for dof, moves in zip(found.recorded.dofs, found.moving, strict=True) if not moves]
    assert "LHipJoint.Xrotation" in still
    assert all(len(found.score[dof].pieces) == 1 for dof in still)
    table = found.table()
    assert len(table) == len(found.recorded.dofs)
    assert table["pieces"].sum() == found.score.piece_count


def test_the_body_of_a_walk_is_decomposed() -> None:
    body = Body.of(detailed=False)
    found = decompose(gmr.read(demo_folder() / "07_01.bvh"), body)
    assert found.score.dofs == body.names
    assert found.median_rms_deg < 1
    assert found.p90_rms_deg < 2
    assert found.motion().skeleton.names == body.skeleton.names


NAN = float("nan")
WALK = demo_folder() / "07_01.bvh"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: decompose_curve([0.0], [0.0]), "curve of 1 samples"),
        (lambda: decompose_curve([0.0, 0.0], [0.0, 1.0]), "times must rise"),
        (lambda: decompose_curve([0.0, NAN], [0.0, 1.0]), "times must rise"),
        (lambda: decompose_curve([0.0, 1.0], [0.0, NAN]), "angle 1 of curve 0 is nan"),
        (lambda: decompose_curve([0.0, 1.0, 2.0], [0.0, 1.0]), "one angle of each curve for each time"),
        (lambda: decompose_curve([0.0, 1.0], [0.0, 1.0], 0), "tolerance is 0 degrees"),
        (lambda: decompose_curve([0.0, 1.0], [0.0, 1.0], 1e300), "give degrees above 0, 180 at most"),
        (lambda: decompose(gmr.read(WALK)[:1]), "two frames or more"),
        (
            lambda: decompose(gmr.read(WALK), joints=["Tail"]),
            "no angles of a joint 'Tail'; it has",
        ),
        (lambda: decompose(gmr.read(WALK), joints=[]), "no joints are named"),
        (lambda: decompose(gmr.read(WALK).shift_root("LeftFoot")), "no angle channels"),
    ],
)
def test_what_cannot_be_decomposed_is_refused_in_words(make: Callable[[], object], words: str) -> None:
    with pytest.raises(gmr.ActionletError, match=words):
        make()


@pytest.mark.skipif("GMR_DATA" not in os.environ, reason="GMR_DATA names no folder of large real files")
def test_eight_walks_are_met_within_a_degree_with_fewer_pieces_than_extremes() -> None:
    folder = Path(os.environ["GMR_DATA"]) / "cmu_asf_amc"
    bones = ["lfemur", "rfemur", "ltibia", "rtibia", "lhumerus", "rhumerus", "lradius", "rradius"]
    rms: list[float] = []
    pieces = plain_pieces = 0
    for take in ("07_01", "07_06", "07_11", "08_01", "08_04", "08_10", "35_01", "35_29"):
        found = decompose(gmr.read(folder / f"{take}.amc"), joints=[*bones, "lowerback", "thorax"])
        rms += found.rms_deg.tolist()
        pieces += found.score.piece_count
        plain_pieces += sum(plain_fit(curve, np.radians(1))[1] for curve in found.recorded.angles.T)
    assert len(rms) == 176
    assert np.median(rms) < 0.8
    assert np.percentile(rms, 90) < 1.3
    assert pieces < 1700 < 2282 < plain_pieces


def test_trembling_below_the_tolerance_is_a_silence() -> None:
    times = np.arange(0, 20, 1 / 60)
    trembling = np.radians(0.05) * np.random.default_rng(1).normal(size=len(times))
    (piece,) = decompose_curve(times, trembling).pieces
    assert piece.is_silence
