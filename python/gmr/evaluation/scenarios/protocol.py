"""What a scenario is."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from gmr.evaluation.scenario import Trial

__all__ = ["Scenario"]


class Scenario(Protocol):
    """A name, and the trials that are asked for.

    One that also has ``notes``, a tuple of sentences, has them said with the evaluation's other notes.
    """

    @property
    def name(self) -> str:
        """What tables and sentences call it; of a few words at most."""
        ...

    def trials(self) -> Iterable[Trial]:
        """The trials, each time the same ones; :meth:`Trial.along` makes one of segments."""
        ...
