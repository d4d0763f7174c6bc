"""What moves a humanoid in an X3D file: a clock, interpolators for the joints that move, and routes."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from gmr.formats.x3d_figure import Figure
from gmr.formats.x3d_humanoid import Moves
from gmr.formats.x3d_nodes import element, numbers, rotation

__all__ = ["animation", "joint_def"]

Floats = NDArray[np.float64]

_KEY_DECIMALS = 9
"""A thousandth of a frame in a million."""
_BLOCK = 1 << 14


def joint_def(name: str) -> str:
    """What a file calls the node of a joint."""
    return f"hanim_{name}"


def animation(figure: Figure) -> Iterator[bytes]:
    """Clock, interpolators and routes, piece by piece; a frame is a key."""
    motion = figure.body.motion
    seconds = (motion.frame_count - 1) * motion.frame_time
    yield _line(element("TimeSensor", def_="clock", cycleInterval=seconds, loop="true"))
    for name in figure.body.stands:
        if name in figure.moving:
            yield from _interpolator(figure, "PositionInterpolator", name, "translation", _translations)
        if name in figure.turning:
            yield from _interpolator(figure, "OrientationInterpolator", name, "rotation", _rotations)


def _translations(figure: Figure, name: str, moves: Moves) -> bytes:
    return numbers(figure.translation(name, moves.vectors))


def _rotations(figure: Figure, name: str, moves: Moves) -> bytes:
    return rotation(moves.turns)


def _interpolator(
    figure: Figure, node: str, name: str, field: str, said: Callable[[Figure, str, Moves], bytes]
) -> Iterator[bytes]:
    last = figure.body.motion.frame_count - 1
    own = f"{name}_{field}"
    yield f'<{node} DEF="{own}" key="'.encode()
    for start in range(0, last + 1, _BLOCK):
        frames = np.arange(start, min(start + _BLOCK, last + 1))
        yield numbers(frames[:, None] / last, _KEY_DECIMALS)
    yield b'" keyValue="'
    for moves in figure.body.blocks([name]):
        yield said(figure, name, moves[name])
    yield b'"/>\n'
    yield _route("clock", "fraction_changed", own, "set_fraction")
    yield _route(own, "value_changed", joint_def(name), f"set_{field}")


def _route(source: str, output: str, target: str, put: str) -> bytes:
    return _line(element("ROUTE", fromNode=source, fromField=output, toNode=target, toField=put))


def _line(text: str) -> bytes:
    return f"{text}\n".encode()
