"""The smaller dataset as a folder of files, with a manifest of what went, why, and what it costs.

What the manifest promises was measured on these very files: they are read again, and every trial is run
again, with the features scaled as in the whole dataset, which tells what the frames that went were worth, and
scaled by what is left, as whoever evaluates the folder will see it.
"""

from __future__ import annotations

import os
import secrets
import shutil
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from gmr.errors import DatasetError, FormatWarning, GmrError
from gmr.evaluation.elsewhere import Runs
from gmr.evaluation.reading import printable
from gmr.formats import read_folder, write
from gmr.formats.folder import Takes
from gmr.formats.registry import FORMATS, suffixes
from gmr.matching.database import Database
from gmr.matching.trial import TrialLog, run_trials
from gmr.motion import Motion
from gmr.pruning.cutting import Piece, origins, pieces_of
from gmr.pruning.manifest import manifest, manifest_words
from gmr.pruning.outcomes import Score, joined, outcomes_of, same_bits
from gmr.pruning.part import Part, recordings_of
from gmr.pruning.prune import LOSSLESS, Pruning

__all__ = ["Written", "check_new_folder", "write_pruned"]

Progress = Callable[[str, int, int], object]


@dataclass(frozen=True, eq=False)
class Written:
    """A smaller dataset in a folder.

    Attributes:
        folder: where it is.
        pieces: its files.
        part: what is left of the dataset; with "lossless" more than no trial needs, where a cut would change
            one.
        whole: how well the whole dataset does.
        kept_scale: how well the files do with the features scaled as in the whole dataset.
        own_scale: how well they do by themselves.
        identical: whether every trial is that of the whole dataset, bit by bit, with the former scale.
    """

    folder: Path
    pieces: tuple[Piece, ...]
    part: Part
    whole: Score
    kept_scale: Score
    own_scale: Score
    identical: bool


def write_pruned(
    of: Pruning,
    source: str | os.PathLike[str],
    folder: str | os.PathLike[str],
    *,
    names: Mapping[str, str | int] | None = None,
    unit: float | str | None = None,
    progress: Progress | None = None,
) -> Written:
    """Write the smaller dataset that was chosen.

    Whole files are copied byte for byte; ranges are cut and written in the format of their file. All is
    written beside the folder and checked there; the folder appears at the end, whole.

    Args:
        of: the pruning.
        source: the folder that was evaluated.
        folder: where to; it must not be there yet, or be empty.
        names, unit: as the evaluation was given them.
        progress: called with the name of a phase, how much of it is done, and of how much.

    Returns:
        What was written, and what was measured on it.

    Raises:
        DatasetError: the folder is not empty, or the source has changed since it was evaluated.
        FormatError: a range was to be cut from a file of a format that gmr does not write.
        OSError: the disk is full, or may not be written to.
    """
    place, tell = Path(folder), progress or (lambda phase, done, of: None)
    check_new_folder(place)
    motions, paths = _motions(of, Path(source))
    place.parent.mkdir(parents=True, exist_ok=True)
    beside = place.with_name(f".{place.name}.{secrets.token_hex(4)}")
    options: dict[str, Any] = {
        "mirror": bool(of.simulation.database.mirrored.any()),
        "schema": of.simulation.database.schema,
        "names": names,
        "unit": unit,
    }
    try:
        written = _written_and_checked(of, Path(source), motions, paths, beside, options, tell)
        told = replace(written, folder=place)
        of.importance.to_csv(beside / "importance.csv")
        of.curve.table.to_csv(beside / "curve.csv")
        (beside / "manifest.json").write_text(manifest(of, told, motions), encoding="utf-8")
        (beside / "manifest.md").write_text(manifest_words(of, told, motions), encoding="utf-8")
        if place.exists():
            place.rmdir()
        beside.rename(place)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
    return told


def check_new_folder(folder: Path) -> None:
    """Raises :class:`gmr.DatasetError` where something is that a new folder would take the place of."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise DatasetError(f"{folder} is there and not empty; give a new folder for the smaller dataset")


def _motions(of: Pruning, source: Path) -> tuple[dict[str, Motion], dict[str, str]]:
    """The recordings as they are read, and where each is below its folder, as the file system has it."""
    takes = _read(source)
    paths = {printable(path): path for path in takes}
    names = [recording.name for recording in recordings_of(of.simulation.database)]
    if gone := [name for name in names if name not in paths]:
        raise DatasetError(f"{source} no longer holds {gone[0]}; evaluate it again")
    return {name: takes[paths[name]] for name in names}, paths


def _read(folder: Path) -> Takes:
    """All that can be read; what is odd about the files was said when they were evaluated."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        return read_folder(folder, errors="collect")


