"""The worst trial as the page's player needs it: poses about the character's place, quantised to 16 bits."""

from __future__ import annotations

import re
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.wording import asked, metres, short_names
from gmr.evaluation.result import Replay
from gmr.pages.columns import packed_array

__all__ = ["packed_replay", "replay_sentence", "sides"]

_MOST_BYTES: Final = 450_000
"""Of poses; a replay that takes more keeps every second, third ... step, and the player fills in between."""
_LEFT: Final = re.compile(
    r"left|(^|[\W_])l([\W_]|$)|^l(?=[A-Z]|hip|fem|tib|foot|toe|hand|wri|rad|hum|cla|thu|fin)"
)
_RIGHT: Final = re.compile(
    r"right|(^|[\W_])r([\W_]|$)|^r(?=[A-Z]|hip|fem|tib|foot|toe|hand|wri|rad|hum|cla|thu|fin)"
)


def packed_replay(replay: Replay, hips: str | None = None) -> dict[str, Any]:
    """The replay for the page's JSON.

    Positions are int16, in units of ``unit`` metres, and horizontally relative to the path: 0.1 mm or better
    wherever on the ground the trial goes.

    Args:
        replay: the trial.
        hips: name of the joint that the body hangs on. What is above it, a root that may stand anywhere, is
            not drawn.
    """
    steps, joints, _ = replay.positions.shape
    stride = max(1, -(-steps * joints * 6 // _MOST_BYTES))
    parents = _drawn_parents(replay, hips)
    about = replay.positions[::stride].astype(np.float64)
    about[..., 0] -= replay.path[::stride, None, 0]
    about[..., 2] -= replay.path[::stride, None, 1]
    about[:, ~_on_a_bone(parents)] = 0.0
    used, clip = np.unique(replay.clip, return_inverse=True)
    unit = float(np.abs(about).max(initial=1e-3)) / 32767
    return {
        "rate": replay.rate / stride,
        "steps": len(about),
        "joints": joints,
        "unit": unit,
        "positions": packed_array(np.rint(about / unit).astype(np.int16)),
        "parents": parents.tolist(),
        "sides": sides(replay.joint_names),
        "head": _head(replay),
        "path": packed_array(replay.path[::stride].astype(np.float32)),
        "reference": packed_array(replay.reference[::stride].astype(np.float32)),
        "offset": packed_array(replay.offset[::stride].astype(np.float32)),
        "clip": packed_array(clip[::stride].astype(np.uint16)),
        "clips": short_names([replay.clip_names[number] for number in used.tolist()]),
        "seconds": packed_array((replay.frame[::stride] / replay.rate).astype(np.float32)),
        "jumped": packed_array(_any_of_stride(replay.jumped, stride).astype(np.uint8)),
    }


def replay_sentence(replay: Replay) -> str:
    """What the replay shows, in words."""
    worst = int(np.argmax(replay.offset))
    return (
        f"Asked for {asked(replay.speed, replay.turn_rate_deg)}, the character is farthest from its plan, "
        f"{metres(float(replay.offset[worst]))}, after {worst / replay.rate:.0f} of "
        f"{len(replay.offset) / replay.rate:.0f} seconds. "
        f"It jumps {int(replay.jumped.sum()):,} times between {len(np.unique(replay.clip)):,} clips."
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


def _head(replay: Replay) -> list[int]:
    """The joint of the head and its highest child, between which a head is drawn; [] without such a name."""
    heads = [place for place, name in enumerate(replay.joint_names) if re.search("head", name, re.IGNORECASE)]
    if not heads or len(replay.positions) == 0:
        return []
    head = heads[0]
    children = np.flatnonzero(replay.parents == head)
    if len(children) == 0:
        return [head, head]
    return [head, int(children[np.argmax(replay.positions[0, children, 1])])]


def _drawn_parents(replay: Replay, hips: str | None) -> NDArray[np.int32]:
    """The parents, -1 also for the hips, for every joint above them, and for what else hangs on those."""
    parents = replay.parents.astype(np.int32)
    above: list[int] = []
    joint = int(parents[replay.joint_names.index(hips)]) if hips in replay.joint_names else -1
    while joint >= 0:
        above.append(joint)
        joint = int(parents[joint])
    parents[above] = -1
    parents[np.isin(parents, above)] = -1
    return parents


def _on_a_bone(parents: NDArray[np.int32]) -> NDArray[np.bool_]:
    """(J,) whether a bone begins or ends at a joint."""
    on = parents >= 0
    on[parents[on]] = True
    return on


def _any_of_stride(jumped: NDArray[np.bool_], stride: int) -> NDArray[np.bool_]:
    padded = np.zeros(-(-len(jumped) // stride) * stride, bool)
    padded[: len(jumped)] = jumped
    return np.asarray(padded.reshape(-1, stride).any(axis=1))
