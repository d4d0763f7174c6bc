"""The conformance files are read and refused as they should be, by gmr and by a second reader."""

from __future__ import annotations

import json
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
import gmr_reference
from gmr import FormatError
from gmr.formats.gmr import read_gmr

FILES = Path(__file__).parent / "data" / "gmr"
VALID = sorted(file for file in (FILES / "valid").iterdir() if file.suffix != ".json")
SENTENCES: dict[str, str] = json.loads((FILES / "invalid" / "sentences.json").read_text(encoding="utf-8"))
DOCUMENT = (Path(__file__).parent.parent / "docs" / "gmr-format.md").read_text(encoding="utf-8")


def told(file: Path) -> list[dict[str, Any]]:
    """What a reader must find, a joint an entry."""
    found: list[dict[str, Any]] = json.loads(file.with_suffix(".json").read_text(encoding="utf-8"))
    return found


def places(joints: list[dict[str, Any]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """(F, J, 3)"""
    found = np.array([joint["positions"] for joint in joints], float)
    return found.reshape(len(joints), -1, 3).swapaxes(0, 1)


@pytest.mark.parametrize("file", VALID, ids=lambda file: file.name)
def test_a_valid_file_is_read(file: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        motion = gmr.read(file, strict=True)
    home = motion.skeleton.home or motion.skeleton
    joints = told(file)
    assert list(home.names) == [joint["name"] for joint in joints]
    assert home.parents.tolist() == [joint["home_parent"] for joint in joints]
    assert home.offsets.tolist() == [joint["home_offset"] for joint in joints]
    np.testing.assert_allclose(motion.positions(dtype=float), places(joints), rtol=0, atol=1e-8)


@pytest.mark.parametrize("file", VALID, ids=lambda file: file.name)
def test_the_second_reader_agrees(file: Path) -> None:
    found = gmr_reference.read(file.read_bytes())
    joints = told(file)
    assert found.names == [joint["name"] for joint in joints]
    assert found.home_parents == [joint["home_parent"] for joint in joints]
    assert found.home_offsets.tolist() == [joint["home_offset"] for joint in joints]
    np.testing.assert_allclose(found.positions, places(joints), rtol=0, atol=1e-8)


@pytest.mark.parametrize("file", sorted(SENTENCES))
def test_an_invalid_file_is_refused_with_its_sentence(file: str) -> None:
    with pytest.raises(FormatError) as caught:
        read_gmr((FILES / "invalid" / file).read_bytes(), name=file)
    assert str(caught.value) == SENTENCES[file]


def test_no_invalid_file_is_forgotten() -> None:
    assert {file.name for file in (FILES / "invalid").iterdir()} == {*SENTENCES, "sentences.json"}


def test_valid_files_come_in_both_forms() -> None:
    texts = {file.stem for file in VALID if file.suffix == ".gmr"}
    assert len(texts) >= 12
    assert texts < {file.stem for file in VALID if file.suffix == ".gmrb"}


def test_the_example_of_the_document_is_the_conformance_file() -> None:
    (example,) = re.findall(r"^```gmr\n(.*?)^```", DOCUMENT, re.MULTILINE | re.DOTALL)
    assert example == (FILES / "valid" / "arm.gmr").read_text(encoding="utf-8")


@pytest.mark.parametrize(("old", "new"), [("LINK Elbow", "LINK Elbo"), ("-55", "nan")])
def test_the_errors_of_the_document_are_said(old: str, new: str) -> None:
    text = (FILES / "valid" / "arm.gmr").read_text(encoding="utf-8").replace(old, new)
    with pytest.raises(FormatError) as caught:
        read_gmr(text.encode(), name="arm.gmr")
    assert f"\n    {caught.value}\n" in DOCUMENT
