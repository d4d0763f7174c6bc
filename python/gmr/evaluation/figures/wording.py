"""What the sentences of the figures share: trials, lengths and clips as they are named there."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import Final

from gmr.evaluation.scenario import Trial
from gmr.evaluation.words import turning
from gmr.matching.naming import recording_of

__all__ = ["asked", "asked_of", "metres", "short_names"]

_LONGEST_LABEL: Final = 32
_AGAIN: Final = "\N{NO-BREAK SPACE}#"


def metres(value: float) -> str:
    """A length: centimetres below half a metre, for there nobody thinks in metres."""
    return f"{value * 100:.0f} cm" if abs(value) < 0.5 else f"{value:.1f} m"


def asked(speed: float, turn_rate_deg: float) -> str:
    """What a trial asks for: "3 m/s turning left by 25 degrees/s"."""
    return f"{speed:g} m/s {turning(turn_rate_deg, turn_rate_deg)}"


def asked_of(trial: Trial) -> str:
    """What a trial asks for; of one that is no cell of the grid, which it is: "path 3 of splines"."""
    return f"{trial.path} of {trial.scenario}" if trial.path else asked(trial.speed, trial.turn_rate_deg)


def short_names(clips: Sequence[str]) -> list[str]:
    """Names that fit beside an axis and stay different, in the order of the clips.

    Folders are left out where the names differ without them, so is the suffix that all share; a name still
    too long loses its beginning, for what tells takes apart, a number most often, is at the end.
    """
    names = [PurePosixPath(clip).name for clip in clips]
    if len(set(names)) < len(set(clips)):
        names = list(clips)
    suffixes = {PurePosixPath(recording_of(name)).suffix for name in names}
    common = suffixes.pop() if len(suffixes) == 1 else ""
    labels: list[str] = []
    for name in names:
        mark = name[len(recording_of(name)) :]
        label = _end_of(recording_of(name).removesuffix(common)) + mark
        same = sum(label == other.split(_AGAIN)[0] for other in labels)
        labels.append(f"{label}{_AGAIN}{same + 1}" if same else label)
    return labels


def _end_of(name: str) -> str:
    if len(name) <= _LONGEST_LABEL:
        return name
    end = name[1 - _LONGEST_LABEL :]
    word = re.search(r"[\W_](?=.{16})", end)
    return f"…{end[word.end() :] if word else end}"
