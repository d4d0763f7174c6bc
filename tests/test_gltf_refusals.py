"""glTF files that are wrong: refused, or read with a warning, in a sentence that says where."""

from __future__ import annotations

import json
import struct
import tracemalloc
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
from gltf_files import JOINTS, POINTS, WEIGHTS, Gltf, arm
from gmr import Character, FormatError, FormatWarning, MissingExtraError
from test_gltf_quirks import attributes, primitive, sparse_without_view


def change(*path: Any, to: Any) -> Callable[[Gltf], None]:
    """A test's file with another value at a place of its JSON."""

    def changed(file: Gltf) -> None:
        place: Any = file.content
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = to

    return changed


def points(at: int, value: float) -> Callable[[Gltf], None]:
    def changed(file: Gltf) -> None:
        wrong = POINTS.copy()
        wrong[at, 1] = value
        attributes(file)["POSITION"] = file.array(wrong)

    return changed


def weights(rows: Any) -> Callable[[Gltf], None]:
    def changed(file: Gltf) -> None:
        attributes(file)["WEIGHTS_0"] = file.array(np.where(np.isnan(rows), WEIGHTS, rows))

    return changed


def joint_out_of_range(file: Gltf) -> None:
    attributes(file)["JOINTS_0"] = file.array(JOINTS + np.array([0, 0, 5, 0]), "u1")


def corner_out_of_range(file: Gltf) -> None:
    primitive(file)["indices"] = file.array([0, 1, 6], "u2")


def times_that_go_back(file: Gltf) -> None:
    file.content["animations"][0]["samplers"][0]["input"] = file.array([0.0, 1, 0.5, 2])


def a_turn_without_direction(file: Gltf) -> None:
    file.content["animations"][0]["samplers"][0]["output"] = file.array([[0.0] * 4] * 4)


def a_huge_sparse_accessor(file: Gltf) -> None:
    sparse_without_view(file)
    file.content["accessors"][-1]["count"] = 10**12


def bytes_read_again_and_again(file: Gltf) -> None:
    view = file.view(bytes(1 << 20))
    file.content["meshes"] += [
        {
            "primitives": [
                {"attributes": {"POSITION": file.accessor(view, 87000, (3,), "f4", byteOffset=4 * k)}}
            ]
        }
        for k in range(100)
    ]
    file.content["nodes"] += [{"mesh": 1 + k} for k in range(100)]
    file.content["scenes"][0]["nodes"] += list(range(5, 105))


none_given = np.full((6, 4), np.nan)
one_empty = none_given.copy()
one_empty[2] = 0
one_less = none_given.copy()
one_less[1] = (0.1, 0.08, 0, 0)
one_negative = none_given.copy()
one_negative[3] = (-1, 1, 1, 0)

