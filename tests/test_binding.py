"""Binding: the laws that weights obey, and the definition beside them."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import gmr
from binding_oracle import Array, Figure, defined, dense, random_figure
from gmr.demo import demo_folder
from gmr.skeleton import End, Skeleton
from gmr.skinning import BindMethod, Skin, bind

METHODS: list[BindMethod] = ["gradient", "heat"]
seeds = st.integers(0, 2**32 - 1).map(np.random.default_rng)
both_methods = pytest.mark.parametrize("method", METHODS)


@pytest.fixture(autouse=True)
def _random_figures_may_be_odd() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.SkinWarning)
        yield


def chain(*xs: float) -> Skeleton:
    """Joints along +X, each the child of the one before."""
    offsets = [(x, 0.0, 0.0) for x in np.diff(xs, prepend=0.0)]
    return Skeleton.post_rotation([f"j{k}" for k in range(len(xs))], np.arange(len(xs)) - 1, offsets)


def tube(length: float, radius: float, rings: int, around: int = 12) -> tuple[Array, NDArray[np.int32]]:
    """A tube along +X from 0, without lids."""
    x, angle = np.meshgrid(
        np.linspace(0, length, rings), np.arange(around) * 2 * np.pi / around, indexing="ij"
    )
    vertices = np.stack([x, radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 3)
    ring, spoke = (
        grid.ravel() for grid in np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij")
    )
    a, b = ring * around + spoke, ring * around + (spoke + 1) % around
    faces = np.concatenate([np.stack([a, b, a + around], 1), np.stack([b, b + around, a + around], 1)])
    return vertices, faces.astype(np.int32)


def weights_of(figure: Figure, method: BindMethod) -> Array:
    bound = bind(figure.vertices, figure.faces, figure.skeleton, method=method)
    return dense(bound.weights, bound.joints, figure.skeleton.joint_count)


@given(seeds)
def test_weights_are_what_the_definition_says(rng: np.random.Generator) -> None:
    figure = random_figure(rng)
    bound = bind(figure.vertices, figure.faces, figure.skeleton)
    expected, outside = defined(figure)
    assert np.array_equal(bound.report.outside, outside)
    found = dense(bound.weights, bound.joints, figure.skeleton.joint_count)
    assert np.abs(found - expected).max() < 1e-6


@both_methods
@given(rng=seeds)
def test_weights_are_at_most_four_not_negative_and_sum_to_one(
    method: BindMethod, rng: np.random.Generator
) -> None:
    figure = random_figure(rng)
    weights, joints = bind(figure.vertices, figure.faces, figure.skeleton, method=method)
    assert weights.shape == joints.shape == (len(figure.vertices), 4)
    assert weights.dtype == np.float32
    assert joints.dtype == np.int32
    assert (np.diff(weights, axis=1) <= 0).all()
    assert (weights >= 0).all()
    assert np.abs(weights.sum(axis=1, dtype=np.float64) - 1).max() < 1e-6
    assert (joints[weights == 0] == 0).all()
    assert not np.any(figure.skeleton.ends[joints[weights > 0]] == End.SITE)


@both_methods
@given(rng=seeds, scale=st.floats(0.01, 100), mirrored=st.booleans())
def test_moving_turning_mirroring_and_scaling_both_changes_nothing(
    method: BindMethod, rng: np.random.Generator, scale: float, mirrored: bool
) -> None:
    figure = random_figure(rng)
    turn = Rotation.random(random_state=rng).as_matrix() * scale @ np.diag([-1.0 if mirrored else 1.0, 1, 1])
    moved = figure.moved(turn, scale * rng.normal(size=3))
    # The heat's equations have as many digits as the mesh's angles let them.
    limit = 1e-6 if method == "gradient" else 1e-4
    assert np.abs(weights_of(moved, method) - weights_of(figure, method)).max() < limit


@both_methods
@given(rng=seeds)
def test_vertices_at_one_place_get_the_same_weights(method: BindMethod, rng: np.random.Generator) -> None:
    figure = random_figure(rng)
    found = weights_of(figure, method)
    _, place = np.unique(figure.vertices, axis=0, return_inverse=True)
    first = np.array([np.flatnonzero(place.reshape(-1) == k)[0] for k in place.reshape(-1)])
    assert np.array_equal(found, found[first])


@both_methods
def test_two_consecutive_bones_share_their_joint_half_and_half_and_keep_their_middles(
    method: BindMethod,
) -> None:
    vertices, faces = tube(8.0, 0.3, 81)
    found = weights_of(Figure(vertices, faces, chain(0, 4, 8)), method)
    at_joint = found[np.isclose(vertices[:, 0], 4)]
    assert np.abs(at_joint - [0.5, 0.5, 0]).max() < 1e-5
    middles = found[np.isclose(vertices[:, 0], 2)], found[np.isclose(vertices[:, 0], 6)]
    limit = 1e-6 if method == "gradient" else 0.01
    assert np.abs(middles[0] - [1, 0, 0]).max() < limit
    assert np.abs(middles[1] - [0, 1, 0]).max() < limit


def test_the_weight_falls_through_the_joint() -> None:
    vertices, faces = tube(8.0, 1.6, 81)
    found = weights_of(Figure(vertices, faces, chain(0, 4, 8, 12)), "gradient")[::12, 1]
    x = vertices[::12, 0]
    assert found[x == 4] == pytest.approx(0.5)
    assert (np.diff(found[x < 6]) >= -1e-7).all()
    assert (found[x < 2.6] == 0).all()
    through = np.abs(x - 4) <= 0.4
    assert np.abs(found[through] - (x[through] - 2.6) / 2.8).max() < 0.02, "linearly, where both are as near"


def test_a_vertex_far_from_all_but_one_bone_follows_it_alone() -> None:
    found = weights_of(
        Figure(np.array([[50.0, 2, 0]]), np.zeros((0, 3), np.int32), chain(0, 1, 99, 100)), "gradient"
    )
    assert found[0].tolist() == [0, 1, 0, 0]


def test_the_left_leg_does_not_pull_the_right() -> None:
    # Hips with two legs; the vertices lie inside and outside of them, 4 from the one bone, 16 from the other.
    names = ["hips", "left", "left foot", "right", "right foot"]
    offsets = [(0, 0, 0), (10, -5, 0), (0, -80, 0), (-10, -5, 0), (0, -80, 0)]
    skeleton = Skeleton.post_rotation(names, [-1, 0, 1, 0, 3], offsets)
    heights = np.linspace(-60, -30, 20)
    sides = [np.stack([np.full(20, x), heights, np.zeros(20)], axis=1) for x in (6.0, 14, -6, -14)]
    found = weights_of(Figure(np.concatenate(sides), np.zeros((0, 3), np.int32), skeleton), "gradient")
    assert (found[:40, 1] == 1).all()
    assert (found[40:, 3] == 1).all()


def test_smoothing_spreads_what_was_in_no_box_over_its_edges() -> None:
    # The branch to j2 is closed at both ends, so what is far past its tail is in no box.
    skeleton = Skeleton.post_rotation(
        ["j0", "j1", "j2", "j3"], [-1, 0, 1, 2], [(0, 0, 0), (4, 0, 0), (4, 0, 0), (0, 0.01, 0)]
    )
    vertices = np.array([[2, 0.5, 0], [10.0, 0, 0]])
    alone = bind(vertices, np.zeros((0, 3), int), skeleton)
    joined = bind(vertices, [[0, 1, 1]], skeleton)
    assert alone.report.outside.tolist() == joined.report.outside.tolist() == [1]
    assert (joined.report.torn, joined.report.still_torn) == (1, 0)
    assert np.allclose(joined.weights[1], [0.5, 0.5, 0, 0])
    assert {*joined.joints[1, :2].tolist()} == {0, int(alone.joints[1, 0])}


@both_methods
def test_a_bound_mesh_follows_its_joints(method: BindMethod) -> None:
    vertices, faces = tube(8.0, 0.3, 41)
    weights, joints = bind(vertices, faces, chain(0, 4, 8), method=method)
    turned = np.tile(np.eye(4), (3, 1, 1))
    turned[1:, :3, :3] = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    turned[1:, :3, 3] = [4.0, -4, 0]
    bent = Skin(vertices, joints, weights, 3).blend(turned)[0]
    thigh = vertices[:, 0] < 2
    assert np.abs(bent[thigh] - vertices[thigh]).max() < 0.1
    shin = vertices[:, 0] > 6
    rigid = vertices[shin] @ turned[1, :3, :3].T + turned[1, :3, 3]
    assert np.abs(bent[shin] - rigid).max() < 0.1


def test_a_joint_where_its_parent_is_leaves_the_others_as_they_were() -> None:
    vertices, faces = tube(8.0, 0.3, 41)
    plain = weights_of(Figure(vertices, faces, chain(0, 4, 8)), "gradient")
    dummy = weights_of(Figure(vertices, faces, chain(0, 4, 4, 8)), "gradient")
    assert np.array_equal(dummy[:, [0, 2, 3]], plain)
    assert not dummy[:, 1].any()


@both_methods
def test_one_joint_takes_all(method: BindMethod) -> None:
    vertices, faces = tube(2.0, 0.3, 5)
    bound = bind(vertices, faces, chain(1.0), method=method)
    assert (bound.weights == [1, 0, 0, 0]).all()
    assert not bound.joints.any()
    assert len(bound.report.outside) in (0, len(vertices))


def test_an_end_site_ends_its_parents_bone_and_carries_nothing() -> None:
    offsets = [(0, 0, 0), (4, 0, 0), (6, 0, 0)]
    skeleton = Skeleton.post_rotation(["a", "b", "b_end"], [-1, 0, 1], offsets, ends=[0, 0, End.SITE])
    vertices, faces = tube(8.0, 0.3, 41)
    found = weights_of(Figure(vertices, faces, skeleton), "gradient")
    assert np.array_equal(found, weights_of(Figure(vertices, faces, chain(0, 4)), "gradient") @ np.eye(2, 3))


def test_joints_that_are_left_out_carry_nothing() -> None:
    vertices, faces = tube(8.0, 0.3, 41)
    skeleton = chain(0, 4, 8)
    bound = bind(vertices, faces, skeleton, joints=["j1"])
    assert (dense(bound.weights, bound.joints, 3) == [0, 1, 0]).all()
    with pytest.raises(gmr.SkeletonError, match="no joint 'j9'"):
        bind(vertices, faces, skeleton, joints=["j9"])
    with pytest.raises(gmr.SkeletonError, match="no joint has none"):
        bind(vertices, faces, skeleton, joints=[])


def test_moved_roots_change_nothing() -> None:
    motion = gmr.read(demo_folder() / "07_01.bvh")
    places = gmr.bones(motion, "per_child")
    vertices = np.concatenate([places.heads, places.tails, (places.heads + places.tails) / 2]) + 0.3
    at_home = bind(vertices, np.zeros((0, 3), int), motion.skeleton)
    elsewhere = bind(vertices, np.zeros((0, 3), int), motion.with_roots(["Hips", "LeftFoot"]).skeleton)
    assert np.array_equal(at_home.weights, elsewhere.weights)
    assert np.array_equal(at_home.joints, elsewhere.joints)


def test_the_report_counts_what_there_is() -> None:
    vertices, faces = tube(8.0, 0.3, 41)
    weights, joints = bound = bind(vertices, faces, chain(0, 4, 4, 8))
    report = bound.report
    assert report.strongest.sum() == len(vertices)
    assert report.strongest.tolist() == [np.sum(joints[:, 0] == j) for j in range(4)]
    assert report.followers.tolist() == [
        np.any((joints == j) & (weights > 0), axis=1).sum() for j in range(4)
    ]
    assert "492 vertices follow 3 of 4 joints (none follows j1)" in str(report)


@given(seeds)
def test_threads_do_not_change_a_bit(rng: np.random.Generator) -> None:
    figure = random_figure(rng)
    one, many = (bind(figure.vertices, figure.faces, figure.skeleton, threads=n) for n in (1, 3))
    assert np.array_equal(one.weights, many.weights)
    assert np.array_equal(one.joints, many.joints)


@both_methods
def test_degenerate_and_crowded_triangles_and_loose_vertices_are_bound(method: BindMethod) -> None:
    vertices, faces = tube(8.0, 0.3, 41)
    odd = np.concatenate(
        [faces, faces[:5], [[0, 0, 0], [1, 2, 1], [0, 12, 24]], [[0, 1, k] for k in range(50, 60)]]
    )
    weights, joints = bind([*vertices, (2, 1, 0), (6, 0, 1)], odd, chain(0, 4, 8), method=method)
    found = dense(weights, joints, 3)
    assert np.isfinite(found).all()
    assert np.abs(found[-2:, :2] - [[1, 0], [0, 1]]).max() < 0.02


@both_methods
def test_what_cannot_be_bound_is_refused_and_named(method: BindMethod) -> None:
    vertices, faces = tube(8.0, 0.3, 5)
    lost = vertices.copy()
    lost[7, 1] = np.nan
    wrong: list[tuple[object, object, str]] = [
        (lost, faces, r"vertex 7 lies at \[0.0, [nN]a[nN]"),
        (np.where(np.isnan(lost), -np.inf, lost), faces, r"vertex 7 lies at .* 0 more"),
        (vertices * 1e200, faces, "vertex .*, and 59 more are like it"),
        (np.zeros((0, 3)), np.zeros((0, 3), int), "no vertices"),
        (vertices[:, :2], faces, r"vertices has shape \(60, 2\)"),
        (vertices, faces[:, :2], r"faces has shape \(96, 2\)"),
        (vertices, faces + 0.5, "type float64"),
        (vertices, faces + 1, "triangle .* names vertex 60, but there are 60"),
        (vertices, [[0, 1, -1]], "triangle 0 names vertex -1"),
        (vertices, [[0, 1, 2**40]], "more than any mesh has"),
    ]
    for places, triangles, said in wrong:
        with pytest.raises(gmr.SkinError, match=said):
            bind(places, triangles, chain(0, 4, 8), method=method)  # type: ignore[arg-type]
    with pytest.raises(gmr.SkeletonError, match="no bone"):
        bind(vertices, faces, chain(), method=method)
    with pytest.raises(gmr.SkeletonError, match=r"joint 'j1' is at \[inf"):
        bind(vertices, faces, chain(0, np.inf), method=method)
    with pytest.raises(gmr.SkinError, match="no method 'nearest'"):
        bind(vertices, faces, chain(0, 4), method="nearest")  # type: ignore[arg-type]


@pytest.mark.parametrize("factor", [100.0, 0.01, 39.37, 1000.0])
def test_different_units_are_warned_of_with_both_sizes(factor: float) -> None:
    vertices, faces = tube(8.0, 0.3, 5)
    with pytest.warns(gmr.SkinWarning, match=r"mesh's box is .* x .*, that of .* different units"):
        bind(vertices * factor, faces, chain(0, 4, 8))


def test_a_mesh_beside_its_skeleton_is_warned_of_and_one_in_place_is_not() -> None:
    vertices, faces = tube(8.0, 0.3, 5)
    with pytest.warns(gmr.SkinWarning, match="apart"):
        bind(vertices + np.array([0, 50, 0]), faces, chain(0, 4, 8))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bind(vertices, faces, chain(0, 4, 8))
        bind(vertices[:12] + np.array([6, 0, 0]), np.zeros((0, 3), int), chain(0, 4, 8))


def test_heat_without_scipy_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy.sparse.linalg", None)
    vertices, faces = tube(8.0, 0.3, 5)
    with pytest.raises(gmr.MissingExtraError, match=r"gmr-motion\[heat\]"):
        bind(vertices, faces, chain(0, 4), method="heat")


def test_heat_solves_its_equation() -> None:
    """Written out edge by edge, for a tube whose triangles have no obtuse angle."""
    vertices, faces = tube(8.0, 0.4, 41)
    found = weights_of(Figure(vertices, faces, chain(0, 4, 8)), "heat")
    matrix, areas = np.zeros((len(vertices), len(vertices))), np.zeros(len(vertices))
    for face in faces:
        for k in range(3):
            at, b, c = vertices[np.roll(face, -k)]
            cross = np.linalg.norm(np.cross(b - at, c - at))
            areas[face[k]] += cross / 6
            _, i, j = np.roll(face, -k)
            flow = 0.5 * (b - at) @ (c - at) / cross
            matrix[[i, j], [i, j]] += flow
            matrix[[i, j], [j, i]] -= flow
    assert matrix[~np.eye(len(matrix), dtype=bool)].max() < 1e-9
    warmth = areas / 0.4**2
    x = vertices[:, 0]
    nearest = np.stack([x < 4, x >= 4, x > 9], axis=1).astype(float)
    nearest[np.isclose(x, 4)] = [0.5, 0.5, 0]
    nearest[np.isclose(x, 8)] = [0, 0.5, 0.5]
    expected = np.linalg.solve(matrix + np.diag(warmth), warmth[:, None] * nearest)
    assert np.abs(found - expected).max() < 1e-5


def test_weights_do_not_jump_from_one_limb_to_the_other() -> None:
    """From the one leg straight over to the other, in small steps, weights go over in small steps."""
    names, parents = ["hips", "left", "left_end", "right", "right_end"], [-1, 0, 1, 0, 3]
    offsets = [(0, 1, 0), (0.2, 0, 0), (0, -0.8, 0), (-0.2, 0, 0), (0, -0.8, 0)]
    ends = [End.JOINT, End.JOINT, End.SITE, End.JOINT, End.SITE]
    legs = Skeleton.post_rotation(names, parents, offsets, ends=ends)
    across = np.linspace(0.2, -0.2, 2001)
    line = np.stack([across, np.full_like(across, 0.5), np.zeros_like(across)], axis=1)
    weights, joints = bind(line, np.zeros((0, 3), int), legs)
    found = dense(weights, joints, 5)
    assert found[0, 1] == 1
    assert found[-1, 3] == 1
    assert found[1000, [1, 3]] == pytest.approx(0.5, abs=1e-3)
    assert np.abs(np.diff(found, axis=0)).max() < 0.01
