"""A motion drives a character whose skeleton has other names, other proportions and another rest pose.

Each joint of the character takes over the turn of the bone that it follows, from rest, in the world
(:mod:`gmr.skinning.driving.rest_poses`); hips go where the motion's go, in the measure of the legs; then the
feet are set on the ground (:mod:`gmr.skinning.driving.standing`). Cf. Gleicher, "Retargetting Motion to New
Characters", SIGGRAPH 1998, whose constraints on the feet these are, met frame by frame in closed form.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gmr.body.joints import find_joints
from gmr.body.measures import UP_TURNS
from gmr.editing.scene import scene_of
from gmr.errors import DatasetError, GmrError
from gmr.forest import home
from gmr.motion import Motion
from gmr.quaternions import conjugate, multiply, rotated
from gmr.skeleton import Skeleton
from gmr.skinning.character import Character
from gmr.skinning.driving.alignment import Laid, Pairs, lay_on
from gmr.skinning.driving.body_of_motion import body_of_motion
from gmr.skinning.driving.body_parts import Body, find_body
from gmr.skinning.driving.driven import Driven, DrivingReport
from gmr.skinning.driving.driven_legs import driven_legs, feet_of_motion
from gmr.skinning.driving.following import Names, follow, names_for_ends, read_names, with_stated
from gmr.skinning.driving.puppet import pose_matrices, strung
from gmr.skinning.driving.rest_poses import (
    facing_turn,
    motion_rest,
    shortest_turn,
    with_flat_feet,
)
from gmr.skinning.driving.stage import Stage, scale_of
from gmr.skinning.driving.standing import measured_feet, stood
from gmr.tpose import leading_rest_frames

__all__ = ["drive"]

Floats = NDArray[np.float64]


def drive(
    motion: Motion,
    character: Character,
    *,
    names: Names | None = None,
    fps: float | None = None,
    root_scale: float | None = None,
    ground: bool = True,
    rest: int | None = None,
) -> Driven:
    """The poses of a character that moves as a motion does.

    Args:
        motion: F frames, in any unit and with any axis up; frames that a converter put before the recording
            are left out.
        character: of J joints.
        names: who follows whom, where names and shape do not tell: character's joint -> motion's joint
            ("" for none); or tables ``follows`` (the same), ``character`` and ``motion`` (part of the body ->
            joint); or a TOML or JSON file of these.
        fps: frames a second of the poses; the motion's where left out.
        root_scale: metres that the character goes for a metre of the motion; the ratio of the legs' lengths
            where left out.
        ground: set the feet on the ground, at the height at which the character's soles are at rest: as a
            whole, and by bending the legs. Else all is left as the turns of the bones put it.
        rest: the frame in which the motion stands upright with straight arms and flat feet, where it has no
            rest pose of its own.

    Returns:
        (F, J, 4, 4) poses, and a report.

    Raises:
        SkeletonError: nothing is matched; or a joint that ``names`` has does not exist.
        FormatError: the map of names cannot be read.
        GmrError: the motion has no rest pose, no unit where one is needed, or poses that are not known.
    """
    tables = read_names(names)
    at_home = home(motion)
    _check(at_home)
    scene = scene_of(at_home)
    mine = with_stated(_body_of_character(character), character.skeleton, tables["character"])
    theirs, by_ends = body_of_motion(at_home, scene, tables["motion"])
    following = follow(
        character.skeleton, at_home.skeleton, (mine, theirs), tables["follows"], by_ends=by_ends
    )
    resting = motion_rest(at_home, following.begins, scene.up, rest)
    lead = leading_rest_frames(at_home)
    recorded = at_home[lead:]
    moving = recorded if fps is None else recorded.resample(fps)
    stage = Stage(moving, scene, character, following, resting)
    if "frame" in resting.said:
        stage = replace(stage, rest=with_flat_feet(resting, recorded, scene.up, feet_of_motion(stage)))
    return _driven(stage, root_scale, ground, lead)


def _check(motion: Motion) -> None:
    if not motion.frame_count:
        raise GmrError(f"{motion.name or 'the motion'} has no frames, so it cannot drive a character")
    known = [np.isfinite(array).all(axis=(1, 2)) for array in (motion.rotations, motion.translations)]
    if not np.all(known):
        frame = int(np.flatnonzero(~np.all(known, axis=0))[0])
        raise GmrError(
            f"{motion.name or 'the motion'} has poses that are not known, first in frame {frame}; fill them, "
            f"or cut them off: motion[:{frame}]"
        )


def _body_of_character(character: Character) -> Body | None:
    """The body of a character, by the joints in which bones begin."""
    skeleton, rest = character.skeleton, np.asarray(character.rest_pose()[:, :3, 3], np.float64)
    body = find_body(skeleton, rest)
    if body is None or body.found_by == "shape":
        return body
    try:
        roles = find_joints(skeleton, rest[None]).roles
    except DatasetError:
        return body
    return _begins(body, skeleton) if names_for_ends(skeleton, body, roles) else body


def _begins(body: Body, motion: Skeleton) -> Body:
    """The body by the joints in which bones begin, where it is known by those in which they end."""
    above = np.where(motion.parents >= 0, motion.parents, np.arange(motion.joint_count))
    return Body(
        {part: tuple(above[list(joints)].tolist()) for part, joints in body.parts.items()}, body.found_by
    )


def _driven(stage: Stage, root_scale: float | None, ground: bool, lead: int) -> Driven:
    pairs = Pairs(stage.character.skeleton, stage.motion.skeleton, stage.following)
    sided = [both for part in ("up_leg", "arm") if (both := stage.sides(part)) is not None]
    facing = facing_turn(stage.places, stage.rest.places, sided)
    laid = lay_on(pairs, stage.places, stage.rest.places, facing)
    scale, scaled_by = scale_of(stage, pairs, root_scale)
    upright = np.array(UP_TURNS[stage.scene.up])
    ways = rotated(upright, stage.motion.positions(dtype=np.float64)) * scale
    changes = _changes(stage)
    turns, anchor = _turns(stage, pairs, laid, changes, ways)
    placed = {anchor: _place(stage, turns, anchor, ways)}
    if stage.following.is_same:
        placed |= {joint: ways[:, stage.following.bones[joint].start] for joint in pairs.all_above(anchor)}
    puppet = strung(stage.character, turns, anchor, placed)
    legs = driven_legs(stage, laid, changes, ways, scale)
    before = measured_feet(puppet, legs) if legs else ()
    raised = sunk = np.zeros(1)
    after = before
    if ground and legs:
        puppet, raised, sunk = stood(puppet, legs, anchor, placed, stage.motion.frame_time)
        after = measured_feet(puppet, legs)
    names, theirs = stage.character.joint_names, stage.motion.skeleton
    used = {bone.name for bone in stage.following.bones.values()}
    unit = stage.scene.unit
    report = DrivingReport(
        follows={names[joint]: bone.name for joint, bone in stage.following.bones.items()},
        matched_by=stage.following.how,
        unmatched_character=tuple(name for j, name in enumerate(names) if j not in stage.following.bones),
        unmatched_motion=tuple(
            n for n, end in zip(theirs.names, theirs.ends, strict=True) if not end and n not in used
        ),
        scale=None if unit.metres is None else scale / unit.metres,
        scaled_by=scaled_by,
        unit="unit not known" if unit.metres is None else f"a unit is {unit.metres:.4g} m{unit.note}",
        up=stage.scene.up,
        rest=stage.rest.said,
        facing_deg=float(np.degrees(2 * np.arctan2(facing[1], facing[3]))),
        rest_turns_deg={names[joint]: angle for joint, angle in laid.angles_deg.items()},
        left_out=lead,
        raised_mm=1000 * float(np.median(raised)),
        sunk_mm=1000 * float(sunk.max(initial=0.0)),
        feet_before=before,
        feet=after,
    )
    return Driven(pose_matrices(puppet), stage.motion.frame_time, report)


def _changes(stage: Stage) -> Floats:
    """(F, K, 4) how the motion's bones have turned since its rest, both upright: ``U G G_0^-1 D^-1``."""
    since = multiply(stage.motion.bone_rotations(dtype=np.float64), conjugate(stage.rest.rotations))
    upright = np.array(UP_TURNS[stage.scene.up])
    return multiply(upright, multiply(since, conjugate(stage.rest.upright)))


