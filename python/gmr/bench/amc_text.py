"""AMC text to arrays and back: one large file."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import gmr
from gmr.bench.harness import Contest
from gmr.bench.inputs import cmu_like_motion
from gmr.bench.peers import find_peers, label
from gmr.dof_rows import DofRows
from gmr.dofs_of_pose import dof_rows_of

__all__ = ["load", "write"]

_PEER_FRAMES = 2000
"""Frames that the peer reads, for all of them would take it minutes; its time grows with their number."""


def load(frame_count: int) -> Iterator[Contest]:
    """Loads one large AMC file: from disk to values, and to a pose that is ready."""
    peers = find_peers("asfamcparser")
    motion = _as_printed(frame_count)
    with tempfile.TemporaryDirectory() as folder:
        file, shorter = Path(folder) / "large.amc", Path(folder) / "shorter.amc"
        gmr.write(motion, file)
        gmr.write(motion[:_PEER_FRAMES], shorter)
        _without_rate(shorter)
        amount = file.stat().st_size / 1e6
        theirs: dict[str, Callable[[], object]] = {}
        if "asfamcparser" in peers:
            parse = peers["asfamcparser"].ParseAMC
            _check_same_values(gmr.read(shorter), parse(str(shorter)).amc)
            theirs[label("asfamcparser")] = lambda: parse(str(shorter))
        for work, ours in (
            ("values", lambda: gmr.read(file)),
            ("a pose that is ready", lambda: gmr.read(file).pose),
        ):
            yield Contest(
                work=f"AMC load, {amount:.0f} MB, to {work}",
                unit="MB/s",
                amount=amount,
                ours=ours,
                peers=theirs,
                peer_amount=shorter.stat().st_size / 1e6,
                absent=peers.absent,
            )


def write(frame_count: int) -> Iterator[Contest]:
    """Writes one large motion as ASF and AMC; no peer on the package index does."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "large.amc"
        motion = _as_printed(frame_count)
        gmr.write(motion, file)
        amount = file.stat().st_size / 1e6
        yield Contest(
            work=f"AMC write, {amount:.0f} MB",
            unit="MB/s",
            amount=amount,
            ours=lambda: gmr.write(motion, file),
        )


def _as_printed(frame_count: int) -> gmr.Motion:
    """The large motion in degrees of freedom with four decimals, as many as files have."""
    motion = cmu_like_motion(frame_count)
    rows = dof_rows_of(motion)
    printed = replace(rows, values=np.round(rows.values, 4))
    return gmr.Motion(rows.acclaim.skeleton, motion.frame_time, printed)


def _without_rate(file: Path) -> None:
    """Takes the line out that the peer would refuse."""
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(b"".join(line for line in lines if not line.startswith(b":SAMPLES")))


def _check_same_values(ours: gmr.Motion, theirs: Any) -> None:
    """The peer leaves the last frame's last bones out, so the frames before are compared."""
    source = ours.source
    assert isinstance(source, DofRows)
    names = [source.acclaim.skeleton.names[joint] for joint in source.listed]
    for k in range(0, min(theirs.count, ours.frame_count) - 1, 97):
        found = [value for name in names for value in theirs.frames[k][name]]
        starts = source.acclaim.starts
        wanted = np.concatenate(
            [source.values[k, starts[joint] : starts[joint + 1]] for joint in source.listed]
        )
        np.testing.assert_array_equal(found, wanted)
