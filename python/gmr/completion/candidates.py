"""The clips that may fill a dataset's holes: those of another folder as they are, mirrored, at another pace,
and made ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from typing import Final

from gmr.completion.up import mirrored_upright
from gmr.errors import GmrError
from gmr.forest import home
from gmr.matching.survey import difference
from gmr.motion import Motion
from gmr.skeleton import Skeleton
from gmr.tpose import leading_rest_frames

__all__ = ["FACTORS", "SYNTHESISED", "Candidate", "on_skeleton", "variants"]

FACTORS: Final = (1.0, 0.8, 0.9, 1.1, 1.25)
"""How many times as fast a clip may be played: within these a walk still looks like one."""

SYNTHESISED: Final = "synthesised"


@dataclass(frozen=True, slots=True)
class Candidate:
    """A clip that may be added.

    Attributes:
        source: the clip that it is made of, by its name in the folder; or the made clip's.
        mirrored: whether it is its mirror image.
        factor: how many times as fast it is played.
        made: whether it was synthesised.
        laid: whether it was laid on the dataset's skeleton from another one.
        turned: the axis that it was turned to have up, as the dataset has; "" where it has so by itself.
        moved: whether it was moved up or down, to the height of the dataset's ground.
    """

    source: str
    mirrored: bool = False
    factor: float = 1.0
    made: bool = False
    laid: bool = False
    turned: str = ""
    moved: bool = False

    @property
    def how(self) -> str:
        """In words: "as it is", "mirrored, 0.8 times as fast", "turned to +Y up", "synthesised"."""
        if self.made:
            return SYNTHESISED
        parts = [
            *(["laid on this skeleton"] if self.laid else []),
            *([f"turned to {self.turned} up"] if self.turned else []),
            *(["moved to the same ground"] if self.moved else []),
            *(["mirrored"] if self.mirrored else []),
            *([f"{self.factor:g} times as fast"] if self.factor != 1 else []),
        ]
        return ", ".join(parts) or "as it is"

    @property
    def whole(self) -> bool:
        """Whether it is a file of the folder, unchanged."""
        return not (self.made or self.laid or self.turned or self.moved or self.mirrored) and self.factor == 1

    @property
    def name(self) -> str:
        """For a file: that of its source, with what was done to it."""
        path = PurePosixPath(self.source)
        if self.whole or self.made:
            return path.name
        done = "".join(f"_{what}" for what in ("laid", "turned", "moved", "mirrored") if getattr(self, what))
        pace = f"_x{self.factor:g}" if self.factor != 1 else ""
        return f"{path.stem}{done}{pace}.bvh"

    def of(self, motion: Motion, up: str = "+Y") -> Motion:
        """The clip, from the motion of its source; a converter's T-pose stays only in a file left whole.

        Args:
            motion: on the dataset's skeleton, and turned to its up axis and moved to its ground where that
                was to be done.
            up: the dataset's up axis.
        """
        if self.whole:
            return motion
        moving = motion[leading_rest_frames(motion) :]
        seen = mirrored_upright(moving, up) if self.mirrored else moving
        return replace(seen, frame_time=seen.frame_time / self.factor) if self.factor != 1 else seen


def variants(
    source: str, *, mirror: bool, laid: bool, turned: str = "", moved: bool = False
) -> Iterator[Candidate]:
    """What can be made of one clip of the folder; ``mirror``: also its mirror image."""
    for mirrored in (False, True) if mirror else (False,):
        for factor in FACTORS:
            yield Candidate(source, mirrored, factor, laid=laid, turned=turned, moved=moved)


def on_skeleton(
    motions: Mapping[str, Motion], skeleton: Skeleton, lay: Callable[[Motion], Motion] | None
) -> tuple[dict[str, Motion], set[str], dict[str, str]]:
    """The clips that have a skeleton, or can be laid on it.

    Args:
        motions: by name.
        skeleton: that they should have; bones may differ in length.
        lay: lays a motion on it; None: those of another skeleton are refused.

    Returns:
        The clips; the names of those that were laid on it; and why each of the others cannot be used.
    """
    usable: dict[str, Motion] = {}
    laid: set[str] = set()
    refused: dict[str, str] = {}
    for name, motion in motions.items():
        if _kind(home(motion).skeleton) == _kind(skeleton):
            usable[name] = motion
        elif lay is None:
            refused[name] = (
                f"another skeleton than the dataset's, {difference(skeleton, motion.skeleton)}; it can be "
                "laid on the dataset's by --retarget"
            )
        else:
            try:
                usable[name] = lay(motion)
                laid.add(name)
            except GmrError as error:
                refused[name] = f"it cannot be laid on the dataset's skeleton: {error}"
    return usable, laid, refused


def _kind(skeleton: Skeleton) -> tuple[object, ...]:
    return skeleton.names, skeleton.parents.tobytes(), skeleton.slots.tobytes()
