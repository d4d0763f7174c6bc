"""What ``gmr evaluate`` prints: the verdict for people, or one JSON object for a machine."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gmr.cli.paragraphs import listed_sentences, paragraph
from gmr.cli.plain_rows import plain_rows

if TYPE_CHECKING:
    from gmr.cli.afterwards import Afterwards
    from gmr.evaluation import Comparison, Evaluation, Verdict

__all__ = ["as_object", "in_words"]


def in_words(found: Evaluation | Comparison, written: Mapping[str, Any]) -> str:
    """The verdict, for several datasets also the first sentence on each and what was noticed about it, and
    where the results lie."""
    lines = [*paragraph(found.verdict.headline), "", *listed_sentences(found.verdict.sentences)]
    evaluations = _evaluations(found)
    for evaluation in evaluations if len(evaluations) > 1 else ():
        lines += ["", *paragraph(f"{evaluation.dataset}: {evaluation.verdict.headline}")]
        lines += ["", *listed_sentences(evaluation.notes)] if evaluation.notes else []
    if written:
        lines.append("")
    if "tables" in written:
        lines.append(f"Tables: {Path(written['tables'][0]).parent}")
    if "figures" in written:
        lines.append(f"Figures: {Path(written['figures'][0]).parent}")
    if "report" in written:
        lines.append(f"Report: {written['report']}")
    return "\n".join(lines)


def as_object(
    found: Evaluation | Comparison,
    written: Mapping[str, Any],
    later: Afterwards,
) -> str:
    """The figures as JSON: of one dataset as they are, of several as a list, with the verdict on all."""
    evaluations = _evaluations(found)
    told = _described(evaluations[0])
    if len(evaluations) > 1:
        told = {
            "verdict": _verdict(found.verdict),
            "datasets": [_described(evaluation) for evaluation in evaluations],
            "failed": dict(found.failed),
        }
    told["written"] = dict(written)
    told |= {name: each.summary() for name, each in later.added.items()}
    told["not_done"] = dict(later.failed)
    return json.dumps(told, indent=2, ensure_ascii=False)


def _evaluations(found: Evaluation | Comparison) -> tuple[Evaluation, ...]:
    from gmr.evaluation import Comparison

    return found.evaluations if isinstance(found, Comparison) else (found,)


def _verdict(verdict: Verdict) -> dict[str, Any]:
    return {"headline": verdict.headline, "sentences": verdict.sentences}


def _described(found: Evaluation) -> dict[str, Any]:
    summary = found.summary
    return {
        "dataset": found.dataset,
        "verdict": _verdict(found.verdict),
        "clips": summary.clip_count,
        "mirrored_clips": summary.mirrored_count,
        "frames": summary.frame_count,
        "seconds": summary.seconds,
        "rate": summary.rate,
        "joints": dict(summary.joints),
        "unit": summary.unit,
        "settings": dict(summary.settings),
        "trials": plain_rows(found.measured.trials),
        "notes": found.notes,
        "failed": dict(found.failed),
        "duplicates": {} if found.simulation is None else dict(found.simulation.database.duplicates),
    }
