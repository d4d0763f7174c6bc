"""What to think of a fit: how far markers stray, where joints are and why, how steady bones are."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gmr.listing import quoted
from gmr.markers.bridging import Stretch
from gmr.markers.segments import Segment

if TYPE_CHECKING:
    from gmr.markers.fit import MarkerFit

__all__ = ["BoneReport", "FitReport", "JointReport", "PartReport", "report_of"]

_FAR: Final = 20.0
"""Millimetres off its part at which a marker is worth a look ..."""
_TIMES: Final = 6.0
"""... where it is also so many times as far as its part's markers are in most frames (the median)."""
_SHOWN: Final = 6


@dataclass(frozen=True, slots=True)
class PartReport:
    """How well the markers of a part fit a rigid body; millimetres.

    Args:
        part: its name.
        joint: the joint that it turns.
        markers: how many its fit was made with.
        mean, worst: of the residuals.
        worst_marker, worst_frame: where the worst is.
        stretches: frames in which too few of its markers were seen, and what became of them.
        notes: what was done for want of markers.
    """

    part: str
    joint: str
    markers: int
    mean: float
    worst: float
    worst_marker: str
    worst_frame: int
    stretches: tuple[Stretch, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class JointReport:
    """Where a joint is, and why; millimetres.

    Args:
        joint: its name.
        parent: the joint above.
        gap: root mean square distance of its places in the two parts.
        weight: 0 to 1, the part that the motion had in its place; anatomy had the rest.
        apart: how far the estimates of motion and anatomy are apart; None where there is one only.
        deviations: standard deviations of the motion's estimate in its three principal directions, least
            first; None where the motion tells nothing.
        rule: where anatomy's estimate is from; "" without one.
    """

    joint: str
    parent: str
    gap: float
    weight: float
    apart: float | None
    deviations: tuple[float | None, ...]
    rule: str


@dataclass(frozen=True, slots=True)
class BoneReport:
    """How steady a bone is: the distance of two joint centres, each as its parts see it; millimetres.

    Args:
        upper, lower: the joints at its ends.
        length: in the motion.
        variation: standard deviation of the distance over the frames.
    """

    upper: str
    lower: str
    length: float
    variation: float


@dataclass(frozen=True, slots=True)
class FitReport:
    """All about a fit. ``str(report)`` is for people, :meth:`as_dict` for programs."""

    relation: str
    mean: float
    """Millimetres from the markers to their places on their parts, the mean over all."""
    parts: tuple[PartReport, ...]
    joints: tuple[JointReport, ...]
    bones: tuple[BoneReport, ...]
    left_out: dict[str, str]
    missing: dict[str, tuple[str, ...]]
    left_over: tuple[str, ...]
    notes: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold."""
        return asdict(self)

    def __str__(self) -> str:
        return "\n".join(_lines(self))


def report_of(fit: MarkerFit) -> FitReport:
    """The report of a fit."""
    parts = tuple(_part(name, segment, fit) for name, segment in fit.segments.items())
    worth = [
        f"frame {part.worst_frame}: '{part.worst_marker}' is {part.worst:.0f} mm off its place on "
        f"'{part.part}'; look for exchanged markers with findings()"
        for part, segment in zip(parts, fit.segments.values(), strict=True)
        if part.worst > max(_FAR, _TIMES * 1000 * float(np.nanmedian(segment.fit.residuals)))
    ]
    return FitReport(
        relation=fit.relation.name,
        mean=float(np.nanmean(fit.residuals)),
        parts=parts,
        joints=tuple(_joint(segment, fit) for segment in fit.segments.values() if segment.centre),
        bones=tuple(_bone(segment, fit) for segment in fit.segments.values() if segment.parent),
        left_out=dict(fit.left_out),
        missing=dict(fit.match.missing),
        left_over=tuple(fit.markers.labels[place] for place in fit.match.left_over),
        notes=(*fit.notes, *worth),
    )


def _part(name: str, segment: Segment, fit: MarkerFit) -> PartReport:
    residuals = 1000 * segment.fit.residuals
    frame, column = np.unravel_index(np.argmax(np.nan_to_num(residuals)), residuals.shape)
    return PartReport(
        part=name,
        joint=segment.part.joint,
        markers=len(segment.labels),
        mean=float(np.nanmean(residuals)),
        worst=float(np.nanmax(residuals)),
        worst_marker=segment.labels[int(column)],
        worst_frame=int(frame),
        stretches=fit.stretches[name],
        notes=segment.notes,
    )


def _joint(segment: Segment, fit: MarkerFit) -> JointReport:
    centre, parent = segment.centre, segment.parent
    assert centre is not None
    assert parent is not None
    deviations = sorted(1000 * float(each) for each in centre.functional_sd)
    return JointReport(
        joint=segment.part.joint,
        parent=fit.segments[parent].part.joint,
        gap=1000 * centre.gap,
        weight=centre.weight,
        apart=None if centre.apart is None else 1000 * centre.apart,
        deviations=tuple(each if np.isfinite(each) else None for each in deviations),
        rule=segment.rule,
    )


def _bone(segment: Segment, fit: MarkerFit) -> BoneReport:
    """The bone from the joint above to the segment's: its upper end as the part above that has it."""
    assert segment.parent is not None
    above = fit.segments[segment.parent]
    upper = above.fit.origins
    if above.parent:
        highest = fit.segments[above.parent]
        upper = highest.fit.place(highest.points[above.part.joint])
    distance = np.linalg.norm(segment.fit.origins - upper, axis=1)
    return BoneReport(
        upper=above.part.joint,
        lower=segment.part.joint,
        length=1000 * float(np.linalg.norm(above.points[segment.part.joint])),
        variation=1000 * float(np.nanstd(distance)),
    )


def _lines(report: FitReport) -> list[str]:
    """The report for people: tables, then what is odd."""
    lines = [f"marker set: {report.relation}", "", "part                markers   mean   worst mm"]
    for part in report.parts:
        worst = f"{part.worst_marker}, frame {part.worst_frame}"
        lines.append(f"{part.part:<20}{part.markers:>5}{part.mean:>9.1f}{part.worst:>8.1f}   {worst}")
    lines += ["", "joint            gap mm   motion   apart mm   anatomy"]
    for joint in report.joints:
        apart = "" if joint.apart is None else f"{joint.apart:.0f}"
        lines.append(
            f"{joint.joint:<16}{joint.gap:>7.1f}{joint.weight:>8.0%}{apart:>10}    {joint.rule or 'none'}"
        )
    lines += ["", "bone                            length   varies mm"]
    for bone in report.bones:
        lines.append(f"{bone.upper + ' - ' + bone.lower:<31}{bone.length:>7.1f}{bone.variation:>10.1f}")
    return [*lines, *_odd_lines(report)]


def _odd_lines(report: FitReport) -> list[str]:
    said = list(report.notes)
    for part in report.parts:
        said += [f"{part.part}: {note}" for note in part.notes]
        for stretch in part.stretches:
            last = stretch.first + stretch.length - 1
            frames = f"frame {last}" if stretch.length == 1 else f"frames {stretch.first} to {last}"
            what = (
                "bridged from the frames around"
                if stretch.became == "bridged"
                else "unknown, NaN in the motion"
            )
            said.append(f"{part.part}: {frames}: too few markers seen; {what}")
    said += [f"{part} is left out: {why}" for part, why in report.left_out.items()]
    for label, near in report.missing.items():
        meant = f"; did you mean {quoted(near, 2)}?" if near else ""
        said.append(f"marker '{label}' is not in the recording{meant}")
    if report.left_over:
        said.append(f"markers that the relation does not name: {quoted(report.left_over, _SHOWN)}")
    return ["", *said] if said else []
