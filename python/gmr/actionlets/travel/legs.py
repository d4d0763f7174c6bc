"""The legs and the pelvis of a body, as travelling needs them."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.body import Body
from gmr.actionlets.travel.leg import Leg
from gmr.actionlets.travel.plan import SIDES
from gmr.actionlets.travel.sole import Sole
from gmr.actionlets.travel.turns import product
from gmr.arrays import read_only

__all__ = ["legs_of", "pelvis_shift", "pelvis_turn", "sole_of"]

Floats = NDArray[np.float64]


@lru_cache(maxsize=32)
def legs_of(body: Body) -> tuple[Leg, Leg]:
    """The left and the right leg of a body."""
    left, right = (_leg(body, side) for side in SIDES)
    return left, right


def sole_of(leg: Leg) -> Sole:
    """The sole of a leg's foot."""
    return Sole(leg.heel, leg.toe, 1.0) if leg.rigid else Sole(leg.heel, leg.toe)


def pelvis_turn(body: Body, angles: Floats) -> Floats:
    """(F, 3, 3) turn of the pelvis in the frame of the heading: tilt, obliquity, rotation."""
    if "root.tilt" not in body.columns:
        return np.broadcast_to(np.eye(3), (len(angles), 3, 3))
    x, z, y = (angles[:, body.column(f"root.{motion}")] for motion in ("tilt", "obliquity", "rotation"))
    return product(x, z, y)


def pelvis_shift(body: Body, angles: Floats) -> Floats:
    """(F, 3) sway, heave and surge of the pelvis in the frame of the heading, metres."""
    if "root.sway" not in body.columns:
        return np.zeros((len(angles), 3))
    return angles[:, [body.column(f"root.{motion}") for motion in ("sway", "heave", "surge")]]


def _leg(body: Body, side: str) -> Leg:
    offsets = dict(zip(body.skeleton.names, np.asarray(body.skeleton.offsets, np.float64), strict=True))
    hip, signs = _columns(body, f"{side}_hip", ("flexion", "abduction", "rotation"))
    (knee,), (bends,) = _columns(body, f"{side}_knee", ("flexion",))
    has_ankle = f"{side}_ankle.flexion" in body.columns
    ankle, ankle_signs = _columns(body, f"{side}_ankle", ("flexion", "inversion", "rotation") * has_ankle)
    return Leg(
        side,
        read_only(offsets[f"{side}_hip"]),
        read_only(offsets[f"{side}_knee"]),
        read_only(offsets[f"{side}_ankle"]),
        read_only(np.array(body.foot.heel)),
        read_only(np.array(body.foot.toe)),
        (hip[0], hip[1], hip[2]),
        signs,
        knee,
        float(bends),
        (ankle[0], ankle[1], ankle[2]) if has_ankle else None,
        ankle_signs,
        _limits(body, [*hip, knee, *ankle], kept=has_ankle),
    )


def _limits(body: Body, columns: list[int], kept: bool) -> tuple[Floats, Floats]:
    """Lowest and highest angles; none for a leg with a rigid ankle, which has no way to keep them."""
    if not kept:
        return read_only(np.full(len(columns), -np.inf)), read_only(np.full(len(columns), np.inf))
    return read_only(body.low[columns]), read_only(body.high[columns])


def _columns(body: Body, joint: str, motions: tuple[str, ...]) -> tuple[list[int], Floats]:
    """Columns of a joint's movements and the sign of each one's axis."""
    columns = [body.column(f"{joint}.{motion}") for motion in motions]
    return columns, read_only(np.array([np.sum(body.dofs[column].axis) for column in columns]))
