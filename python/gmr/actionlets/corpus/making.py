"""Takes are made: what a worker does, wherever it is."""

from __future__ import annotations

import hashlib
import io
import pickle
import platform
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np

import gmr
from gmr.actionlets.corpus.exclusive import is_held
from gmr.actionlets.corpus.journal import Record
from gmr.actionlets.corpus.plan import Order, Plan
from gmr.errors import GmrError
from gmr.formats.registry import named_format
from gmr.formats.writing import write_pieces

if TYPE_CHECKING:
    from gmr.actionlets.actions.library import Library
    from gmr.actionlets.actions.taking import Take
    from gmr.actionlets.body import Body
    from gmr.motion import Motion

__all__ = ["Made", "Work", "make", "versions"]

_INSTANT: Final = 1e-9
"""Seconds up to which a span lasts no time."""


@dataclass(frozen=True)
class Work:
    """What a worker must know beside the numbers of the takes.

    Args:
        plan: of the corpus.
        library: the pickled library; a worker elsewhere has not the user's files.
        folder: where the command has the corpus.
        word: by which a worker sees that it has the same folder; one that has not sends its files back.
    """

    plan: Plan
    library: bytes
    folder: str
    word: str


@dataclass(frozen=True)
class Made:
    """What became of a take.

    Args:
        number: which.
        record: its labels; None where it could not be made.
        failed: why not.
        data: its file, where the worker could not write it.
    """

    number: int
    record: Record | None = None
    failed: str = ""
    data: bytes | None = None


def make(work: Work, numbers: tuple[int, ...]) -> list[Made]:
    """Makes takes and writes their files.

    Raises:
        GmrError: a file cannot be written; or this worker has other versions of what the numbers depend on.
    """
    here = versions()
    if here != work.plan.made_with:
        asked = ", ".join(f"{name} {version}" for name, version in work.plan.made_with.items())
        found = ", ".join(f"{name} {version}" for name, version in here.items())
        raise GmrError(
            f"the worker on {platform.node()} has {found}, but {asked} is needed; install the same"
        )
    writes = is_held(Path(work.folder), work.word)
    return [_made(work, number, writes) for number in numbers]


def versions() -> dict[str, str]:
    """Versions of what the numbers of a take depend on."""
    return {"gmr": gmr.__version__, "numpy": np.__version__}


def _made(work: Work, number: int, writes: bool) -> Made:
    order = work.plan.order(number)
    file = work.plan.file(number)
    try:
        take = _take(work, order)
        data = _file(work.plan.format, take.motion)
    except GmrError as error:
        return Made(number, failed=str(error))
    record = _record(work.plan, order, take, file, data)
    if not writes:
        return Made(number, record, data=data)
    path = Path(work.folder, file)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_pieces(path, [data])
    return Made(number, record)


def _file(format: str, motion: Motion) -> bytes:
    """What is in the file of a motion."""
    found = io.BytesIO()
    found.writelines(named_format(format).write(motion))
    return found.getvalue()


def _take(work: Work, order: Order) -> Take:
    settings = dict(order.settings)
    timing = {name: settings.pop(name) for name in ("seconds", "variation") if name in settings}
    return _library(work.library)[order.action].take(
        fps=work.plan.fps,
        seed=order.seed,
        body=_body(work.plan.body == "detailed", **settings),
        **cast(Any, timing),
        **order.parameters,
    )


@lru_cache(maxsize=1)
def _library(pickled: bytes) -> Library:
    return cast("Library", pickle.loads(pickled))


@lru_cache(maxsize=64)
def _body(detailed: bool, **settings: Any) -> Body:
    from gmr.actionlets.body import Body

    return Body.of(detailed=detailed, **settings)


def _record(plan: Plan, order: Order, take: Take, file: str, data: bytes) -> Record:
    """The labels of a take: what was asked for, and what became of it."""
    done, motion = take.performance, take.motion
    shown = motion.frame_count * motion.frame_time
    return {
        "take": order.number,
        "file": file,
        "action": order.action,
        "index": order.index,
        "seed": order.seed,
        "seconds": order.settings.get("seconds", done.seconds),
        "fps": plan.fps,
        "frames": motion.frame_count,
        "body": plan.body,
        **{name: value for name, value in order.settings.items() if name != "seconds"},
        "parameters": dict(order.parameters),
        "phases": [[label, *span] for label, *ends in done.phases for span in _within([ends], shown)],
        "contacts": {side: _within(spans, shown) for side, spans in done.contacts.items()},
        "bytes": len(data),
        "sha256": hashlib.sha256(data).hexdigest(),
    }


def _within(spans: Iterable[Any], seconds: float) -> list[list[float]]:
    """What of these spans lies within a take; what lasts no time is none."""
    cut = ([max(float(start), 0.0), min(float(end), seconds)] for start, end in spans)
    return [[start, end] for start, end in cut if end - start > _INSTANT]
