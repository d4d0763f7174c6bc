"""A motion becomes a .glb: its joints as a tree of nodes, its frames as one animation, and no mesh.

glTF counts in metres with Y up, and a node turns all that hangs on it, as a joint of BVH does: the motion is
written in post-rotation form. Source: glTF 2.0 specification, 3.5.3 "Transformations" and 3.11 "Animations".
"""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.body.measures import UP_TURNS
from gmr.errors import FormatError
from gmr.formats.gltf_animation_writer import animation_of
from gmr.formats.gltf_blob import Blob
from gmr.formats.gltf_document import pygltflib
from gmr.formats.oddity import say
from gmr.guesses import guess_body
from gmr.skeleton import End
from gmr.skinning.keyframes import Animation, Channel
from gmr.skinning.transforms import continuous

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skeleton import Skeleton

__all__ = ["glb_of_motion"]

Floats = NDArray[np.float64]


def glb_of_motion(motion: Motion) -> list[bytes]:
    """The pieces, in order, of a .glb file that holds a motion.

    Each joint is a node, End Sites too, but not tips of zero length that reading added. Every joint that
    turns something has a track of rotations, each root and each joint that moves against its parent one of
    translations; what stays has a key at the beginning and one at the end. Where another axis than Y is up,
    all hang on a node that turns it up.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``).
        FormatError: there are no frames, they take no time, one is not finite, or no unit is known.

    Warns:
        FormatWarning: the unit or the axis that is up was guessed from the body.
    """
    name = motion.name
    _check(motion)
    metres, up = _unit_and_up(motion)
    posed = motion.to_post_rotation()
    skeleton = posed.skeleton
    joints = [joint for joint, end in enumerate(skeleton.ends.tolist()) if end != End.TIP]
    node_of = {joint: node for node, joint in enumerate(joints)}
    model = pygltflib()
    nodes = [_node(skeleton, joint, metres, node_of, model) for joint in joints]
    roots = [node_of[root] for root in skeleton.roots]
    if up != "+Y":
        turn = np.asarray(UP_TURNS[up], np.float64).tolist()
        nodes.append(model.Node(name=f"{up} is up", rotation=turn, children=roots))
        roots = [len(nodes) - 1]
    blob = Blob(model)
    called = PurePath(name).stem if name else "motion"
    animation = Animation(called, tuple(_channels(posed, metres, node_of)))
    content = model.GLTF2(
        asset=model.Asset(generator=f"gmr {_core.__version__}", version="2.0"),
        scene=0,
        scenes=[model.Scene(name=called, nodes=roots)],
        nodes=nodes,
        animations=[animation_of(animation, blob)],
        accessors=blob.accessors,
        bufferViews=blob.views,
        buffers=[model.Buffer()],
    )
    content.set_binary_blob(blob.data())
    return [bytes(piece) for piece in content.save_to_bytes()]


def _check(motion: Motion) -> None:
    if not motion.frame_count:
        what = "the motion has no frames, and a .glb shows its joints by what moves; write it as .bvh or .gmr"
        raise FormatError(what, file=motion.name)
    if motion.frame_count > 1 and not motion.frame_time > 0:
        what = "its frames take no time, and a .glb says when each is"
        advice = "give them some: dataclasses.replace(motion, frame_time=1 / 30)"
        raise FormatError(f"{what}; {advice}", file=motion.name)
    pose = motion.pose
    finite = np.isfinite(pose.rotations).all(axis=(1, 2)) & np.isfinite(pose.translations).all(axis=(1, 2))
    if not finite.all():
        what = f"frame {int(np.flatnonzero(~finite)[0])} holds NaN, which a .glb cannot say; fill or cut it"
        raise FormatError(what, file=motion.name)


def _unit_and_up(motion: Motion) -> tuple[float, str]:
    """Metres per file unit, and the axis that is up; what had to be guessed is said."""
    guess, metres = guess_body(motion), motion.unit
    if metres is None and guess.unit is None:
        what = "a .glb is in metres, and neither the motion nor the body in it says how long its unit is"
        raise FormatError(f"{what}; declare it: motion.with_unit('cm')", file=motion.name)
    if metres is None and guess.unit is not None:
        metres = guess.unit.metres
        what = f"the unit is not said; taken for {guess.unit.name} ({metres:.4g} m), a guess from the body"
        say(f"{what}; motion.with_unit states another", motion.name, strict=False)
    up = guess.up.axis if guess.up is not None and guess.up.sure else "+Y"
    if up != "+Y":
        say(f"{up} is up in it, and +Y in a .glb; a node above its roots turns it", motion.name, strict=False)
    assert metres is not None
    return metres, up


def _node(skeleton: Skeleton, joint: int, metres: float, node_of: dict[int, int], model: Any) -> Any:
    children = [node_of[child] for child in skeleton.children[joint] if child in node_of]
    offset = skeleton.offsets[joint] * metres
    place = offset.tolist() if offset.any() else None
    return model.Node(name=skeleton.names[joint], translation=place, children=children)


def _channels(motion: Motion, metres: float, node_of: dict[int, int]) -> list[Channel]:
    """Of every joint that turns something, and of every one that moves."""
    times = np.arange(motion.frame_count, dtype=np.float64) * motion.frame_time
    skeleton, pose = motion.skeleton, motion.pose
    moved = dict(zip(pose.translated.tolist(), np.moveaxis(pose.translations, 1, 0), strict=True))
    turned = {
        int(skeleton.parents[child]): int(slot) for child, slot in enumerate(skeleton.slots) if slot >= 0
    }
    found = []
    for joint, node in node_of.items():
        if joint in moved:
            # The first root keeps all its keys: they tell the rate, and how many frames there are.
            is_first = joint == skeleton.roots[0]
            found.append(_channel(node, "translation", moved[joint] * metres, times, keeps=is_first))
        if joint in turned:
            turns = continuous(pose.rotations[:, turned[joint]])
            found.append(_channel(node, "rotation", turns, times))
    return found


def _channel(node: int, path: Any, values: Floats, times: Floats, *, keeps: bool = False) -> Channel:
    """A channel; what stays has a key at the beginning and one at the end, unless it ``keeps`` them all."""
    single = values.astype(np.float32)
    if len(single) > 2 and not keeps and (single == single[0]).all():
        single, times = single[[0, -1]], times[[0, -1]]
    return Channel(node, path, times.astype(np.float32), single)
