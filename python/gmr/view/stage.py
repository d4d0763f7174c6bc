"""Figures on a viser scene, drawn frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.view.bone_shapes import BONE_FACES, BONE_VERTICES, Placed, placed_bones
from gmr.view.colours import TRAILS, bone_colours
from gmr.view.layout import laid_out
from gmr.view.skin_drawing import Drawn, drawn_skin

if TYPE_CHECKING:
    from viser import SceneApi, ViserServer

    from gmr.skinning.blending import Method
    from gmr.view.figure import Figure
    from gmr.view.timeline import Timeline

__all__ = ["LAYERS", "METHODS", "Look", "Stage"]

METHODS = ("lbs", "dqbs", "cor")
LAYERS = ("skeleton", "skin", "trails", "names")
_TRAIL_RATE = 30.0
"""Points a second of a trail."""
_TRAIL_WIDTH = 0.006
"""As a share of the figure's size."""
_FILL = 1.3
"""Light from everywhere, beside that from above."""
_ABOVE = 0.06
"""How far above a figure its name is, as a share of its height."""


@dataclass(frozen=True)
class Look:
    """What is drawn, and how.

    Raises:
        GmrError: there is no such method or layer, or the opacity is out of range.
    """

    method: Method = "lbs"
    """How skins are blended: "lbs", "dqbs" or "cor"."""
    weights: str | None = None
    """A joint whose weights colour the skins; None: the colours of their materials."""
    layers: frozenset[str] = frozenset(LAYERS)
    """Some of "skeleton", "skin", "trails", "names"."""
    opacity: float = 1.0
    """Of skins, from 0.1 to 1: below 1 the bones in them are seen."""
    overlay: bool = False
    """Figures stand where they are in their files, not beside each other."""

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise GmrError(f"there is no blending '{self.method}'; take one of {', '.join(METHODS)}")
        if not 0.1 <= self.opacity <= 1:
            raise GmrError(f"an opacity of {self.opacity:g} cannot be; give from 0.1 to 1")
        if wrong := sorted(set(self.layers) - set(LAYERS)):
            raise GmrError(f"nothing drawn is called '{wrong[0]}'; there are {', '.join(LAYERS)}")


class Stage:
    """A ground with figures on it. What it shows changes by :meth:`draw` and :meth:`look_like`.

    Args:
        server: a viser server whose scene is empty.
        figures: at least one.
        look: how they are drawn.
    """

    def __init__(self, server: ViserServer, figures: Sequence[Figure], look: Look) -> None:
        self._scene = server.scene
        self._look = look
        self._layout = laid_out(figures, overlay=look.overlay)
        self._light_and_ground(server)
        self._actors = [
            _Actor(server.scene, figure, number, place, look)
            for number, (figure, place) in enumerate(zip(figures, self._layout.places, strict=True))
        ]

    def draw(self, timeline: Timeline, tick: int) -> None:
        """All figures as they are at a tick of the time line."""
        for actor in self._actors:
            actor.draw(timeline.frame(actor.figure, tick))

    def look_like(self, look: Look) -> None:
        """Draws the same frame otherwise; figures stay where they stand.

        Raises:
            GmrError: no skin has the joint whose weights are asked for.
        """
        for actor in self._actors:
            actor.look_like(look)
        self._look = look

    def _light_and_ground(self, server: ViserServer) -> None:
        layout = self._layout
        camera = server.initial_camera
        camera.fov, camera.up = layout.field, (0.0, 1.0, 0.0)
        camera.position, camera.look_at = layout.eye, layout.centre
        size = float(np.linalg.norm(layout.high - layout.low))
        camera.near, camera.far = size * 1e-3, max(size * 100, 100.0)
        side = layout.cell * 10 * np.ceil(size * 1.2 / (layout.cell * 10))
        middle = np.round(layout.centre / layout.cell) * layout.cell
        self._scene.add_grid(
            "/ground", side, side, plane="xz", cell_size=layout.cell, section_size=layout.cell * 5,
            cell_color=(176, 180, 186), section_color=(120, 126, 134), plane_color=(236, 238, 240),
            plane_opacity=1.0, shadow_opacity=0.25, fade_distance=1e6,
            position=(middle[0], layout.ground, middle[2]),
        )  # fmt: skip
        self._scene.world_axes.visible = False
        self._scene.configure_environment_map(None)
        self._scene.add_light_hemisphere("/light", intensity=_FILL, ground_color=(190, 190, 200))


