"""What an evaluation found: tables, a verdict in words, and the worst trial to look at.

Metres, seconds and degrees throughout; a column's name never changes once released.
"""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.replays import Replays
from gmr.evaluation.table_files import write_tables
from gmr.evaluation.tables import Tables
from gmr.table import Table

if TYPE_CHECKING:
    import pyarrow

    from gmr.evaluation.simulation import Simulation
    from gmr.pages.section import Section

    AnyTable: TypeAlias = "pyarrow.Table | Table"

__all__ = ["Evaluation", "Replay", "Summary", "Tables", "Verdict"]


@dataclass(frozen=True, slots=True)
class Summary:
    """What was evaluated, and how.

    Attributes:
        dataset: name of the dataset, that is of its folder.
        clip_count: clips evaluated, mirrored copies not counted.
        mirrored_count: mirrored copies added to them.
        frame_count: frames of all of these at ``rate``, mirrored copies counted.
        seconds: their duration, mirrored copies counted.
        rate: frames per second of the evaluation.
        joint_count: joints of the skeleton.
        joints: role ("hips", "left_foot", ...) -> name of the joint that was taken for it.
        unit: the unit of length of the files in words, and where it comes from.
        settings: every setting of the run by its name, as plain values.
    """

    dataset: str
    clip_count: int
    mirrored_count: int
    frame_count: int
    seconds: float
    rate: float
    joint_count: int
    joints: Mapping[str, str]
    unit: str
    settings: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Verdict:
    """The evaluation in words.

    Attributes:
        headline: the one sentence to remember.
        sentences: what stands behind it, in reading order; each carries its figures.
    """

    headline: str
    sentences: tuple[str, ...]

    def __str__(self) -> str:
        """The whole verdict as one paragraph."""
        return " ".join((self.headline, *self.sentences))


@dataclass(frozen=True, slots=True)
class Replay:
    """One trial as it was played, T steps at ``rate``, to be drawn.

    Attributes:
        positions: (T, J, 3) float32, world positions of the joints in metres, Y up, jumps smoothed.
        parents: (J,) int32, index of each joint's parent, -1 for a root.
        joint_names: the J names.
        path: (T, 2), where the character was on the ground, (x, z) in metres.
        reference: (T, 2), where it should have been at the same time.
        offset: (T,), the distance between the two in metres.
        clip: (T,) int32, the clip played, an index into ``clip_names``.
        frame: (T,) int32, the frame of that clip at ``rate``.
        jumped: (T,) bool, whether this step was entered by a jump.
        clip_names: names of the clips.
        rate: steps per second.
        speed: the speed asked for, m/s.
        turn_rate_deg: the turn rate asked for, degrees/s, positive to the left.
        tracking: "time" or "velocity".
        scenario: "constant" or "switching".
    """

    positions: NDArray[np.float32]
    parents: NDArray[np.int32]
    joint_names: tuple[str, ...]
    path: NDArray[np.float64]
    reference: NDArray[np.float64]
    offset: NDArray[np.float64]
    clip: NDArray[np.int32]
    frame: NDArray[np.int32]
    jumped: NDArray[np.bool_]
    clip_names: tuple[str, ...]
    rate: float
    speed: float
    turn_rate_deg: float
    tracking: str
    scenario: str = "constant"


@dataclass(frozen=True, slots=True)
class Evaluation:
    """What :func:`gmr.evaluate` found.

    Attributes:
        dataset: name of the dataset.
        measured: the tables, as gmr's own :class:`Table` of NumPy columns.
        summary: what was evaluated, and how.
        verdict: the result in words.
        replay: the trial that strayed farthest from its path.
        notes: what was noticed or assumed on the way, one sentence each.
        failed: file that could not be used -> why, in one sentence.
        simulation: the database, what was asked of it and every step of every trial, to be looked at or run
            again; it is not pickled, and None in what was.
        replays: all trials as they were played, to be drawn; likewise.
    """

    dataset: str
    measured: Tables
    summary: Summary
    verdict: Verdict
    replay: Replay
    notes: tuple[str, ...] = ()
    failed: Mapping[str, str] = field(default_factory=dict)
    simulation: Simulation | None = field(default=None, repr=False, compare=False)
    replays: Replays | None = field(default=None, repr=False, compare=False)

    def __reduce__(self) -> tuple[type[Evaluation], tuple[Any, ...]]:
        """Everything but what was simulated, which is large and belongs to this process."""
        left_out = ("simulation", "replays")
        kept = (each.name for each in fields(self) if each.name not in left_out)
        return Evaluation, tuple(getattr(self, name) for name in kept)

    @property
    def trials(self) -> AnyTable:
        """One row a trial, as ``pyarrow.Table`` where pyarrow is installed, else :class:`Table`."""
        return _arrow_where_installed(self.measured.trials)

    @property
    def coverage(self) -> AnyTable:
        """One row a 1-s window, as ``pyarrow.Table`` where pyarrow is installed, else :class:`Table`."""
        return _arrow_where_installed(self.measured.coverage)

    @property
    def usage(self) -> AnyTable:
        """One row a frame, as ``pyarrow.Table`` where pyarrow is installed, else :class:`Table`."""
        return _arrow_where_installed(self.measured.usage)

    @property
    def transitions(self) -> AnyTable:
        """One row a jump, as ``pyarrow.Table`` where pyarrow is installed, else :class:`Table`."""
        return _arrow_where_installed(self.measured.transitions)

    @property
    def clips(self) -> AnyTable:
        """One row a clip, as ``pyarrow.Table`` where pyarrow is installed, else :class:`Table`."""
        return _arrow_where_installed(self.measured.clips)

    def tables(self) -> dict[str, Table]:
        """The tables by name, as gmr's own :class:`Table` whether pyarrow is installed or not."""
        return {name: getattr(self.measured, name) for name in Tables.__dataclass_fields__}

    def write_tables(
        self, folder: str | os.PathLike[str], formats: Sequence[str] = ("csv",)
    ) -> tuple[Path, ...]:
        """Write every table into a folder, in every format: all of the files, or none of them.

        Args:
            folder: where to; made where it is missing.
            formats: of "csv", "json" and "parquet".

        Returns:
            The files written.

        Raises:
            ValueError: an unknown format.
            MissingExtraError: Parquet is asked for and pyarrow is not installed.
            OSError: the folder may not be written to, or the disk is full.
        """
        return write_tables(self.tables(), folder, formats)

    def write_figures(self, folder: str | os.PathLike[str], *added: Section) -> tuple[Path, ...]:
        """Write every figure as SVG into a folder, ``<figure>.svg`` each: all of them, or none.

        Args:
            folder: where to; made where it is missing.
            added: sections of what was done with the evaluation, whose figures are drawn too.

        Raises:
            MissingExtraError: vl-convert-python is not installed.
            OSError: the folder may not be written to, or the disk is full.
        """
        from gmr.evaluation.figures import svg

        return svg(self, folder, added)

    def report(self, path: str | os.PathLike[str], *added: Section) -> None:
        """Write the report: one self-contained HTML file that opens offline.

        Args:
            path: the file.
            added: sections of what was done with the evaluation, such as that of a pruning.

        Raises:
            OSError: the file cannot be written.
        """
        from gmr.evaluation.report import write_report

        write_report(self, path, added)


def _arrow_where_installed(table: Table) -> AnyTable:
    return table.to_arrow() if importlib.util.find_spec("pyarrow") else table
