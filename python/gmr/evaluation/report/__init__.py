"""The report: one self-contained HTML file, words first, that opens offline on a desktop and on a phone."""

from __future__ import annotations

import os
from collections.abc import Sequence

from gmr.evaluation.report.page import page
from gmr.evaluation.result import Evaluation
from gmr.pages.section import Section
from gmr.replacing import replacing

__all__ = ["write_report"]


def write_report(evaluation: Evaluation, path: str | os.PathLike[str], added: Sequence[Section] = ()) -> None:
    """Write the report of an evaluation; a report that stood there before is replaced at once or not at all.

    Args:
        evaluation: what to report.
        path: the HTML file to write; its folder exists.
        added: sections of what was done with the evaluation.

    Raises:
        OSError: the file cannot be written, or the disk is full.
    """
    content = page(evaluation, added).encode()
    with replacing(path) as (file,):
        file.write(content)
