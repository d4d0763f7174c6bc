"""A character that a program steps: what it should do goes in, the pose to draw comes out.

The whole step runs in the core, in microseconds; docs/matching.md has an example. Metres, seconds, radians;
the ground plane is (x, z), heading 0 looks along +Z and grows counter-clockwise seen from above.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.matching.database import Database
from gmr.matching.trial import Status

__all__ = ["Character", "Shown"]


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """What a character shows, every jump smoothed.

    Attributes:
        positions: (J, 3) float32, of all joints in the world.
        bone_rotations: (J, 4) float32 xyzw, the world rotation of the bone that ends in each joint; the
            identity where nothing turns it, as above a root.
        x, z, heading: where its simulation root is shown.
    """

    positions: NDArray[np.float32]
    bone_rotations: NDArray[np.float32]
    x: float
    z: float
    heading: float


class Character:
    """A body that follows what it is asked for, by motion matching.

    It begins at a place of the ground, wanting to stay there. The database's clock ticks inside; between two
    ticks the pose is that between two rows, so any rate of drawing will do.

    Args:
        database: what is played and searched.
        x, z, heading: where it begins.
        search_every: seconds from a search to the next.
        exclude_within: rows of the playing clip at most this many frames from the next one are not jumped to.
        transition_penalty: added to the cost of every row but the next one; 0 or more.
        tags: bits that every row jumped to carries all of.
        weights: (D,) what squared differences are multiplied by, 0 or more; None: 1.
        half_life: of the smoothing of jumps, in seconds.

    Raises:
        ValueError: a number is out of bounds, or no row carries the tags.
    """

    def __init__(
        self,
        database: Database,
        x: float = 0.0,
        z: float = 0.0,
        heading: float = 0.0,
        *,
        search_every: float = 0.1,
        exclude_within: int = 20,
        transition_penalty: float = 0.0,
        tags: int = 0,
        weights: ArrayLike | None = None,
        half_life: float = 0.1,
    ) -> None:
        self._core = _core.Character(
            database.core,
            (x, z, heading),
            search_every,
            exclude_within,
            transition_penalty,
            tags,
            None if weights is None else np.asarray(weights, np.float32).tolist(),
            half_life,
        )
        times = np.array(self._core.times)
        times.flags.writeable = False
        self._times = times

    @property
    def times(self) -> NDArray[np.float64]:
        """(K,) seconds ahead for which a step asks where to be, ascending."""
        return self._times

    def step(self, wanted: ArrayLike, dt: float) -> Shown:
        """Let ``dt`` seconds pass.

        Args:
            wanted: (K, 3) for each of :attr:`times` the x, z and heading where the character should be so
                many seconds after the end of this step, in the world.
            dt: 0 to 10 seconds.

        Returns:
            What is shown then.

        Raises:
            ValueError: a shape, a number or ``dt`` is out of bounds; the character is then as it was.
        """
        places = np.ascontiguousarray(wanted, np.float64)
        if places.ndim != 2:
            raise ValueError(f"wanted must be ({len(self._times)}, 3): x, z and heading, not {places.shape}")
        return _shown(*self._core.step(places, dt))

    @property
    def shown(self) -> Shown:
        """What the last step has shown."""
        return _shown(*self._core.shown())

    @property
    def place(self) -> tuple[float, float, float]:
        """x, z and heading of the simulation root, without the smoothing of jumps.

        Set, it takes the character there as it stands: off a wall, or anywhere.
        """
        return self._core.place

    @place.setter
    def place(self, place: tuple[float, float, float]) -> None:
        self._core.place = place

    @property
    def row(self) -> int:
        """The row of the database that is played."""
        return self._core.choice[0]

    @property
    def status(self) -> Status:
        """How the last tick came to show :attr:`row`."""
        return Status(self._core.choice[1])

    @property
    def costs(self) -> tuple[float, float]:
        """What :attr:`row` cost the last tick over the pose and over the trajectory; NaN without a search."""
        return self._core.choice[2:]

    def search_now(self) -> None:
        """Have the next tick search, as is due where what is asked for changes at once."""
        self._core.search_now()


def _shown(
    positions: NDArray[np.float32], bone_rotations: NDArray[np.float32], place: tuple[float, float, float]
) -> Shown:
    return Shown(positions, bone_rotations, *place)