class _Actor:
    """One figure in the scene."""

    def __init__(
        self, scene: SceneApi, figure: Figure, number: int, place: NDArray[np.float64], look: Look
    ) -> None:
        self.figure = figure
        self._scene, self._look, self._frame = scene, look, 0
        self._node = f"/{number + 1} {figure.name.replace('/', ' ')}"
        low, high = figure.box
        self._size = float(np.max(high - low)) if figure.heads.shape[1] == 0 else _body_size(figure)
        scene.add_frame(self._node, show_axes=False, position=place)
        self._bones = placed_bones(figure.heads, figure.tails, self._size)
        self._drawn_bones = _add_bones(scene, f"{self._node}/skeleton", figure, self._bones, number)
        self._trails = _add_trails(scene, self._node, figure, self._size)
        self._tops, height = _tops(figure)
        self._name: Any = scene.add_label(f"{self._node}/name", figure.name, anchor="bottom-center")
        # What is worn may be taller than the bones.
        self._above = height * _ABOVE + max(0.0, float(high[1] - self._tops[figure.known, 1].max()))
        self._skin: Drawn | None = self._dressed()
        self._show_layers()

    def draw(self, frame: int) -> None:
        self._frame = frame
        known = bool(self.figure.known[frame])
        if self._drawn_bones is not None and "skeleton" in self._look.layers:
            _send_changed(self._drawn_bones, self._bones, frame)
        if self._skin is not None and "skin" in self._look.layers:
            self._skin.draw(frame)
        if known:
            self._name.position = self._tops[frame] + np.array([0.0, self._above, 0.0])

    def look_like(self, look: Look) -> None:
        before, self._look = self._look, look
        if (before.method, before.weights) != (look.method, look.weights) and self._skin is not None:
            self._skin.remove()
            self._skin = self._dressed()
        self._show_layers()
        self.draw(self._frame)

    def _dressed(self) -> Drawn | None:
        worn = self.figure.worn
        if worn is None:
            return None
        has = self._look.weights in worn.character.joint_names
        weights = self._look.weights if has else None
        return drawn_skin(self._scene, f"{self._node}/skin", worn, self._look.method, weights)

    def _show_layers(self) -> None:
        layers = self._look.layers
        if self._drawn_bones is not None:
            self._drawn_bones.visible = "skeleton" in layers
        for trail in self._trails:
            trail.visible = "trails" in layers
        self._name.visible = "names" in layers
        if self._skin is not None:
            self._skin.show("skin" in layers, self._look.opacity)


def _body_size(figure: Figure) -> float:
    """The longest side of the figure in a usual frame."""
    known = np.flatnonzero(figure.known)
    few = known[:: max(1, len(known) // 50)]
    places = np.concatenate([figure.heads[few], figure.tails[few]], axis=1)
    finite = np.isfinite(places).all(axis=-1, keepdims=True)
    high = np.where(finite, places, -np.inf).max(axis=1)
    low = np.where(finite, places, np.inf).min(axis=1)
    sides = (high - low).max(axis=1)
    return max(float(np.median(sides[np.isfinite(sides)])), 1e-6) if len(sides) else 1.0


def _tops(figure: Figure) -> tuple[NDArray[np.float64], float]:
    """(F, 3) the place over the middle of the figure at the height of its top, and how tall it is."""
    places = np.concatenate([figure.heads, figure.tails], axis=1).astype(np.float64)
    if not places.shape[1] and figure.worn is not None:
        places = figure.worn.poses[..., :3, 3]
    finite = np.isfinite(places).all(axis=-1, keepdims=True)
    high = np.where(finite, places, -np.inf).max(axis=1)
    low = np.where(finite, places, np.inf).min(axis=1)
    known = np.isfinite(high).all(axis=1)
    tops = np.where(known[:, None], (high + low) / 2, 0.0)
    tops[:, 1] = np.where(known, high[:, 1], 0.0)
    return tops, float(np.median((high - low)[known, 1]))


def _add_bones(scene: SceneApi, node: str, figure: Figure, bones: Placed, number: int) -> Any:
    if not figure.heads.shape[1]:
        return None
    return scene.add_batched_meshes_simple(
        node, BONE_VERTICES, BONE_FACES, batched_positions=bones.positions[0], batched_wxyzs=bones.wxyzs[0],
        batched_scales=bones.scales[0], batched_colors=bone_colours(figure.sides, number), lod="off",
    )  # fmt: skip


def _send_changed(handle: Any, bones: Placed, frame: int) -> None:
    """What differs from what the browser has; lengths of bones mostly never change."""
    for key, values in (
        ("batched_positions", bones.positions),
        ("batched_wxyzs", bones.wxyzs),
        ("batched_scales", bones.scales),
    ):
        if not np.array_equal(getattr(handle, key), values[frame]):
            setattr(handle, key, values[frame])


def _add_trails(scene: SceneApi, node: str, figure: Figure, size: float) -> list[Any]:
    every = max(1, round(1 / _TRAIL_RATE / figure.frame_time))
    added = []
    for number, trail in enumerate(figure.trails):
        places = trail.places[::every]
        pieces = np.stack([places[:-1], places[1:]], axis=1)
        pieces = pieces[np.isfinite(pieces).all(axis=(1, 2))]
        if not len(pieces):
            continue
        added.append(
            scene.add_line_segments(
                f"{node}/trails/{number + 1} {trail.joint.replace('/', ' ')}",
                pieces,
                TRAILS[number % len(TRAILS)],
                thickness=size * _TRAIL_WIDTH,
            )
        )
    return added