def _written_and_checked(
    of: Pruning,
    source: Path,
    motions: Mapping[str, Motion],
    paths: Mapping[str, str],
    beside: Path,
    options: Mapping[str, Any],
    tell: Progress,
) -> Written:
    """Write, read and run again; where nothing may change and something does, cut less and begin again."""
    asked, part = Runs.of(of.simulation), of.chosen.part
    while True:
        pieces = pieces_of(asked.database, motions, paths, part)
        _write(pieces, source, motions, paths, beside, tell)
        tell("checking what was written", 0, 1)
        takes = _read(beside)
        kept = _built(takes, options, asked.database)
        logs = _run(asked, kept)
        back = [_renumbered(log, origins(asked.database, kept, pieces)) for log in logs]
        same = same_bits(of.simulation, back)
        if same.all() or of.goal != LOSSLESS:
            break
        part = _cut_less(of, part, back, same)
        shutil.rmtree(beside)
    alone = _run(asked, _built(takes, options, None))
    tell("checking what was written", 1, 1)
    return Written(
        beside,
        tuple(pieces),
        part,
        of.outcomes.score,
        _score(asked, logs),
        _score(asked, alone),
        bool(same.all()),
    )


def _built(takes: Mapping[str, Motion], options: Mapping[str, Any], like: Database | None) -> Database:
    scale = None if like is None else like.normalization
    return Database.build(dict(takes), normalization=scale, **options)


def _run(asked: Runs, database: Database) -> list[TrialLog]:
    return [run_trials(database, asked.profiles, tracking=tracking) for tracking in asked.trackings]


def _score(asked: Runs, logs: list[TrialLog]) -> Score:
    return joined([outcomes_of(log, asked.trials) for log in logs]).score


def _renumbered(log: TrialLog, rows: Any) -> TrialLog:
    """A log on the pieces with the rows of the whole."""
    return replace(log, row=np.where(log.row >= 0, rows[np.maximum(log.row, 0)], -1))


def _cut_less(of: Pruning, part: Part, logs: list[TrialLog], same: Any) -> Part:
    """The part with those recordings whole at which trials that changed first went another way."""
    database, count = of.simulation.database, len(of.simulation.trials)
    recordings = recordings_of(database)
    firsts = np.sort(np.array([start for each in recordings for start in each.starts]))
    owner = {start: each for each in recordings for start in each.starts}
    ranges = dict(part.ranges)
    before_all = list(of.simulation.logs.values())
    for run in np.flatnonzero(~same).tolist():
        before, after = (group[run // count].row[run % count] for group in (before_all, logs))
        step = int(np.argmax(before != after))
        for row in {int(before[max(step - 1, 0)]), int(before[step]), int(after[step])} - {-1}:
            recording = owner[int(firsts[np.searchsorted(firsts, row, "right") - 1])]
            ranges[recording.name] = ((0, recording.frames),)
    if ranges == dict(part.ranges):
        raise GmrError("trials change with files that are whole; this is a fault of gmr: please report it")
    return Part(part.rate, ranges)


def _write(
    pieces: list[Piece],
    source: Path,
    motions: Mapping[str, Motion],
    paths: Mapping[str, str],
    folder: Path,
    tell: Progress,
) -> None:
    for number, piece in enumerate(pieces):
        tell("writing the smaller dataset", number, len(pieces))
        place = folder / piece.file
        place.parent.mkdir(parents=True, exist_ok=True)
        if piece.frames is None:
            whole = source / paths[piece.source]
            shutil.copyfile(whole, place)
            _copy_what_serves(whole.parent, place.parent)
        else:
            write(piece.of(motions[piece.source]), place)
    tell("writing the smaller dataset", len(pieces), len(pieces))


def _copy_what_serves(source: Path, folder: Path) -> None:
    """Files that are part of others: the ASF of an AMC, what a glTF names."""
    names = [path.name for path in source.iterdir() if path.is_file()]
    serving: set[str] = set().union(*(known.serving_files(names) for known in FORMATS))
    if any(name.lower().endswith(".gltf") for name in names):
        serving |= {name for name in names if not name.lower().endswith(suffixes())}
    for name in sorted(serving):
        if not (folder / name).exists():
            shutil.copyfile(source / name, folder / name)
