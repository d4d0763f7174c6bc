"""A binary file is mapped: opening it reads its header, a range of frames only its own pages."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.formats.gmr import read_gmr, write_gmrb
from gmr.formats.safetensors import read_container
from gmr.frames import Pose

SMAPS = Path("/proc/self/smaps")


@pytest.fixture
def motion(data: Path) -> gmr.Motion:
    return gmr.read(data / "cmu_07_01.bvh").split("LeftFoot")


@pytest.fixture
def long(motion: gmr.Motion, tmp_path: Path) -> Path:
    """A file of 30,000 frames, 30 MB."""
    pose = motion.pose
    rotations, translations = (np.tile(a, (500, 1, 1)) for a in (pose.rotations, pose.translations))
    file = tmp_path / "long.gmrb"
    gmr.write(gmr.Motion(motion.skeleton, 0.01, Pose(rotations, pose.translated, translations)), file)
    return file


def resident(file: Path) -> int:
    """Bytes of the file's maps that are in this process's memory."""
    found, inside = 0, False
    for line in SMAPS.read_text().splitlines():
        if not line.split(" ", 1)[0].endswith(":"):
            inside = line.endswith(str(file))
        elif inside and line.startswith("Rss:"):
            found += 1024 * int(line.split()[1])
    return found


@pytest.mark.skipif(not SMAPS.exists(), reason="needs Linux's account of mapped pages")
def test_frames_that_nobody_looks_at_are_not_read(long: Path) -> None:
    motion = gmr.read(long)
    assert long.stat().st_size > 30_000_000
    assert resident(long) < 1_000_000
    part = motion[10_000:11_000]
    assert np.shares_memory(part.rotations, motion.rotations)
    assert resident(long) < 1_000_000
    part.positions()
    assert 1_000_000 < resident(long) < 4_000_000


def test_frames_are_the_memory_of_the_file(motion: gmr.Motion) -> None:
    raw = write_gmrb(motion)
    whole = np.frombuffer(raw, np.uint8)
    found = read_gmr(raw)
    assert np.shares_memory(found.rotations, whole)
    assert np.shares_memory(found.translations, whole)
    assert not found.rotations.flags.writeable
    home = gmr.forest.home(motion)
    assert np.shares_memory(read_gmr(rows := write_gmrb(home)).rows, np.frombuffer(rows, np.uint8))


def test_a_motion_without_frames_in_use_lets_the_file_go(long: Path) -> None:
    skeleton = gmr.read(long).skeleton
    assert skeleton.joint_count == 38
    if SMAPS.exists():
        assert str(long) not in SMAPS.read_text()


def test_a_mapped_file_can_be_replaced_by_what_was_read_of_it(long: Path) -> None:
    motion = gmr.read(long)
    gmr.write(motion[:100], long)
    assert gmr.read(long) == motion[:100]
    assert motion.frame_count == 30_000
    np.testing.assert_array_equal(motion[-60:].rotations, motion[:60].rotations)


@pytest.mark.skipif(sys.platform == "win32", reason="pipes are named otherwise there")
def test_what_cannot_be_mapped_is_read(motion: gmr.Motion, tmp_path: Path) -> None:
    import threading

    pipe = tmp_path / "pipe.gmrb"
    os.mkfifo(pipe)
    raw = write_gmrb(motion)
    writer = threading.Thread(target=pipe.write_bytes, args=(raw,))
    writer.start()
    assert gmr.read(pipe) == motion
    writer.join()
    (tmp_path / "empty.gmrb").touch()
    with pytest.raises(gmr.FormatError, match="the file is empty"):
        gmr.read(tmp_path / "empty.gmrb")


def test_the_library_safetensors_opens_it(motion: gmr.Motion, tmp_path: Path) -> None:
    from safetensors import safe_open
    from safetensors.numpy import load_file, save_file

    file = tmp_path / "walk.gmrb"
    gmr.write(motion, file)
    arrays = load_file(file)
    assert arrays["rotations"].tobytes() == motion.rotations.tobytes()
    assert arrays["parents"].tolist() == motion.skeleton.parents.tolist()
    with safe_open(file, "numpy") as opened:
        metadata = opened.metadata()
    assert json.loads(metadata["names"]) == list(motion.skeleton.names)
    save_file(arrays, tmp_path / "again.gmrb", metadata)
    assert gmr.read(tmp_path / "again.gmrb") == motion
    assert gmr.read((tmp_path / "again.gmrb").read_bytes()) == motion


def test_numbers_are_aligned_in_the_file(motion: gmr.Motion) -> None:
    for name in ("a", "ab", "abcdefg"):
        renamed = gmr.Motion(
            gmr.Skeleton.post_rotation([name], [-1], np.zeros((1, 3))),
            0.1,
            Pose(np.zeros((3, 0, 4)), np.array([0]), np.arange(9.0).reshape(3, 1, 3)),
        )
        held = read_container(write_gmrb(renamed), None)
        assert held.start % 8 == 0
        assert all(held.tensors[key].begin % 8 == 0 for key in ("offsets", "rotations", "translations"))
        assert held.tensors["parents"].begin % 4 == 0


def test_numbers_that_are_not_finite_are_found_by_who_looks(motion: gmr.Motion) -> None:
    raw = bytearray(write_gmrb(motion))
    held = read_container(bytes(raw), None)
    at = held.start + held.tensors["translations"].begin + 8 * (5 * 6 + 3)
    raw[at : at + 8] = np.float64(np.nan).tobytes()
    found = read_gmr(bytes(raw))
    assert np.isnan(found.translations).sum() == 1
    with pytest.raises(gmr.FormatError, match="joint 'LeftFoot', Xposition is nan in frame 5"):
        read_gmr(bytes(raw), strict=True)


def test_quaternions_of_other_lengths_are_refused_where_all_is_looked_at(motion: gmr.Motion) -> None:
    pose = motion.pose
    rotations = pose.rotations.copy()
    rotations[5, 0] *= 1.1
    written = write_gmrb(replace(motion, source=Pose(rotations, pose.translated, pose.translations)))
    assert read_gmr(written).rotations[5, 0].tolist() == rotations[5, 0].tolist()
    with pytest.raises(gmr.FormatError, match="1 quaternion is not of length 1, the first in frame 5"):
        read_gmr(written, strict=True)
