"""Skinning: tubes round the bones of a real skeleton, moved by a real walk, against NumPy and libigl.

The vertices of a tube come ring by ring, as exporters write a surface. Each follows four joints, those whose
bones are nearest by a distance that is a little uneven, as weights that someone painted are; the strongest
comes first. So neighbours mostly follow the same joints, but hundreds of sets of joints occur: more than on
most characters, whose vertices mostly follow fewer than four. The worst case is there too: a body whose
vertices follow each four joints at random, in no order.

Every side gets the same float32 numbers, and the answers are compared before anything is timed. What can be
made ready once (weights as a dense matrix, libigl's matrix) is made ready, on either side. libigl gives its
matrix in float64, whatever it is given; beside it stands the same product in float32.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.bench.harness import Contest
from gmr.bench.inputs import cmu_like_motion
from gmr.bench.peers import find_peers, label
from gmr.motion import Motion
from gmr.quaternions import from_matrices, matrices, multiply
from gmr.skeleton import Skeleton
from gmr.skinning import Method, Skin

__all__ = ["dual_quaternions", "linear"]

Array = NDArray[np.float32]
Blend = Callable[[Array], Array]
"""The vertices (V, 3) under the transforms (B, 4, 4) of one frame."""

_SIZES: Final = {7_000: 32, 1_000_000: 1}
"""Vertices, and frames of them in a call."""


@dataclass(frozen=True)
class Body:
    """A skin, and the transforms (F, B, 4, 4) that move it."""

    skin: Skin
    transforms: NDArray[np.float64]
    remark: str = ""

    @property
    def amount(self) -> float:
        """Millions of vertices in a call."""
        return len(self.transforms) * self.skin.vertex_count / 1e6


def linear(frame_count: int) -> Iterator[Contest]:
    """Linear blending with four influences in float32, against NumPy and libigl; then with normals."""
    found = find_peers("igl")
    targets = {"numpy, dense": 4.0, "numpy, gathered": 10.0, label("igl"): 12.0}
    for body in _bodies(frame_count):
        blends = {"numpy, dense": _dense(body.skin), "numpy, gathered": _gathered(body.skin)}
        if "igl" in found:
            blends[label("igl")] = _libigl(body.skin, np.float64)
            blends[label("igl") + ", its matrix in float32"] = _libigl(body.skin, np.float32)
        peers = {name: _checked(body, "lbs", blend) for name, blend in blends.items()}
        yield _contest(body, "lbs", peers, {} if body.remark else targets, found.absent)
        yield _contest(body, "lbs", normals=True)


def dual_quaternions(frame_count: int) -> Iterator[Contest]:
    """Dual quaternion blending in float32, against NumPy and our own linear blending; then with normals."""
    for body in _bodies(frame_count):
        peers: dict[str, Callable[[], object]] = {
            "numpy, gathered": _checked(body, "dqbs", _numpy_dual_quaternions(body.skin)),
            "gmr, linear": _ours(body, "lbs", normals=False),
        }
        targets = {} if body.remark else {"numpy, gathered": 20.0, "gmr, linear": 0.8}
        yield _contest(body, "dqbs", peers, targets)
        yield _contest(body, "dqbs", normals=True)


def _contest(
    body: Body,
    method: Method,
    peers: dict[str, Callable[[], object]] | None = None,
    targets: dict[str, float] | None = None,
    absent: dict[str, str] | None = None,
    *,
    normals: bool = False,
) -> Contest:
    name = {"lbs": "linear", "dqbs": "dual quaternion"}[method]
    return Contest(
        work=f"{name} skinning, {body.skin.vertex_count:,} vertices"
        + body.remark
        + (", with normals" if normals else ""),
        unit="M vertices/s",
        amount=body.amount,
        ours=_ours(body, method, normals=normals),
        peers=peers or {},
        targets=targets or {},
        absent=absent or {},
    )


def _ours(body: Body, method: Method, *, normals: bool) -> Callable[[], object]:
    shape = (len(body.transforms), body.skin.vertex_count, 3)
    out, turned = np.empty(shape, np.float32), np.empty(shape, np.float32)
    if normals:
        return lambda: body.skin.blend(body.transforms, method, normals=turned, out=out, threads=1)
    return lambda: body.skin.blend(body.transforms, method, out=out, threads=1)


def _checked(body: Body, method: Method, blend: Blend) -> Callable[[], object]:
    """``blend`` of every frame, once its answer is seen to be ours."""
    transforms = body.transforms.astype(np.float32)
    extent = np.ptp(body.skin.vertices, axis=0).max()
    apart = np.abs(blend(transforms[-1]) - body.skin.blend(body.transforms[-1], method)[0]).max()
    if apart > 1e-4 * extent:
        raise ValueError(f"a peer's vertices are {apart} away from ours; one of them is wrong")
    return lambda: [blend(frame) for frame in transforms]


def _dense(skin: Skin) -> Blend:
    """As SMPL's code does: one matrix product blends the transforms of all vertices."""
    weights, homogeneous = _dense_weights(skin), _homogeneous(skin)

    def blend(transforms: Array) -> Array:
        blended = (weights @ transforms[:, :3].reshape(-1, 12)).reshape(-1, 3, 4)
        found: Array = np.einsum("vab,vb->va", blended, homogeneous)
        return found

    return blend


