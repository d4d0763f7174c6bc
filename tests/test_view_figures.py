"""What the viewer draws, before any browser: figures, bones as bodies, trails, time lines, patches, skins."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import gmr
from figures import body
from gmr import quaternions
from gmr.demo import demo_folder
from gmr.errors import GmrError
from gmr.view.bone_shapes import BONE_FACES, BONE_VERTICES, placed_bones
from gmr.view.browser_skin import browser_skin
from gmr.view.colours import LEVELS, level_colours
from gmr.view.figure import Figure, Worn, motion_figure, posed_figure
from gmr.view.fitting import fitted_poses
from gmr.view.layout import laid_out
from gmr.view.patches import joint_weights, plain_patches, weight_patches
from gmr.view.playing import Player
from gmr.view.timeline import Timeline
from random_characters import character as random_character

DATA = Path(__file__).parent / "data"
PLACES = st.floats(-3, 3, width=32)


@pytest.fixture(scope="module")
def walk() -> gmr.Motion:
    return gmr.read(demo_folder() / "07_01.bvh")


@pytest.fixture(scope="module")
def figure(walk: gmr.Motion) -> Figure:
    return motion_figure(walk)


@pytest.fixture(scope="module")
def cylinder() -> gmr.Character:
    return gmr.read_character(DATA / "rigged_simple.gltf")


def still(frames: int, frame_time: float, name: str = "still") -> Figure:
    heads = np.zeros((frames, 1, 3), np.float32)
    return Figure(name, frame_time, heads, heads + np.float32(1), ("",))


def with_gap(motion: gmr.Motion, gap: slice) -> gmr.Motion:
    rotations = motion.rotations.copy()
    rotations[gap] = np.nan
    return gmr.Motion.from_pose(
        motion.skeleton, rotations, motion.translations, motion.frame_time, name="gap"
    )


@given(arrays(np.float32, (4, 3), elements=PLACES), arrays(np.float32, (4, 3), elements=PLACES))
def test_a_bone_leads_from_its_head_to_its_tail(
    heads: np.ndarray[tuple[int, int], np.dtype[np.float32]],
    tails: np.ndarray[tuple[int, int], np.dtype[np.float32]],
) -> None:
    placed = placed_bones(heads, tails, 1.0)
    xyzw = np.roll(placed.wxyzs.astype(np.float64), -1, axis=-1)
    tips = placed.positions + quaternions.rotated(xyzw, placed.scales * np.array([0.0, 1.0, 0.0]))
    np.testing.assert_allclose(np.linalg.norm(xyzw, axis=-1), 1, atol=1e-5)
    np.testing.assert_allclose(tips, tails, atol=3e-3)


def test_the_shape_of_a_bone_is_closed_and_turned_outward() -> None:
    edges = np.sort(np.concatenate([BONE_FACES[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert (counts == 2).all()
    a, b, c = np.moveaxis(BONE_VERTICES[BONE_FACES].astype(np.float64), 1, 0)
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 > 0


def test_a_bone_with_nan_has_no_size() -> None:
    heads = np.zeros((2, 3), np.float32)
    tails = np.array([[0, 1, 0], [0, np.nan, 0]], np.float32)
    placed = placed_bones(heads, tails, 1.0)
    assert np.isfinite(placed.wxyzs).all()
    assert placed.scales[0, 1] == 1
    assert (placed.scales[1] == 0).all()


def test_a_figure_is_the_motion_in_metres(walk: gmr.Motion, figure: Figure) -> None:
    bones = gmr.bones(walk, "per_child", slice(None))
    np.testing.assert_allclose(figure.heads, bones.heads * 0.0254 / 0.45, atol=1e-6)
    assert any("cmu" in note for note in figure.notes)
    low, high = figure.box
    assert 1.4 < high[1] - low[1] < 2.2


def test_a_motion_in_metres_is_not_guessed_at(walk: gmr.Motion) -> None:
    said = walk.with_unit("cmu").to_unit("m")
    figure = motion_figure(said)
    assert figure.notes == ()
    np.testing.assert_allclose(figure.heads, motion_figure(walk).heads, atol=1e-5)


def test_what_has_z_up_is_turned(walk: gmr.Motion, figure: Figure) -> None:
    turn = np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    rotations, places = walk.rotations.copy(), walk.translations.copy()
    root = walk.skeleton.slots[walk.skeleton.children[walk.skeleton.roots[0]][0]]
    rotations[:, root] = quaternions.multiply(turn, rotations[:, root])
    lying = gmr.Motion.from_pose(
        walk.skeleton, rotations, quaternions.rotated(turn, places), walk.frame_time, unit=walk.unit
    )
    turned = motion_figure(lying)
    assert any("+Z is up" in note for note in turned.notes)
    np.testing.assert_allclose(turned.heads[5:], figure.heads[5:], atol=1e-4)


def test_sides_follow_the_names_of_the_tails(walk: gmr.Motion, figure: Figure) -> None:
    assert set(figure.sides) == {"left", "right", ""}
    assert figure.sides.count("left") == figure.sides.count("right")
    places = walk.positions(dtype=np.float64)[5] * 0.0254 / 0.45
    told = 0
    for tail, side in zip(figure.tails[5], figure.sides, strict=True):
        at = np.linalg.norm(places - tail, axis=1) < 1e-5
        names = [name for name, here in zip(walk.skeleton.names, at, strict=True) if here]
        told += bool(names)
        assert not names or any(name[:1] == side[:1].upper() or not side for name in names)
    assert told > 20, "but for bones without length, which have a tail of their own"


def test_trails_are_the_ways_of_root_and_hands(walk: gmr.Motion, figure: Figure) -> None:
    assert [trail.joint for trail in figure.trails] == ["Hips", "LeftHand", "RightHand"]
    places = walk.positions(joints=["LeftHand"], dtype=np.float64)[:, 0] * 0.0254 / 0.45
    trail = figure.trails[1].places
    np.testing.assert_allclose(trail[1:], places[1:], atol=1e-5)
    assert np.isnan(trail[0]).all(), "the T-pose in front was not walked to"


def test_unknown_frames_are_told_and_not_drawn(walk: gmr.Motion) -> None:
    figure = motion_figure(with_gap(walk, slice(10, 20)).with_unit("cmu"))
    assert not figure.known[10:20].any()
    assert figure.known[20:].all()
    assert any("10 of" in note for note in figure.notes)
    assert np.isfinite(figure.box).all()


def test_nothing_to_show_is_said(walk: gmr.Motion, cylinder: gmr.Character) -> None:
    with pytest.raises(GmrError, match="no frames"):
        motion_figure(walk[:0])
    with pytest.raises(GmrError, match="NaN"):
        motion_figure(with_gap(walk, slice(None)))
    with pytest.raises(GmrError, match="NaN"):
        posed_figure(cylinder, np.full((3, 2, 4, 4), np.nan))
    with pytest.raises(GmrError, match="no frames"):
        posed_figure(cylinder, np.zeros((0, 2, 4, 4)))
    with pytest.raises(GmrError, match=r"\(frames, 2, 4, 4\)"):
        posed_figure(cylinder, np.eye(4))
    with pytest.raises(GmrError, match="nothing to show"):
        gmr.view.save([], "never.html")


def test_gaps_in_poses_are_gaps_in_the_figure(cylinder: gmr.Character) -> None:
    poses = cylinder.animation(0)
    whole = posed_figure(cylinder, poses, 1 / 24)
    poses = poses.copy()
    poses[3:5] = np.nan
    gapped = posed_figure(cylinder, poses, 1 / 24)
    assert not gapped.known[3:5].any()
    np.testing.assert_allclose(gapped.heads[5:], whole.heads[5:], atol=1e-6)


def test_bones_of_a_posed_character_are_at_its_joints(cylinder: gmr.Character) -> None:
    poses = cylinder.animation(0)
    figure = posed_figure(cylinder)
    np.testing.assert_allclose(figure.heads[:, 0], poses[:, 0, :3, 3], atol=1e-5)
    np.testing.assert_allclose(figure.tails[:, 0], poses[:, 1, :3, 3], atol=1e-5)


@given(
    st.integers(1, 40),
    st.integers(1, 40),
    st.sampled_from([24, 30, 60, 120, 119.88]),
    st.sampled_from([25, 30, 50]),
)
def test_every_tick_shows_the_frame_that_has_begun(first: int, second: int, fps: float, other: float) -> None:
    figures = [still(first, 1 / fps), still(second, 1 / other)]
    timeline = Timeline.of(figures)
    assert timeline.step == min(1 / fps, 1 / other)
    for figure in figures:
        shown = [timeline.frame(figure, tick) for tick in range(timeline.tick_count)]
        assert shown[0] == 0
        assert (
            shown[-1] == figure.frame_count - 1 or timeline.seconds < figure.frame_count * figure.frame_time
        )
        assert all(0 <= b - a <= 2 for a, b in pairwise(shown))
        for tick, frame in enumerate(shown[:-1]):
            begins = frame * figure.frame_time
            assert begins <= tick * timeline.step + 1e-6


def test_a_page_at_a_lower_rate_has_fewer_ticks() -> None:
    figure = still(120, 1 / 120)
    assert Timeline.of([figure]).tick_count == 120
    slow = Timeline.of([figure], 30)
    assert slow.tick_count == 30
    assert [slow.frame(figure, tick) for tick in range(30)] == list(range(0, 120, 4))
    assert Timeline.of([figure], 500).tick_count == 120


def test_a_player_loops_pauses_and_ends() -> None:
    player = Player(Timeline(0.1, 10))
    assert player.advance(0.25)
    assert player.tick == 2
    player.advance(0.9)
    assert player.tick == 1
    player.go(-1)
    assert (player.tick, player.is_playing) == (9, False)
    assert not player.advance(1)
    player.loop(False)
    player.toggle()
    assert (player.tick, player.is_playing) == (0, True)
    player.run_at(2)
    player.advance(0.2)
    assert player.tick == 4
    player.advance(10)
    assert (player.tick, player.is_playing) == (9, False)


def test_figures_side_by_side_do_not_meet(figure: Figure, walk: gmr.Motion) -> None:
    figures = [figure, figure, motion_figure(walk.mirror())]
    layout = laid_out(figures)
    boxes = [(np.array(each.box[0]) + place, np.array(each.box[1]) + place)
             for each, place in zip(figures, layout.places, strict=True)]  # fmt: skip
    for k, (low, high) in enumerate(boxes):
        for other_low, other_high in boxes[k + 1 :]:
            assert ((other_low > high) | (low > other_high))[[0, 2]].any()
    assert all((place == 0).all() for place in laid_out(figures, overlay=True).places)


@pytest.mark.parametrize("count", [1, 2, 7])
def test_everything_is_in_sight_and_fills_it(figure: Figure, walk: gmr.Motion, count: int) -> None:
    layout = laid_out([figure, *[motion_figure(walk)] * (count - 1)])
    back = layout.eye - layout.centre
    back /= np.linalg.norm(back)
    right = np.cross([0, 1, 0], back)
    right /= np.linalg.norm(right)
    corners = np.array(
        [np.where(which, high, low) for low, high in layout.boxes for which in np.ndindex(2, 2, 2)]
    )
    away = corners - layout.eye
    ahead = -away @ back
    aside = np.abs(away @ right) / (1.3 * ahead)
    above = np.abs(away @ np.cross(back, right)) / ahead
    filled = np.tan(layout.field / 2)
    assert (ahead > 0).all()
    assert (np.maximum(aside, above) < filled).all()
    # What lies above the figures is kept for their names.
    assert max(aside.max(), above.max()) > 0.85 * filled


@pytest.mark.parametrize("seed", range(6))
def test_the_browser_carries_a_skin_to_where_the_kernels_do(seed: int) -> None:
    character, poses = _rigid_character(seed)
    skin = browser_skin(Worn(character, poses))
    assert skin is not None
    turns = quaternions.matrices(np.roll(skin.wxyzs, -1, axis=-1))
    moved = np.einsum("fbij,vj->fbvi", turns, skin.vertices) + skin.positions[:, :, None]
    blended = np.einsum("vb,fbvi->fvi", skin.weights, moved)
    expected = character.skin(poses)
    np.testing.assert_allclose(blended, expected, atol=2e-4 * np.abs(expected).max())


def _rigid_character(seed: int) -> tuple[gmr.Character, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]:
    """The cylinder in random rigid poses, its bind matrices scaled by a common factor."""
    from dataclasses import replace

    rng = np.random.default_rng(seed)
    cylinder = gmr.read_character(DATA / "rigged_simple.gltf")
    part = cylinder.parts[0]
    assert part.inverse_bind is not None
    factor = np.diag([*rng.uniform(0.2, 3, 1).repeat(3), 1.0])
    made = replace(cylinder, parts=(replace(part, inverse_bind=part.inverse_bind @ factor),))
    turns = rng.normal(size=(5, 2, 4))
    poses = np.tile(np.eye(4), (5, 2, 1, 1))
    poses[..., :3, :3] = quaternions.matrices(turns / np.linalg.norm(turns, axis=-1, keepdims=True))
    poses[..., :3, 3] = rng.normal(size=(5, 2, 3))
    # The rest pose of the cylinder is itself turned and scaled, each joint as the other.
    return made, poses @ cylinder.rest_pose()


def test_a_stretched_joint_is_not_left_to_the_browser(cylinder: gmr.Character) -> None:
    poses = cylinder.animation(0).copy()
    poses[2, 1, :3, :3] *= 1.5
    assert browser_skin(Worn(cylinder, poses)) is None


def test_patches_are_all_triangles_once(cylinder: gmr.Character) -> None:
    for patches in (plain_patches(cylinder), weight_patches(cylinder, cylinder.joint_names[1])):
        assert sum(len(patch.faces) for patch in patches) == len(cylinder.faces)
        vertices = cylinder.merged.vertices
        drawn = np.concatenate([vertices[patch.vertices][patch.faces] for patch in patches])
        np.testing.assert_array_equal(
            np.unique(drawn.reshape(-1, 9), axis=0),
            np.unique(vertices[cylinder.faces].reshape(-1, 9), axis=0),
        )


def test_weights_are_coloured_from_none_to_all(cylinder: gmr.Character) -> None:
    joint = cylinder.joint_names[1]
    weights = joint_weights(cylinder, joint)
    colours = [tuple(colour) for colour in level_colours().tolist()]
    levels = {colours.index(patch.colour): patch for patch in weight_patches(cylinder, joint)}
    assert len(colours) == LEVELS
    for level, patch in levels.items():
        means = weights[patch.vertices][patch.faces].mean(axis=1)
        assert (means >= level / LEVELS - 1e-6).all()
        assert (means <= (level + 1) / LEVELS + 1e-6).all()
    both = joint_weights(cylinder, cylinder.joint_names[0]) + weights
    np.testing.assert_allclose(both, 1, atol=1e-5)
    with pytest.raises(GmrError, match="no joint 'Nose'"):
        weight_patches(cylinder, "Nose")


@pytest.mark.parametrize("seed", range(8))
def test_weights_of_all_joints_sum_to_one_with_several_skins(seed: int) -> None:
    character = random_character(seed)
    total = sum(joint_weights(character, name) for name in dict.fromkeys(character.joint_names))
    if len(set(character.joint_names)) == len(character.joint_names):
        np.testing.assert_allclose(total, 1, atol=1e-4)


def test_a_motion_of_a_character_fits_it(cylinder: gmr.Character) -> None:
    motion = gmr.read(DATA / "rigged_simple.gltf")
    np.testing.assert_allclose(fitted_poses(cylinder, motion, 1.0), cylinder.animation(0), atol=1e-6)
    twice = motion.to_unit("cm")
    np.testing.assert_allclose(fitted_poses(cylinder, twice, 0.01), cylinder.animation(0), atol=1e-6)
    figure = motion_figure(motion, cylinder)
    assert figure.worn is not None


def test_what_does_not_fit_a_character_is_said(cylinder: gmr.Character, walk: gmr.Motion) -> None:
    with pytest.raises(GmrError, match="has no joint"):
        fitted_poses(cylinder, walk, 1.0)
    with pytest.raises(GmrError):
        motion_figure(walk, cylinder)
    motion = gmr.read(DATA / "rigged_simple.gltf")
    with pytest.raises(GmrError, match="from its parent"):
        fitted_poses(cylinder, motion, 2.0)


def test_a_motion_of_another_skeleton_drives_the_character(walk: gmr.Motion) -> None:
    puppet = body()
    figure = motion_figure(walk, puppet)
    driven = gmr.skinning.drive(walk.with_unit("cmu"), puppet)
    assert figure.worn is not None
    np.testing.assert_array_equal(figure.worn.poses, driven.poses)
    assert any(f"of {len(puppet.joints)} joints" in note for note in figure.notes)
    hips = figure.trails[0].places
    assert np.ptp(hips[:, [0, 2]], axis=0).max() > 1.5, "it walks"
