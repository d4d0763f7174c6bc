"""All that the glTF standard allows is read right."""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
from gltf_files import FACES, JOINTS, POINTS, WEIGHTS, Gltf, arm, turn
from gmr import Character, FormatError, FormatWarning
from random_characters import png


def primitive(file: Gltf) -> dict[str, Any]:
    found: dict[str, Any] = file.content["meshes"][0]["primitives"][0]
    return found


def attributes(file: Gltf) -> dict[str, int]:
    found: dict[str, int] = primitive(file)["attributes"]
    return found


def assert_is_arm(character: Character) -> None:
    """The vertices, faces and weights of the arm, whatever form they were in."""
    (part,) = character.parts
    assert np.array_equal(part.vertices, POINTS)
    assert np.array_equal(part.faces, FACES)
    assert np.allclose(part.weights, WEIGHTS, atol=5e-3)
    assert np.array_equal(part.joints[:, :3], JOINTS[:, :3])


def interleaved(file: Gltf) -> None:
    rows = np.zeros(6, np.dtype([("place", "<f4", 3), ("joints", "u1", 4), ("spare", "u1", 8)]))
    rows["place"], rows["joints"], rows["spare"] = POINTS, JOINTS, 99
    view = file.view(b"before" + rows.tobytes(), byteStride=24)
    file.content["bufferViews"][view]["byteOffset"] += 2
    file.content["bufferViews"][view]["byteLength"] -= 2
    attributes(file)["POSITION"] = file.accessor(view, 6, (3,), "f4", byteOffset=4)
    attributes(file)["JOINTS_0"] = file.accessor(view, 6, (4,), "u1", byteOffset=16)


def sparse(file: Gltf) -> None:
    wrong = POINTS.copy()
    wrong[[1, 4]] = 7
    index = file.array(wrong)
    file.content["accessors"][index]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": file.view(bytes([1, 4])), "componentType": 5121},
        "values": {"bufferView": file.view(POINTS[[1, 4]].tobytes())},
    }
    attributes(file)["POSITION"] = index


def sparse_without_view(file: Gltf) -> None:
    index = file.array(POINTS)
    rest = np.flatnonzero(POINTS.any(axis=1)).astype("<u2")
    file.content["accessors"][index] |= {
        "sparse": {
            "count": len(rest),
            "indices": {"bufferView": file.view(rest.tobytes()), "componentType": 5123},
            "values": {"bufferView": file.view(POINTS[rest].tobytes())},
        }
    }
    del file.content["accessors"][index]["bufferView"]
    attributes(file)["POSITION"] = index


def weights_of_bytes(file: Gltf) -> None:
    attributes(file)["WEIGHTS_0"] = file.array(np.rint(WEIGHTS * 255), "u1", normalized=True)


def weights_of_shorts_that_are_not_called_normalised(file: Gltf) -> None:
    attributes(file)["WEIGHTS_0"] = file.array(np.rint(WEIGHTS * 65535), "u2")


def wide_joints_and_corners(file: Gltf) -> None:
    attributes(file)["JOINTS_0"] = file.array(JOINTS, "u2")
    primitive(file)["indices"] = file.array(FACES.ravel(), "u4")


def narrow_corners(file: Gltf) -> None:
    primitive(file)["indices"] = file.array(FACES.ravel(), "u1")


def quantised(file: Gltf) -> None:
    attributes(file)["POSITION"] = file.array(2 * POINTS, "i2")
    file.content["extensionsUsed"] = file.content["extensionsRequired"] = ["KHR_mesh_quantization"]


FORMS = [
    interleaved,
    sparse,
    sparse_without_view,
    weights_of_bytes,
    weights_of_shorts_that_are_not_called_normalised,
    wide_joints_and_corners,
    narrow_corners,
]


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
def test_accessors_of_every_form_hold_the_same(form: Callable[[Gltf], None]) -> None:
    file = arm()
    form(file)
    assert_is_arm(gmr.read_character(file.glb()))


def test_quantised_places_are_read_as_numbers() -> None:
    file = arm()
    quantised(file)
    assert np.array_equal(gmr.read_character(file.glb()).parts[0].vertices, 2 * POINTS)


def test_buffers_and_pictures_beside_the_file(tmp_path: Path) -> None:
    file = arm()
    file.content["images"] = [{"uri": "skin%20colour.png"}]
    file.content["textures"] = [{"source": 0}]
    file.content["materials"][0]["pbrMetallicRoughness"] = {"baseColorTexture": {"index": 0}}
    (tmp_path / "arm.bin").write_bytes(file.binary)
    (tmp_path / "skin colour.png").write_bytes(png(7))
    (tmp_path / "arm.gltf").write_bytes(file.gltf("arm.bin"))
    character = gmr.read_character(tmp_path / "arm.gltf")
    assert_is_arm(character)
    assert character.textures[0].data == png(7)
    assert character.textures[0].mime_type == "image/png"
    assert character.materials[0].base_color_texture is not None


