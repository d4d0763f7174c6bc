"""What went from a dataset, why, and what it costs: for machines and for people."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gmr.evaluation.reading import printable
from gmr.evaluation.words import count, duration, hold, number, percent
from gmr.motion import Motion
from gmr.pruning.outcomes import Score
from gmr.pruning.part import Range, gaps, recordings_of
from gmr.pruning.prune import Pruning
from gmr.pruning.words import asked_sentence, twice_sentence

if TYPE_CHECKING:
    from gmr.pruning.writing import Written

__all__ = ["cost_of_files", "files_words", "manifest", "manifest_words", "scores", "scores_of"]

NEVER = "no trial needs it"


def manifest(of: Pruning, written: Written, motions: Mapping[str, Motion]) -> str:
    """The manifest as JSON: metres, seconds, frames of the files (the first is 0, ranges end at the last)."""
    database = of.simulation.database
    scale = database.normalization
    content = {
        "dataset": of.dataset,
        "goal": of.goal,
        "mirror": bool(database.mirrored.any()),
        "seconds_before": of.curve.points[0].part.seconds,
        "seconds_after": written.part.seconds,
        "identical": written.identical,
        "runs": {"simulated": _score(of.chosen.score), **scores_of(written)},
        # A feature without weight is divided by infinity, which JSON does not know.
        "scale": {
            "offset": scale.offset.tolist(),
            "scale": [each if math.isfinite(each) else None for each in scale.scale.tolist()],
        },
        "files": [
            {
                "file": printable(piece.file),
                "of": piece.source,
                "frames": "all" if piece.frames is None else [piece.frames[0], piece.frames[1] - 1],
                "seconds": piece.of(motions[piece.source]).duration,
            }
            for piece in written.pieces
        ],
        "gone": list(_gone(of, written)),
        "not_evaluated": dict(of.failed),
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def scores_of(written: Written) -> dict[str, dict[str, Any]]:
    """How well the whole dataset and the files do, as plain values."""
    return {
        "whole_dataset": _score(written.whole),
        "files_with_the_scale_of_the_whole": _score(written.kept_scale),
        "files_by_themselves": _score(written.own_scale),
    }


def _score(score: Score) -> dict[str, Any]:
    offset = None if math.isnan(score.offset) else score.offset
    return {"offset_mean": offset, "held": score.held, "runs": score.runs}


def _gone(of: Pruning, written: Written) -> Iterator[dict[str, Any]]:
    """Every range that is gone, in seconds of its clip."""
    rows = of.outcomes.rows[of.outcomes.rows >= 0]
    played = np.bincount(rows, minlength=len(of.simulation.database)).astype(np.int64)
    worth = {row["clip"]: row for row in of.importance.rows()}
    rate = of.simulation.database.rate
    for recording in recordings_of(of.simulation.database):
        own = recording.total(played)
        for first, end in gaps(recording.frames, written.part.ranges[recording.name]):
            whole = (first, end) == (0, recording.frames)
            shown = float(np.sum(own[first:end])) / rate
            yield {
                "clip": recording.name,
                "seconds": [first / rate, (end - 1) / rate],
                "whole": whole,
                "played_seconds": shown,
                "why": _why(of, recording.name, (first, end), shown, worth[recording.name], whole),
            }
    yield from _duplicates(of)


def _duplicates(of: Pruning) -> Iterator[dict[str, Any]]:
    """The clips that another one equals, which were gone before the first trial."""
    everything = of.curve.points[0].part
    for name, first in of.simulation.database.duplicates.items():
        ((_, end),) = everything.ranges[name]
        yield {
            "clip": name,
            "seconds": [0.0, (end - 1) / everything.rate],
            "whole": True,
            "played_seconds": 0.0,
            "why": f"the same motion as '{first}'",
        }


def _why(of: Pruning, clip: str, gone: Range, shown: float, worth: Mapping[str, Any], whole: bool) -> str:
    needed = any(max(gone[0], first) < min(gone[1], end) for first, end in of.lossless.ranges[clip])
    if not needed:
        return NEVER
    every = of.outcomes.rows[of.outcomes.rows >= 0].size / of.simulation.database.rate
    said = f"trials need it, but little: it is shown for {duration(shown)}, {percent(shown / every)} of all"
    if not shown:
        said = "no trial shows it, but the features of frames that are shown look at it"
    if whole and math.isfinite(worth["loss"]):
        said += f"; {_alone(worth['offset_change'], worth['held_change'])}"
    return said


def _alone(offset: float, held: float) -> str:
    """What it costs to leave out a clip, alone."""
    far = f"the mean offset by {offset:+.4f} m" if abs(offset) >= 0.0001 else ""
    trials = f"the trials that hold by {held:+.0f}" if held else ""
    changed = " and ".join(filter(None, (far, trials)))
    return f"left out alone, it changes {changed or 'next to nothing'}"


def manifest_words(of: Pruning, written: Written, motions: Mapping[str, Motion]) -> str:
    """The manifest in words, as Markdown."""
    before, after = of.curve.points[0].part.seconds, written.part.seconds
    share = 1 - after / before
    gone = list(_gone(of, written))
    lines = [
        f"# {of.dataset}, smaller",
        "",
        f"There were {duration(before)} of motion; {duration(after)} are here: {percent(share)} went. "
        + " ".join([*asked_sentence(of), *twice_sentence(of), cost_of_files(written)]),
        "",
        "| | mean offset, m | trials that hold |",
        "|---|---|---|",
        *(_row(what, score) for what, score in scores(written, "these files").items()),
        "",
        "The last two rows were measured on these files, read again; the last is what `gmr evaluate` shows "
        "of this folder with the same settings.",
        "",
        f"## What went: {count(len(gone), 'range')}",
        "",
        *(_line(each) for each in gone),
        "",
        *_not_evaluated(of),
        f"## What is here: {count(len(written.pieces), 'file')}",
        "",
        *(
            f"- `{printable(piece.file)}`: "
            + (
                "as it was, byte for byte"
                if piece.frames is None
                else f"frames {piece.frames[0]} to {piece.frames[1] - 1} of `{piece.source}`"
            )
            for piece in written.pieces
        ),
    ]
    return "\n".join(lines) + "\n"


def _not_evaluated(of: Pruning) -> Iterator[str]:
    """What was no part of the evaluation, as a section."""
    if of.failed:
        yield from (f"## What could not be evaluated, and is not here: {count(len(of.failed), 'file')}", "")
        yield from (f"- `{name}`: {why}" for name, why in of.failed.items())
        yield ""


def files_words(written: Written) -> str:
    """How long the written files are, and what they cost."""
    return f"The files hold {duration(written.part.seconds)}. {cost_of_files(written)}"


def cost_of_files(written: Written) -> str:
    """What the written files cost, by the scale of the whole dataset and by their own, in sentences."""
    return f"{_cost_by_the_same_scale(written)} {_cost_by_their_own_scale(written)}"


def _cost_by_the_same_scale(written: Written) -> str:
    if written.identical:
        return (
            "It costs nothing: with the features scaled as in the whole dataset every trial is the same, bit "
            "by bit, as was checked on these files."
        )
    lost = written.whole.held - written.kept_scale.held
    said = f"It costs {f'{lost} of {written.whole.runs} trials' if lost > 0 else 'no trial'}"
    if lost < 0:
        said += f", and {-lost} of {written.whole.runs} more {hold(-lost)}"
    change = written.kept_scale.offset - written.whole.offset
    if math.isfinite(change):
        way = "grows" if change >= 0 else "shrinks"
        far = f"{number(abs(change))} m" if abs(change) >= 0.001 else "less than a millimetre"
        said += f"; the mean distance from the path {way} by {far}"
    return said + "."


def _cost_by_their_own_scale(written: Written) -> str:
    """What whoever evaluates the new folder will see."""
    held, before = written.own_scale.held, written.whole.held
    whole = f", where {before} did" if held != before else ", too"
    return (
        f"An evaluation of the new folder scales the features by what is left: there {held} of "
        f"{count(written.own_scale.runs, 'trial')} {hold(held)}{whole}."
    )


def scores(written: Written, files: str) -> dict[str, Score]:
    """How well the whole dataset does, and ``files``, what was written, by both scales."""
    return {
        "the whole dataset": written.whole,
        f"{files}, features scaled as in the whole": written.kept_scale,
        f"{files} by themselves": written.own_scale,
    }


def _row(what: str, score: Score) -> str:
    offset = "" if math.isnan(score.offset) else f"{score.offset:.3f}"
    return f"| {what} | {offset} | {score.held} of {score.runs} |"


def _line(gone: Mapping[str, Any]) -> str:
    first, last = gone["seconds"]
    what = "all of it" if gone["whole"] else f"{first:.2f} to {last:.2f} s"
    return f"- `{gone['clip']}`, {what}: {gone['why']}."
