"""Angles of a body whose pelvis turns, for one whose pelvis does not: hips and waist turn instead.

The paper's body has no degrees of freedom in its root. Where the pelvis of an action tilts, drops to a side
or turns, thighs and trunk keep their directions as far as their ranges of motion let them: the turn of the
pelvis is put before theirs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.limits import squashed
from gmr.actionlets.travel.turns import angles_of, product, times

if TYPE_CHECKING:
    from gmr.actionlets.body import Body
    from gmr.actionlets.score import Score

__all__ = ["sampled"]

Floats = NDArray[np.float64]

_PELVIS = ("root.tilt", "root.obliquity", "root.rotation")
_HUNG = (
    ("left_hip.flexion", "left_hip.abduction", "left_hip.rotation"),
    ("right_hip.flexion", "right_hip.abduction", "right_hip.rotation"),
    ("waist.flexion", "waist.lateral", "waist.rotation"),
)


def sampled(body: Body, score: Score, fps: float) -> Floats:
    """(F, D) the angles of a score for a body, in radians and metres.

    Args:
        body: D degrees of freedom.
        score: of the detailed body.
        fps: frames a second.
    """
    found = score.sample(fps, body.names)
    if _PELVIS[0] in body.columns:
        return found
    turns = score.sample(fps, _PELVIS)
    if not turns.any():
        return found
    # All three turn about X, Z and Y in this order, the pelvis right-handed about each.
    pelvis = product(turns[:, 0], turns[:, 1], turns[:, 2])
    for names in _HUNG:
        columns = body.subset(names)
        signs = np.array([np.sum(body.dofs[column].axis) for column in columns])
        own = found[:, columns] * signs
        turned = times(pelvis, product(own[:, 0], own[:, 1], own[:, 2]))
        found[:, columns] = squashed(
            np.stack(angles_of(turned), axis=1) * signs, body.low[columns], body.high[columns]
        )
    return found
