"""The report: one self-contained HTML file, words first, that opens offline on a desktop and on a phone."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from gmr.evaluation.report.page import page
from gmr.evaluation.result import Evaluation
from gmr.pages.section import Section
from gmr.replacing import replacing

if TYPE_CHECKING:
    from gmr.evaluation.comparison import Comparison

__all__ = ["write_comparison", "write_report"]


def write_comparison(comparison: Comparison, path: str | os.PathLike[str]) -> None:
    """Write the report of a comparison, as :func:`write_report` does that of an evaluation.

    Raises:
        OSError: the file cannot be written, or the disk is full.
    """
    from gmr.evaluation.report.comparison_page import comparison_page

    content = comparison_page(comparison).encode()
    with replacing(path) as (file,):
        file.write(content)


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
