"""What the player draws of a body, and what is said of a trial in words."""

from __future__ import annotations

import re
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.wording import asked_of, metres
from gmr.evaluation.replays import PlayedTrial, Replays

__all__ = ["drawn_parents", "head_of", "on_a_bone", "replay_sentence", "sides"]

_LEFT: Final = re.compile(
    r"left|(^|[\W_])l([\W_]|$)|^l(?=[A-Z]|hip|fem|tib|foot|toe|hand|wri|rad|hum|cla|thu|fin)"
)
_RIGHT: Final = re.compile(
    r"right|(^|[\W_])r([\W_]|$)|^r(?=[A-Z]|hip|fem|tib|foot|toe|hand|wri|rad|hum|cla|thu|fin)"
)


def replay_sentence(played: PlayedTrial) -> str:
    """What a replay shows, in words."""
    offset = played.offset
    worst = int(np.argmax(offset))
    seconds = played.trial.seconds * worst / max(len(offset) - 1, 1)
    jumps = int(played.jumped.sum())
    return (
        f"Asked for {asked_of(played.trial)}, the character is farthest from "
        f"its plan, {metres(float(offset[worst]))}, after {seconds:.0f} of {played.trial.seconds:.0f} "
        f"seconds. It jumps {jumps:,} {'time' if jumps == 1 else 'times'}."
    )


def sides(names: tuple[str, ...]) -> list[int]:
    """1 for a joint of the left side, 2 of the right, 0 of neither, from its name."""
    return [_side(name) for name in names]


def _side(name: str) -> int:
    short = name.rpartition(":")[2]
    for side, pattern in ((1, _LEFT), (2, _RIGHT)):
        if pattern.search(short) or pattern.search(short.lower()):
            return side
    return 0


def head_of(replays: Replays, parents: NDArray[np.int32]) -> list[int]:
    """The joint of the head and its highest child, between which a head is drawn; [] without such a name.

    Args:
        replays: whose body.
        parents: (J,) as drawn; what no bone holds has no head.
    """
    drawn = on_a_bone(parents)
    heads = [
        place
        for place, name in enumerate(replays.joint_names)
        if drawn[place] and re.search("head", name, re.IGNORECASE)
    ]
    if not heads or len(replays.positions) == 0:
        return []
    head = heads[0]
    children = np.flatnonzero(parents == head)
    if len(children) == 0:
        return [head, head]
    return [head, int(children[np.argmax(replays.positions[0, children, 1])])]


def drawn_parents(parents: NDArray[np.int32], names: tuple[str, ...], hips: str | None) -> NDArray[np.int32]:
    """The parents, -1 also for the hips, for every joint above them, and for what else hangs on those."""
    parents = parents.astype(np.int32)
    above: list[int] = []
    joint = int(parents[names.index(hips)]) if hips in names else -1
    while joint >= 0:
        above.append(joint)
        joint = int(parents[joint])
    parents[above] = -1
    parents[np.isin(parents, above)] = -1
    return parents


def on_a_bone(parents: NDArray[np.int32]) -> NDArray[np.bool_]:
    """(J,) whether a bone begins or ends at a joint."""
    on = parents >= 0
    on[parents[on]] = True
    return on
