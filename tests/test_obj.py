"""OBJ meshes: polygons of any shape, indices of any kind, materials, and binding to a skeleton."""

from __future__ import annotations

import sys
import types
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import gmr
from gltf_files import POINTS, arm
from gmr import FormatError, FormatWarning, Skeleton
from gmr.formats.obj import read_obj
from gmr.formats.polygons import triangulated
from random_characters import png

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def faces_of(text: str) -> list[list[list[float]]]:
    """The places of the corners of each triangle."""
    (part,) = read_obj(text.encode()).parts
    found: list[list[list[float]]] = part.vertices[part.faces].tolist()
    return found


@pytest.mark.parametrize(
    "face", ["1 2 3 4", "-4 -3 -2 -1", "1// 2// 3// 4//", "1 2 \\\n 3 4", "1 2 3 4 # a comment"]
)
def test_indices_count_from_the_first_or_from_the_last(face: str) -> None:
    assert faces_of(f"{SQUARE}f {face}\n") == [
        [[0, 0, 0], [1, 0, 0], [1, 1, 0]],
        [[0, 0, 0], [1, 1, 0], [0, 1, 0]],
    ]


def test_negative_indices_count_from_where_the_face_stands() -> None:
    text = SQUARE + "f -4 -3 -2\n" + "v 9 9 9\n" + "f -5 -4 -2\n"
    assert faces_of(text)[1] == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def test_vertices_are_kept_apart_where_coordinates_or_normals_differ() -> None:
    text = SQUARE + "vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 0 1 0\nf 1/1/1 2/2/1 3/3/1\nf 1/1/2 3/3/1 4/2/1\n"
    (part,) = read_obj(text.encode()).parts
    assert len(part.vertices) == 5  # the first stands there with two normals
    assert part.texture_coordinates is not None
    assert part.normals is not None
    corner = part.faces[0]
    assert part.texture_coordinates[corner].tolist() == [[0, 1], [1, 1], [0, 0]]  # v points down
    assert part.normals[part.faces[1, 0]].tolist() == [0, 1, 0]


def test_groups_and_materials_make_parts() -> None:
    text = SQUARE + "g left\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\ng right\nf 1 2 4\ng left\nf 2 3 4\n"
    found = read_obj(text.encode())
    assert [(part.name, part.material, len(part.faces)) for part in found.parts] == [
        ("left", 0, 1),
        ("left", 1, 2),
        ("right", 1, 1),
    ]
    assert [material.name for material in found.materials] == ["a", "b"]


def test_faces_without_coordinates_do_not_take_them_from_others() -> None:
    text = SQUARE + "vt 0.5 0.5\nf 1/1 2/1 3/1\nf 1 3 4\n"
    textured, plain = read_obj(text.encode()).parts
    assert textured.texture_coordinates is not None
    assert plain.texture_coordinates is None


def test_colours_after_places_are_kept_and_a_weight_is_not_one() -> None:
    colored = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n"
    (part,) = read_obj(colored.encode()).parts
    assert part.colors is not None
    assert part.colors[:, 3].tolist() == [1, 1, 1]
    assert read_obj(b"v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").parts[0].colors is None


LIBRARY = """
newmtl skin
Kd 0.2 0.4 0.6
map_Kd -s 1 1 1 -clamp on skin colour.png
Pm 0.25
Pr 0.5
newmtl glass
Kd 0.1 0.2 0.3
d 0.5
"""


def test_materials_come_with_their_pictures(tmp_path: Path) -> None:
    (tmp_path / "body.mtl").write_text(LIBRARY)
    (tmp_path / "skin colour.png").write_bytes(png(3))
    text = "mtllib body.mtl\n" + SQUARE + "usemtl glass\nf 1 2 3\nusemtl skin\nf 1 3 4\n"
    found = read_obj(text.encode(), name=str(tmp_path / "body.obj"))
    glass, skin = found.materials
    assert glass.base_color == (0.1, 0.2, 0.3, 0.5)
    assert glass.alpha_mode == "BLEND"
    assert skin.base_color == (1, 1, 1, 1)
    assert (skin.metallic, skin.roughness) == (0.25, 0.5)
    assert skin.base_color_texture is not None
    texture = found.textures[skin.base_color_texture.texture]
    assert texture.data == png(3)
    assert (texture.mime_type, texture.name, texture.wrap_s) == ("image/png", "skin colour", 33071)


def test_several_libraries_in_a_line_and_one_with_a_blank_in_its_name(tmp_path: Path) -> None:
    for name, color in (("a.mtl", "1 0 0"), ("b.mtl", "0 1 0"), ("c d.mtl", "0 0 1")):
        (tmp_path / name).write_text(f"newmtl {name[0]}\nKd {color}\n")
    uses = "".join(f"usemtl {name}\nf 1 2 3\n" for name in "abc")
    text = f"mtllib a.mtl b.mtl\nmtllib c d.mtl\n{SQUARE}{uses}"
    found = read_obj(text.encode(), name=str(tmp_path / "a.obj"))
    assert [material.base_color[:3] for material in found.materials] == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]


