"""Blending against definitions written from the papers, in NumPy and SciPy."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import gmr
from gmr.skinning import Method, Skin

Array = NDArray[np.float64]


def random_skin(rng: np.random.Generator, vertices: int, joints: int, influences: int) -> Skin:
    weights = rng.random((vertices, influences)) ** 3
    followed = np.stack([rng.permutation(max(joints, influences))[:influences] for _ in range(vertices)])
    weights[followed >= joints] = 0
    weights[np.arange(vertices), followed.argmin(axis=1)] += 0.1
    normals = rng.normal(size=(vertices, 3))
    return Skin(
        rng.normal(size=(vertices, 3)),
        followed,
        weights / weights.sum(axis=1, keepdims=True),
        joints,
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
        faces=rng.integers(0, vertices, (2 * vertices, 3)),
    )


def random_transforms(rng: np.random.Generator, frames: int, joints: int, scale: float = 1.0) -> Array:
    transforms = np.zeros((frames, joints, 4, 4))
    turns = Rotation.random(frames * joints, random_state=rng).as_matrix()
    transforms[..., :3, :3] = turns.reshape(frames, joints, 3, 3) * scale
    transforms[..., :3, 3] = rng.normal(size=(frames, joints, 3))
    transforms[..., 3, 3] = 1
    return transforms


def linear(skin: Skin, transforms: Array) -> Array:
    """(F, V, 4, 4): sum_i w_i E_i."""
    used = np.where(skin.weights > 0, skin.joints, 0)
    return np.asarray(np.einsum("vk,fvkab->fvab", skin.weights.astype(float), transforms[:, used]))


def dual_quaternions(skin: Skin, transforms: Array, hemisphere: str) -> Array:
    """(F, V, 3): each quaternion multiplied out by SciPy, the influences one after the other."""
    found = np.empty((len(transforms), skin.vertex_count, 3))
    for frame, v in itertools.product(range(len(transforms)), range(skin.vertex_count)):
        used = np.flatnonzero(skin.weights[v])
        parts = []
        for k in used:
            matrix = transforms[frame, skin.joints[v, k]]
            real = Rotation.from_matrix(matrix[:3, :3]).as_quat()
            x, y, z = matrix[:3, 3]
            rx, ry, rz, rw = real
            dual = 0.5 * np.array(
                [
                    x * rw + y * rz - z * ry,
                    y * rw + z * rx - x * rz,
                    z * rw + x * ry - y * rx,
                    -x * rx - y * ry - z * rz,
                ]
            )
            parts.append(np.concatenate([real, dual]))
        pivot = parts[int(np.argmax(skin.weights[v, used]))][:4]
        total = np.zeros(8)
        for part, weight in zip(parts, skin.weights[v, used].astype(float), strict=True):
            against = pivot if hemisphere == "pivot" else total[:4]
            total += part * (-weight if part[:4] @ against < 0 else weight)
        total /= np.linalg.norm(total[:4])
        (rx, ry, rz, rw), (dx, dy, dz, dw) = total[:4], total[4:]
        way = 2 * (
            rw * np.array([dx, dy, dz]) - dw * np.array([rx, ry, rz]) + np.cross([rx, ry, rz], [dx, dy, dz])
        )
        found[frame, v] = Rotation.from_quat(total[:4]).apply(skin.vertices[v].astype(float)) + way
    return found


@pytest.mark.parametrize(
    ("vertices", "joints", "influences"), [(37, 5, 4), (20, 3, 1), (33, 9, 7), (1, 1, 2)]
)
def test_blending_is_what_the_papers_write(vertices: int, joints: int, influences: int) -> None:
    rng = np.random.default_rng(vertices)
    skin, transforms = random_skin(rng, vertices, joints, influences), random_transforms(rng, 6, joints)
    matrices = linear(skin, transforms)
    expected = (matrices @ np.append(skin.vertices, np.ones((vertices, 1)), axis=1)[..., None])[..., :3, 0]
    assert np.abs(skin.blend(transforms) - expected).max() < 5e-6
    for hemisphere in ("pivot", "running"):
        blended = skin.blend(transforms, "dqbs", hemisphere=hemisphere)
        assert np.abs(blended - dual_quaternions(skin, transforms, hemisphere)).max() < 5e-5


def test_scale_is_blended_before_rigid_motion() -> None:
    rng = np.random.default_rng(3)
    skin, rigid = random_skin(rng, 50, 4, 4), random_transforms(rng, 5, 4)
    scales = rng.uniform(0.5, 2.0, (5, 4))
    scaled = rigid.copy()
    scaled[..., :3, :3] *= scales[..., None, None]
    used = np.where(skin.weights > 0, skin.joints, 0)
    own = np.einsum("vk,fvk->fv", skin.weights, scales[:, used])
    for frame in range(5):
        grown = Skin(skin.vertices * own[frame, :, None], skin.joints, skin.weights, 4)
        expected = grown.blend(rigid[frame], "dqbs")
        assert np.abs(skin.blend(scaled[frame], "dqbs") - expected).max() < 1e-5


def test_every_method_agrees_where_a_vertex_follows_one_joint() -> None:
    rng = np.random.default_rng(5)
    skin = random_skin(rng, 64, 6, 1)
    transforms = random_transforms(rng, 4, 6, scale=1.7)
    straight, normals = skin.blend(transforms, "lbs", normals=True)
    methods: list[Method] = ["dqbs", "cor"]
    for method in methods:
        found, turned = skin.blend(transforms, method, normals=True)
        assert np.abs(found - straight).max() < 1e-5
        assert np.abs(turned - normals).max() < 1e-5


def test_the_answer_goes_where_it_is_wanted_and_does_not_depend_on_threads() -> None:
    rng = np.random.default_rng(6)
    skin, transforms = random_skin(rng, 5000, 12, 4), random_transforms(rng, 40, 12)
    out, normals = np.empty((40, 5000, 3), np.float32), np.empty((40, 5000, 3), np.float32)
    found, turned = skin.blend(transforms, "dqbs", out=out, normals=normals, threads=1)
    assert found is out
    assert turned is normals
    again, turned_again = skin.blend(transforms, "dqbs", normals=True, threads=3)
    assert again.tobytes() == out.tobytes()
    assert turned_again.tobytes() == normals.tobytes()
    assert np.shares_memory(skin.blend(transforms[0], out=out[:1]), out)


def test_a_skin_does_not_change_when_its_maker_writes_on() -> None:
    vertices = np.zeros((1, 3), np.float32)
    skin = Skin(vertices, [[0]], [[1.0]])
    vertices[:] = 9
    assert skin.blend(np.eye(4)[None]).tolist() == [[[0.0, 0.0, 0.0]]]


def test_an_empty_skin_and_no_frames_are_fine() -> None:
    empty = Skin(np.zeros((0, 3)), np.zeros((0, 4), int), np.zeros((0, 4)))
    assert empty.blend(np.zeros((2, 0, 4, 4))).shape == (2, 0, 3)
    one = Skin(np.zeros((1, 3)), [[0]], [[1.0]])
    assert one.blend(np.zeros((0, 1, 4, 4))).shape == (0, 1, 3)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"weights": [[1.0], [float("nan")]]}, "vertex 1 has the weight NaN"),
        ({"weights": [[0.0], [1.0]]}, "vertex 0 follows no joint"),
        ({"joints": [[0], [2]], "joint_count": 2}, "vertex 1 follows joint 2, but there are 2"),
        ({"joints": [[0.5], [1.0]]}, "give whole numbers"),
        ({"joints": [[0], [2**40]]}, "more than any mesh has"),
        ({"joints": [[0]]}, "joints has 1 rows for 2 vertices"),
        ({"vertices": [[0.0, 0.0]]}, "give (N, 3)"),
        ({"normals": [[0.0, 0.0, 1.0]]}, "normals holds 3 elements where 6 are needed"),
        ({"joints": [[0], [70000]]}, "a skin can follow 65536 at most"),
    ],
)
def test_wrong_skins_are_refused_in_words(change: dict[str, object], said: str) -> None:
    given: dict[str, object] = {"vertices": np.zeros((2, 3)), "joints": [[0], [1]], "weights": [[1.0], [1.0]]}
    with pytest.raises(gmr.SkinError) as caught:
        Skin(**(given | change))  # type: ignore[arg-type]
    assert said in str(caught.value)


def test_wrong_blends_are_refused_in_words() -> None:
    skin = Skin(np.zeros((2, 3)), [[0], [1]], [[1.0], [1.0]])
    eye = np.broadcast_to(np.eye(4), (1, 2, 4, 4))
    wrong: list[tuple[Callable[[], object], str]] = [
        (lambda: skin.blend(eye[:, :1]), "give (frames, 2, 4, 4)"),
        (lambda: skin.blend(eye.swapaxes(0, 1)), "give (frames, 2, 4, 4)"),
        (lambda: skin.blend(eye * 2), "does not end in the row 0 0 0 1"),
        (lambda: skin.blend(eye, "linear"), "choose one of lbs, dqbs, cor"),  # type: ignore[call-overload]
        (lambda: skin.blend(eye, "cor"), "give it its faces"),
        (lambda: skin.blend(eye, normals=True), "made without any"),
        (lambda: skin.blend(eye, out=np.empty((1, 2, 3))), "give a C-contiguous float32 array"),  # type: ignore[arg-type]
    ]
    for call, said in wrong:
        with pytest.raises(gmr.SkinError) as caught:
            call()
        assert said in str(caught.value)
    with pytest.raises(gmr.SkinError, match="triangle 0 names vertex 5"):
        Skin(np.zeros((2, 3)), [[0], [1]], [[1.0], [1.0]], faces=[[0, 1, 5]]).centers()
