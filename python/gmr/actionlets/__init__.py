"""Actionlets: human motion put together from single cycles of acceleration and deceleration, and taken apart
into them.

Source: Zheng, Li, Ogunbona, Dong, Kharitonenko, "Human Motion Simulation and Action Corpus", 2007.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gmr.lazily import lazily

if TYPE_CHECKING:
    from gmr.actionlets import corpus, posing, travel
    from gmr.actionlets.actionlet import Actionlet
    from gmr.actionlets.actions.action import Action
    from gmr.actionlets.actions.library import Library, library
    from gmr.actionlets.actions.performance import Performance
    from gmr.actionlets.actions.taking import Take
    from gmr.actionlets.body import Body
    from gmr.actionlets.corpus.reading import Corpus
    from gmr.actionlets.decomposition import Decomposed, decompose, decompose_curve, decompose_curves
    from gmr.actionlets.dofs import Dof
    from gmr.actionlets.measured import Measured
    from gmr.actionlets.mutation import mutate, substituted, variation
    from gmr.actionlets.operations import concatenate, insert, is_periodic, repeated, stretched, synchronise
    from gmr.actionlets.pictures import film_strip
    from gmr.actionlets.reading import read
    from gmr.actionlets.score import Score
    from gmr.actionlets.track import Piece, Track

__all__ = [
    "Action",
    "Actionlet",
    "Body",
    "Corpus",
    "Decomposed",
    "Dof",
    "Library",
    "Measured",
    "Performance",
    "Piece",
    "Score",
    "Take",
    "Track",
    "concatenate",
    "corpus",
    "decompose",
    "decompose_curve",
    "decompose_curves",
    "film_strip",
    "insert",
    "is_periodic",
    "library",
    "mutate",
    "posing",
    "read",
    "repeated",
    "stretched",
    "substituted",
    "synchronise",
    "travel",
    "variation",
]

# Each name is imported when it is first used: who asks for an actionlet need not wait for the library.
_HOMES = {
    "Action": "gmr.actionlets.actions.action",
    "Actionlet": "gmr.actionlets.actionlet",
    "Body": "gmr.actionlets.body",
    "Corpus": "gmr.actionlets.corpus.reading",
    "Decomposed": "gmr.actionlets.decomposition",
    "Dof": "gmr.actionlets.dofs",
    "Library": "gmr.actionlets.actions.library",
    "Measured": "gmr.actionlets.measured",
    "Performance": "gmr.actionlets.actions.performance",
    "Piece": "gmr.actionlets.track",
    "Score": "gmr.actionlets.score",
    "Take": "gmr.actionlets.actions.taking",
    "Track": "gmr.actionlets.track",
    "concatenate": "gmr.actionlets.operations",
    "decompose": "gmr.actionlets.decomposition",
    "decompose_curve": "gmr.actionlets.decomposition",
    "decompose_curves": "gmr.actionlets.decomposition",
    "film_strip": "gmr.actionlets.pictures",
    "insert": "gmr.actionlets.operations",
    "is_periodic": "gmr.actionlets.operations",
    "library": "gmr.actionlets.actions.library",
    "mutate": "gmr.actionlets.mutation",
    "read": "gmr.actionlets.reading",
    "repeated": "gmr.actionlets.operations",
    "stretched": "gmr.actionlets.operations",
    "substituted": "gmr.actionlets.mutation",
    "synchronise": "gmr.actionlets.operations",
    "variation": "gmr.actionlets.mutation",
}
_MODULES = frozenset({"corpus", "posing", "travel"})

__getattr__ = lazily(__name__, _HOMES, _MODULES)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