def _gathered(skin: Skin) -> Blend:
    """Only the influences' transforms, gathered."""
    homogeneous = _homogeneous(skin)

    def blend(transforms: Array) -> Array:
        blended = np.einsum("vk,vkab->vab", skin.weights, transforms[:, :3][skin.joints])
        found: Array = np.einsum("vab,vb->va", blended, homogeneous)
        return found

    return blend


def _libigl(skin: Skin, kind: type[np.float32 | np.float64]) -> Blend:
    """``lbs_matrix`` once, then one product a frame: in float64, as libigl gives it, or in float32."""
    import igl

    matrix = np.ascontiguousarray(
        igl.lbs_matrix(skin.vertices.astype(np.float64), _dense_weights(skin).astype(np.float64)), kind
    )
    return lambda transforms: matrix @ transforms[:, :3].transpose(0, 2, 1).reshape(-1, 3).astype(kind)


def _numpy_dual_quaternions(skin: Skin) -> Blend:
    """The same formulas over whole arrays."""
    pivots = skin.joints[np.arange(skin.vertex_count), skin.weights.argmax(axis=1)]

    def blend(transforms: Array) -> Array:
        real = from_matrices(transforms[:, :3, :3].astype(np.float64))
        ways = np.append(transforms[:, :3, 3].astype(np.float64), np.zeros((len(real), 1)), axis=1)
        dual = 0.5 * multiply(ways, real)
        parts = np.concatenate([real, dual], axis=1).astype(np.float32)
        signs = np.where(real @ real.T < 0, np.float32(-1), np.float32(1))
        weights = skin.weights * signs[pivots[:, None], skin.joints]
        sums = np.einsum("vk,vkc->vc", weights, parts[skin.joints])
        sums /= np.linalg.norm(sums[:, :4], axis=1, keepdims=True)
        r, w, d, dw = sums[:, :3], sums[:, 3:4], sums[:, 4:7], sums[:, 7:]
        inner = np.cross(r, skin.vertices) + w * skin.vertices
        found: Array = skin.vertices + 2 * (np.cross(r, inner + d) + w * d - dw * r)
        return found

    return blend


def _dense_weights(skin: Skin) -> Array:
    dense = np.zeros((skin.vertex_count, skin.joint_count), np.float32)
    np.add.at(dense, (np.arange(skin.vertex_count)[:, None], skin.joints), skin.weights)
    return dense


def _homogeneous(skin: Skin) -> Array:
    return np.append(skin.vertices, np.ones((skin.vertex_count, 1), np.float32), axis=1)


@cache
def _bodies(frame_count: int) -> list[Body]:
    """A small body in many frames and large ones in one; a smoke run's are smaller."""
    share = min(1.0, frame_count / 36_000)
    bodies = [_body(max(1000, round(share * count)), frames) for count, frames in _SIZES.items()]
    return [*bodies, _scrambled(bodies[-1])]