def test_a_picture_in_a_view_and_one_in_a_data_uri() -> None:
    file = arm()
    encoded = "data:image/png;base64," + base64.b64encode(png(1)).decode()
    view = file.view(png(2))
    file.content["images"] = [{"uri": encoded}, {"bufferView": view, "mimeType": "image/png"}]
    file.content["textures"] = [{"source": 0}, {"source": 1}]
    character = gmr.read_character(file.glb())
    assert [texture.data for texture in character.textures] == [png(1), png(2)]


def test_eight_influences() -> None:
    file = arm()
    half = WEIGHTS / 2
    for name in ("WEIGHTS_0", "WEIGHTS_1"):
        attributes(file)[name] = file.array(half)
    attributes(file)["JOINTS_1"] = attributes(file)["JOINTS_0"]
    part = gmr.read_character(file.glb()).parts[0]
    assert part.weights.shape == part.joints.shape == (6, 8)
    assert np.allclose(part.weights.sum(axis=1), 1)


@pytest.mark.parametrize(("mode", "corners"), [(5, [0, 1, 2, 3]), (6, [0, 1, 2, 3])])
def test_strips_and_fans_wind_as_the_standard_says(mode: int, corners: list[int]) -> None:
    file = arm()
    primitive(file).update(mode=mode, indices=file.array(corners, "u1"))
    faces = gmr.read_character(file.glb()).parts[0].faces.tolist()
    expected = {5: [[0, 1, 2], [1, 3, 2]], 6: [[1, 2, 0], [2, 3, 0]]}[mode]
    assert faces == expected


def test_without_indices_every_three_vertices_are_a_triangle() -> None:
    file = arm()
    del primitive(file)["indices"]
    assert gmr.read_character(file.glb()).parts[0].faces.tolist() == [[0, 1, 2], [3, 4, 5]]


def test_without_inverse_bind_matrices_they_are_the_identity() -> None:
    file = arm()
    del file.content["skins"][0]["inverseBindMatrices"]
    bind = gmr.read_character(file.glb()).parts[0].inverse_bind
    assert bind is not None
    assert np.array_equal(bind, np.tile(np.eye(4), (3, 1, 1)))


def test_several_skins_may_use_one_joint_with_other_matrices() -> None:
    file = arm()
    other = 2 * np.eye(4)
    other[3, 3] = 1
    file.content["skins"].append({"joints": [4, 0], "inverseBindMatrices": file.array([other, np.eye(4)])})
    file.content["nodes"].append({"mesh": 0, "skin": 1})
    file.content["scenes"][0]["nodes"].append(5)
    attributes(file)["JOINTS_0"] = file.array(np.tile([0, 1, 0, 1], (6, 1)), "u1")
    file.content["skins"][0]["joints"] = [2, 3, 4]
    character = gmr.read_character(file.glb())
    assert character.joint_names == ("upper", "lower", "hand", "holder")
    one, two = character.parts
    assert one.inverse_bind is not None
    assert two.inverse_bind is not None
    assert np.array_equal(two.inverse_bind[2], other)
    assert one.inverse_bind[2, 1, 3] == -2
    assert set(two.joints[:, 0].tolist()) == {2}
    assert character.merged.inverse_binds.shape == (2, 4, 4, 4)


