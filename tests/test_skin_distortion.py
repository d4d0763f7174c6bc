"""What skinning does to a surface, measured: laws of the measures, and what theory says of the capsule."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import gmr
from gmr.skinning.blending import Method
from gmr.skinning.capsule import RADIUS, capsule, measured_capsule, transforms
from gmr.skinning.distortion import Surface, segment_distances

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
SQUARES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = np.array([t for a, b, c, d in SQUARES for t in ((a, b, c), (a, c, d))])

METHODS: list[Method] = ["lbs", "dqbs", "cor"]

seeds = st.integers(0, 2**31)


@given(seeds)
def test_moving_as_one_distorts_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    surface = Surface(CUBE, FACES)
    moved = Rotation.random(random_state=rng).apply(CUBE) + rng.normal(size=3)
    found = surface.measured(moved[None])
    assert surface.volume == pytest.approx(1)
    assert surface.is_closed
    assert found.volume[0] == pytest.approx(1)
    assert max(found.edge[0], found.edge_worst[0], found.area[0], found.area_worst[0]) < 1e-12


@given(seeds, st.floats(0.1, 10))
def test_growing_is_measured_as_growth(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    found = Surface(CUBE, FACES).measured(scale * CUBE[None] + rng.normal(size=3))
    assert found.volume[0] == pytest.approx(scale**3)
    assert found.edge[0] == pytest.approx(abs(np.log(scale)), abs=1e-12)
    assert found.area_worst[0] == pytest.approx(2 * abs(np.log(scale)), abs=1e-12)


@pytest.mark.parametrize("missing", range(6))
def test_a_flat_hole_is_closed(missing: int) -> None:
    open_cube = Surface(CUBE, np.delete(FACES, [2 * missing, 2 * missing + 1], axis=0))
    assert not open_cube.is_closed
    assert open_cube.volume == pytest.approx(1)
    assert Surface(CUBE, np.delete(FACES, [0, 1, 2, 3], axis=0)).volume == pytest.approx(1)


def test_a_seam_is_no_hole() -> None:
    """Each triangle with corners of its own, as a seam of texture coordinates leaves them."""
    apart = Surface(CUBE[FACES].reshape(-1, 3), np.arange(FACES.size).reshape(-1, 3))
    assert apart.is_closed
    assert apart.volume == pytest.approx(1)


def test_a_mesh_without_surface_is_refused() -> None:
    with pytest.raises(gmr.SkinError, match="no triangle with an area"):
        Surface(CUBE, [[0, 0, 1]])


@given(seeds)
def test_distances_from_segments_are_the_least_of_points_on_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, heads, tails = rng.normal(size=(1, 5, 3)), rng.normal(size=(1, 3, 3)), rng.normal(size=(1, 3, 3))
    share = np.linspace(0, 1, 2001)[:, None, None]
    on_them = heads[0] + share * (tails - heads)[0]
    brute = np.linalg.norm(points[0, :, None, None] - on_them, axis=-1).min(axis=(1, 2))
    assert np.allclose(segment_distances(points, heads, tails)[0], brute, atol=2e-3)


def test_the_capsule_is_closed_and_as_large_as_a_capsule() -> None:
    ideal = np.pi * RADIUS**2 * 2 + 4 / 3 * np.pi * RADIUS**3
    assert capsule().surface.is_closed
    assert capsule().surface.volume == pytest.approx(ideal, rel=0.005)
    assert np.ptp(capsule().skin.vertices[capsule().ring][:, 1]) < 1e-7


@given(st.floats(0, 179))
def test_linear_blending_shrinks_a_twisted_ring_by_the_cosine_of_half_the_angle(degrees: float) -> None:
    angles = np.array([degrees])
    linear = measured_capsule("twist", "lbs", angles)
    assert linear["section_least"][0] == pytest.approx(np.cos(np.radians(degrees) / 2), abs=1e-5)
    for method in METHODS[1:]:
        kept = measured_capsule("twist", method, angles)
        assert kept["section_least"][0] == pytest.approx(1, abs=1e-5)
        assert kept["volume"][0] == pytest.approx(1, abs=2e-3)


@given(st.floats(20, 150))
def test_a_bend_loses_volume_linearly_and_bulges_by_dual_quaternions(degrees: float) -> None:
    linear, dual, centers = (
        {name: table[name][0] for name in table.column_names}
        for table in (measured_capsule("bend", method, np.array([degrees])) for method in METHODS)
    )
    assert linear["volume"] < centers["volume"] <= dual["volume"] + 1e-3
    assert linear["bulge"] < centers["bulge"] < dual["bulge"]


def test_a_capsule_at_rest_is_at_rest() -> None:
    matrices = transforms("bend", np.zeros(1))
    assert np.array_equal(matrices, np.broadcast_to(np.eye(4), (1, 2, 4, 4)))
    table = measured_capsule("bend", "dqbs", np.zeros(1))
    assert table["volume"][0] == pytest.approx(1)
    assert abs(table["bulge"][0]) < 1e-6
