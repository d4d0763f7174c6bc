"""Binding beside what artists bound: real characters, stripped of their weights (GMR_DATA)."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import gmr
from binding_oracle import Array, dense
from gmr.skinning import BindMethod, Character, Skin, bind
from gmr.skinning.bone_segments import bone_segments

FOLDER = Path(os.environ.get("GMR_DATA", "/nonexistent")) / "gltf"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="GMR_DATA names no folder with gltf/")


class Likeness(NamedTuple):
    """How like the artist's weights others are."""

    apart: float
    """Mean over the vertices of the sum over the joints of absolute differences: 0 to 2."""
    strongest: float
    """The part of the vertices whose strongest joint is the artist's."""


class Case(NamedTuple):
    file: str
    method: BindMethod
    apart: float
    strongest: float


CASES = [
    Case("cesium_man.gltf", "gradient", 0.195, 0.935),
    Case("cesium_man.gltf", "heat", 0.25, 0.95),
    Case("fox.glb", "gradient", 0.51, 0.75),
    Case("fox.glb", "heat", 0.64, 0.74),
    Case("rigged_simple.gltf", "gradient", 0.095, 1.0),
    Case("rigged_simple.gltf", "heat", 0.12, 1.0),
]


def character(file: str) -> Character:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        return gmr.read_character(FOLDER / file)


def at_rest(of: Character) -> NDArray[np.float32]:
    found: NDArray[np.float32] = of.skin(of.rest_pose())[0]
    return found


def artists_weights(of: Character) -> Array:
    assert len(of.merged.inverse_binds) == 1
    return dense(of.merged.weights, of.merged.joints, len(of.joints))


def likeness(weights: Array, artists: Array) -> Likeness:
    same = weights.argmax(axis=1) == artists.argmax(axis=1)
    return Likeness(float(np.abs(weights - artists).sum(axis=1).mean()), float(same.mean()))


def nearest_bone(of: Character) -> Array:
    bones, vertices = bone_segments(of.skeleton), at_rest(of).astype(np.float64)
    along = bones.tails - bones.heads
    part = np.einsum("vbi,bi->vb", vertices[:, None] - bones.heads, along) / (along**2).sum(axis=1)
    foot = bones.heads + np.clip(part, 0, 1)[..., None] * along
    nearest = np.linalg.norm(vertices[:, None] - foot, axis=-1).argmin(axis=1)
    return np.asarray(np.eye(len(of.joints))[bones.joints[nearest]])


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.file}-{case.method}")
def test_weights_are_as_like_the_artists_as_the_documentation_says(case: Case) -> None:
    real = character(case.file)
    weights, joints = bind(at_rest(real), real.faces, real.skeleton, method=case.method)
    found = likeness(dense(weights, joints, len(real.joints)), artists_weights(real))
    print(case.file, case.method, found, likeness(nearest_bone(real), artists_weights(real)))
    assert found.apart <= case.apart
    assert found.strongest >= case.strongest


def test_gradients_are_nearer_to_cesium_mans_artist_than_the_nearest_bone() -> None:
    real = character("cesium_man.gltf")
    weights, joints = bind(at_rest(real), real.faces, real.skeleton)
    found = likeness(dense(weights, joints, len(real.joints)), artists_weights(real))
    assert found.apart < 0.65 * likeness(nearest_bone(real), artists_weights(real)).apart


@pytest.mark.parametrize("file", ["cesium_man.gltf", "fox.glb"])
def test_the_animated_surface_stays_near_the_artists(file: str) -> None:
    real = character(file)
    rest = at_rest(real)
    weights, joints = bind(rest, real.faces, real.skeleton)
    poses = real.animation(0)
    transforms = poses @ np.linalg.inv(real.rest_pose())
    ours = Skin(rest, joints, weights, len(real.joints)).blend(transforms)
    size = float(np.linalg.norm(np.ptp(rest, axis=0)))
    apart = np.linalg.norm(ours - real.skin(poses), axis=-1) / size
    print(
        file, f"surface: mean {apart.mean():.4f}, 95 % {np.quantile(apart, 0.95):.4f}, most {apart.max():.4f}"
    )
    assert apart.mean() < 0.01


def test_seams_of_real_characters_stay_closed() -> None:
    for file in ("cesium_man.gltf", "fox.glb"):
        real = character(file)
        rest = at_rest(real)
        weights, joints = bind(rest, real.faces, real.skeleton)
        _, first, place = np.unique(rest, axis=0, return_index=True, return_inverse=True)
        same = first[place.reshape(-1)]
        assert len(first) < len(rest)
        assert np.array_equal(weights, weights[same])
        assert np.array_equal(joints, joints[same])
