"""What moves a humanoid in an X3D file: a clock, an interpolator for each joint that turns or is translated, and
the routes between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from gmr.formats.x3d_humanoid import Humanoid, Moves
from gmr.formats.x3d_nodes import element, numbers, rotation

__all__ = ["animation", "joint_def", "offset"]

Floats = NDArray[np.float64]

_KEY_DECIMALS = 9
"""A thousandth of a frame in a million."""
_BLOCK = 1 << 14


def joint_def(name: str) -> str:
    """What a file calls the node of a joint."""
    return f"hanim_{name}"


def offset(body: Humanoid, name: str, vectors: Floats) -> Floats:
    """(n, 3) metres: the translation of a joint, given its vectors from the joint above (the root: its
    places)."""
    centres, above = body.measured.centres, body.standing_above(name)
    return vectors - (centres[name] - (centres[above] if above else 0.0))


def animation(body: Humanoid) -> Iterator[bytes]:
    """Clock, interpolators and routes, piece by piece; a frame is a key."""
    motion, measured = body.motion, body.measured
    seconds = (motion.frame_count - 1) * motion.frame_time
    yield _line(element("TimeSensor", def_="clock", cycleInterval=seconds, loop="true"))
    for name in body.stands:
        if name in measured.moving:
            yield from _interpolator(
                body, "PositionInterpolator", name, "translation", lambda moves, name=name: numbers(offset(body, name, moves.vectors))
            )
        if name in measured.turning:
            yield from _interpolator(
                body, "OrientationInterpolator", name, "rotation", lambda moves: rotation(moves.turns)
            )


def _interpolator(
    body: Humanoid, node: str, name: str, field: str, said: Callable[[Moves], bytes]
) -> Iterator[bytes]:
    last = body.motion.frame_count - 1
    own = f"{name}_{field}"
    yield f'<{node} DEF="{own}" key="'.encode()
    for start in range(0, last + 1, _BLOCK):
        frames = np.arange(start, min(start + _BLOCK, last + 1))
        yield numbers(frames[:, None] / last, _KEY_DECIMALS)
    yield b'" keyValue="'
    for _, moves in body.blocks([name]):
        yield said(moves[name])
    yield b'"/>\n'
    yield _route("clock", "fraction_changed", own, "set_fraction")
    yield _route(own, "value_changed", joint_def(name), f"set_{field}")


def _route(source: str, output: str, target: str, put: str) -> bytes:
    return _line(element("ROUTE", fromNode=source, fromField=output, toNode=target, toField=put))


def _line(text: str) -> bytes:
    return f"{text}\n".encode()
