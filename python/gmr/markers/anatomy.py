"""Where anatomy says that a joint centre is: rules that a relation names, each with its source.

A rule gives a place in the template of the part above the joint from where that part's markers are there, and
how far it may be off (one standard deviation). Lengths are metres.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gmr.markers.centres import Guess

__all__ = ["RULES", "Body", "Rule"]

Array = NDArray[np.float64]
Names = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Body:
    """What a rule may ask of the part above the joint.

    Args:
        points: marker or joint name -> (3,) place in the part's template.
        axes: (3, 3) columns left, up, forward of the part in its template; None where it has none yet.
        length: the greatest distance of two markers of the whole recording that are nearly stretched out,
            in metres; None where one of them is missing.
    """

    points: Mapping[str, Array]
    axes: Array | None
    length: Callable[[str, str], float | None]

    def middle(self, names: Names) -> Array:
        """(3,) the mean of some points."""
        return np.asarray(np.mean([self.points[name] for name in names], axis=0), np.float64)


@dataclass(frozen=True)
class Rule(ABC):
    """A rule for a joint centre.

    Args:
        within: standard deviation of the place in each direction, metres.
    """

    within: float
    source: ClassVar[str]
    needs_axes: ClassVar[bool] = False

    @property
    def names(self) -> Iterator[str]:
        """The points of the part above that the rule cannot do without."""
        for key, value in vars(self).items():
            if isinstance(value, tuple) and value and isinstance(value[0], str) and key != "leg":
                yield from value
            elif isinstance(value, str) and key in ("of", "plane", "joint", "back", "front"):
                yield value

    @abstractmethod
    def place(self, body: Body) -> Array:
        """(3,) the joint centre in the template of the part above."""

    def guess(self, body: Body) -> Guess:
        """The joint centre with its uncertainty."""
        return Guess(self.place(body), np.eye(3) * self.within**2, self.source)


@dataclass(frozen=True)
class Midpoint(Rule):
    """The middle of some points, such as the two epicondyles of the knee."""

    of: Names = ()
    within: float = 0.008
    source = "midpoint of markers"

    def place(self, body: Body) -> Array:
        """The mean of the points."""
        return body.middle(self.of)


@dataclass(frozen=True)
class Offset(Rule):
    """A point and a step from it: to the left, up and forward, in metres."""

    of: str = ""
    by: tuple[float, float, float] = (0.0, 0.0, 0.0)
    within: float = 0.015
    source = "offset from a marker"
    needs_axes = True

    def place(self, body: Body) -> Array:
        """The point, moved along the axes of the part."""
        assert body.axes is not None
        return np.asarray(body.points[self.of] + body.axes @ np.array(self.by), np.float64)


@dataclass(frozen=True)
class _Pelvis(Rule):
    """What rules of the pelvis share: spines in front (left, right), and behind (one or two)."""

    asis: Names = ()
    psis: Names = ()

    def frame(self, body: Body) -> tuple[Array, Array, float, float]:
        """Origin between the anterior spines, columns forward, up, right, and the pelvis' width and depth."""
        left, right = (body.points[name] for name in self.asis)
        origin, behind = (left + right) / 2, body.middle(self.psis)
        to_right = _unit(right - left)
        forward = origin - behind
        depth = float(np.linalg.norm(forward))
        forward = _unit(forward - (forward @ to_right) * to_right)
        axes = np.stack([forward, np.cross(to_right, forward), to_right], axis=1)
        return origin, axes, float(np.linalg.norm(right - left)), depth


@dataclass(frozen=True)
class Harrington(_Pelvis):
    """The hip from the width and depth of the pelvis and the length of the leg.

    The deviations are those of the regression on other subjects (5.2, 3.6 and 3.2 mm forward, up and aside)
    with 6 mm for where skin markers sit over the spines.
    """

    side: str = ""
    leg: Names = ()
    within: float = 0.006
    source = "Harrington et al., J. Biomech. 40 (2007) 595"
    _ERRORS: ClassVar[tuple[float, float, float]] = (0.0052, 0.0036, 0.0032)

    def place(self, body: Body) -> Array:
        """Equations of the paper in millimetres: forward, up, aside."""
        origin, axes, width, depth = self.frame(body)
        width, depth = 1000 * width, 1000 * depth
        length = body.length(*self.leg) if len(self.leg) == 2 else None
        forward = -0.24 * depth - 9.9
        if length is None:
            up, aside = -0.30 * width - 10.9, 0.33 * width + 7.3
        else:
            up = -0.16 * width - 0.04 * 1000 * length - 7.1
            aside = 0.28 * depth + 0.16 * width + 7.9
        right = aside if self.side == "right" else -aside
        return np.asarray(origin + axes @ np.array([forward, up, right]) / 1000, np.float64)

    def guess(self, body: Body) -> Guess:
        """Its uncertainty differs by direction."""
        _, axes, _, _ = self.frame(body)
        variances = np.square(self._ERRORS) + self.within**2
        return Guess(self.place(body), axes @ np.diag(variances) @ axes.T, self.source)


