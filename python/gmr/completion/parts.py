"""Parts that the page of a completion and its section in a report share: its maps, its clips, its method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from gmr.completion.complete import Completion
from gmr.evaluation.report.parts import shown_figure
from gmr.evaluation.report.tables import Column, html_table
from gmr.evaluation.words import count
from gmr.pages.document import element, items
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["LACKING", "MAPS", "clips_table", "clips_title", "maps", "method"]

MAPS: Final = "A cell is a trial: the character is sent along a circle, or straight ahead, at one speed."
"""What is to be known of the maps."""

LACKING: Final = (
    "What trials lack, added up: nothing for one that holds, half for one whose worst error is twice the "
    "limit, nearly one for one that is hopeless."
)
"""What is to be known of the table of chosen clips."""


def maps(drawn: Sequence[Figure]) -> str:
    """The maps of a completion: those before and after side by side where there is room, then the change."""
    pairs = zip(drawn[:-1:2], drawn[1::2], strict=True)
    beside = (element("div", "".join(map(shown_figure, pair)), class_="pairs") for pair in pairs)
    return "".join(beside) + shown_figure(drawn[-1])


def clips_title(of: Completion) -> str:
    """How many clips were added, and where they come from."""
    many = count(len(of.added), "clip")
    return f"{many} chosen from {of.source}" if of.source else f"{many} made"


def clips_table(of: Completion, saved_as: str) -> str:
    """The added clips, with a button that saves the page's table ``saved_as``: of chosen ones what each took
    away, of made ones what each was made for."""
    shown, columns = _chosen(of) if of.source else _made(of)
    save = element("button", f"Save {saved_as}.csv", type="button", data_save=saved_as)
    table = html_table(shown, columns, f"{clips_title(of)}, sortable")
    return element("div", save, class_="controls") + table


def method(of: Completion) -> str:
    """How clips were made or chosen."""
    return element("ul", items(_CHOOSING if of.source else _MAKING))


def _made(of: Completion) -> tuple[Table, Sequence[Column]]:
    mark = ["holds" if held else "still fails" for held in of.clips["holds"].tolist()]
    return Table({**dict(of.clips), "mark": mark}), _CLIPS


def _chosen(of: Completion) -> tuple[Table, Sequence[Column]]:
    played = of.clips["played_seconds"]
    return Table(
        {**dict(of.chosen), "step": np.arange(1, len(played) + 1), "played_seconds": played}
    ), _CHOICES


_CLIPS: Final = (
    Column("clip", "Clip"),
    Column("speed", "Speed, m/s", "g"),
    Column("turn_rate_deg", "Turn, deg/s", "g"),
    Column("seconds", "Length, s", ".1f"),
    Column("played_seconds", "Played, s", ".1f"),
    Column("mark", "Its trial"),
)

_CHOICES: Final = (
    Column("step", "Step", "d"),
    Column("clip", "Clip"),
    Column("how", "How"),
    Column("seconds", "Length, s", ".1f"),
    Column("cost_before", "Lacking before", ".2f"),
    Column("cost_after", "Lacking after", ".2f"),
    Column("gain", "Taken away per s", ".4f"),
    Column("held", "Trials that hold", "d"),
    Column("played_seconds", "Played, s", ".1f"),
)

_MAKING: Final = (
    "Both evaluations run the same trials; the second one on the dataset and the made clips together.",
    "A clip is made for each trial that did not hold, and one straight ahead for each such speed, on the "
    "skeleton of the dataset's first clip: actionlets on a body of its proportions, laid on its joints.",
    "All made clips are kept, also those that do not help: what they cost is in the figures.",
    "The features are scaled anew with the made clips, so trials far from any hole may change too.",
)

_CHOOSING: Final = (
    "Both evaluations run the same trials; the second one on the dataset and the chosen clips together.",
    "Candidates are clips as they are, mirrored, and played 0.8, 0.9, 1.1 and 1.25 times as fast; "
    "synthesised ones too where that was asked for.",
    "They are ranked by what searches for the speed and turn rate of the failing trials could save by them, "
    "per second and in all; with the best eight all trials are run again. The one that takes away most of "
    "what the trials lack, per second recorded, is kept, so long as no fewer trials hold and it takes away "
    "1% or more; then the next one is looked for.",
    "For choosing, features are scaled as in the dataset by itself; for the second evaluation anew over "
    "both.",
)
