"""The reader of glTF files under a coverage-guided fuzzer: container, JSON, accessors, skins, animations.

A file is refused with ``FormatError`` or read; what is read can be skinned, plays, is written and read again.
Each input is tried as it is, and once more with the lengths that a binary file's header and JSON chunk have,
which a mutation seldom gets right. Anything else that is raised, a hang or a gigabyte taken is a finding. See
README.md for the command.
"""

from __future__ import annotations

import json
import sys
import warnings

import atheris

with atheris.instrument_imports(include=["gmr.formats", "gmr.skinning"]):
    import numpy as np

    from gmr.errors import FormatError, GmrError
    from gmr.formats.gltf import read_gltf, read_gltf_character
    from gmr.formats.gltf_writer import glb_pieces
    from gmr.skinning.character import Character

LONGEST_MESSAGE = 1000


def attempt(data: bytes, *, strict: bool) -> Character | None:
    """The character, None where it is refused in a sentence."""
    try:
        return read_gltf_character(data, strict=strict)
    except FormatError as error:
        if len(str(error)) > LONGEST_MESSAGE:
            raise AssertionError(f"no sentence that helps: {error}") from error
        return None


def repaired(data: bytes) -> bytes | None:
    """The binary file with the lengths that it has; None where that is not one."""
    if data[:4] != b"glTF":
        return None
    try:
        _, length = json.JSONDecoder().raw_decode(data[20:].decode("latin-1"))
    except (ValueError, RecursionError):
        return None
    end = 20 + length
    binary = data[end + 8 :] if len(data) > end + 8 else b""
    chunks = length.to_bytes(4, "little") + b"JSON" + data[20:end]
    chunks += len(binary).to_bytes(4, "little") + b"BIN\0" + binary
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks


def check(data: bytes) -> None:
    """One file."""
    for form in (data, repaired(data)):
        if form is not None:
            check_one(form)


def check_one(data: bytes) -> None:
    """One form of it."""
    character = attempt(data, strict=False)
    if character is None:
        assert attempt(data, strict=True) is None, "strict reads what is refused otherwise"
        return
    if character.skinned_parts:
        merged = character.merged
        assert merged.joints.max(initial=0) < len(character.joints) * len(merged.inverse_binds)
        assert np.allclose(merged.weights.sum(axis=1), 1, atol=1e-5)
    try:
        motion = read_gltf(data)
        assert motion.skeleton.names[: len(character.joints)] == character.joint_names
    except FormatError:
        pass
    try:
        pieces = glb_pieces(character)
    except GmrError:
        return
    again = read_gltf_character(b"".join(pieces))
    assert len(again.parts) == len(character.parts)
    assert len(again.nodes) >= len(character.nodes)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()