@dataclass(frozen=True)
class Lumbar(_Pelvis):
    """The joint of the last lumbar vertebra and the sacrum; the mean of the equations for women and men."""

    within: float = 0.015
    source = "Reed et al. 1999, in Dumas et al., J. Biomech. 40 (2007) 543"

    def place(self, body: Body) -> Array:
        """Behind and above the middle of the anterior spines, in parts of their distance."""
        origin, axes, width, _ = self.frame(body)
        step = np.array([-(0.264 + 0.289) / 2, (0.126 + 0.172) / 2, 0.0]) * width
        return np.asarray(origin + axes @ step, np.float64)


@dataclass(frozen=True)
class Cervical(Rule):
    """The joint of the last cervical and the first thoracic vertebra; the mean of women's and men's."""

    back: str = ""
    front: str = ""
    within: float = 0.015
    source = "Reed et al. 1999, in Dumas et al., J. Biomech. 40 (2007) 543"
    needs_axes = True

    def place(self, body: Body) -> Array:
        """From C7 towards the sternal notch, raised by an angle, a part of their distance."""
        assert body.axes is not None
        start, line = body.points[self.back], body.points[self.front] - body.points[self.back]
        along = _unit(line)
        up = _unit(body.axes[:, 1] - (body.axes[:, 1] @ along) * along)
        angle, part = math.radians((8 + 14) / 2), (0.55 + 0.53) / 2
        step = math.cos(angle) * along + math.sin(angle) * up
        return np.asarray(start + part * np.linalg.norm(line) * step, np.float64)


@dataclass(frozen=True)
class Acromion(Rule):
    """The shoulder below the acromion, by a part of the distance of the two acromia."""

    of: str = ""
    across: Names = ()
    within: float = 0.015
    source = "Rab et al., Gait Posture 15 (2002) 113"
    needs_axes = True

    def place(self, body: Body) -> Array:
        """17 % of the distance down along the trunk."""
        assert body.axes is not None
        left, right = (body.points[name] for name in self.across)
        return np.asarray(
            body.points[self.of] - 0.17 * np.linalg.norm(left - right) * body.axes[:, 1], np.float64
        )


@dataclass(frozen=True)
class Chord(Rule):
    """The joint inward of one marker on its side, in the plane of the joint above and another marker.

    Seen from the centre, the marker and the joint above are at a right angle. ``offset`` is half the joint's
    width and the marker's radius; where the width was measured, write it.
    """

    of: str = ""
    joint: str = ""
    plane: str = ""
    offset: float = 0.05
    within: float = 0.012
    source = "chord function, Kadaba et al., J. Orthop. Res. 8 (1990) 383"

    def place(self, body: Body) -> Array:
        """Away from the marker that gives the plane, for that one is outside too."""
        marker = body.points[self.of]
        to_joint = body.points[self.joint] - marker
        distance = float(np.linalg.norm(to_joint))
        along = to_joint / distance
        outward = body.points[self.plane] - marker
        inward = -_unit(outward - (outward @ along) * along)
        cosine = min(self.offset / distance, 1.0)
        step = cosine * along + math.sqrt(1 - cosine**2) * inward
        return np.asarray(marker + self.offset * step, np.float64)


RULES: Final[Mapping[str, type[Rule]]] = {
    "midpoint": Midpoint,
    "offset": Offset,
    "harrington": Harrington,
    "lumbar": Lumbar,
    "cervical": Cervical,
    "acromion": Acromion,
    "chord": Chord,
}
"""The rules by the names that a relation gives them."""


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector), np.float64)
