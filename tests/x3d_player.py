"""An X3D browser in small: reads a file, plays it, and says where the joints of its humanoid are.

It knows nothing of how gmr writes: nodes, routes and interpolators are followed as ISO/IEC 19775-1 says.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def floats(text: str, width: int = 1) -> Floats:
    """Numbers of a field, ``width`` to a row."""
    return np.array(text.replace(",", " ").split(), np.float64).reshape(-1, width)


def matrix_of(turn: Floats) -> Floats:
    """Rodrigues' formula for an SFRotation."""
    axis, angle = turn[:3], turn[3]
    size = np.linalg.norm(axis)
    if size == 0:
        return np.eye(3)
    x, y, z = axis / size
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def between_turns(one: Floats, other: Floats, share: float) -> Floats:
    """The turn on the shortest way from one to another, as a matrix."""
    start, change = matrix_of(one), matrix_of(one).T @ matrix_of(other)
    angle = np.arccos(np.clip((np.trace(change) - 1) / 2, -1, 1))
    axis = np.array([change[2, 1] - change[1, 2], change[0, 2] - change[2, 0], change[1, 0] - change[0, 1]])
    return start @ matrix_of(np.append(axis, share * angle))


@dataclass
class Player:
    """A scene.

    Args:
        root: the element ``X3D``.
    """

    root: ET.Element
    nodes: dict[str, ET.Element] = field(default_factory=dict)

    @classmethod
    def of(cls, data: bytes) -> Player:
        player = cls(ET.fromstring(data))
        for node in player.root.iter():
            name = node.get("DEF")
            if name is not None:
                assert name not in player.nodes, f"{name} is defined twice"
                player.nodes[name] = node
        return player

    @property
    def humanoid(self) -> ET.Element:
        (found,) = self.root.iter("HAnimHumanoid")
        return found

    @property
    def joints(self) -> list[ET.Element]:
        """The joints of the tree, without those that are listed beside it."""
        return [node for node in self.humanoid.iter("HAnimJoint") if node.get("USE") is None]

    @property
    def seconds(self) -> float:
        clocks = list(self.root.iter("TimeSensor"))
        return float(clocks[0].get("cycleInterval", "1")) if clocks else 0.0

    def places(self, fraction: float) -> dict[str, Floats]:
        """(3,) by joint's name, at a fraction of the cycle."""
        values = self._values(fraction)
        found: dict[str, Floats] = {}

        def walk(node: ET.Element, world: Floats) -> None:
            if node.tag == "HAnimJoint" and node.get("USE") is None:
                world = world @ self._transform(node, values)
                centre = floats(node.get("center", "0 0 0"), 3)[0]
                found[node.get("name", "")] = (world @ np.append(centre, 1))[:3]
            for child in node:
                walk(child, world)

        walk(self.humanoid, self._transform(self.humanoid, values))
        return found

    def _transform(self, node: ET.Element, values: dict[tuple[str, str], Floats]) -> Floats:
        """T C R S C^-1, with what is routed to the node."""
        name = node.get("DEF", "")
        shift = values.get((name, "translation"), floats(node.get("translation", "0 0 0"), 3)[0])
        centre = floats(node.get("center", "0 0 0"), 3)[0]
        turn = values.get((name, "rotation"))
        if turn is None:
            turn = matrix_of(floats(node.get("rotation", "0 0 1 0"), 4)[0])
        found = np.eye(4)
        found[:3, :3] = turn
        found[:3, 3] = shift + centre - turn @ centre
        return found

    def _values(self, fraction: float) -> dict[tuple[str, str], Floats]:
        """By node and field, what the interpolators give to it when the clock says ``fraction``."""
        routes = [
            (r.attrib["fromNode"], r.attrib["fromField"], r.attrib["toNode"], r.attrib["toField"])
            for r in self.root.iter("ROUTE")
        ]
        driven = set()
        for source, output, target, put in routes:
            if self.nodes[source].tag == "TimeSensor":
                assert (output, put) == ("fraction_changed", "set_fraction")
                driven.add(target)
        found = {}
        for source, output, target, put in routes:
            if source in driven:
                assert output == "value_changed"
                found[target, put.removeprefix("set_")] = self._interpolated(self.nodes[source], fraction)
        return found

    def _interpolated(self, node: ET.Element, fraction: float) -> Floats:
        keys = floats(node.attrib["key"])[:, 0]
        turns = node.tag == "OrientationInterpolator"
        values = floats(node.attrib["keyValue"], 4 if turns else 3)
        assert len(keys) == len(values)
        assert np.all(np.diff(keys) >= 0)
        at = int(np.clip(np.searchsorted(keys, fraction, side="right") - 1, 0, len(keys) - 2))
        share = float(np.clip((fraction - keys[at]) / (keys[at + 1] - keys[at]), 0, 1))
        if turns:
            return between_turns(values[at], values[at + 1], share)
        return np.asarray(values[at] + share * (values[at + 1] - values[at]), np.float64)
