"""The parts of one body over all frames: their rigid fits, the joint centres between them, their axes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.listing import quoted
from gmr.markers.anatomy import Body
from gmr.markers.centres import Centre, Guess, joint_centre
from gmr.markers.gaps import seen
from gmr.markers.labels import Match
from gmr.markers.relation import Direction, Part, Relation
from gmr.markers.rigid import FEWEST, RigidFit, find_template, fit_poses

__all__ = ["Segment", "find_segments"]

Array = NDArray[np.float64]

_SHOWN = 6
_THIN = 0.004
"""Metres of spread off one line that a cluster needs."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of the relation, as it was found in a recording.

    Args:
        part: what the relation says of it.
        labels: the markers that its fit was made with, as the relation calls them.
        columns: where they are in the recording.
        fit: its template and its poses in metres; once oriented, its template's axes are left, up, forward
            and its origin is its joint.
        points: marker or joint -> (3,) place in the template.
        parent: the part above that was found; None for a root.
        centre: of the joint to the parent; None for a root.
        rule: where anatomy's estimate of that centre is from, "" without one.
        third: whether its joint was the third point of its fit.
        notes: what was done for want of markers, in words.
    """

    part: Part
    labels: tuple[str, ...]
    columns: tuple[int, ...]
    fit: RigidFit
    points: Mapping[str, Array]
    parent: str | None
    centre: Centre | None
    rule: str
    third: bool
    notes: tuple[str, ...]


def find_segments(
    positions: Array, relation: Relation, match: Match
) -> tuple[dict[str, Segment], dict[str, str]]:
    """Fits all parts of a relation that the markers tell of.

    Args:
        positions: (F, M, 3) metres, NaN where not seen.
        relation: the parts.
        match: where their markers are among the M.

    Returns:
        Part name -> segment, parents first, oriented; and for each part that was left out the reason.

    Raises:
        GmrError: both directions of a part are one.
    """
    found: dict[str, Segment] = {}
    left_out: dict[str, str] = {}
    for part in relation.parts:
        made = _segment(part, found, positions, match)
        if isinstance(made, str):
            left_out[part.name] = made
        else:
            found[part.name] = made
            if made.parent and made.centre:
                above = found[made.parent]
                points = {**above.points, part.joint: made.centre.in_parent}
                found[made.parent] = replace(above, points=points)
    for name in found:
        found[name] = _oriented(found[name], found)
    return found, left_out


def _segment(part: Part, found: Mapping[str, Segment], positions: Array, match: Match) -> Segment | str:
    """The part with its joint, not yet oriented; or why there is none."""
    labels = tuple(label for label in part.markers if label in match.found)
    absent = [label for label in part.markers if label not in match.found]
    above = found.get(part.parent or "")
    notes = [f"without {quoted(absent, _SHOWN)}"] if absent and labels else []
    guess, why_none = _guess(part, above, positions, match)
    if why_none:
        notes.append(why_none)
    third = len(labels) == FEWEST - 1 and above is not None and guess is not None
    if len(labels) < FEWEST and not third:
        return _too_few(part, labels, above)
    columns = tuple(match.found[label] for label in labels)
    places = positions[:, columns]
    if third:
        assert above is not None
        assert guess is not None
        places = np.concatenate([places, above.fit.place(guess.place)[:, None]], axis=1)
    template = find_template(places)
    if template is None:
        return f"no frame shows {FEWEST} of its points off one line"
    known = seen(template.points)
    if not known.all():
        lost = [label for label, there in zip(labels, known, strict=False) if not there]
        notes.append(f"{quoted(lost, _SHOWN)} is never seen with {FEWEST} others" if lost else "")
    fit = fit_poses(template.points, places)
    points = _points(part, fit, labels, positions, match)
    centre = None
    if above is None:
        points[part.joint] = np.nanmean(fit.points, axis=0)
        if part.parent is not None:
            notes.append(f"'{part.parent}' is missing, so its joint is a root in the middle of its markers")
    else:
        try:
            centre = joint_centre(above.fit, fit, guess, functional=not third)
        except ValueError as error:
            return f"its joint cannot be placed: {error}"
        points[part.joint] = centre.in_child
    if third:
        notes.append("its joint, as the part above carries it, is its third point")
        fit = replace(fit, residuals=fit.residuals[:, :-1])
    return Segment(
        part=part,
        labels=labels,
        columns=columns,
        fit=fit,
        points=points,
        parent=above.part.name if above else None,
        centre=centre,
        rule=guess.rule if guess else "",
        third=third,
        notes=tuple(note for note in notes if note),
    )


def _guess(part: Part, above: Segment | None, positions: Array, match: Match) -> tuple[Guess | None, str]:
    """Anatomy's estimate of the part's joint, or why there is none."""
    if part.centre is None or above is None:
        return None, ""
    lacking = [name for name in part.centre.names if name not in above.points]
    if lacking:
        return None, f"its rule for the joint needs {quoted(lacking, _SHOWN)}"
    axes = None
    if part.centre.needs_axes:
        axes = _axes(above, {})
        if axes is None:
            return None, f"its rule for the joint needs the directions of '{above.part.name}'"

    def length(one: str, other: str) -> float | None:
        if one not in match.found or other not in match.found:
            return None
        apart = np.linalg.norm(positions[:, match.found[one]] - positions[:, match.found[other]], axis=1)
        apart = apart[np.isfinite(apart)]
        return float(np.quantile(apart, 0.98)) if len(apart) else None

    return part.centre.guess(Body(above.points, axes, length)), ""


def _too_few(part: Part, labels: tuple[str, ...], above: Segment | None) -> str:
    if not labels:
        return "none of its markers is in the recording" if part.markers else "it has no markers"
    markers = "1 marker" if len(labels) == 1 else f"{len(labels)} markers"
    if len(labels) < FEWEST - 1:
        return f"it has {markers} of the {FEWEST} that a turn takes"
    why = "the part above is missing" if above is None else "nothing says where its joint is"
    return f"it has {markers}, and {why}, which would be the third point"


def _points(
    part: Part, fit: RigidFit, labels: tuple[str, ...], positions: Array, match: Match
) -> dict[str, Array]:
    """Where the markers of the part, loose ones too, are in its template."""
    points = {label: fit.points[k] for k, label in enumerate(labels) if seen(fit.points[k])}
    for label in part.loose:
        if label not in match.found:
            continue
        places = fit.seen_from(positions[:, match.found[label]])
        places = places[seen(places)]
        if len(places):
            points[label] = places.mean(axis=0)
    return points


def _axes(segment: Segment, found: Mapping[str, Segment]) -> Array | None:
    """(3, 3) columns left, up, forward in the template; None where a direction cannot be told, or both are
    one.

    A direction that lacks a point is taken over from the part above, as it is on the average.
    """
    told: dict[int, Array] = {}
    for way in segment.part.directions:
        vector = _vector(way, segment)
        if vector is None and found:
            vector = _taken_over(way.axis, segment, found)
        if vector is None:
            return None
        told[way.axis] = vector
    (first, along), (second, across) = told.items()
    axes = np.zeros((3, 3))
    axes[:, first] = along / np.linalg.norm(along)
    across = across - (across @ axes[:, first]) * axes[:, first]
    if np.linalg.norm(across) < _THIN:
        return None
    axes[:, second] = across / np.linalg.norm(across)
    third = 3 - first - second
    axes[:, third] = np.cross(axes[:, (third + 1) % 3], axes[:, (third + 2) % 3])
    return axes


def _vector(way: Direction, segment: Segment) -> Array | None:
    ends = []
    for names in (way.start, way.end):
        there = [segment.points[name] for name in names if name in segment.points]
        if len(there) < len(names):
            return None
        ends.append(np.mean(there, axis=0))
    vector: Array = ends[1] - ends[0]
    return vector if np.linalg.norm(vector) > _THIN else None


def _taken_over(axis: int, segment: Segment, found: Mapping[str, Segment]) -> Array:
    """The axis of the part above (oriented already), else of the laboratory, as the segment sees it."""
    world = np.broadcast_to(np.eye(3)[axis], (len(segment.fit.rotations), 3))
    if segment.parent:
        world = found[segment.parent].fit.rotations[:, :, axis]
    vector: Array = np.nanmean(np.einsum("fji,fj->fi", segment.fit.rotations, world), axis=0)
    return vector


def _oriented(segment: Segment, found: Mapping[str, Segment]) -> Segment:
    """The segment with its template's axes left, up, forward and its joint at the origin."""
    axes = _axes(segment, found)
    if axes is None:
        raise GmrError(
            f"[parts.{segment.part.name}]: its two directions are one line in this recording, which tells no "
            "turn about it. Give the relation another for one of them, by other markers."
        )
    points = dict(segment.points)
    if segment.parent is None and segment.part.at and all(name in points for name in segment.part.at):
        points[segment.part.joint] = np.mean([points[name] for name in segment.part.at], axis=0)
    joint = points[segment.part.joint]
    fit = segment.fit
    return replace(
        segment,
        fit=RigidFit(
            points=(fit.points - joint) @ axes,
            rotations=fit.rotations @ axes,
            origins=fit.place(joint),
            known=fit.known,
            residuals=fit.residuals,
        ),
        points={name: axes.T @ (place - joint) for name, place in points.items()},
    )