def test_a_picture_from_another_machine_is_looked_for_beside(tmp_path: Path) -> None:
    (tmp_path / "a.mtl").write_text("newmtl skin\nmap_Kd C:\\work\\skin.png\n")
    (tmp_path / "skin.png").write_bytes(png(3))
    text = "mtllib a.mtl\n" + SQUARE + "usemtl skin\nf 1 2 3\n"
    assert len(read_obj(text.encode(), name=str(tmp_path / "a.obj")).textures) == 1


@pytest.mark.parametrize("missing", ["a.mtl", "skin.png"])
def test_what_is_missing_beside_is_said(tmp_path: Path, missing: str) -> None:
    (tmp_path / "a.mtl").write_text("newmtl skin\nmap_Kd skin.png\n")
    (tmp_path / "skin.png").write_bytes(png(3))
    (tmp_path / missing).unlink()
    text = "mtllib a.mtl\n" + SQUARE + "usemtl skin\nf 1 2 3\n"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        read_obj(text.encode(), name=str(tmp_path / "a.obj"))
    assert any(missing in str(warning.message) for warning in caught)
    with pytest.raises(FormatError, match=missing):
        read_obj(text.encode(), name=str(tmp_path / "a.obj"), strict=True)


REFUSED = [
    ("f 1 2 9\n", ":5: a corner has the index 9, but there are 4 vertices"),
    ("f 1 2 -5\n", ":5: '-5': -5 is no line"),
    ("f 0 1 2\n", ":5: '0': 0 is no line"),
    ("f 1 2\n", ":5: a face has 2 corners"),
    ("f 1/2 2/1 3/1\n", ":5: a corner has the index 2, but there are 0 coordinates"),
    ("f a b c\n", ":5: 'a' is no corner"),
    ("f 1/1/1/1 2 3\n", ":5: '1/1/1/1' is no corner"),
    (f"f 1 2 {10**30}\n", ":5: .* is no line"),
    ("v 1 2\n", ":5: 2 numbers where 3 are needed"),
    ("v 1 2 x\n", ":5: '1 2 x' are not all numbers"),
    ("v 1 2 nan\n", ":5: '1 2 nan': numbers must be finite"),
    ("v 1 2 1e400\n", ":5: .*: numbers must be finite"),
    ("", "there is no face"),
]


@pytest.mark.parametrize(("line", "said"), REFUSED)
def test_what_is_wrong_is_refused_with_its_line(line: str, said: str) -> None:
    with pytest.raises(FormatError, match=said):
        read_obj((SQUARE + line).encode(), name="a.obj")


def test_lines_and_surfaces_are_left_out_with_a_warning() -> None:
    with pytest.warns(FormatWarning, match="left out: 'l', 'curv'"):
        read_obj((SQUARE + "l 1 2\ncurv 0 1 1 2\nf 1 2 3\n").encode())


def test_triangles_without_area_are_kept_with_a_warning() -> None:
    with pytest.warns(FormatWarning, match="1 triangles have two corners that are one vertex"):
        (part,) = read_obj((SQUARE + "f 1 2 2\nf 1 2 3\n").encode()).parts
    assert len(part.faces) == 2


@given(
    st.binary(max_size=200), st.lists(st.sampled_from(["v", "f", "1", "-1", "/", "\n", " ", "vt", "\\", "e"]))
)
def test_any_text_is_refused_or_read(data: bytes, words: list[str]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        for text in (data, SQUARE.encode() + "".join(words).encode()):
            try:
                read_obj(text, name="a.obj")
            except FormatError as error:
                assert str(error).startswith("a.obj")  # noqa: PT017


def areas(points: Any, normal: Any) -> Any:
    """(T,) signed areas of triangles."""
    return np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]) @ normal / 2