REFUSED: list[tuple[Callable[[Gltf], None], str]] = [
    (joint_out_of_range, r"primitives\[0\]: vertex 2 names the joints \[0, 1, 7, 0\], but skins\[0\] has 3"),
    (corner_out_of_range, r"primitives\[0\].indices go up to 6, but there are 6 vertices"),
    (points(3, np.nan), r"meshes\[0\].primitives\[0\]: vertex 3 is at"),
    (points(3, np.inf), r"vertex 3 is at"),
    (weights(one_negative), r"WEIGHTS_0: vertex 3 has the weights"),
    (weights(np.zeros((6, 4))), "no weight other than 0"),
    (times_that_go_back, r"channels\[0\]: key 2 is at 0.5 s, before key 1 at 1 s"),
    (a_turn_without_direction, "the rotation of key 0 is 0 0 0 0"),
    (a_huge_sparse_accessor, "refers to the same bytes too often"),
    (bytes_read_again_and_again, "refers to the same bytes too often"),
    (change("nodes", 4, "children", to=[2]), r"nodes\[2\] hangs on nodes\[0\] and nodes\[4\]"),
    (change("nodes", 0, "children", to=[0]), r"nodes\[0\] hangs on itself"),
    (change("nodes", 0, "children", to=[9]), r"nodes\[0\] refers to nodes\[9\], but the file has 5"),
    (change("nodes", 2, "rotation", to=[0, 0, 0, 0]), r"nodes\[2\].rotation has the length 0"),
    (change("nodes", 2, "scale", to=[1, 1]), r"nodes\[2\].scale has 2 numbers"),
    (change("nodes", 2, to={"children": [3], "matrix": [1] * 16}), r"nodes\[2\].matrix has the last row"),
    (
        change("nodes", 2, "matrix", to=np.eye(4).ravel().tolist()),
        r"channels\[1\] moves .* given by a matrix",
    ),
    (change("skins", 0, "joints", to=[]), r"skins\[0\] has no joints"),
    (change("skins", 0, "joints", to=[2, 2, 3]), r"skins\[0\] names a joint twice"),
    (change("skins", 0, "joints", to=[2, 3, 77]), r"skins\[0\] refers to nodes\[77\]"),
    (change("skins", 0, "inverseBindMatrices", to=0), r"accessors\[0\] of the type 'VEC3'; it must be MAT4"),
    (change("accessors", 0, "count", to=7), r"accessors\[0\] wants 7 elements of 12 bytes"),
    (change("accessors", 0, "count", to=10**15), r"accessors\[0\] wants 1,000,000,000,000,000 elements"),
    (change("accessors", 0, "count", to=10**30), r"accessors\[0\].count is"),
    (change("accessors", 0, "count", to=0), r"accessors\[0\] counts 0 elements"),
    (change("accessors", 0, "count", to=-5), r"accessors\[0\] counts -5 elements"),
    (change("accessors", 0, "count", to="6"), r"accessors\[0\].count is ''6'', where a whole number"),
    (change("accessors", 0, "byteOffset", to=-4), r"accessors\[0\] wants"),
    (change("accessors", 0, "componentType", to=5124), "component type 5124"),
    (change("accessors", 1, "count", to=5), r"JOINTS_0 has 5 elements for 6 vertices"),
    (change("bufferViews", 0, "byteLength", to=10**9), r"bufferViews\[0\] is 1000000000 bytes"),
    (change("bufferViews", 0, "byteOffset", to=-1), r"bufferViews\[0\] is"),
    (change("bufferViews", 0, "byteStride", to=-12), r"accessors\[0\] wants"),
    (change("bufferViews", 0, "buffer", to=1), r"bufferViews\[0\] refers to buffers\[1\]"),
    (change("animations", 0, "samplers", 0, "interpolation", to="EASE"), "interpolates by 'EASE'"),
    (change("animations", 0, "samplers", 0, "interpolation", to="CUBICSPLINE"), "it needs 3 for each time"),
    (change("animations", 0, "channels", 0, "target", "path", to="colour"), "moves 'colour'"),
    (change("animations", 0, "channels", 1, "target", to={"node": 3, "path": "rotation"}), "VEC3"),
    (change("asset", to={"version": "1.0"}), "this is glTF '1.0'"),
    (change("asset", to=7), "asset.version is missing"),
    (change("extensionsRequired", to=["KHR_draco_mesh_compression"]), "'KHR_draco_mesh_compression'"),
    (change("meshes", 0, "primitives", 0, "mode", to=9), "has the mode 9"),
    (change("meshes", 0, "primitives", 0, "material", to=4), r"refers to materials\[4\]"),
    (change("meshes", 0, "primitives", 0, "attributes", to=[1]), "attributes is"),
    (change("materials", 0, "alphaMode", to="GLASS"), "alphaMode is 'GLASS'"),
    (change("scene", to=3), r"scene refers to scenes\[3\]"),
]


@pytest.mark.parametrize(("bend", "said"), REFUSED, ids=lambda value: None)
def test_what_is_wrong_is_refused_in_a_sentence_that_says_where(
    bend: Callable[[Gltf], None], said: str
) -> None:
    file = arm()
    bend(file)
    with pytest.raises(FormatError, match=said) as caught:
        gmr.read_character(file.glb())
    assert len(str(caught.value)) < 400


def flat_bind(file: Gltf) -> None:
    binds = np.tile(np.eye(4), (3, 1, 1))
    binds[1, :3, :3] = 0
    file.content["skins"][0]["inverseBindMatrices"] = file.array(binds)


def morphs(file: Gltf) -> None:
    primitive(file)["targets"] = [{"POSITION": attributes(file)["POSITION"]}]


def degenerate(file: Gltf) -> None:
    primitive(file)["indices"] = file.array([0, 1, 1, 0, 1, 2], "u2")


def bad_normals(file: Gltf) -> None:
    attributes(file)["NORMAL"] = file.array(np.full((6, 3), np.nan))


def lost_picture(file: Gltf) -> None:
    file.content["images"] = [{"uri": "lost.png"}]
    file.content["textures"] = [{"source": 0}]
    file.content["materials"][0]["normalTexture"] = {"index": 0}


WARNED: list[tuple[Callable[[Gltf], None], str]] = [
    (weights(one_less), r"the weights of 1 of 6 vertices do not sum to 1 \(the least to 0.18\)"),
    (weights(one_empty), "1 of 6 vertices have no weight; each goes with the first joint that it names"),
    (flat_bind, "that of joint 'lower' flattens what the joint carries"),
    (morphs, "has 1 morph targets, which are left out"),
    (degenerate, "has 1 triangles two corners of which are one vertex; they are kept"),
    (bad_normals, r"primitives\[0\].NORMAL has values that are not finite; it is left out"),
    (lost_picture, r"images\[0\] is in the file 'lost.png'"),
    (change("extensionsUsed", to=["KHR_materials_clearcoat"]), "left out: 'KHR_materials_clearcoat'"),
    (change("meshes", 0, "primitives", to=[]), r"meshes\[0\] is empty"),
    (change("meshes", 0, "primitives", 0, "mode", to=1), "made of lines, which are left out"),
    (change("nodes", 2, "rotation", to=[0, 0, 0, 2]), "rotations that are not of length 1"),
    (change("nodes", 0, "children", to=[2]), "1 nodes with meshes are not in the scene"),
]


