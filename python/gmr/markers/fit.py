"""From markers to a motion: the parts of a body fitted, joined, and what to think of it reported."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.listing import quoted
from gmr.markers.assembly import assemble
from gmr.markers.axes import AXES, axis_vector
from gmr.markers.labels import Match, best_relation, match_labels
from gmr.markers.relation import Relation, load_relation, shipped_relations
from gmr.markers.segments import Segment, find_segments

if TYPE_CHECKING:
    from gmr.markers.bridging import Stretch
    from gmr.markers.recording import Markers
    from gmr.markers.report import FitReport
    from gmr.motion import Motion

__all__ = ["MarkerFit", "fit"]

_SHOWN = 8
_UPRIGHT = 0.5
"""Cosine of the angle to an axis below which a body counts as not upright along it."""


@dataclass(frozen=True, eq=False, repr=False)
class MarkerFit:
    """A motion made of markers, with all that tells how well.

    Args:
        motion: in the unit of the recording, +Y up.
        markers: the recording that it was made of, turned so that +Y is up.
        relation: which marker is on which part.
        match: which of its markers were found.
        segments: part -> its fit in metres, oriented; parents first.
        left_out: part -> why it is not in the motion.
        stretches: part -> the frames in which it was not seen enough.
        notes: what had to be assumed, in words.
    """

    motion: Motion
    markers: Markers
    relation: Relation
    match: Match
    segments: Mapping[str, Segment]
    left_out: Mapping[str, str]
    stretches: Mapping[str, tuple[Stretch, ...]]
    notes: tuple[str, ...]

    @cached_property
    def residuals(self) -> NDArray[np.float64]:
        """(F, M) millimetres from each marker to its place on its part; NaN where it has none."""
        found = np.full(self.markers.positions.shape[:2], np.nan)
        for segment in self.segments.values():
            found[:, segment.columns] = 1000 * segment.fit.residuals
        return found

    @cached_property
    def report(self) -> FitReport:
        """What to think of the fit, as tables and in words."""
        from gmr.markers.report import report_of

        return report_of(self)

    @property
    def unknown(self) -> dict[str, tuple[Stretch, ...]]:
        """Part -> the stretches in which its pose, and all below it, is NaN in the motion."""
        held = {
            part: tuple(stretch for stretch in found if stretch.became == "unknown")
            for part, found in self.stretches.items()
        }
        return {part: found for part, found in held.items() if found}

    def picture(self, frames: int = 6) -> str:
        """SVG: markers and skeleton in some frames, from the front and the side."""
        from gmr.markers.picture import film_strip

        return film_strip(self, frames)

    def __repr__(self) -> str:
        return f"MarkerFit({self.motion!r}, {len(self.segments)} parts, {len(self.left_out)} left out)"


def fit(
    markers: Markers,
    relation: Relation | str | Path | None = None,
    *,
    subject: str | None = None,
    max_gap: float = 0.2,
    bones: Literal["constant", "measured"] = "constant",
) -> MarkerFit:
    """The motion of the body that wears the markers.

    Each part is a rigid fit of its markers (:mod:`gmr.markers.rigid`), each joint centre what motion and
    anatomy say together (:mod:`gmr.markers.centres`), the motion their transforms in each other
    (:mod:`gmr.markers.assembly`).

    Args:
        markers: a recording with a known unit.
        relation: which marker is on which part: a relation, the name of one that ships with gmr, or a file;
            told by the labels where left out.
        subject: the person meant, where labels begin with a name: "Anna" in "Anna:LASI".
        max_gap: seconds of a part not being seen that are bridged by slerp. In longer stretches, and at the
            edges of the recording, the part is NaN.
        bones: "constant": bones keep their length; "measured": each joint goes where the part below has it,
            so that every part is where it was fitted.

    Raises:
        GmrError: there are no markers; the unit is unknown; the relation does not fit the labels; no part is
            seen. Says what to do.
    """
    if bones not in ("constant", "measured"):
        raise ValueError(f"bones='{bones}' is not known; use 'constant' or 'measured'")
    name = markers.name or "the recording"
    _check_markers(markers)
    if markers.unit is None:
        raise GmrError(f"{name} does not say in what unit it is; declare it first: markers.with_unit('mm')")
    if not markers.frame_count:
        raise GmrError(f"{name} has no frames, so there is no motion in it")
    chosen = _chosen(markers, relation)
    try:
        match = match_labels(chosen, markers.labels, subject=subject)
    except GmrError as error:
        raise GmrError(f"{name}: {error}") from None
    notes: list[str] = []
    if match.prefix and subject is None:
        notes.append(f"of several subjects, '{match.prefix}' wears the most of the markers and was taken")
    turned, segments, left_out = _upright(markers, chosen, match, notes)
    if not segments:
        raise GmrError(
            f"{name}: no part of '{chosen.name}' can be fitted. {_why_not(chosen, match, left_out)}"
        )
    motion, stretches = assemble(
        segments,
        markers.frame_time,
        markers.unit,
        longest=max_gap / markers.frame_time * (1 + 1e-9) if markers.frame_time else 0,
        bones=bones,
        name=markers.name,
    )
    return MarkerFit(motion, turned, chosen, match, segments, left_out, stretches, tuple(notes))


def _check_markers(markers: Markers) -> None:
    """Refuses a recording without markers; what it holds instead is said."""
    if not markers.labels:
        only = f", only {' and '.join(markers.ignored)}" if markers.ignored else ""
        raise GmrError(
            f"{markers.name or 'the recording'}: it holds no markers{only}, and a motion is made of markers. "
            "Export the places of the markers too."
        )


def _chosen(markers: Markers, wanted: Relation | str | Path | None) -> Relation:
    if wanted is not None:
        return load_relation(wanted)
    found = best_relation(markers.labels)
    if found is None:
        raise GmrError(
            f"{markers.name or 'the recording'}: its labels ({quoted(markers.labels, _SHOWN)}) are those of "
            f"no marker set that gmr knows ({', '.join(shipped_relations())}). Write a relation that says "
            "which marker is on which part, and name its file."
        )
    return found


def _upright(
    markers: Markers, relation: Relation, match: Match, notes: list[str]
) -> tuple[Markers, dict[str, Segment], dict[str, str]]:
    """The recording with +Y up, and its parts; the body tells which way is up where nothing else does."""
    if markers.up is None:
        segments, _ = find_segments(_metres(markers), relation, match)
        up = _body_up(segments)
        axis = max(AXES, key=lambda each: float(axis_vector(each) @ up))
        notes.append(f"nothing says which way is up; {axis} is taken, along which the body stands")
        markers = markers.with_up("+Y", was=axis)
    turned = markers.with_up("+Y")
    segments, left_out = find_segments(_metres(turned), relation, match)
    if segments and _body_up(segments)[1] < _UPRIGHT:
        said = f"{turned.up.by}" if turned.up else ""
        notes.append(f"the body does not stand upright along the axis that is taken to point up ({said})")
    return turned, segments, left_out


def _metres(markers: Markers) -> NDArray[np.float64]:
    assert markers.unit is not None
    return markers.positions * markers.unit


def _body_up(segments: Mapping[str, Segment]) -> NDArray[np.float64]:
    """(3,) the mean direction of up of the root parts and those that hang on them, in the laboratory."""
    central = [
        segment
        for segment in segments.values()
        if segment.parent is None or segments[segment.parent].parent is None
    ]
    ups = [np.nanmean(segment.fit.rotations[:, :, 1], axis=0) for segment in central]
    up: NDArray[np.float64] = np.mean(ups, axis=0) if ups else np.array([0.0, 1.0, 0.0])
    return up


def _why_not(relation: Relation, match: Match, left_out: Mapping[str, str]) -> str:
    """Which markers are missing, and what is there that is nearly called so."""
    if not match.missing:
        part, reason = next(iter(left_out.items()))
        return f"'{part}': {reason}."
    near = {label: like for label, like in match.missing.items() if like}
    meant = "; ".join(f"'{label}': did you mean {quoted(like, 2)}?" for label, like in list(near.items())[:4])
    return f"Missing are {quoted(tuple(match.missing), _SHOWN)}. {meant}".strip()