@given(st.integers(4, 40), st.integers(0, 2**32))
def test_a_concave_polygon_becomes_triangles_that_fill_it(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    steps = rng.random(count) + 0.05
    angles = 2 * np.pi * np.cumsum(steps) / steps.sum()
    if np.diff(np.append(angles, angles[0] + 2 * np.pi)).max() >= np.pi:
        return  # the middle must see all corners for the area below
    reach = rng.uniform(0.2, 1, count)
    flat = np.stack([reach * np.cos(angles), reach * np.sin(angles), np.zeros(count)], axis=1)
    turn = Rotation.random(rng=rng)
    points = turn.apply(flat) + rng.normal(size=3)
    faces = triangulated(np.arange(count, dtype=np.int32), np.array([count]), points)
    found = areas(points[faces], turn.apply([0, 0, 1]))
    whole = (reach * np.roll(reach, -1) * np.sin(np.diff(np.append(angles, angles[0] + 2 * np.pi)))).sum() / 2
    assert faces.shape == (count - 2, 3)
    assert (found > -1e-9).all()
    assert np.isclose(found.sum(), whole)


def test_a_comb_is_cut_right() -> None:
    teeth = [[x, 0 if x % 2 else 3, 0] for x in range(20)]
    points = np.array([[-1, -1, 0], [20, -1, 0], *teeth[::-1]], float)
    count = len(points)
    faces = triangulated(np.arange(count, dtype=np.int32), np.array([count]), points)
    found = areas(points[faces], np.array([0, 0, 1]))
    around = np.roll(points, -1, axis=0)
    whole = (points[:, 0] * around[:, 1] - points[:, 1] * around[:, 0]).sum() / 2
    assert (found >= -1e-12).all()
    assert np.isclose(found.sum(), whole)


def test_a_concave_polygon_of_too_many_corners_is_refused_with_its_line() -> None:
    x = np.arange(1000)
    places = [f"v {k} {3 * (k % 2)} 0" for k in x] + ["v 500 -9 0"]
    text = "\n".join(places) + "\nf " + " ".join(str(k + 1) for k in range(1001)) + "\n"
    with pytest.raises(FormatError, match=r":1002: a concave polygon has 1,001 corners"):
        read_obj(text.encode(), name="a.obj")


@pytest.fixture
def nearest_joint(monkeypatch: pytest.MonkeyPatch) -> None:
    """The simplest binding: each vertex goes with the two joints nearest to it."""

    def bind(vertices: Any, faces: Any, skeleton: Skeleton) -> Any:
        places = np.zeros((skeleton.joint_count, 3))
        for joint in skeleton.parents_first:
            parent = skeleton.parents[joint]
            places[joint] = skeleton.offsets[joint] + (places[parent] if parent >= 0 else 0)
        apart = np.linalg.norm(vertices[:, None] - places, axis=2)
        joints = np.argsort(apart, axis=1, kind="stable")[:, :2].astype(np.int32)
        weights = 1 / (0.1 + np.take_along_axis(apart, joints, axis=1))
        return (weights / weights.sum(axis=1, keepdims=True)).astype(np.float32), joints

    module: Any = types.ModuleType("gmr.skinning.binding")
    module.bind = bind
    monkeypatch.setitem(sys.modules, "gmr.skinning.binding", module)


@pytest.mark.usefixtures("nearest_joint")
def test_an_obj_is_bound_to_a_skeleton_and_stands_still_at_rest(tmp_path: Path, walk_path: Path) -> None:
    skeleton = gmr.read(walk_path).skeleton
    (tmp_path / "a.obj").write_text(SQUARE + "g one\nf 1 2 3\ng two\nf 1 3 4\n")
    character = gmr.read_character(tmp_path / "a.obj", skeleton=skeleton)
    assert character.joint_names == skeleton.names
    assert [part.name for part in character.parts] == ["one", "two"]
    merged = character.merged
    transforms = character.rest_pose() @ merged.inverse_binds[0]
    # The matrices are rounded to what a .glb holds.
    assert np.allclose(transforms, np.eye(4), atol=1e-5)
    assert np.allclose(merged.weights.sum(axis=1), 1)
    assert np.array_equal(
        gmr.read_character(tmp_path / "a.obj", gmr.read(walk_path)).merged.joints, merged.joints
    )


@pytest.mark.usefixtures("nearest_joint")
def test_a_bound_obj_is_written_and_comes_back(tmp_path: Path, walk_path: Path) -> None:
    (tmp_path / "a.obj").write_text(SQUARE + "g one\nf 1 2 3\ng two\nf 1 3 4\n")
    character = gmr.read_character(tmp_path / "a.obj", gmr.read(walk_path))
    gmr.write_character(character, tmp_path / "a.glb", np.tile(character.rest_pose(), (2, 1, 1, 1)), 0.1)
    again = gmr.read_character(tmp_path / "a.glb")
    assert again.joint_names == character.joint_names
    assert np.array_equal(again.merged.vertices, character.merged.vertices)
    assert np.array_equal(again.merged.weights[:, :2], character.merged.weights)
    assert np.array_equal(again.merged.inverse_binds, character.merged.inverse_binds)


@pytest.mark.usefixtures("nearest_joint")
def test_a_gltf_without_skin_is_bound_where_its_nodes_put_it(walk_path: Path) -> None:
    file = arm()
    del file.content["skins"], file.content["animations"]
    del file.content["nodes"][1]["skin"]
    character = gmr.read_character(file.glb(), gmr.read(walk_path))
    expected = 2 * Rotation.from_euler("x", -90, degrees=True).apply(POINTS + 5)
    assert np.allclose(character.parts[0].vertices, expected, atol=1e-5)


def test_an_obj_needs_a_skeleton_and_a_skinned_file_none(tmp_path: Path, walk_path: Path) -> None:
    (tmp_path / "a.obj").write_text(SQUARE + "f 1 2 3\n")
    with pytest.raises(FormatError, match="skeleton="):
        gmr.read_character(tmp_path / "a.obj")
    with pytest.raises(FormatError, match="a skin of its own"):
        gmr.read_character(arm().glb(), gmr.read(walk_path))
    with pytest.raises(FormatError, match=r"the suffix '.bvh' is none"):
        gmr.read_character(walk_path)
