"""Binding by gradients as its definition says it, dense, in NumPy; and figures that are bound."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.skeleton import End, Skeleton

Array = NDArray[np.float64]


@dataclass
class Figure:
    """A mesh beside a skeleton, both at rest."""

    vertices: Array
    faces: NDArray[np.int32]
    skeleton: Skeleton

    def moved(self, linear: Array, way: Array) -> Figure:
        """Both under a linear map and then a translation."""
        offsets = self.skeleton.offsets @ linear.T
        offsets[list(self.skeleton.roots)] += way
        skeleton = Skeleton.post_rotation(
            self.skeleton.names, self.skeleton.parents, offsets, ends=self.skeleton.ends
        )
        return Figure(self.vertices @ linear.T + way, self.faces, skeleton)


def random_figure(rng: np.random.Generator) -> Figure:
    """A tree of up to nine joints, some of them End Sites, and vertices round it that triangles join."""
    count = int(rng.integers(1, 10))
    parents = np.array([-1, *(rng.integers(0, k) for k in range(1, count))])
    offsets = rng.normal(size=(count, 3))
    offsets *= (0.3 + rng.random((count, 1))) / np.linalg.norm(offsets, axis=1, keepdims=True)
    leaf = ~np.isin(np.arange(count), parents)
    ends = np.where(leaf & (parents >= 0) & (rng.random(count) < 0.4), End.SITE, End.JOINT)
    skeleton = Skeleton.post_rotation([f"j{k}" for k in range(count)], parents, offsets, ends=ends)
    places = rest(skeleton)
    vertices = places[rng.integers(0, count, 60)] + rng.normal(size=(60, 3)) * rng.uniform(0.1, 1.5, (60, 1))
    vertices = np.concatenate([vertices, vertices[::4]])
    faces = rng.integers(0, len(vertices), (80, 3)).astype(np.int32)
    return Figure(vertices, faces, skeleton)


def rest(skeleton: Skeleton) -> Array:
    places = skeleton.offsets.copy()
    for joint in skeleton.parents_first:
        if skeleton.parents[joint] >= 0:
            places[joint] += places[skeleton.parents[joint]]
    return places


def dense(weights: NDArray[np.float32], joints: NDArray[np.int32], joint_count: int) -> Array:
    """(V, J)"""
    found = np.zeros((len(weights), joint_count))
    for column in range(weights.shape[1]):
        np.add.at(found, (np.arange(len(found)), joints[:, column]), weights[:, column])
    return found


def defined(figure: Figure) -> tuple[Array, NDArray[np.intp]]:
    """(V, J) weights, and the vertices in no box. No joint may lie where its parent does."""
    vertices, skeleton = figure.vertices, figure.skeleton
    places, count = rest(skeleton), skeleton.joint_count
    bones = []  # joint, head, tail, open at the head, open at the tail
    for j in range(count):
        children, parent = skeleton.children[j], skeleton.parents[j]
        if skeleton.ends[j] == End.SITE:
            continue
        alone = parent < 0 and len(children) < 2
        bones += [(j, places[j], places[c], alone, skeleton.ends[c] == End.SITE) for c in children]
        if not children:
            before = places[parent] if parent >= 0 else places[j]
            bones.append((j, places[j], places[j] + 1.5 * (places[j] - before), alone, True))
    owners = np.array([bone[0] for bone in bones])
    heads, tails = np.array([bone[1] for bone in bones]), np.array([bone[2] for bone in bones])
    open_head, open_tail = np.array([bone[3:] for bone in bones]).T
    along = tails - heads
    length = np.linalg.norm(along, axis=1)
    long = length > 0
    direction = along / np.where(long, length, 1)[:, None]
    margin = np.where(long, 0.35 * length, 1.0)

    beside = vertices[:, None] - heads
    s = np.einsum("vbi,bi->vb", beside, direction)
    aside = np.linalg.norm(beside - s[..., None] * direction, axis=-1)
    distance = np.where(s <= 0, np.linalg.norm(beside, axis=-1), aside)
    distance = np.where(s >= length, np.linalg.norm(vertices[:, None] - tails, axis=-1), distance)
    nearest = distance.argmin(axis=1)
    projects = ((s >= 0) | open_head) & ((s <= length) | open_tail)
    across = 0.35 * length
    for b in range(len(bones)):
        mine = (nearest == b) & projects[:, b]
        if mine.any():
            across[b] = max(aside[mine, b].max(), 1e-6 * length[b])
    rise = np.where(open_head, 1, np.clip((s + margin) / (2 * margin), 0, 1))
    fall = np.where(open_tail, 1, np.clip((length + margin - s) / (2 * margin), 0, 1))
    ends = np.concatenate([heads, tails])
    slack = 0.01 * np.linalg.norm(ends - ends.mean(axis=0), axis=1).max()
    least = distance.min(axis=1, keepdims=True)
    reach = 1.5 * least + slack
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(distance > least, (reach - distance) / (reach - least), 1.0)
        beside = np.where(long, 2 - aside / across, 0).clip(0, 1)
    gradient = rise * fall * beside * share.clip(0, 1)

    weights = np.zeros((len(vertices), count))
    for b, joint in enumerate(owners):
        weights[:, joint] = np.maximum(weights[:, joint], gradient[:, b])
    outside = np.flatnonzero(weights.sum(axis=1) == 0)
    weights[outside, owners[nearest[outside]]] = 1
    weights = _four_largest(weights)
    smoothed = weights.copy()
    corners = vertices[figure.faces]
    for v in outside:
        touching = (corners == vertices[v]).all(axis=-1).any(axis=1)
        around = np.unique(np.concatenate([corners[touching].reshape(-1, 3), vertices[[v]]]), axis=0)
        first = [int(np.flatnonzero((vertices == place).all(axis=1))[0]) for place in around]
        smoothed[v] = weights[first].mean(axis=0)
    return _four_largest(smoothed), outside


def _four_largest(weights: Array) -> Array:
    rest = np.argsort(-weights, axis=1, kind="stable")[:, 4:]
    kept = weights.copy()
    np.put_along_axis(kept, rest, 0, axis=1)
    return np.asarray(kept / kept.sum(axis=1, keepdims=True))
