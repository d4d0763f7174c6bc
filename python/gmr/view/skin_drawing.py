"""A worn character in a viser scene: carried by the browser, or as vertices that gmr's kernels blend."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from gmr.view.browser_skin import BrowserSkin, browser_skin
from gmr.view.figure import finite_poses
from gmr.view.patches import Patch, plain_patches, weight_patches

if TYPE_CHECKING:
    from viser import SceneApi

    from gmr.skinning.blending import Method
    from gmr.view.figure import Worn

__all__ = ["Drawn", "drawn_skin", "is_carried_by_browser"]

_MOST_JOINTS = 300
"""Joints times patches above which a message for each costs more than the vertices."""


class Drawn(Protocol):
    """A skin in the scene."""

    def draw(self, frame: int) -> None:
        """As it is in a frame; nothing where the pose is not known."""

    def show(self, visible: bool, opacity: float) -> None:
        """Whether it is seen, and how much hides behind it."""

    def remove(self) -> None:
        """Takes it out of the scene."""


def drawn_skin(scene: SceneApi, node: str, worn: Worn, method: Method, weights: str | None) -> Drawn:
    """Adds a skin to the scene.

    The browser blends linearly, and so carries a skin by itself where that is asked for and it can
    (:func:`gmr.view.browser_skin.browser_skin`); all else are vertices from ``character.skin``.

    Args:
        scene: of viser.
        node: under which it is added.
        worn: F frames.
        method: "lbs", "dqbs" or "cor".
        weights: a joint whose weights colour it.
    """
    character = worn.character
    patches = plain_patches(character) if weights is None else weight_patches(character, weights)
    skin = browser_skin(worn) if is_carried_by_browser(worn, method, weights, len(patches)) else None
    return (
        _Blended(scene, node, worn, patches, method)
        if skin is None
        else _Carried(scene, node, worn, patches, skin)
    )


def is_carried_by_browser(worn: Worn, method: Method, weights: str | None, patches: int = 1) -> bool:
    """Whether joints are sent to the browser, where the skin allows it, rather than vertices."""
    return method == "lbs" and weights is None and patches * len(worn.character.joints) <= _MOST_JOINTS


class _Patched:
    """A mesh for each patch."""

    def __init__(self, worn: Worn) -> None:
        self._known = finite_poses(worn.poses)
        self._visible, self._is_known = True, True
        self._meshes: list[Any] = []

    def show(self, visible: bool, opacity: float) -> None:
        self._visible = visible
        shade = None if opacity == 1 else opacity
        for mesh in self._meshes:
            if mesh.opacity != shade:
                mesh.opacity = shade
        self._set_visible()

    def remove(self) -> None:
        for mesh in self._meshes:
            mesh.remove()

    def _is_drawn(self, frame: int) -> bool:
        self._is_known = bool(self._known[frame])
        self._set_visible()
        return self._is_known

    def _set_visible(self) -> None:
        seen = self._visible and self._is_known
        for mesh in self._meshes:
            if mesh.visible != seen:
                mesh.visible = seen


class _Carried(_Patched):
    """The browser has the vertices, and is told where the joints are."""

    def __init__(
        self, scene: SceneApi, node: str, worn: Worn, patches: list[Patch], skin: BrowserSkin
    ) -> None:
        super().__init__(worn)
        self._skin = skin
        joints = skin.wxyzs.shape[1]
        still, origin = np.tile([1.0, 0.0, 0.0, 0.0], (joints, 1)), np.zeros((joints, 3))
        self._meshes = [
            scene.add_mesh_skinned(
                f"{node}/{number + 1}", skin.vertices[patch.vertices], patch.faces, bone_wxyzs=still,
                bone_positions=origin, skin_weights=skin.weights[patch.vertices], color=patch.colour,
                side="double",
                receive_shadow=False,
            )
            for number, patch in enumerate(patches)
        ]  # fmt: skip

    def draw(self, frame: int) -> None:
        if not self._is_drawn(frame):
            return
        for mesh in self._meshes:
            poses = zip(mesh.bones, self._skin.wxyzs[frame], self._skin.positions[frame], strict=True)
            for bone, wxyz, position in poses:
                bone.wxyz, bone.position = wxyz, position


class _Blended(_Patched):
    """The browser is sent all vertices, frame by frame."""

    def __init__(self, scene: SceneApi, node: str, worn: Worn, patches: list[Patch], method: Method) -> None:
        super().__init__(worn)
        self._worn, self._patches, self._method = worn, patches, method
        first = int(np.argmax(self._known))
        vertices = self._vertices(first)
        self._meshes = [
            scene.add_mesh_simple(
                f"{node}/{number + 1}",
                vertices[patch.vertices],
                patch.faces,
                color=patch.colour,
                side="double",
                receive_shadow=False,
            )
            for number, patch in enumerate(patches)
        ]

    def draw(self, frame: int) -> None:
        if not self._is_drawn(frame):
            return
        vertices = self._vertices(frame)
        for mesh, patch in zip(self._meshes, self._patches, strict=True):
            mesh.vertices = vertices[patch.vertices]

    def _vertices(self, frame: int) -> NDArray[np.float32]:
        return np.asarray(self._worn.character.skin(self._worn.poses[frame], self._method)[0], np.float32)
