"""What a decomposition comes to: the score, how far it is from the recording, how small it is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actionlet import Actionlet
from gmr.actionlets.decomposition.recorded import Recorded
from gmr.actionlets.score import Score
from gmr.actionlets.track import Track
from gmr.arrays import read_only
from gmr.motion import Motion
from gmr.table import Table

__all__ = ["Decomposed"]

Floats = NDArray[np.float64]

_NUMBERS: Final = 3
"""Of a piece: end, duration and skew; besides, a track has one angle where it starts."""


@dataclass(frozen=True, eq=False)
class Decomposed:
    """A recording as a score.

    Attributes:
        score: a track for each degree of freedom.
        recorded: what was decomposed.
        tolerance_deg: with which.
    """

    score: Score
    recorded: Recorded
    tolerance_deg: float

    @cached_property
    def composed(self) -> Floats:
        """(F, D) radians: the score at the recording's frames."""
        return read_only(self.score.angles(self.recorded.times, self.recorded.dofs))

    @cached_property
    def rms_deg(self) -> Floats:
        """(D,) root mean square of recording minus score, degrees."""
        apart = np.degrees(self.composed - self.recorded.angles)
        return read_only(np.sqrt((apart**2).mean(axis=0)))

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        """(D,) whether more than one silence is in the track: the others hold one angle throughout."""
        tracks = (self.score[dof] for dof in self.recorded.dofs)
        return read_only(np.array([not all(p.is_silence for p in track.pieces) for track in tracks]))

    @property
    def median_rms_deg(self) -> float:
        """Median of :attr:`rms_deg` over what moves; over all where nothing does."""
        return float(np.median(self._of_moving))

    @property
    def p90_rms_deg(self) -> float:
        """90th percentile of :attr:`rms_deg` over what moves; over all where nothing does."""
        return float(np.percentile(self._of_moving, 90))

    @property
    def ratio(self) -> float:
        """How many times smaller the score is than the samples, each number a float32."""
        kept = _NUMBERS * self.score.piece_count + len(self.recorded.dofs)
        return self.recorded.angles.size / kept

    def table(self) -> Table:
        """A row for each degree of freedom: its RMS error in degrees, range, pieces, silences, and how many
        times smaller its track is than its samples."""
        tracks = [self.score[dof] for dof in self.recorded.dofs]
        counts = np.array([len(track.pieces) for track in tracks])
        return Table(
            {
                "dof": np.array(self.recorded.dofs, object),
                "rms_deg": self.rms_deg,
                "max_deg": np.abs(np.degrees(self.composed - self.recorded.angles)).max(axis=0),
                "low_deg": np.degrees(self.recorded.angles.min(axis=0)),
                "high_deg": np.degrees(self.recorded.angles.max(axis=0)),
                "pieces": counts,
                "silences": np.array([sum(p.is_silence for p in track.pieces) for track in tracks]),
                "ratio": len(self.recorded.angles) / (_NUMBERS * counts + 1),
            }
        )

    def motion(self, score: Score | None = None) -> Motion:
        """The recording composed again: from its score, or from another one, such as a mutation of it."""
        return self.recorded.played(score or self.score)

    def as_dict(self) -> dict[str, Any]:
        """All of it in plain values, for JSON: degrees and seconds."""
        rows = {row.pop("dof"): row for row in self.table().rows()}
        for dof, row in rows.items():
            row["track"] = _plain(self.score[dof])
        return {
            "seconds": self.score.duration,
            "fps": self.recorded.fps,
            "frames": len(self.recorded.angles),
            "tolerance_deg": self.tolerance_deg,
            "pieces": self.score.piece_count,
            "median_rms_deg": self.median_rms_deg,
            "p90_rms_deg": self.p90_rms_deg,
            "ratio": self.ratio,
            "dofs": rows,
        }

    @property
    def _of_moving(self) -> Floats:
        return self.rms_deg[self.moving] if self.moving.any() else self.rms_deg


def _plain(track: Track) -> list[dict[str, float]]:
    return [
        {
            "start_deg": float(np.degrees(piece.start)),
            "end_deg": float(np.degrees(piece.end)),
            "seconds": piece.duration,
            "skew": piece.skew,
        }
        for piece in track.pieces
        if isinstance(piece, Actionlet)
    ]
