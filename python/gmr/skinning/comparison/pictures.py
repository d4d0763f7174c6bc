"""The comparison's stills: the capsule in extremes, the character where the methods differ most."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from gmr.pages.theme import LIGHT, STEPS
from gmr.skinning.capsule import Movement, capsule, transforms
from gmr.skinning.comparison.measured import METHODS, Comparison
from gmr.skinning.comparison.rendering import Look, View, look_of, still

__all__ = ["Picture", "direction", "picture_count", "pictures"]

_SIZE: Final = (1200, 620)
_CAPSULE_SIZE: Final = (1200, 430)
_CAPSULES: Final[tuple[tuple[Movement, float], ...]] = (("bend", 120.0), ("twist", 170.0))
_FRAMES: Final = 3


@dataclass(frozen=True, slots=True)
class Picture:
    """A still.

    Attributes:
        name: of its file, without the suffix.
        group: what it shows.
        title, caption: in words.
        png: the file's bytes.
    """

    name: str
    group: Literal["capsule", "clip"]
    title: str
    caption: str
    png: bytes


def pictures(of: Comparison) -> Iterator[Picture]:
    """The stills, as they are drawn."""
    for movement, degrees in _CAPSULES:
        yield _capsule(movement, degrees)
    look = look_of(of.character)
    for frame in of.most_apart(_FRAMES):
        yield _frame(of, look, frame)


def picture_count(of: Comparison) -> int:
    """How many stills :func:`pictures` draws."""
    return len(_CAPSULES) + len(of.most_apart(_FRAMES))


def direction(of: Comparison) -> NDArray[np.float64]:
    """From where the character is seen: from the side of its way, a little to the front and from above.

    One that stays where it is is seen from its right front.
    """
    roots = of.poses[:, 0, :3, 3]
    way = (roots[-1] - roots[0]) * [1, 0, 1]
    height = np.ptp(of.character.rest_pose()[:, 1, 3])
    if np.linalg.norm(way) < 0.5 * height:
        way = np.array([0.0, 0.0, 1.0])
    way = way / np.linalg.norm(way)
    side = np.cross([0.0, 1.0, 0.0], way)
    seen: NDArray[np.float64] = side + 0.6 * way + [0, 0.25, 0]
    return seen


def _capsule(movement: Movement, degrees: float) -> Picture:
    of = capsule()
    matrices = transforms(movement, np.array([degrees]))
    assert of.skin.faces is not None
    look = Look(of.skin.faces, ((0, of.skin.vertex_count, None, None, ""),))
    views = [
        View(name, of.skin.blend(matrices, method)[0], look, _stripes(of.skin.vertices))
        for method, name in METHODS.items()
    ]
    words = {"bend": "bent", "twist": "twisted"}[movement]
    return Picture(
        f"capsule_{movement}",
        "capsule",
        f"The capsule {words} by {degrees:.0f}°",
        f"The same two bones and weights, {words} by {degrees:.0f} degrees, in the three methods.",
        still(views, (0.25, 0.15, 1.0), size=_CAPSULE_SIZE),
    )


def _frame(of: Comparison, look: Look, frame: int) -> Picture:
    skinned = {name: of.character.skin(of.poses[frame], method)[0] for method, name in METHODS.items()}
    linear, dual, _ = METHODS.values()
    apart = 1000 * np.linalg.norm(skinned[dual] - skinned[linear], axis=-1).astype(float)
    views = [View(name, vertices, look) for name, vertices in skinned.items()]
    views.append(View(f"apart: dark is {apart.max():.0f} mm", skinned[dual], look, _heat(apart)))
    seconds = of.apart["seconds"][frame]
    return Picture(
        f"frame_{frame:05}",
        "clip",
        f"Frame {frame}, {seconds:.2f} s",
        "The methods side by side, and how far dual quaternions put each vertex from where linear blending "
        f"does: at most {apart.max():.0f} mm, round {of.apart['joint'][frame]}.",
        still(views, direction(of).tolist(), size=_SIZE),
    )


def _heat(values: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Colours of the page's scale of errors: pale at 0, dark at the greatest."""
    scale = np.array([_rgb(LIGHT[f"error-{step}"]) for step in range(STEPS)])
    place = np.linspace(0, max(float(values.max()), 1e-9), STEPS)
    channels = [np.interp(values, place, scale[:, channel]) for channel in range(3)]
    return np.stack(channels, axis=1).astype(np.uint8)


def _stripes(vertices: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Eight stripes along the capsule, so that a twist is seen."""
    around = np.arctan2(vertices[:, 2], vertices[:, 0]) / (2 * np.pi) + 0.5
    dark = (np.floor(16 * around + 0.01) % 2).astype(bool)
    found: NDArray[np.uint8] = np.where(dark[:, None], _rgb(LIGHT["kind-0"]), _rgb(LIGHT["bar-second"]))
    return found.astype(np.uint8)


def _rgb(colour: str) -> list[int]:
    return [int(colour[at : at + 2], 16) for at in (1, 3, 5)]
