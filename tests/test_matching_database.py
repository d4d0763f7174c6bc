"""The database: features that do not depend on the world, copies that are mirror images, honest notes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import gmr
from gmr.demo import demo_folder
from gmr.errors import DatasetError
from gmr.matching import LOCOMOTION, Database, Group, Schema
from gmr.matching.prepare import in_metres_upright
from gmr.motion import Motion
from gmr.quaternions import multiply
from gmr.skeleton import Skeleton
from walkers import CMU, body, placed, walker

WALKS = [walker(3.0, 1.2, 0.4, name="curve"), walker(2.0, 2.5, -0.2, heading=2.0, swing=0.8, name="run")]

SHORT = Schema(
    (
        Group("left toe position", "position", "left_toe"),
        Group("head velocity", "velocity", "Head", times=(-0.05, 0.0), weight=2.0),
        Group("trajectory position", "root_position", times=(-0.1, 0.1)),
        Group("trajectory facing", "root_facing", times=(0.1,), weight=0.5),
    )
)
"""Features of other joints, at other times, for clips of half a second."""


def test_rows_are_the_frames_of_all_clips_at_60_hz() -> None:
    database = Database.build([walker(2.0, fps=30), walker(1.5, fps=120, name="second")])
    assert database.rate == 60
    assert database.clip_names == ("motion 1", "second")
    assert [int((database.clips == clip).sum()) for clip in (0, 1)] == [121, 91]
    np.testing.assert_array_equal(database.frames, [*range(121), *range(91)])
    np.testing.assert_allclose(database.seconds[121:], np.arange(91) / 60)
    assert database.clip_rows("second") == slice(121, 212)
    assert len(database) == 212
    assert database.features.shape == (212, 27)
    assert database.features.dtype == np.float32


def test_a_motion_that_is_there_twice_counts_once() -> None:
    walk, run = WALKS
    clips = {"a": walk, "b": run, "a again": replace(walk, name="another")}
    database = Database.build(clips, mirror=True)
    once = Database.build({"a": walk, "b": run}, mirror=True)
    assert database.duplicates == {"a again": "a"}
    assert database.clip_names == once.clip_names == ("a", "a (mirrored)", "b", "b (mirrored)")
    assert database.features.tobytes() == once.features.tobytes()
    told = "'a again' holds the same motion as 'a' and was left out: every motion counts once."
    assert database.notes[0] == told
    assert not database.excluded
    assert not once.duplicates


@pytest.mark.parametrize("again", ["said unit", "elsewhere", "half the rate", "few digits", "mirrored"])
def test_a_motion_is_known_again_however_its_file_has_it(again: str) -> None:
    walk = walker(3.0, 1.2, 0.4, fps=120)
    files = {
        "said unit": walk.to_unit("cm"),
        "elsewhere": placed(walk, 2.0, (3.0, -1.0)),
        "half the rate": walk[::2],
        "few digits": Motion.from_pose(
            walk.skeleton,
            walk.rotations.round(6),
            walk.translations.round(6),
            walk.frame_time,
            unit=walk.unit,
        ),
        "mirrored": walk.mirror(),
    }
    once, mirror = {"walk": walk, "run": WALKS[1]}, again == "mirrored"
    database = Database.build({"again": files[again], **once}, mirror=mirror)
    assert database.duplicates == {"again": "walk (mirrored)" if mirror else "walk"}
    alone = Database.build(once, mirror=mirror)
    assert database.features.tobytes() == alone.features.tobytes()


def test_a_take_is_known_again_without_the_pose_that_a_converter_put_before_it(data: Path) -> None:
    take = gmr.read(data / "cmu_07_01.bvh")
    takes = {"take": take, "without": take[1:], "mirrored": take[1:].mirror()}
    database = Database.build(takes, mirror=True, schema=SHORT)
    assert database.duplicates == {"without": "take", "mirrored": "take (mirrored)"}
    assert database.clip_names == ("take", "take (mirrored)")


@pytest.mark.parametrize("joint", range(len(WALKS[0].skeleton.names)))
def test_a_bone_that_is_turned_otherwise_makes_another_motion(joint: int) -> None:
    walk = WALKS[0]
    slot = int(walk.skeleton.slots[joint])
    if slot < 0:
        pytest.skip("nothing turns with this joint")
    along = walk.rotations.copy()
    for frame, angle in enumerate(np.radians(20) * np.sin(np.linspace(0, 6, walk.frame_count))):
        along[frame, slot] = _turned_by(along[frame, slot], float(angle))
    other = Motion.from_pose(walk.skeleton, along, walk.translations, walk.frame_time, unit=walk.unit)
    assert not Database.build({"a": walk, "b": other}).duplicates


def test_hands_and_head_that_nothing_hangs_on_are_looked_at() -> None:
    ends = replace(WALKS[0].skeleton, ends=np.zeros_like(WALKS[0].skeleton.ends))
    leaf = int(np.flatnonzero(~np.isin(np.arange(len(ends.names)), ends.parents) & (ends.slots >= 0))[0])
    nod = WALKS[0].rotations.copy()
    nod[:, ends.slots[leaf]] = multiply(nod[:, ends.slots[leaf]], np.array([0.0, 0.1, 0.0, np.sqrt(0.99)]))
    clips = {
        name: Motion.from_pose(ends, rotations, WALKS[0].translations, WALKS[0].frame_time, unit=1.0)
        for name, rotations in (("a", WALKS[0].rotations), ("b", nod))
    }
    assert not Database.build(clips).duplicates


def test_of_files_of_one_motion_the_one_with_the_highest_rate_stays() -> None:
    walk = walker(3.0, 1.2, 0.4, fps=120)
    clips = {"a": walk[::2], "the whole take": walk, "again the whole take": walk}
    assert Database.build(clips).duplicates == dict.fromkeys(("a", "again the whole take"), "the whole take")


def test_motions_that_differ_by_a_millimetre_or_a_frame_are_two() -> None:
    walk = walker(3.0, 1.2, 0.4)
    nod = walk.rotations.copy()
    nod[100, 1] = _turned_by(nod[100, 1], 0.005)
    other = Motion.from_pose(walk.skeleton, nod, walk.translations, walk.frame_time, unit=walk.unit)
    later = walk[1:]
    assert not Database.build({"a": walk[:-1], "b": other[:-1], "c": later}).duplicates


def _turned_by(rotation: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    about_x = np.array([np.sin(angle / 2), 0.0, 0.0, np.cos(angle / 2)])
    return np.asarray(multiply(rotation, about_x))


def test_a_motion_with_other_tags_or_another_rate_is_another_clip() -> None:
    walk = WALKS[0]
    frames = np.arange(walk.frame_count) % 2
    fast = replace(walk, frame_time=0.01)
    clips = {"a": walk, "tagged": walk, "by frame": walk, "again": walk, "fast": fast}
    database = Database.build(clips, tags={"tagged": 1, "by frame": frames, "again": frames.astype(np.uint8)})
    assert database.duplicates == {"by frame": "again"}
    assert database.clip_names == ("a", "tagged", "again", "fast")


def test_a_duplicate_of_a_clip_that_is_left_out_is_left_out_for_the_same_reason() -> None:
    walk = WALKS[1]
    places = walk.translations.copy()
    places[60:] += 3.0
    jumping = Motion.from_pose(walk.skeleton, walk.rotations, places, walk.frame_time, unit=walk.unit)
    database = Database.build({"a": WALKS[0], "b": jumping, "c": jumping})
    assert set(database.excluded) == {"b", "c"}
    assert database.excluded["b"] == database.excluded["c"]
    assert database.excluded["b"].startswith("its hips jump")
    assert not database.duplicates
    assert not any("same motion" in note for note in database.notes)


def test_frames_without_their_whole_future_are_no_candidates() -> None:
    database = Database.build(WALKS)
    for clip in (0, 1):
        rows = database.clip_rows(clip)
        ahead = rows.stop - np.arange(rows.start, rows.stop) - 1
        np.testing.assert_array_equal(database.candidates[rows], ahead >= 60)


@given(st.floats(-7, 7), st.floats(-30, 30), st.floats(-30, 30))
def test_turning_and_moving_the_world_leaves_features_unchanged(turn: float, x: float, z: float) -> None:
    here = Database.build(WALKS)
    there = Database.build([placed(walk, turn, (x, z)) for walk in WALKS], normalization=here.normalization)
    np.testing.assert_allclose(there.features, here.features, atol=5e-3)
    np.testing.assert_allclose(there.positions, here.positions, atol=2e-5)


def test_features_are_what_the_schema_says() -> None:
    walk = walker(3.0, 1.2, 0.4)
    database = Database.build([walk])
    raw = database.features * database.normalization.scale + database.normalization.offset
    columns = {name: raw[:, part] for name, part in LOCOMOTION.slices().items()}
    roots = database.joints
    np.testing.assert_allclose(
        columns["left foot position"], database.positions[:, roots["left_foot"]], atol=1e-4
    )
    np.testing.assert_allclose(columns["hips velocity"], np.tile([0, 0, 1.2], (181, 1)), atol=0.01)
    ahead = np.array([20, 40, 60]) / 60
    chord = 1.2 * ahead * np.sinc(0.2 * ahead / np.pi)
    expected = np.stack([chord * np.sin(0.2 * ahead), chord * np.cos(0.2 * ahead)], axis=1).ravel()
    np.testing.assert_allclose(columns["trajectory position"][5:100], np.tile(expected, (95, 1)), atol=0.01)
    facing = np.stack([np.sin(0.4 * ahead), np.cos(0.4 * ahead)], axis=1).ravel()
    np.testing.assert_allclose(columns["trajectory facing"][:120], np.tile(facing, (120, 1)), atol=1e-3)
    foot = walk.positions(dtype=np.float64)[:, roots["right_foot"]]
    speed = np.linalg.norm(np.gradient(foot, 1 / 60, axis=0), axis=1)
    np.testing.assert_allclose(np.linalg.norm(columns["right foot velocity"], axis=1), speed, atol=1e-3)
    np.testing.assert_array_equal(database.is_trajectory, [False] * 15 + [True] * 12)
    np.testing.assert_allclose(database.normalize(raw), database.features, atol=1e-5)


def test_groups_of_candidates_have_their_weight_as_mean_standard_deviation() -> None:
    database = Database.build(WALKS)
    for group in LOCOMOTION.groups:
        columns = database.features[database.candidates, LOCOMOTION.slices()[group.name]]
        assert columns.std(axis=0, dtype=np.float64).mean() == pytest.approx(group.weight, rel=1e-4)
        np.testing.assert_allclose(columns.mean(axis=0, dtype=np.float64), 0, atol=1e-4)


def mirrored_features(features: NDArray[np.float32]) -> NDArray[np.float32]:
    """Raw default features seen in a mirror: left for right, x turned round."""
    feet, hips, ahead = features[:, :12], features[:, 12:15], features[:, 15:]
    swapped = feet.reshape(-1, 2, 2, 3)[:, :, ::-1] * [-1, 1, 1]
    turned = ahead.reshape(-1, 6, 2) * [-1, 1]
    parts = (swapped.reshape(-1, 12), hips * [-1, 1, 1], turned.reshape(-1, 12))
    return np.concatenate(parts, axis=1).astype(np.float32)


def test_the_features_of_a_mirrored_clip_are_the_mirrored_features() -> None:
    database = Database.build(WALKS, mirror=True)
    assert database.clip_names == ("curve", "curve (mirrored)", "run", "run (mirrored)")
    np.testing.assert_array_equal(database.mirrored, [False, True, False, True])
    raw = database.features * database.normalization.scale + database.normalization.offset
    for clip in ("curve", "run"):
        original, image = database.clip_rows(clip), database.clip_rows(f"{clip} (mirrored)")
        np.testing.assert_allclose(raw[image], mirrored_features(raw[original]), atol=1e-4)
        np.testing.assert_allclose(database.turns[image], -database.turns[original], atol=1e-7)


def test_search_finds_rows_by_their_features() -> None:
    database = Database.build(WALKS, mirror=True)
    rows = np.flatnonzero(database.candidates)[::7]
    costs, found = database.search(database.features[rows])
    np.testing.assert_array_equal(found[:, 0], rows)
    np.testing.assert_array_equal(costs, 0)
    query = database.features[200] + 0.3
    costs, found = database.search(query, k=5)
    distances = ((database.features.astype(np.float64) - query) ** 2).sum(axis=1)
    distances[~database.candidates] = np.inf
    np.testing.assert_array_equal(found[0], np.argsort(distances, kind="stable")[:5])
    np.testing.assert_allclose(costs[0], np.sort(distances)[:5], rtol=1e-5)
    with pytest.raises(ValueError, match="queries are of 3 numbers; this index is of 27"):
        database.search(np.zeros(3))


def test_tags_of_the_file_are_those_of_the_nearest_rows() -> None:
    walk = walker(2.0, fps=30, name="walk")
    bits = (np.arange(61) >= 30).astype(np.uint32) * 4
    database = Database.build([walk, walker(2.0, name="run")], tags={"walk": bits, "run": 1}, mirror=True)
    at = np.round(np.arange(121) / 2).astype(int)
    np.testing.assert_array_equal(database.tags[database.clip_rows("walk")], bits[at])
    np.testing.assert_array_equal(database.tags[database.clip_rows("walk (mirrored)")], bits[at])
    np.testing.assert_array_equal(database.tags[database.clip_rows("run")], 1)
    _, found = database.search(database.features[:50], tags=1)
    assert set(database.clips[found.ravel()].tolist()) <= {2, 3}
    with pytest.raises(DatasetError, match="no clip has this name"):
        Database.build([walk], tags={"wlak": 1})
    with pytest.raises(DatasetError, match="61 frames"):
        Database.build([walk], tags={"walk": [1, 2]})


def test_clips_in_other_units_and_with_other_axes_up_give_the_same_rows() -> None:
    plain = Database.build([walker(2.0, name="walk")])
    centimetres = Database.build([walker(2.0, scale=100.0, unit=None, name="walk")])
    np.testing.assert_allclose(centimetres.positions, plain.positions, atol=1e-5)
    assert any("0.01 m (cm)" in note for note in centimetres.notes)
    cmu = walker(2.0, scale=0.45 / 0.0254, unit=None, name="walk")
    assert any("CMU's 0.45 inch scale" in note for note in Database.build([cmu]).notes)
    for up in ("+Z", "-Z", "-Y", "+X", "-X"):
        laid = laid_down(walker(2.0, name="walk"), up)
        database = Database.build([laid])
        np.testing.assert_allclose(database.positions, plain.positions, atol=2e-5)
        assert any(f"{up} up" in note for note in database.notes)
    assert not any("nit" in note or "up" in note for note in plain.notes if "vary" not in note)


def laid_down(motion: Motion, up: str) -> Motion:
    """The motion in a world in which the axis ``up`` is up."""
    from gmr.body.measures import UP_TURNS
    from gmr.quaternions import conjugate, matrices, multiply

    down = conjugate(np.array(UP_TURNS[up]))
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    rotations[:, 0] = multiply(down, rotations[:, 0])
    return Motion.from_pose(
        motion.skeleton, rotations, translations @ matrices(down).T, motion.frame_time, unit=motion.unit,
        name=motion.name,
    )  # fmt: skip


def test_bodies_of_other_sizes_share_a_database_and_keep_their_bones() -> None:
    tall = walker(2.0, scale=1.1, name="tall")
    database = Database.build([walker(2.0, name="usual"), replace(tall, unit=1.0)])
    bones = [database.core.offsets(row) for row in (0, 121)]
    np.testing.assert_allclose(bones[1], bones[0] * 1.1, rtol=1e-6)


def test_a_body_that_floats_is_put_on_the_ground() -> None:
    walk = walker(2.0, name="walk")
    lifted = walk.translations + np.array([0.0, 0.7, 0.0])
    floating = Motion.from_pose(walk.skeleton, walk.rotations, lifted, walk.frame_time, unit=1.0, name="walk")
    database = Database.build([floating])
    assert abs(np.quantile(database.positions[:, :, 1].min(axis=1), 0.1)) < 0.05
    assert any("moved to have it at 0" in note for note in database.notes)


def test_a_clip_with_another_skeleton_is_left_out_by_name() -> None:
    odd = walker(2.0, names=CMU | {"head": "Kopf"}, name="odd.bvh")
    database = Database.build([*WALKS, odd])
    assert database.clip_names == ("curve", "run")
    assert "without 'Head' and with 'Kopf' besides" in database.excluded["odd.bvh"]
    assert any(
        "2 of 3 clips have the one" in note and "a folder of their own" in note for note in database.notes
    )
    with pytest.raises(DatasetError, match=r"2 different skeletons \('usual'; 'odd.bvh'\)"):
        Database.build([walker(2.0, name="usual"), odd])


def test_broken_clips_are_left_out_and_the_others_stay() -> None:
    walk = WALKS[0]
    torn = walk.translations.copy()
    torn[90:, 0, 0] += 4.0
    holes = walk.translations.copy()
    holes[7] = np.nan

    def made_of(translations: NDArray[np.float64], name: str, frame_time: float = 1 / 60) -> Motion:
        return Motion.from_pose(walk.skeleton, walk.rotations, translations, frame_time, unit=1.0, name=name)

    clips = [made_of(torn, "torn"), made_of(holes, "holes"), walk[:1].with_name("pose")]
    database = Database.build([*clips, made_of(walk.translations, "timeless", 0.0), walk], mirror=True)
    assert database.clip_names == ("curve", "curve (mirrored)")
    assert "its hips jump 4.01 m within a frame, 1.48 s after its beginning" in database.excluded["torn"]
    assert "not finite" in database.excluded["holes"]
    assert "frame time is 0" in database.excluded["timeless"]
    assert set(database.excluded) == {"torn", "holes", "timeless", "pose"}
    with pytest.raises(DatasetError, match="'holes': it holds numbers that are not finite"):
        Database.build([made_of(holes, "holes")])


def test_clips_shorter_than_the_horizon_are_refused_when_there_is_no_other() -> None:
    with pytest.raises(DatasetError, match=r"'blink', lasts 0\.50 s"):
        Database.build([walker(0.5, name="blink")])
    exactly = Database.build([walker(1.0)])
    assert exactly.candidates.sum() == 1
    with pytest.raises(DatasetError, match="no motion at all"):
        Database.build([])
    with pytest.raises(DatasetError, match=r"put this one into a list"):
        Database.build(WALKS[0])  # type: ignore[arg-type]


def test_a_body_that_stands_still_is_said_not_to_vary() -> None:
    database = Database.build([walker(2.0, 0.0, swing=0.0)])
    assert np.isfinite(database.features).all()
    assert sum("does not vary in this dataset" in note for note in database.notes) == 7


def test_a_normalization_can_be_that_of_another_database() -> None:
    whole = Database.build(WALKS)
    part = Database.build(WALKS[1:], normalization=whole.normalization)
    np.testing.assert_allclose(part.features, whole.features[whole.clip_rows(1)], atol=1e-5)


def test_a_clip_without_a_name_of_its_own_gets_one() -> None:
    database = Database.build([walker(2.0), WALKS[0], WALKS[1].with_name("curve")])
    assert database.clip_names == ("motion 1", "curve", "curve (2)")


def test_a_schema_is_data(data: Path) -> None:
    motion = gmr.read(data / "cmu_07_01.bvh")
    database = Database.build([motion], schema=SHORT)
    assert SHORT.dims == 15
    assert database.features.shape[1] == 15
    assert SHORT.columns[:4] == (
        "left toe position x", "left toe position y", "left toe position z", "head velocity -0.050 s x",
    )  # fmt: skip
    np.testing.assert_array_equal(np.flatnonzero(database.candidates), np.arange(6, len(database) - 6))
    with pytest.raises(DatasetError, match="use one of position, velocity"):
        Group("speed", "speed")  # type: ignore[arg-type]
    with pytest.raises(DatasetError, match="needs a joint"):
        Group("foot", "position")
    with pytest.raises(DatasetError, match="takes no joint"):
        Group("root", "root_position", "Hips")
    with pytest.raises(gmr.SkeletonError, match="no joint 'Tail'"):
        Database.build([motion], schema=Schema((Group("tail", "velocity", "Tail"),)))
    with pytest.raises(DatasetError, match="weight of feature group 'x'"):
        Database.build([motion], schema=Schema((Group("x", "velocity", "Head", weight=-1.0),)))


def test_a_real_walk_has_the_figures_it_should_have(data: Path) -> None:
    """CMU 07_01 walks at 1.37 m/s on the whole; measured here over the half second that the project ships."""
    database = Database.build([gmr.read(data / "cmu_07_01.bvh")], schema=SHORT, mirror=True)
    assert len(database) == 60
    assert any("T-pose" in note for note in database.notes)
    assert any("0.0564444 m" in note for note in database.notes)
    assert database.seconds[0] == pytest.approx(1 / 120, rel=1e-3)
    speed = np.hypot(*database.displacements.T) * 60
    assert speed.mean() == pytest.approx(1.37, abs=0.1)
    assert database.displacements[:, 1].min() > 0, "it walks forward"
    assert database.positions[:, database.joints["head"], 1].mean() == pytest.approx(1.4, abs=0.1)


def test_a_joint_that_only_some_clips_translate_is_at_its_offset_in_the_others() -> None:
    walk = walker(2.0, name="walk")
    spine = walk.skeleton.index("Spine")
    moved = np.concatenate([walk.translations, np.tile([0.0, 0.3, 0.0], (walk.frame_count, 1, 1))], axis=1)
    sliding = Motion.from_pose(
        walk.skeleton, walk.rotations, moved, walk.frame_time, translated=[0, spine], unit=1.0, name="sliding"
    )
    database = Database.build([walk, sliding], mirror=True)
    for clip, height in (("walk", 0.25), ("sliding", 0.3), ("sliding (mirrored)", 0.3)):
        spines = database.core.translations[database.clip_rows(clip), 1]
        np.testing.assert_allclose(spines, np.broadcast_to([0.0, height, 0.0], spines.shape), atol=1e-6)


def test_arrays_are_read_only_and_outlive_the_database() -> None:
    features = Database.build(WALKS).features
    assert np.isfinite(features).all()
    with pytest.raises(ValueError, match="read-only"):
        features[0, 0] = 1.0


def test_a_torso_is_refused_before_anything_is_measured() -> None:
    skeleton = body()
    kept = [skeleton.index(name) for name in ("Hips", "Spine", "Head", "LeftArm", "RightArm")]
    torso = Skeleton.post_rotation(
        [skeleton.names[joint] for joint in kept], [-1, 0, 1, 1, 1], skeleton.offsets[kept]
    )
    rest = np.tile([0.0, 0.0, 0.0, 1.0], (90, torso.slot_count, 1))
    motion = Motion.from_pose(torso, rest, np.zeros((90, 1, 3)), 1 / 60)
    with pytest.raises(DatasetError, match="no joint that is known as left up leg"):
        Database.build([motion])


def test_the_configuration_of_a_clip_does_not_matter() -> None:
    clip = gmr.read(demo_folder() / "07_01.bvh")
    moved = clip.with_roots(["LeftFoot", "Head"])
    one, other = (gmr.matching.Database.build([motion]) for motion in (clip, moved))
    np.testing.assert_array_equal(one.features, other.features)


def test_a_schema_weighed_anew_scales_just_the_groups_that_are_named() -> None:
    clip = walker(3, 1.2)
    plain = Database.build([clip])
    weighed = Database.build([clip], schema=LOCOMOTION.weighed({"foot velocity": 3.0}))
    for name, columns in LOCOMOTION.slices().items():
        factor = 3.0 if name.endswith("foot velocity") else 1.0
        np.testing.assert_allclose(
            weighed.features[:, columns], factor * plain.features[:, columns], rtol=1e-5, atol=1e-5
        )
    assert LOCOMOTION.weighed({group.name: group.weight for group in LOCOMOTION.groups}) == LOCOMOTION
    for weights, says in (
        ({"hips": 1.0}, "no feature group is called"),
        ({"hips velocity": -1.0}, "0 or more"),
    ):
        with pytest.raises(gmr.DatasetError, match=says):
            LOCOMOTION.weighed(weights)


def test_notes_speak_of_no_clip_that_is_left_out(data: Path) -> None:
    walk = gmr.read(data / "cmu_07_01.bvh")
    side = in_metres_upright(walk, 0.0254 / 0.45, "+X")
    database = Database.build({"walk.bvh": walk, "half.bvh": walk[:-1], "side.bvh": side}, schema=SHORT)
    assert "shows no facing" in database.excluded["side.bvh"]
    assert "side.bvh" not in str(database.notes)
    assert "used as they are" not in str(database.notes)
    assert any(note.startswith("2 of 2 clips begin with a T-pose") for note in database.notes)


def test_the_t_pose_of_one_clip_is_told_of_one(data: Path) -> None:
    walk = gmr.read(data / "cmu_07_01.bvh")
    alone, first = (
        Database.build(clips, schema=SHORT)
        for clips in ({"a.bvh": walk}, {"a.bvh": walk, "b.bvh": walk[1:-1]})
    )
    assert any(note.startswith("The one clip begins with a T-pose") for note in alone.notes)
    assert any(note.startswith("1 of 2 clips begins with a T-pose") for note in first.notes)
