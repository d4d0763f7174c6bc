"""Decomposition: a recorded motion becomes a score of actionlets.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", Eq. 3, read backwards.
"""

from __future__ import annotations

from collections.abc import Iterable

from gmr.actionlets.body import Body
from gmr.actionlets.decomposition.decomposed import Decomposed
from gmr.actionlets.decomposition.fitting import TOLERANCE_DEG, decompose_curve, decompose_curves
from gmr.actionlets.decomposition.recorded import Recorded, recorded
from gmr.actionlets.score import Score
from gmr.motion import Motion

__all__ = ["Decomposed", "Recorded", "decompose", "decompose_curve", "decompose_curves", "recorded"]


def decompose(
    motion: Motion,
    body: Body | None = None,
    joints: Iterable[str] | None = None,
    tolerance_deg: float = TOLERANCE_DEG,
) -> Decomposed:
    """The score that a recording is, and how well it fits.

    Args:
        motion: two frames or more; a T-pose that a converter put before the first is left out.
        body: whose degrees of freedom are read from it; None: the angle channels of its file.
        joints: names, where not all are wanted: of the file, or of the body.
        tolerance_deg: a piece is spent where it takes away an error as great as this for half a second.

    Returns:
        ``.score`` in radians and seconds, ``.table()`` of the fit, ``.motion()`` that is composed again.

    Raises:
        ActionletError: fewer than two frames, a joint without angles, rotations without channels, or angles
            that are not finite.
        GmrError: the motion shows no body.
    """
    curves = recorded(motion, body, joints)
    tracks = decompose_curves(curves.times, curves.angles, tolerance_deg)
    return Decomposed(Score(dict(zip(curves.dofs, tracks, strict=True))), curves, float(tolerance_deg))
