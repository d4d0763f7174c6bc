"""Characters made by hand: a body of boxes that rests in any pose, its joints called and turned at will."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from gmr.quaternions import conjugate, from_matrices, multiply, rotated
from gmr.skinning import Character, Nodes, Part
from gmr.skinning.transforms import local_matrices

Floats = NDArray[np.float64]

BODY: Mapping[str, tuple[str, tuple[float, float, float]]] = {
    "Hips": ("", (0.0, 0.95, 0.0)),
    "Spine": ("Hips", (0.0, 0.1, 0.0)),
    "Chest": ("Spine", (0.0, 0.2, 0.01)),
    "Neck": ("Chest", (0.0, 0.25, 0.0)),
    "Head": ("Neck", (0.0, 0.1, 0.02)),
    "Tail": ("Hips", (0.0, 0.0, -0.3)),
    **{
        name: (parent, offset)
        for side, x in (("Left", 1.0), ("Right", -1.0))
        for name, parent, offset in (
            (f"{side}Shoulder", "Chest", (0.04 * x, 0.2, 0.0)),
            (f"{side}UpperArm", f"{side}Shoulder", (0.12 * x, 0.0, 0.0)),
            (f"{side}LowerArm", f"{side}UpperArm", (0.25 * x, -0.12, 0.0)),
            (f"{side}Hand", f"{side}LowerArm", (0.2 * x, -0.12, 0.05)),
            (f"{side}UpperLeg", "Hips", (0.1 * x, -0.05, 0.0)),
            (f"{side}LowerLeg", f"{side}UpperLeg", (0.03 * x, -0.42, 0.02)),
            (f"{side}Foot", f"{side}LowerLeg", (0.0, -0.4, -0.03)),
            (f"{side}Toe", f"{side}Foot", (0.01 * x, -0.05, 0.11)),
        )
    },
}
"""Parent and vector from it, in metres, of each joint of a body that rests in an A-pose and faces +Z."""


def character(
    names: Sequence[str],
    parents: Sequence[int],
    places: Floats,
    seed: int = 0,
    feet: Sequence[int] = (),
) -> Character:
    """A character with joints at these places, turned at random, and a small box on each; feet have soles.

    Args:
        names: (J,)
        parents: (J,)
        places: (J, 3) metres, in the world.
        seed: of how the joints are turned.
        feet: joints whose boxes reach from behind them to before them and down to the ground.
    """
    rng = np.random.default_rng(seed)
    turns = rng.normal(size=(len(names), 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    above = np.asarray(parents)
    held = above >= 0
    local, vectors = turns.copy(), places.copy()
    local[held] = multiply(conjugate(turns[above[held]]), turns[held])
    vectors[held] = rotated(conjugate(turns[above[held]]), places[held] - places[above[held]])
    count = len(names)
    nodes = Nodes(
        (*names, "mesh"),
        np.append(above, -1).astype(np.int32),
        np.vstack([vectors, np.zeros(3)]),
        np.vstack([local, [0, 0, 0, 1]]),
        np.ones((count + 1, 3)),
    )
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
    boxes = [place + 0.02 * corners for place in places]
    for foot in feet:
        boxes[foot] = places[foot] * [1, 0, 1] + corners * [0.04, 0.04, 0.1] + [0, 0.04, 0.05]
    rest = local_matrices(places, turns, np.ones((count, 3)))
    sides = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]], np.int32)
    part = Part(
        name="boxes",
        vertices=np.concatenate(boxes).astype(np.float32),
        faces=np.concatenate([sides + 8 * k for k in range(count)]),
        normals=None,
        texture_coordinates=None,
        material=None,
        joints=np.repeat(np.arange(count, dtype=np.int32), 8)[:, None],
        weights=np.ones((8 * count, 1), np.float32),
        inverse_bind=np.linalg.inv(rest).astype(np.float64),
        node=count,
    )
    return Character("figure", nodes, np.arange(count, dtype=np.int32), (part,))


def body(
    seed: int = 0,
    *,
    bend: Mapping[str, Floats] | None = None,
    facing: float = 0.0,
    size: float = 1.0,
    rename: Mapping[str, str] | None = None,
) -> Character:
    """The body of :data:`BODY` as a character.

    Args:
        seed: of how the joints are turned.
        bend: by joint a quaternion that turns it at rest, and all below.
        facing: radians about the vertical by which it faces elsewhere than +Z.
        size: metres for each.
        rename: other names.
    """
    names = list(BODY)
    turns: dict[str, Floats] = {}
    places: dict[str, Floats] = {}
    about = np.array([0.0, np.sin(facing / 2), 0.0, np.cos(facing / 2)])
    for name, (parent, offset) in BODY.items():
        above = turns.get(parent, about)
        places[name] = places.get(parent, np.zeros(3)) + rotated(above, size * np.array(offset))
        turns[name] = multiply(above, (bend or {}).get(name, np.array([0.0, 0, 0, 1])))
    found = np.array([places[name] for name in names])
    parents = [names.index(parent) if parent else -1 for parent, _ in BODY.values()]
    called = [(rename or {}).get(name, name) for name in names]
    feet = [names.index(f"{side}Foot") for side in ("Left", "Right")]
    return character(called, parents, found, seed, feet)


def turned_at_random(rng: np.random.Generator, most: float) -> Floats:
    """(4,) a turn by up to ``most`` radians."""
    axis = rng.normal(size=3)
    angle = rng.uniform(0, most)
    return np.array([*(np.sin(angle / 2) * axis / np.linalg.norm(axis)), np.cos(angle / 2)])


def joint_turns(poses: Floats) -> Floats:
    """(F, J, 4) of pose matrices."""
    return from_matrices(poses[..., :3, :3])
