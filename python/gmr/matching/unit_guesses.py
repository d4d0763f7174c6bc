"""Metres per file unit of the clips of a dataset: what they say, or what their legs tell."""

from __future__ import annotations

from collections.abc import Mapping

from gmr.body.joints import Joints
from gmr.body.measures import Poses, leg_length
from gmr.errors import DatasetError
from gmr.guesses import GUESSED_UNITS, STATURE_PER_LEG, unit_of_legs
from gmr.listing import quoted
from gmr.matching.prepare import unit_text
from gmr.motion import Motion
from gmr.units import metres_per_unit

__all__ = ["middle", "units_of"]

_BODIES = (0.5, 3.0)
"""Metres of stature outside which a unit that was given is said to be odd."""


def units_of(
    motions: Mapping[str, Motion],
    poses: Mapping[str, Poses],
    joints: Joints,
    unit: float | str | None,
    excluded: dict[str, str],
) -> tuple[dict[str, float], list[str]]:
    """Metres per file unit of each clip: what it says, else what the caller says, else a guess, which is
    noted.

    Clips whose body has a human's legs in no known unit join ``excluded``.

    Raises:
        DatasetError: all of them do.
    """
    given = None if unit is None else metres_per_unit(unit)
    units: dict[str, float] = {}
    odd: dict[str, float] = {}
    guesses: dict[float, list[tuple[str, float]]] = {}
    for name, motion in motions.items():
        known = motion.unit or given
        leg = leg_length(motion.skeleton, poses[name], joints.roles)
        if known is not None:
            stature = STATURE_PER_LEG * leg * known
            if not _BODIES[0] <= stature <= _BODIES[1]:
                odd[name] = stature
        else:
            guess = unit_of_legs(leg)
            if guess is None:
                excluded[name] = (
                    f"a leg of {leg:.4g} file units is a human's in none of {', '.join(GUESSED_UNITS)}; say "
                    "how many metres a file unit is: --unit on the command line, unit=... in Python"
                )
                continue
            known = guess.metres
            guesses.setdefault(known, []).append((name, guess.body_metres))
        units[name] = known
    if not units:
        name = next(iter(motions))
        raise DatasetError(f"'{name}': {excluded[name]}")
    notes = [
        f"Unit guessed from the length of the legs: {unit_text(metres)}, which makes the body about "
        f"{middle([stature for _, stature in clips]):.2f} m tall"
        + (f" (for {quoted([name for name, _ in clips], 5)})" if len(guesses) > 1 else "")
        + "; if it is another, say --unit (unit=... in Python)."
        for metres, clips in guesses.items()
    ]
    if odd:
        notes.append(
            f"The unit that was given makes the body of {len(odd)} of {len(motions)} clips "
            f"({quoted(odd, 3)}) about {middle(list(odd.values())):.2g} m tall: give another, or none, and "
            "it is guessed clip by clip."
        )
    return units, notes


def middle(values: list[float]) -> float:
    """The middle one of some values; of an even number, the upper one of both."""
    return sorted(values)[len(values) // 2]
