"""What a corpus is asked to hold: from it follows every take, each by itself."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import prod
from typing import Any, Final

from gmr.actionlets.corpus.choices import Choice, Drawn, Each, Fixed, Value, seed_of, share_of

__all__ = ["Order", "Plan"]

_FOLDER_OF: Final = 1000
"""Takes in a folder at most: with a million in one, file systems and people grow slow."""


@dataclass(frozen=True)
class Order:
    """One take to be made.

    Args:
        number: its place in the corpus.
        action: which action of the library.
        index: which variation of it.
        seed: of all that is drawn while it is made.
        settings: "seconds" (of motion; left out where the action's own is meant), "variation" (how far it is
            from the action as written, 0 to 1), "height" (m), "percentile", "sex" of the body.
        parameters: of the action, in its units.
    """

    number: int
    action: str
    index: int
    seed: int
    settings: Mapping[str, Value]
    parameters: Mapping[str, float]


@dataclass(frozen=True)
class Plan:
    """A whole corpus, from which each take follows by its number alone.

    Args:
        actions: names of actions of the library.
        variations: takes of each.
        seed: of all that is drawn.
        fps: frames a second.
        format: suffix of the motion files.
        body: "paper" (15 joints, 22 degrees of freedom) or "detailed" (40).
        settings: choices of what :attr:`Order.settings` has.
        parameters: by action, choices of its parameters.
        library: the files of the library besides its own, with the digest of each.
        made_with: versions of what the numbers depend on.
    """

    actions: tuple[str, ...]
    variations: int
    seed: int
    fps: float
    format: str
    body: str
    settings: Mapping[str, Choice]
    parameters: Mapping[str, Mapping[str, Choice]]
    library: Mapping[str, str]
    made_with: Mapping[str, str]

    def __len__(self) -> int:
        """How many takes there are to be."""
        return len(self.actions) * self.variations

    def order(self, number: int) -> Order:
        """The take of that number: variation ``number % variations`` of action ``number // variations``.

        It depends on the seed, the action and the variation's index alone. What is given as a list takes each
        value in turn, several lists all combinations in turn, the last list's values changing fastest.
        """
        kind, index = divmod(number, self.variations)
        action = self.actions[kind]
        chosen = self._chosen(action, index)
        settings = {name: chosen[name] for name in self.settings}
        parameters = {name: float(chosen["." + name]) for name in self.parameters[action]}
        return Order(number, action, index, seed_of(self.seed, action, index), settings, parameters)

    def file(self, number: int) -> str:
        """Where the take of that number lies in the corpus, with ``/``."""
        kind, index = divmod(number, self.variations)
        action = self.actions[kind]
        return f"{action}/{index // _FOLDER_OF:03d}/{action}_{index:06d}{self.format}"

    def to_json(self) -> str:
        """The plan as a file has it, readable."""
        return json.dumps(self._tree(), indent=2, ensure_ascii=False) + "\n"

    def differences(self, written: str) -> list[str]:
        """In what another plan, as its file has it, is not this one: one phrase each.

        Raises:
            ValueError: it is no plan.
        """
        other = json.loads(written)
        if not isinstance(other, dict) or "takes" not in other:
            raise ValueError("this is no plan of a corpus")
        there, here = (dict(_leaves(tree, ())) for tree in (other, self._tree()))
        return [
            f"{name}: {there.get(name, 'nothing')} there, {here.get(name, 'nothing')} asked for"
            for name in (*here, *(name for name in there if name not in here))
            if there.get(name) != here.get(name)
        ]

    def _chosen(self, action: str, index: int) -> dict[str, Value]:
        """The values of settings, and of parameters behind a dot, of one variation."""
        choices = {**self.settings, **{f".{name}": own for name, own in self.parameters[action].items()}}
        lists = {name: own.values for name, own in choices.items() if isinstance(own, Each)}
        left = index % prod(map(len, lists.values()))
        found: dict[str, Value] = {}
        for name, values in reversed(lists.items()):
            left, place = divmod(left, len(values))
            found[name] = values[place]
        for name, own in choices.items():
            if isinstance(own, Fixed):
                found[name] = own.value
            elif isinstance(own, Drawn):
                found[name] = own.at(share_of(self.seed, action, index, name))
        return found

    def _tree(self) -> dict[str, Any]:
        return {
            "takes": len(self),
            "actions": list(self.actions),
            "variations": self.variations,
            "seed": self.seed,
            "fps": self.fps,
            "format": self.format,
            "body": self.body,
            **{name: str(own) for name, own in self.settings.items()},
            "parameters": {
                action: {name: str(own) for name, own in choices.items()}
                for action, choices in self.parameters.items()
            },
            "library": dict(self.library),
            "made_with": dict(self.made_with),
        }


def _leaves(tree: Any, path: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Each value of a tree by the names that lead to it."""
    if isinstance(tree, dict) and tree:
        for name, below in tree.items():
            yield from _leaves(below, (*path, str(name)))
    else:
        shown = ", ".join(map(str, tree)) if isinstance(tree, list) else str(tree)
        yield " ".join(path), shown or "nothing"
