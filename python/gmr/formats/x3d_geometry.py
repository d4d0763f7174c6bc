"""The visible body of a humanoid: a sphere at each joint, capsules from each joint to the next, a head."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gmr.formats.x3d_figure import Figure
from gmr.formats.x3d_nodes import closed, element, opened
from gmr.quaternions import about, multiply
from gmr.skinning.driving.rest_poses import shortest_turn

__all__ = ["axis_angle", "ground", "segment", "viewpoint"]

Floats = NDArray[np.float64]

_UP = np.array([0.0, 1.0, 0.0])
_RADII = (
    ("hip", 0.045), ("knee", 0.031), ("talocrural", 0.022), ("metatarsophalangeal", 0.018),
    ("sternoclavicular", 0.025), ("shoulder", 0.026), ("elbow", 0.021), ("radiocarpal", 0.018),
    ("carp", 0.007), ("skullbase", 0.03), ("vc", 0.028), ("vl", 0.058), ("vt", 0.055),
    ("humanoid_root", 0.05), ("sacroiliac", 0.05),
)  # fmt: skip
"""Radius over stature, by what a name contains, the likeliest first; by eye."""
_COLOURS = {"l": "0.25 0.45 0.85", "r": "0.9 0.5 0.2", "": "0.75 0.73 0.7"}
"""Of the left side, the right side and the middle."""
_HEAD = 0.065
"""Radius of a head over stature, and how high its middle is above the base of the skull."""
_FIELD_OF_VIEW = np.pi / 4
_WIDE = 4 / 3
"""Width over height of the narrowest picture that shows all of the way."""


def segment(figure: Figure, name: str) -> Iterator[str]:
    """The shapes of the part of the body that a joint turns, in the default pose."""
    start, stature = figure.centres[name], figure.stature
    ends = [figure.centres[below] for below, above in figure.body.above.items() if above == name]
    if name == "skullbase":
        yield from _head(start, figure.tips.get(name), stature)
        return
    if name in figure.tips:
        ends.append(figure.tips[name])
    thick = stature * next(share for part, share in _RADII if part in name)
    colour = name[0] if name[1:2] == "_" else ""
    yield from _shape(element("Sphere", radius=thick), colour, start)
    for end in ends:
        way = end - start
        length = float(np.linalg.norm(way))
        if length > thick / 4:
            turn = axis_angle(shortest_turn(_UP, way))
            cylinder = element("Cylinder", radius=thick, height=length, top="false", bottom="false")
            yield from _shape(cylinder, colour, (start + end) / 2, turn)
            yield from _shape(element("Sphere", radius=thick), colour, end)


def _head(base: Floats, crown: Floats | None, stature: float) -> Iterator[str]:
    """A ball from the base of the skull to the crown, and a nose that tells where the face is."""
    high = stature * 2 * _HEAD if crown is None else float(np.linalg.norm(crown - base))
    radius = min(max(high / 2, 0.045 * stature), 0.08 * stature)
    way = _UP if crown is None else (crown - base) / max(high, 1e-12)
    middle = base + radius * way
    yield from _shape(element("Sphere", radius=radius), "", middle)
    nose = middle + np.array([0.0, 0.0, radius])
    yield from _shape(element("Sphere", radius=radius / 5), "", nose)


def _shape(geometry: str, colour: str, place: Floats, turn: Floats | None = None) -> Iterator[str]:
    yield opened("Transform", translation=place, rotation=turn)
    material = element("Material", diffuseColor=_COLOURS[colour])
    yield f"<Shape><Appearance>{material}</Appearance>{geometry}</Shape>"
    yield closed("Transform")


def axis_angle(turn: Floats) -> Floats:
    """(4,) axis and radians of a quaternion."""
    sign = -1.0 if turn[3] < 0 else 1.0
    size = float(np.linalg.norm(turn[:3]))
    axis = sign * turn[:3] / size if size > 0 else np.array([0.0, 0.0, 1.0])
    return np.append(axis, 2 * np.arctan2(size, abs(turn[3])))


def ground(figure: Figure) -> Iterator[str]:
    """A plate under all places that the humanoid goes to."""
    low, high = figure.box
    stature = figure.stature
    thick = 0.01 * stature
    middle, size = (low + high) / 2, high - low + 2 * stature
    place = np.array([middle[0], figure.floor - 1.5 * thick - 0.02 * stature, middle[2]])
    box = element("Box", size=np.array([size[0], thick, size[2]]))
    yield opened("Transform", translation=place)
    material = element("Material", diffuseColor="0.45 0.5 0.48", specularColor="0 0 0")
    yield f"<Shape><Appearance>{material}</Appearance>{box}</Shape>"
    yield closed("Transform")


def viewpoint(figure: Figure) -> str:
    """From where all of the way is seen, across it; from before the body where it stays in place."""
    low, high = figure.box
    stature = figure.stature
    reach = float(np.hypot(*(high - low)[[0, 2]]))
    ahead = _heading(figure)
    aside = ahead + np.pi / 2 if reach > stature else ahead + np.pi / 4
    turn = multiply(about(_UP, np.asarray(aside)), about(np.array([1.0, 0.0, 0.0]), np.asarray(-0.12)))
    target = (low + high) / 2 - 0.05 * stature * _UP
    wide = max((reach + 0.8 * stature) / _WIDE, 1.5 * stature)
    far = wide / 2 / np.tan(_FIELD_OF_VIEW / 2)
    place = target + far * np.array(
        [np.sin(aside) * np.cos(0.12), np.sin(0.12), np.cos(aside) * np.cos(0.12)]
    )
    return element(
        "Viewpoint",
        description="all of the way",
        position=place,
        orientation=axis_angle(turn),
        fieldOfView=float(_FIELD_OF_VIEW),
    )


def _heading(figure: Figure) -> float:
    """Radians about the vertical from +Z to where the root looks first."""
    x, y, z, w = figure.still["humanoid_root"]
    return float(np.arctan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y)))
