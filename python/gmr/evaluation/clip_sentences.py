"""Which clips carry a dataset and which are never played, in words; a clip counts with its mirrored copy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.usage import plays
from gmr.evaluation.words import count, duration, listing, percent, some_of
from gmr.matching.naming import recording_of
from gmr.table import Table

__all__ = ["MOST_NAMES", "below_their_common_folder", "clip_sentences", "originals"]

MOST_NAMES: Final = 3


@dataclass(frozen=True, slots=True)
class _Clips:
    """Clips together with their mirrored copies, the most played first, of equals the longest."""

    names: list[str]
    seconds: NDArray[np.float64]
    share: NDArray[np.float64]

    @classmethod
    def of(cls, clips: Table) -> _Clips:
        own = originals(clips).tolist()
        names, which = np.unique(below_their_common_folder(own), return_inverse=True)
        seconds = np.bincount(which, np.where(clips["mirrored"], 0.0, clips["seconds"]), len(names))
        share = np.bincount(which, clips["played_share"], len(names))
        order = np.lexsort((names, -seconds, -share))
        return cls(
            names[order].tolist(), *(per_clip[order].astype(np.float64) for per_clip in (seconds, share))
        )


def originals(clips: Table) -> NDArray[np.str_]:
    """(C,) the names of the clips, a mirrored copy's that of its original."""
    pairs = zip(clips["clip"].tolist(), clips["mirrored"].tolist(), strict=True)
    return np.array([recording_of(name) if copy else name for name, copy in pairs], str)


def below_their_common_folder(names: list[str]) -> list[str]:
    """The names without the folders that all of them begin with."""
    parts = [name.split("/") for name in names]
    shared = 0
    while all(len(part) > shared + 1 for part in parts) and len({part[shared] for part in parts}) == 1:
        shared += 1
    return ["/".join(part[shared:]) for part in parts]


def clip_sentences(clips: Table, usage: Table) -> Iterator[str]:
    """Say which clips and sub-folders carry the trials, which clips are never played, and how many frames are
    shown."""
    together = _Clips.of(clips)
    yield _carrying(together)
    yield from _by_folder(together)
    yield _never_played(together)
    yield f"Of all frames, {percent(float(np.mean(plays(usage)['count'] > 0)))} are shown at least once."


def _carrying(clips: _Clips) -> str:
    carrying = int(np.searchsorted(np.cumsum(clips.share), 0.5)) + 1
    led_by = [
        f"{name} ({percent(share)})"
        for name, share in zip(clips.names[:MOST_NAMES], clips.share, strict=False)
        if share > 0
    ]
    if len(clips.names) == 1:
        return f"All of the time is played from the one clip, {clips.names[0]}."
    if carrying == 1:
        share = percent(float(clips.share[0]))
        return f"A single clip of {len(clips.names)}, {clips.names[0]}, is played for {share} of the time."
    named = f", led by {listing(led_by)}" if carrying > MOST_NAMES else f": {listing(led_by[:carrying])}"
    return f"Half of the time is played from {carrying} of {len(clips.names)} clips{named}."


def _by_folder(clips: _Clips) -> Iterator[str]:
    """The shares of the sub-folders, where there are some with several clips; the largest first."""
    share: dict[str, float] = {}
    for name, played in zip(clips.names, clips.share.tolist(), strict=True):
        folder = name.partition("/")[0] if "/" in name else ""
        share[folder] = share.get(folder, 0.0) + played
    if not 1 < len(share) < len(clips.names):
        return
    first, *others = sorted(share, key=lambda folder: (-share[folder], folder))
    told, rest = others[: MOST_NAMES - 1], others[MOST_NAMES - 1 :]
    parts = [f"{percent(share[first])} of the time is played from {_in_folder(first)}"]
    parts += [f"{percent(share[folder])} from {_in_folder(folder)}" for folder in told]
    if rest:
        remaining = percent(sum(share[folder] for folder in rest))
        parts.append(f"{remaining} from the other {len(rest) if len(rest) > 1 else 'one'}")
    yield f"By sub-folder: {listing(parts)}."


def _in_folder(folder: str) -> str:
    return folder or "clips in none"


def _never_played(clips: _Clips) -> str:
    unused = clips.share == 0
    if not unused.any():
        return "Every clip is played at least once."
    names = [name for name, never in zip(clips.names, unused, strict=True) if never]
    seconds = float(clips.seconds[unused].sum())
    part = percent(seconds / max(float(clips.seconds.sum()), 1e-9))
    verb = "is" if len(names) == 1 else "are"
    return (
        f"{count(len(names), 'clip')} of {len(clips.names)} {verb} never played "
        f"({duration(seconds)}, {part} of the material): {some_of(names, MOST_NAMES)}."
    )
