"""What ``gmr evaluate`` does with a finished evaluation; what fails or is interrupted costs nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
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


@dataclass(slots=True)
class Afterwards:
    """What was added to an evaluation, and what could not be.

    Attributes:
        phases: told of progress.
        added: by its key in the JSON object.
        failed: option -> why it came to nothing.
        interrupted: whether one was interrupted; then none is begun any more.
    """

    phases: Phases
    added: dict[str, Added] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)
    interrupted: bool = False

    def add(self, key: str, option: str, work: Callable[[], Added]) -> None:
        """Do what an option asks for; why it could not be is kept, to be told when the report is written."""
        if self.interrupted:
            self.failed[option] = "what came before it was interrupted"
            return
        try:
            with trouble_with_files(self.phases):
                self.added[key] = work()
        except GmrError as error:
            self.failed[option] = str(error)
        except KeyboardInterrupt:
            self.interrupted = True
            self.failed[option] = "it was interrupted"

    def told(self) -> Iterator[str]:
        """A sentence for each option that came to nothing."""
        for option, why in self.failed.items():
            yield f"{option} came to nothing, all else is done: {why}"
