"""BVH text to arrays and back: one large file, and a folder of many."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import gmr
from gmr.bench.harness import Contest
from gmr.bench.inputs import cmu_like_bvh, cmu_like_motion, data_folder
from gmr.bench.peers import find_peers, label
from gmr.demo import demo_folder

__all__ = ["load", "load_folder", "write"]


def load(frame_count: int) -> Iterator[Contest]:
    """Loads one large file, from disk to arrays."""
    peers = find_peers("pybvh", "pymotion")
    data = cmu_like_bvh(frame_count)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "large.bvh"
        file.write_bytes(data)
        theirs: dict[str, Callable[[], object]] = {}
        if "pybvh" in peers:
            pybvh = peers["pybvh"]
            _check_same_angles(gmr.read(file), pybvh.read_bvh_file(file, world_up="+y"))
            theirs[label("pybvh")] = lambda: pybvh.read_bvh_file(file, world_up="+y")
        if "pymotion" in peers:
            pymotion_bvh = _pymotion_bvh()
            theirs[label("pymotion")] = lambda: pymotion_bvh().load(str(file))
        yield Contest(
            work=f"BVH load, {len(data) / 1e6:.0f} MB",
            unit="MB/s",
            amount=len(data) / 1e6,
            ours=lambda: gmr.read(file),
            peers=theirs,
            targets={label("pybvh"): 5.0},
            absent=peers.absent,
        )


def load_folder(frame_count: int) -> Iterator[Contest]:
    """Loads a folder of many files: the CMU subjects 01 to 09 below GMR_DATA, else the shipped clips."""
    del frame_count
    peers = find_peers("pybvh")
    folder = data_folder("cmu_bvh_01_09") or demo_folder()
    files = sorted(folder.rglob("*.bvh"))
    folders = sorted({file.parent for file in files})
    amount = sum(file.stat().st_size for file in files) / 1e6
    theirs: dict[str, Callable[[], object]] = {}
    if "pybvh" in peers:
        pybvh = peers["pybvh"]
        theirs[label("pybvh")] = lambda: [pybvh.read_bvh_directory(one, world_up="+y") for one in folders]
    for threads, cores in ((1, "one core"), (None, "all cores")):
        yield Contest(
            work=f"folder of {len(files)} BVH files, {amount:.0f} MB, {cores}",
            unit="MB/s",
            amount=amount,
            ours=lambda threads=threads: gmr.read_folder(folder, threads=threads),  # type: ignore[misc]
            peers=theirs,
            targets={label("pybvh"): 5.0},
            absent=peers.absent,
            all_cores=threads is None,
        )


def write(frame_count: int) -> Iterator[Contest]:
    """Writes one large motion as BVH text, into a new file."""
    peers = find_peers("pybvh", "pymotion")
    motion = cmu_like_motion(frame_count)
    with tempfile.TemporaryDirectory() as folder:
        source, ours, theirs_file = (Path(folder) / name for name in ("in.bvh", "ours.bvh", "theirs.bvh"))
        source.write_bytes(cmu_like_bvh(frame_count))
        gmr.write(motion, ours)
        if not np.array_equal(gmr.read(ours).rows, motion.rows):
            raise AssertionError("what gmr wrote does not read back bit-identical")
        size = ours.stat().st_size
        theirs: dict[str, Callable[[], object]] = {}
        if "pybvh" in peers:
            pybvh = peers["pybvh"]
            loaded = pybvh.read_bvh_file(source, world_up="+y")
            theirs[label("pybvh")] = _anew(theirs_file, lambda: pybvh.write_bvh_file(loaded, theirs_file))
        if "pymotion" in peers:
            saver = _pymotion_bvh()()
            saver.load(str(source))
            theirs[label("pymotion")] = _anew(theirs_file, lambda: saver.save(str(theirs_file)))
        yield Contest(
            work=f"BVH write, {len(cmu_like_bvh(frame_count)) / 1e6:.0f} MB",
            unit="MB/s",
            amount=size / 1e6,
            ours=_anew(ours, lambda: gmr.write(motion, ours)),
            peers=theirs,
            targets={label("pybvh"): 5.0},
            absent=peers.absent,
        )


def _anew(file: Path, write: Callable[[], object]) -> Callable[[], object]:
    """Writes where there is nothing: what replacing a file safely takes is no part of the comparison."""

    def remove_and_write() -> None:
        file.unlink(missing_ok=True)
        write()

    return remove_and_write


def _pymotion_bvh() -> Any:
    from pymotion.io.bvh import BVH

    return BVH


def _check_same_angles(ours: gmr.Motion, theirs: Any) -> None:
    angles = np.rad2deg(theirs.joint_angles).reshape(ours.frame_count, -1)
    np.testing.assert_allclose(ours.rows[:, 3:], angles, atol=1e-9)