def _turns(stage: Stage, pairs: Pairs, laid: Laid, changes: Floats, ways: Floats) -> tuple[Floats, int]:
    """(F, J, 4) the turns of all joints of the character from its rest, and the joint that has a place."""
    bones, places = stage.following.bones, stage.places
    parents = stage.character.joint_parents
    order = stage.character.skeleton.parents_first
    hips = stage.both("hips")
    anchor = hips[0] if hips else pairs.trunk
    turns = np.empty((len(ways), len(places), 4))
    for joint, bone in bones.items():
        turns[:, joint] = multiply(changes[:, bone.carrier], laid.turns[joint])
        led = laid.leads_to.get(joint)
        if led is not None and stage.motion.skeleton.parents[bones[led].start] != bone.start:
            # Where joints between the two bend, the direction is that of them all.
            now = rotated(turns[:, joint], places[led] - places[joint])
            wanted = ways[:, bones[led].start] - ways[:, bone.start]
            turns[:, joint] = multiply(shortest_turn(now, wanted), turns[:, joint])
    for joint in order:
        if joint not in bones:
            above = int(parents[joint])
            has_above = pairs.nearest(joint) >= 0
            turns[:, joint] = turns[:, above if has_above else anchor]
    return turns, anchor


def _place(stage: Stage, turns: Floats, anchor: int, ways: Floats) -> Floats:
    """(F, 3) of the anchor: the middle of the hip joints goes where the motion's goes, for that is what legs
    hang on, wherever a skeleton has its root."""
    sided = stage.sides("up_leg")
    if sided is None:
        return ways[:, stage.following.bones[anchor].start]
    mine, theirs = sided
    middle = stage.places[list(mine)].mean(axis=0) - stage.places[anchor]
    return np.asarray(ways[:, list(theirs)].mean(axis=1) - rotated(turns[:, anchor], middle), np.float64)