@pytest.mark.parametrize(("bend", "said"), WARNED, ids=lambda value: None)
def test_what_is_odd_is_read_with_a_warning_or_refused_where_strict(
    bend: Callable[[Gltf], None], said: str
) -> None:
    file = arm()
    bend(file)
    with pytest.warns(FormatWarning, match=said):
        gmr.read_character(file.glb())
    with pytest.raises(FormatError, match=said):
        gmr.read_character(file.glb(), strict=True)


def read_quietly(data: bytes) -> Character:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        return gmr.read_character(data)


def test_weights_that_sum_to_less_are_divided_by_their_sum_and_none_go_with_the_first_joint() -> None:
    file = arm()
    both = np.where(np.isnan(one_less), one_empty, one_less)
    weights(both)(file)
    part = read_quietly(file.glb()).parts[0]
    assert np.allclose(part.weights[1], [0.1 / 0.18, 0.08 / 0.18, 0, 0])
    assert part.weights[2].tolist() == [1, 0, 0, 0]
    assert np.array_equal(part.weights[3:], WEIGHTS[3:])


@pytest.mark.parametrize("length", [0, 3, 11, 12, 19, 20, 100, 1000, -1])
def test_a_binary_file_that_is_cut_off_is_refused(length: int) -> None:
    with pytest.raises(FormatError):
        gmr.read_character(arm().glb()[:length])


def test_a_chunk_that_counts_more_than_there_is_is_refused() -> None:
    data = bytearray(arm().glb())
    data[12:16] = struct.pack("<I", len(data))
    with pytest.raises(FormatError, match="chunk 0 counts"):
        gmr.read_character(bytes(data))


@pytest.mark.parametrize(
    ("uri", "said"),
    [
        (
            "data:application/octet-stream;base64,AAAA",
            r"buffers\[0\] says that .*, but 3 are there",
        ),
        ("data:application/octet-stream;base64,!!!!", r"buffers\[0\] is no base64"),
        ("data:application/octet-stream", "without a comma"),
        ("arm.bin", "read from a path"),
    ],
)
def test_a_buffer_that_is_not_there_is_refused(uri: str, said: str) -> None:
    with pytest.raises(FormatError, match=said):
        gmr.read_character(arm().gltf(uri))


@pytest.mark.parametrize(
    "uri", ["../out.bin", "/etc/hostname", "http://127.0.0.1/arm.bin", "file:///etc/x", "."]
)
def test_only_files_beside_are_opened(uri: str, tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (tmp_path / "out.bin").write_bytes(arm().binary)
    (folder / "arm.gltf").write_bytes(arm().gltf(uri))
    with pytest.raises(FormatError, match=r"buffers\[0\] is at"):
        gmr.read_character(folder / "arm.gltf")


@pytest.mark.parametrize(
    "text",
    [b"", b"{", b"[]", b"{}", b'{"asset":{"version":"2.0"},"nodes":7}', b"[" * 100_000, b"{\xff}", b"{nan}"],
)
def test_json_that_is_none_is_refused(text: bytes) -> None:
    with pytest.raises(FormatError):
        gmr.read_character(text)


def test_a_deep_tree_is_read_in_a_row() -> None:
    count = 20_000
    nodes: list[dict[str, Any]] = [{"children": [k + 1]} for k in range(count)]
    nodes.append({"name": "end"})
    text = json.dumps({"asset": {"version": "2.0"}, "nodes": nodes}).encode()
    assert len(gmr.read_character(text).nodes) == count + 1


def test_hostile_counts_take_no_memory() -> None:
    file = arm()
    a_huge_sparse_accessor(file)
    data = file.glb()
    tracemalloc.start()
    try:
        with pytest.raises(FormatError):
            gmr.read_character(data)
        assert tracemalloc.get_traced_memory()[1] < 20_000_000
    finally:
        tracemalloc.stop()


def test_an_animation_that_would_last_for_ages_is_refused() -> None:
    file = arm()
    file.content["animations"][0]["samplers"][0]["input"] = file.array([0.0, 1, 2, 1e30])
    with pytest.raises(FormatError, match="lasts 1e\\+30 s"):
        gmr.read(file.glb())
    file.content["animations"][0]["samplers"][0]["input"] = file.array([0.0, 1, 2, 1e6])
    with pytest.raises(FormatError, match="check its times"):
        gmr.read(file.glb())


def test_without_pygltflib_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "pygltflib", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'gmr-motion\[gltf\]'"):
        gmr.read_character(arm().glb())
