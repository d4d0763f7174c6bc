"""The labels of a recording matched with those of a relation.

"Subject:L_IAS", "l_ias" and "LIAS" are the same marker; a marker that is missing is reported with the labels
of the recording that are nearest to it.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from gmr.errors import GmrError
from gmr.listing import quoted
from gmr.markers.relation import Relation, load_relation, shipped_relations

__all__ = ["Match", "best_relation", "match_labels"]

_SHOWN = 8
"""Names of subjects that an error lists."""


@dataclass(frozen=True, slots=True)
class Match:
    """What of a relation is in a recording.

    Args:
        found: the relation's label -> the marker's index in the recording.
        missing: the relation's label -> the nearest labels of the recording, which may be none.
        left_over: indices of the markers that the relation does not name.
        prefix: the subject that was chosen among several, "" where there was no choice.
    """

    found: Mapping[str, int]
    missing: Mapping[str, tuple[str, ...]]
    left_over: tuple[int, ...]
    prefix: str

    @property
    def coverage(self) -> float:
        """Part of the relation's labels that were found, 0 to 1."""
        return len(self.found) / max(1, len(self.found) + len(self.missing))


def match_labels(wanted: Relation, labels: Sequence[str], *, subject: str | None = None) -> Match:
    """Finds the markers of a relation in a recording.

    Args:
        wanted: the relation.
        labels: the labels of the recording; the first counts where one repeats.
        subject: the prefix of the person meant, as "Anna" in "Anna:LASI"; where left out, the one of whom the
            most markers are found.

    Raises:
        GmrError: no label begins with that prefix.
    """
    prefixes = list(dict.fromkeys(_split(label)[0] for label in labels)) or [""]
    if subject is not None and subject not in prefixes:
        known = quoted([prefix for prefix in prefixes if prefix], _SHOWN)
        there = f"there are {known}" if known else "labels begin with no name; leave it out"
        raise GmrError(f"no marker is of the subject '{subject}'; {there}")
    tried = [
        (_of_subject(wanted, labels, prefix), prefix) for prefix in prefixes if subject in (None, prefix)
    ]
    found, prefix = max(tried, key=lambda each: len(each[0]), default=({}, ""))
    taken = set(found.values())
    left_over = tuple(place for place in range(len(labels)) if place not in taken)
    plain = {_split(labels[place])[1]: labels[place] for place in left_over}
    missing = {
        label: tuple(plain[near] for near in difflib.get_close_matches(label, plain, n=2, cutoff=0.7))
        for label in wanted.labels
        if label not in found
    }
    return Match(found, missing, left_over, prefix if len(prefixes) > 1 else "")


def best_relation(labels: Sequence[str]) -> Relation | None:
    """The relation that ships with gmr of which the most is found, at least half; None where none fits."""
    fitting = [(match_labels(load_relation(name), labels).coverage, name) for name in shipped_relations()]
    coverage, name = max(fitting, default=(0.0, ""))
    return load_relation(name) if coverage >= 0.5 else None


def _of_subject(wanted: Relation, labels: Sequence[str], prefix: str) -> dict[str, int]:
    places: dict[str, int] = {}
    for place, label in enumerate(labels):
        of, plain = _split(label)
        if of == prefix:
            places.setdefault(_plain(plain), place)
    found = {label: places[_plain(label)] for label in wanted.labels if _plain(label) in places}
    for other, label in wanted.aliases.items():
        if label not in found and _plain(other) in places:
            found[label] = places[_plain(other)]
    return {label: found[label] for label in wanted.labels if label in found}


def _split(label: str) -> tuple[str, str]:
    """Subject and marker of "Subject:Marker"."""
    prefix, _, plain = label.rpartition(":")
    return prefix, plain


def _plain(label: str) -> str:
    return re.sub(r"[\s_\-.]", "", label).casefold()
