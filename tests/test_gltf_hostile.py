"""No value anywhere in a glTF file makes its reader crash, hang or give what cannot be used."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import gmr
from gltf_files import Gltf, arm
from gmr import Character, FormatError, FormatWarning, GmrError
from gmr.formats.gltf_writer import glb_pieces
from test_gltf_quirks import FORMS, quantised
from test_gltf_refusals import lost_picture, morphs

FILES = [arm(), arm(), *(arm() for _ in FORMS)]
for change, file in zip([quantised, morphs, *FORMS], FILES, strict=True):
    change(file)
lost_picture(FILES[0])

values = st.one_of(
    st.sampled_from([None, True, "", "x", [], {}, [[]], -1, 0, 1, 2, 3, 4, 5, 255, 5120, 5126, 1e300, 0.5]),
    st.sampled_from(["SCALAR", "VEC2", "VEC3", "VEC4", "MAT4", "STEP", "CUBICSPLINE", "scale", "weights"]),
    st.sampled_from([2**31, 2**32, 2**53, 2**63, 10**30, [0], [1, 2], [0, 0, 0], [0, 0, 0, 0], [1] * 16]),
    st.integers(-10, 3000),
)


def places(found: Any) -> Iterator[tuple[Any, Any]]:
    """Every container in a JSON value, with each of its keys."""
    for key in list(found) if isinstance(found, dict) else range(len(found)):
        yield found, key
        if isinstance(found[key], dict | list):
            yield from places(found[key])


def bent(draw: st.DataObject) -> Gltf:
    """A file with other values in a few places, or without some."""
    file = copy.deepcopy(draw.draw(st.sampled_from(FILES)))
    for _ in range(draw.draw(st.integers(1, 3))):
        container, key = draw.draw(st.sampled_from(list(places(file.content))))
        if draw.draw(st.booleans()) and isinstance(container, dict):
            del container[key]
        else:
            container[key] = copy.deepcopy(draw.draw(values))
    return file


def attempt(data: bytes, strict: bool = False) -> Character | None:
    try:
        return gmr.read_character(data, strict=strict)
    except FormatError as error:
        assert len(str(error)) < 1000  # noqa: PT017
        return None


@given(st.data())
def test_a_file_with_anything_anywhere_is_refused_or_can_be_used(draw: st.DataObject) -> None:
    data = bent(draw).glb()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", FormatWarning)
        character = attempt(data)
        if character is None:
            assert attempt(data, strict=True) is None
            return
        if character.skinned_parts:
            assert np.allclose(character.merged.weights.sum(axis=1), 1, atol=1e-5)
        try:
            motion = gmr.read(data)
            assert motion.skeleton.names[: len(character.joints)] == character.joint_names
        except FormatError:
            assert not len(character.joints) or character.animations
        try:
            written = b"".join(glb_pieces(character))
        except GmrError as error:
            assert "sheared" in str(error) or "no triangle" in str(error) or "nothing to write" in str(error)  # noqa: PT017
            return
        again = gmr.read_character(written)
    assert len(again.parts) == len(character.parts)
    for one, other in zip(again.parts, character.parts, strict=True):
        assert np.array_equal(one.vertices, other.vertices)
        assert np.array_equal(one.faces, other.faces)


@given(st.binary(max_size=200))
def test_any_bytes_after_the_beginning_are_refused_or_read(data: bytes) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        for start in (b"glTF\x02\0\0\0", b'{"asset":{"version":"2.0"},'):
            attempt(start + data)
