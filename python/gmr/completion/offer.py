"""What there is to choose from: clips of another folder as they can stand beside the dataset, and made ones.

A folder has one skeleton and one up axis for all its files. So clips with other joints are laid on the
dataset's skeleton or refused, and clips with another up axis are turned to the dataset's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from gmr.completion.candidates import Candidate, on_skeleton, variants
from gmr.completion.choosing import joined
from gmr.completion.tempo import Rows, rows_of
from gmr.completion.up import standing, turned_up
from gmr.errors import DatasetError, GmrError
from gmr.evaluation.words import count
from gmr.matching.database import Database
from gmr.matching.survey import survey
from gmr.motion import Motion

__all__ = ["Kind", "Offer", "offer_of"]


@dataclass(frozen=True, slots=True)
class Kind:
    """How the dataset is read and compared, as all clips beside it have to be.

    Attributes:
        whole: the dataset by itself.
        motions: its clips, by name.
        reading: ``names`` and ``unit`` of the evaluation.
    """

    whole: Database
    motions: Mapping[str, Motion]
    reading: Mapping[str, Any]

    def build(self, motions: Mapping[str, Motion], mirror: bool) -> Database:
        """A database of other clips that is scaled as the dataset's."""
        return Database.build(
            motions,
            mirror=mirror,
            schema=self.whole.schema,
            rate=self.whole.rate,
            normalization=self.whole.normalization,
            **self.reading,
        )

    def stands(self, motions: Mapping[str, Motion]) -> tuple[str, Motion]:
        """The up axis of some clips together, and one of them that stands along it."""
        seen = survey(motions, self.whole.schema.span, **self.reading)
        return seen.up, motions[standing(seen)]


@dataclass(eq=False)
class Offer:
    """The candidates, and what they are made of.

    Attributes:
        up: the dataset's up axis.
        motions: by name: the clips of the other folder that have the dataset's skeleton, or were laid on it,
            and made clips.
        came_up: the up axis of those that have it by themselves.
        rows: the frames of each candidate.
        refused: clips that cannot be used, and why.
        notes: what was noticed about the other folder, in sentences.
    """

    up: str
    motions: dict[str, Motion] = field(default_factory=dict)
    came_up: str = "+Y"
    rows: dict[Candidate, Rows] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def clip(self, candidate: Candidate) -> Motion:
        """The clip that is added where a candidate is chosen."""
        motion = self.motions[candidate.source]
        upright = turned_up(motion, self.came_up, candidate.turned) if candidate.turned else motion
        return candidate.of(upright, self.up)

    def add(
        self,
        kind: Kind,
        clips: Mapping[str, Motion],
        ways: Callable[..., Iterable[Candidate]],
        told: bool = False,
    ) -> str:
        """Take up clips of one up axis; those that cannot be used are refused.

        Args:
            kind: what they have to stand beside.
            clips: by name.
            ways: the candidates of a clip, by its name and whether it can be mirrored.
            told: also take up what is noticed about them.

        Returns:
            Why none of them can be used; "" where some can.
        """
        if not clips:
            return ""
        try:
            database = _built(kind, clips)
        except DatasetError as error:
            self.refused |= dict.fromkeys(clips, str(error))
            return str(error)
        self.refused |= database.excluded
        self.notes += database.notes if told else ()
        self.rows |= _rows(database, clips, ways, bool(kind.whole.mirrored.any()))
        return ""


def offer_of(
    kind: Kind,
    others: Mapping[str, Motion],
    source: str,
    *,
    lay: bool,
    make: Callable[[Motion], Mapping[str, Motion]],
) -> Offer:
    """Look at all that could be added.

    Args:
        kind: what it has to stand beside.
        others: the clips of the other folder, by name.
        source: what they are called together.
        lay: lay clips of another skeleton on the dataset's; else they are refused.
        make: gives clips that compete with them, by name, on the skeleton of a clip.

    Raises:
        DatasetError: no clip of the other folder can be used, and nothing else competes; it says why.
    """
    up, like = kind.stands(kind.motions)
    made = make(like)
    layer = _Layer(like) if lay else None
    usable, laid, refused = on_skeleton(others, kind.whole.skeleton, layer)
    own = {name: motion for name, motion in usable.items() if name not in laid}
    came_up = _up_of(kind, own, up)
    offer = Offer(up, {**usable, **made}, came_up, refused=refused)
    turned = up if came_up != up else ""
    troubles = [
        offer.add(kind, own, partial(variants, laid=False, turned=turned), told=True),
        offer.add(
            kind, {name: usable[name] for name in usable if name in laid}, partial(variants, laid=True)
        ),
        offer.add(kind, made, _as_made),
    ]
    if not offer.rows and any(troubles):
        raise DatasetError(f"no clip of {source} can be used: {next(filter(None, troubles))}")
    offer.notes += tuple(layer.notes()) if layer else ()
    if turned:
        offer.notes += (
            f"Its files have {came_up} up, those of the dataset {up}: what is chosen is turned to {up} up.",
        )
    return offer


def _built(kind: Kind, clips: Mapping[str, Motion]) -> Database:
    """With mirrored copies, where the skeleton has such."""
    try:
        return kind.build(clips, mirror=True)
    except DatasetError:
        return kind.build(clips, mirror=False)


def _rows(
    database: Database, clips: Iterable[str], ways: Callable[..., Iterable[Candidate]], copies: bool
) -> dict[Candidate, Rows]:
    """The frames of every candidate; ``copies``: the dataset has mirrored copies, so each clip brings one."""
    number = {name: clip for clip, name in enumerate(database.clip_names)}
    rows: dict[Candidate, Rows] = {}
    for name in (name for name in clips if name in number):
        image = number.get(f"{name} (mirrored)")
        for candidate in ways(name, mirror=image is not None and not copies):
            of = [image] if candidate.mirrored else [number[name], *([image] if copies else [])]
            parts = [rows_of(database, clip, candidate.factor) for clip in of if clip is not None]
            rows[candidate] = joined(parts)
    return rows


def _up_of(kind: Kind, motions: Mapping[str, Motion], up: str) -> str:
    """The up axis of some clips; that of the dataset where they have none."""
    try:
        return kind.stands(motions)[0] if motions else up
    except DatasetError:
        return up  # why none of them can be used is told when they are added


def _as_made(name: str, *, mirror: bool) -> Iterator[Candidate]:
    """A made clip competes as it is."""
    yield Candidate(name, made=True)


class _Layer:
    """Lays motions on the skeleton of another, and counts those that it took a frame for the rest pose of."""

    def __init__(self, like: Motion) -> None:
        self.like, self.stood = like, 0

    def __call__(self, motion: Motion) -> Motion:
        from gmr.skinning.driving.other_skeleton import retarget
        from gmr.skinning.driving.rest_frame import rest_frame

        # Without its name, so that the same trouble with many clips reads the same.
        nameless = replace(motion, name=None)
        try:
            laid = retarget(nameless, self.like).motion
        except GmrError:
            if (frame := rest_frame(nameless)) is None:
                raise
            laid = retarget(nameless, self.like, rest=frame).motion
            self.stood += 1
        return replace(laid, name=motion.name)

    def notes(self) -> Iterator[str]:
        """Which rest poses were taken, in a sentence, where that had to be decided."""
        if self.stood:
            has = count(self.stood, "clip of another skeleton has", "clips of another skeleton have")
            yield f"{has} no rest pose: laid on the dataset's by the frame in which each stands best."
