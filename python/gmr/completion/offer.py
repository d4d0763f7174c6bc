"""What there is to choose from: clips of another folder as they can stand beside the dataset, and made ones.

A folder has one skeleton, one up axis and one ground for all its files. So clips with other joints are laid
on the dataset's skeleton or refused, clips with another up axis are turned to the dataset's, and clips whose
ground lies higher or lower are moved to its ground.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from gmr.completion.candidates import Candidate, on_skeleton, variants
from gmr.completion.choosing import joined
from gmr.completion.places import Place, placed
from gmr.completion.tempo import Rows, rows_of
from gmr.completion.up import standing
from gmr.errors import DatasetError, GmrError
from gmr.evaluation.words import count
from gmr.matching.database import Database
from gmr.matching.naming import image_of
from gmr.matching.survey import Survey, survey
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

    def seen(self, motions: Mapping[str, Motion]) -> Survey:
        """What holds for some clips together."""
        return survey(motions, self.whole.schema.span, **self.reading)

    def like(self) -> Motion:
        """A clip of the dataset that stands along its up axis."""
        return self.motions[standing(self.seen(self.motions))]


@dataclass(eq=False)
class Offer:
    """The candidates, and what they are made of.

    Attributes:
        up: the dataset's up axis.
        motions: by name: the clips of the other folder that have the dataset's skeleton, or were laid on it,
            and made clips.
        places: how clips that were not laid on the skeleton stand, by name.
        rows: the frames of each candidate.
        refused: clips that cannot be used, and why.
        notes: what was noticed about the other folder, in sentences.
    """

    up: str
    motions: dict[str, Motion] = field(default_factory=dict)
    places: dict[str, Place] = field(default_factory=dict)
    rows: dict[Candidate, Rows] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def clip(self, candidate: Candidate) -> Motion:
        """The clip that is added where a candidate is chosen."""
        motion = self.motions[candidate.source]
        if candidate.turned or candidate.moved:
            motion = self.places[candidate.source].put(candidate.source, motion)
        return candidate.of(motion, self.up)

    def told(self, chosen: Iterable[Candidate]) -> tuple[str, ...]:
        """What was noticed about the other folder and done with what was chosen, in sentences."""
        put = {candidate.source for candidate in chosen if candidate.turned or candidate.moved}
        places = {id(place): place for place in self.places.values()}
        return (*self.notes, *(note for place in places.values() for note in place.told(put)))

    def add(
        self,
        kind: Kind,
        clips: Mapping[str, Motion],
        ways: Callable[..., Iterable[Candidate]],
        place: Place | None = None,
    ) -> str:
        """Take up clips of one up axis; those that cannot be used are refused.

        Args:
            kind: what they have to stand beside.
            clips: by name.
            ways: the candidates of a clip, by its name and whether it can be mirrored.
            place: how they stand; with it, also what is noticed about them is taken up.

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
        if place is not None:
            own = (note for note in database.notes if not place.foreign(note))
            self.notes = tuple(dict.fromkeys((*self.notes, *own)))
            self.places |= dict.fromkeys(clips, place)
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
    dataset = kind.seen(kind.motions)
    like = kind.motions[standing(dataset)]
    made = make(like)
    layer = _Layer(like) if lay else None
    usable, laid, refused = on_skeleton(others, kind.whole.skeleton, layer)
    own = {name: motion for name, motion in usable.items() if name not in laid}
    offer = Offer(dataset.up, {**usable, **made}, refused=refused)
    troubles = [
        *(
            offer.add(kind, clips, _as_placed(place), place)
            for clips, place in placed(own, dataset, kind.seen)
        ),
        offer.add(
            kind, {name: usable[name] for name in usable if name in laid}, partial(variants, laid=True)
        ),
        offer.add(kind, made, _as_made),
    ]
    if not offer.rows and any(troubles):
        raise DatasetError(f"no clip of {source} can be used: {next(filter(None, troubles))}")
    offer.notes += tuple(layer.notes()) if layer else ()
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
        image = number.get(image_of(name))
        for candidate in ways(name, mirror=image is not None and not copies):
            of = [image] if candidate.mirrored else [number[name], *([image] if copies else [])]
            parts = [rows_of(database, clip, candidate.factor) for clip in of if clip is not None]
            rows[candidate] = joined(parts)
    return rows


def _as_placed(place: Place | None) -> Callable[..., Iterable[Candidate]]:
    """The candidates of a clip that has the dataset's skeleton by itself."""
    turned, moved = (place.turned, bool(place.lift)) if place else ("", False)
    return partial(variants, laid=False, turned=turned, moved=moved)


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