def _body(vertex_count: int, frame_count: int) -> Body:
    motion = cmu_like_motion(500)[100 :: 400 // frame_count][:frame_count]
    skeleton = motion.skeleton
    rest = _rest(skeleton)
    turning = [joint for joint in range(skeleton.joint_count) if skeleton.children[joint]]
    bones = [(joint, child) for joint in turning for child in skeleton.children[joint]]
    heads, tails = rest[[joint for joint, _ in bones]], rest[[child for _, child in bones]]
    turned_by = np.array([turning.index(joint) for joint, _ in bones])
    rng = np.random.default_rng(0)
    vertices, joints, weights = [], [], []
    for bone, count in enumerate(np.diff(np.linspace(0, vertex_count, len(bones) + 1).astype(int))):
        tube = _tube(heads[bone], tails[bone], count, rng)
        uneven = np.exp(0.3 * rng.normal(size=(count, len(bones))))
        followed, shares = _nearest(tube, heads, tails, turned_by, uneven)
        vertices.append(tube)
        joints.append(followed)
        weights.append(shares)
    normals = rng.normal(size=(vertex_count, 3))
    skin = Skin(
        np.concatenate(vertices),
        np.concatenate(joints),
        np.concatenate(weights),
        len(turning),
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
    )
    return Body(skin, _transforms(motion, rest)[:, turning])


def _tube(
    head: NDArray[np.float64], tail: NDArray[np.float64], count: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """(count, 3) vertices round a bone, in rings of sixteen."""
    along = np.arange(count)[:, None] // 16 * 16 / max(count, 1)
    around = rng.normal(size=(count, 3))
    around /= np.linalg.norm(around, axis=1, keepdims=True)
    length = float(np.linalg.norm(tail - head))
    tube: NDArray[np.float64] = head + along * (tail - head) + 0.25 * length * around
    return tube


def _nearest(
    points: NDArray[np.float64],
    heads: NDArray[np.float64],
    tails: NDArray[np.float64],
    turned_by: NDArray[np.int64],
    uneven: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The four joints (P, 4) whose bones are nearest, and their weights, the strongest first.

    Squared distances are times ``uneven`` (P, bones).
    """
    axes = tails - heads
    squares = np.maximum((axes**2).sum(axis=1), 1e-12)
    nearness = np.zeros((len(points), turned_by.max() + 1))
    for bone, joint in enumerate(turned_by):
        along = np.clip((points - heads[bone]) @ axes[bone] / squares[bone], 0, 1)[:, None]
        apart = ((points - heads[bone] - along * axes[bone]) ** 2).sum(axis=1)
        near = 1 / (uneven[:, bone] * (apart + 1e-3 * squares.mean())) ** 2
        nearness[:, joint] = np.maximum(nearness[:, joint], near)
    joints = np.argsort(-nearness, axis=1, kind="stable")[:, :4]
    weights = np.take_along_axis(nearness, joints, axis=1)
    return joints, weights / weights.sum(axis=1, keepdims=True)


def _scrambled(body: Body) -> Body:
    """Its vertices, each following four joints at random."""
    rng = np.random.default_rng(0)
    count, joint_count = body.skin.vertex_count, body.skin.joint_count
    joints = rng.random((count, joint_count), np.float32).argpartition(4, axis=1)[:, :4]
    weights = 0.01 + rng.random((count, 4))
    weights /= weights.sum(axis=1, keepdims=True)
    skin = Skin(body.skin.vertices, joints, weights, joint_count, normals=body.skin.normals)
    return Body(skin, body.transforms, remark=", joints at random")


def _ancestors(parents: NDArray[np.int32], joint: int) -> Iterator[int]:
    while parents[joint] >= 0:
        joint = int(parents[joint])
        yield joint


def _rest(skeleton: Skeleton) -> NDArray[np.float64]:
    """(J, 3) where the joints are before anything turns."""
    rest = skeleton.offsets.copy()
    for joint in range(skeleton.joint_count):
        rest[joint] += sum(skeleton.offsets[above] for above in _ancestors(skeleton.parents, joint))
    return rest


def _transforms(motion: Motion, rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, J, 4, 4): from rest, where no joint is turned, to each frame."""
    positions = motion.positions(dtype=np.float64)
    turns = matrices(motion.joint_rotations(dtype=np.float64))
    found = np.zeros((*positions.shape[:2], 4, 4))
    found[..., :3, :3] = turns
    found[..., :3, 3] = positions - np.einsum("fjab,jb->fja", turns, rest)
    found[..., 3, 3] = 1
    return found