def test_a_mesh_without_skin_on_a_joint_is_carried_by_it_whole() -> None:
    file = arm()
    file.content["nodes"][4]["children"] = [5]
    file.content["nodes"].append(
        {"name": "sword", "mesh": 1, "translation": [0, 0, 3], "rotation": turn(90, 0)}
    )
    bare = {"POSITION": attributes(file)["POSITION"]}
    file.content["meshes"].append({"primitives": [{"attributes": bare}]})
    character = gmr.read_character(file.glb())
    sword = character.parts[1]
    poses = character.animation(fps=3)
    assert sword.inverse_bind is not None
    local = np.eye(4)
    local[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    local[2, 3] = 3
    points = np.concatenate([POINTS, np.ones((6, 1))], axis=1)
    expected = np.einsum("fij,vj->fvi", poses[:, 2] @ local, points)
    found = np.einsum("fij,vj->fvi", poses[:, sword.joints[0, 0]] @ sword.inverse_bind[2], points)
    assert np.allclose(found, expected, atol=1e-6)
    assert (sword.weights == 1).all()


def test_a_mesh_that_nothing_carries_is_a_part_without_weights() -> None:
    file = arm()
    file.content["nodes"].append({"name": "floor", "mesh": 1})
    file.content["scenes"][0]["nodes"].append(5)
    bare = {"POSITION": attributes(file)["POSITION"]}
    file.content["meshes"].append({"name": "floor", "primitives": [{"attributes": bare}]})
    floor = gmr.read_character(file.glb()).parts[1]
    assert not floor.is_skinned
    assert floor.node == 5


def test_motion_without_a_skin_moves_the_nodes_that_are_animated_and_those_below() -> None:
    file = arm()
    for key in ("meshes", "skins", "materials"):
        del file.content[key]
    file.content["nodes"][1] = {"name": "beside"}
    motion = gmr.read(file.glb())
    assert motion.skeleton.names[:3] == ("upper", "lower", "hand")
    assert np.allclose(motion.positions(), gmr.read(arm().glb()).positions())


def steps(file: Gltf, mode: str, values: Any) -> None:
    sampler = file.content["animations"][0]["samplers"][1]
    sampler.update(interpolation=mode, output=file.array(values))


def test_steps_hold_the_value_before() -> None:
    file = arm()
    steps(file, "STEP", [[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]])
    channel = gmr.read_character(file.glb()).animations[0].channels[1]
    times = np.array([-1, 0, 0.25, 0.4999, 0.5, 0.75, 1, 1.99, 2, 9])
    assert channel.at(times)[:, 0].tolist() == [0, 0, 0, 0, 1, 1, 2, 2, 3, 3]


def test_splines_follow_the_cubic_that_their_tangents_are_of() -> None:
    # x(t) = t^3 - 2 t + 1, with x' = 3 t^2 - 2, is its own Hermite spline.
    file = arm()
    keys = np.array([0, 0.5, 1, 2])
    place, slope = keys**3 - 2 * keys + 1, 3 * keys**2 - 2
    triples = np.stack([slope, place, slope], axis=1)[..., None] * [1.0, 0, 0]
    steps(file, "CUBICSPLINE", triples.reshape(-1, 3))
    channel = gmr.read_character(file.glb()).animations[0].channels[1]
    times = np.linspace(0, 2, 50)
    assert np.allclose(channel.at(times)[:, 0], times**3 - 2 * times + 1, atol=1e-6)


def test_turns_take_the_short_arc_at_even_speed() -> None:
    file = arm()
    far = [-x for x in turn(60, 2)]
    file.content["animations"][0]["samplers"][0]["output"] = file.array([turn(0, 2), far, turn(60, 2), far])
    channel = gmr.read_character(file.glb()).animations[0].channels[0]
    found = channel.at(np.linspace(0, 0.5, 7))
    angles = 2 * np.degrees(np.arctan2(np.abs(found[:, 2]), np.abs(found[:, 3])))
    assert np.allclose(angles, np.linspace(0, 60, 7), atol=1e-4)
    assert (found[:, 2] * found[:, 3] >= 0).all()


def test_mirrored_joints_turn_as_they_do() -> None:
    file = arm()
    file.content["nodes"][0]["scale"] = [-2, 2, 2]
    motion = gmr.read(file.glb(), fps=5)
    character = gmr.read_character(file.glb())
    assert np.allclose(motion.positions()[:, :3], character.animation(fps=5)[..., :3, 3], atol=1e-5)


def test_animated_scale_is_said() -> None:
    file = arm()
    samplers, channels = (file.content["animations"][0][key] for key in ("samplers", "channels"))
    scales = file.array(np.array([[1, 1, 1], [1, 2, 1], [1, 1, 1], [1, 1, 1]]))
    samplers.append({"input": samplers[0]["input"], "output": scales})
    channels.append({"sampler": 2, "target": {"node": 3, "path": "scale"}})
    with pytest.warns(FormatWarning, match="stretches or shears joints .*'lower'"):
        motion = gmr.read(file.glb())
    poses = gmr.read_character(file.glb()).animation()
    assert np.allclose(motion.positions()[:, :3], poses[..., :3, 3], atol=1e-5)


def test_the_first_of_several_animations_is_read_and_the_others_named() -> None:
    file = arm()
    file.content["animations"].append({**file.content["animations"][0], "name": "rest"})
    with pytest.warns(FormatWarning, match="2 animations: 'wave', 'rest'; the first"):
        gmr.read(file.glb())
    assert gmr.read(file.glb(), animation="rest").frame_count > 0
    with pytest.raises(FormatError, match="no animation 'run'; there are 'wave', 'rest'"):
        gmr.read(file.glb(), animation="run")


def test_a_file_without_animation_is_a_skeleton_alone() -> None:
    file = arm()
    del file.content["animations"]
    motion = gmr.read(file.glb())
    assert motion.frame_count == 0
    assert motion.skeleton.names[:3] == ("upper", "lower", "hand")
