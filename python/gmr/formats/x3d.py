"""A motion as a humanoid of H-Anim in X3D (ISO/IEC 19775-1, 19776-1 version 4.0; ISO/IEC 19774-1:2019).

gmr writes the format, and does not read it.
"""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path

from gmr import _core
from gmr.errors import FormatWarning, GmrError
from gmr.formats.hanim import articulations
from gmr.formats.writing import write_pieces
from gmr.formats.x3d_animation import animation, joint_def
from gmr.formats.x3d_figure import Figure, figure_of
from gmr.formats.x3d_geometry import axis_angle, ground, segment, viewpoint
from gmr.formats.x3d_humanoid import humanoid_of
from gmr.formats.x3d_nodes import closed, element, opened
from gmr.motion import Motion

__all__ = ["write_x3d", "x3d_chunks"]

_HEADER = """<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE X3D PUBLIC "ISO//Web3D//DTD X3D 4.0//EN" "https://www.web3d.org/specifications/x3d-4.0.dtd">
<X3D profile="Immersive" version="4.0" xmlns:xsd="http://www.w3.org/2001/XMLSchema-instance" \
xsd:noNamespaceSchemaLocation="https://www.web3d.org/specifications/x3d-4.0.xsd">
"""


def write_x3d(
    motion: Motion,
    path: str | os.PathLike[str],
    *,
    names: Mapping[str, str] | None = None,
    rest: int | None = None,
) -> None:
    """Write a motion as X3D; as :func:`gmr.write`, for a body that gmr does not know by itself.

    Args:
        motion: of a human.
        path: where; what was there is replaced when its successor is whole.
        names: joints by part of the body, ``{"left_up_leg": "joint_7"}``, chains as ``"spine.0"``; they go
            before any guess. The parts are those of ``gmr/data/joint_names``.
        rest: the frame in which the motion stands most like H-Anim's default pose, where it has no rest pose
            of its own.

    Raises:
        SkeletonError: hips, legs or feet are not known; says what is missing.
        GmrError: as :func:`x3d_chunks`; or the file cannot be written.
    """
    write_pieces(Path(path), x3d_chunks(motion, names=names, rest=rest))


def x3d_chunks(
    motion: Motion, *, names: Mapping[str, str] | None = None, rest: int | None = None
) -> Iterator[bytes]:
    """The motion as an X3D file, piece by piece; a single frame is a posture that does not move.

    Its joints are where those of the motion are, in metres and Y up. All is checked before the first piece
    comes out.

    Args:
        motion: of a human.
        names: joints by part of the body; see :func:`write_x3d`.
        rest: the frame in which it rests.

    Raises:
        SkeletonError: hips, legs or feet are not known.
        FormatError: a place is no finite number.
        GmrError: there are no frames, or several without a frame time; the unit is not known, or makes the
            body smaller or larger than X3D can say in metres; or there is no such frame.

    Warns:
        FormatWarning: the unit was guessed, or there is no rest pose.
    """
    if motion.frame_count > 1 and not motion.frame_time:
        raise GmrError(
            f"{motion.name or 'the motion'} does not say how long a frame lasts, so X3D cannot play it; give "
            "it a frame time, or write a single frame: motion[0:1]"
        )
    figure = figure_of(humanoid_of(motion, names, rest))
    file, unit = motion.name or "the motion", figure.body.scene.unit
    if unit.guessed:
        what = f"taken to be in {unit.name}, guessed from the body; state another with motion.with_unit"
        warnings.warn(FormatWarning(f"{file}: {what}"), stacklevel=2)
    if figure.body.odd:
        what = f"{figure.body.odd}; name another frame with gmr.formats.x3d.write_x3d(motion, path, rest=...)"
        warnings.warn(FormatWarning(f"{file}: {what}"), stacklevel=2)
    return _pieces(figure)


def _pieces(figure: Figure) -> Iterator[bytes]:
    yield _HEADER.encode()
    yield _text(_head(figure))
    yield _text([opened("Scene"), *_world(figure), *_humanoid(figure)])
    if figure.body.motion.frame_count > 1:
        yield from animation(figure)
    yield _text([closed("Scene"), closed("X3D")])


def _text(lines: list[str] | Iterator[str]) -> bytes:
    return "".join(f"{line}\n" for line in lines).encode()


def _title(figure: Figure) -> str:
    return Path(figure.body.motion.name or "motion").stem or "motion"


def _token(title: str) -> str:
    """The title as an NMTOKEN of XML, which the schema wants the name of a humanoid to be; of letters only
    those that all editions of XML know."""
    return re.sub(r"[^\w.\-]", "_", title, flags=re.ASCII)


def _head(figure: Figure) -> Iterator[str]:
    unit = figure.body.scene.unit
    guessed = ", guessed from the body" if unit.guessed else ""
    yield opened("head")
    yield element("component", name="HAnim", level="1")
    said = {
        "title": _title(figure),
        "generator": f"gmr {_core.__version__}",
        "unit of the motion": f"{figure.body.metres:.9g} m{guessed}",
        "rest pose": figure.body.rest.said,
        "frames": f"{figure.body.motion.frame_count} at {figure.body.motion.fps:.9g} frames a second",
        "left out": ", ".join(figure.body.left_out) or "no joint",
    }
    for name, content in said.items():
        yield element("meta", name=name, content=content)
    yield closed("head")


def _world(figure: Figure) -> Iterator[str]:
    yield element("WorldInfo", title=_title(figure))
    yield element("NavigationInfo", type='"EXAMINE" "ANY"')
    yield element("Background", skyColor="0.93 0.94 0.96")
    yield element("DirectionalLight", direction="-0.3 -1 -0.4", intensity="0.7", global_="true")
    yield viewpoint(figure)
    yield from ground(figure)


def _humanoid(figure: Figure) -> Iterator[str]:
    """The tree of joints and segments, and the lists of both, which H-Anim asks for beside it."""
    yield opened(
        "HAnimHumanoid",
        def_="hanim_humanoid",
        name=_token(_title(figure)),
        version="2.0",
        loa="1",
        skeletalConfiguration="BASIC",
    )
    yield from _joint(figure, "humanoid_root")
    for name in figure.body.above:
        yield element("HAnimJoint", use=joint_def(name), containerField="joints")
    for name in figure.body.above:
        yield element("HAnimSegment", use=joint_def(articulations()[name].segment), containerField="segments")
    yield closed("HAnimHumanoid")


def _joint(figure: Figure, name: str) -> Iterator[str]:
    stand = figure.body.stands.get(name)
    turn = shift = None
    if stand is not None and name not in figure.turning:
        turn = axis_angle(figure.still[name])
    if name == "humanoid_root" and name not in figure.moving:
        shift = figure.translation(name, figure.box[0])
    yield opened(
        "HAnimJoint",
        def_=joint_def(name),
        name=name,
        containerField=None if figure.body.above[name] else "skeleton",
        description=None if stand is None else figure.body.motion.skeleton.names[stand.named],
        center=figure.centres[name],
        rotation=turn if turn is not None and turn[3] else None,
        translation=shift,
    )
    part = articulations()[name].segment
    yield opened("HAnimSegment", def_=joint_def(part), name=part)
    yield from segment(figure, name)
    yield closed("HAnimSegment")
    for below, above in figure.body.above.items():
        if above == name:
            yield from _joint(figure, below)
    yield closed("HAnimJoint")
