"""What ``gmr evaluate`` does with a finished evaluation; where one of these things fails, the rest stands."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from gmr.cli.outcome import trouble_with_files
from gmr.cli.progress import Phases
from gmr.errors import GmrError

if TYPE_CHECKING:
    from gmr.cli.choosing import Completed
    from gmr.cli.pruning import Pruned
    from gmr.cli.tuning import Tuned

    Added: TypeAlias = "Pruned | Tuned | Completed"

__all__ = ["Afterwards"]


@dataclass(frozen=True, slots=True)
class Afterwards:
    """What was added to an evaluation, and what could not be.

    Attributes:
        phases: told of progress.
        added: by its key in the JSON object.
        failed: option -> why it came to nothing.
    """

    phases: Phases
    added: dict[str, Added] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)

    @contextmanager
    def trying(self, option: str) -> Iterator[None]:
        """Do what an option asks for; an error of it is kept, to be told when the report is written."""
        try:
            with trouble_with_files(self.phases):
                yield
        except GmrError as error:
            self.failed[option] = str(error)

    def told(self) -> Iterator[str]:
        """A sentence for each option that came to nothing."""
        for option, why in self.failed.items():
            yield f"{option} came to nothing, all else is done: {why}"
