"""Meshes drawn off the screen by PyVista (VTK): stills and a film."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.errors import MissingExtraError
from gmr.skinning.character import Character

if TYPE_CHECKING:
    import pyvista

__all__ = ["Look", "View", "film", "film_frames", "look_of", "still"]

_SKIN: Final = "#c9b49c"
_GROUND: Final = "#e9ecef"
_FILM_RATE: Final = 30

Progress = Callable[[int], None]


@dataclass(frozen=True)
class Look:
    """What a mesh looks like: parts that follow each other, each with a picture or a colour."""

    faces: NDArray[np.int32]
    parts: tuple[tuple[int, int, NDArray[np.float32] | None, bytes | None, str], ...] = ()
    """First vertex, one past the last, texture coordinates, the picture's bytes, a colour."""


@dataclass(frozen=True)
class View:
    """One of several pictures side by side."""

    title: str
    vertices: NDArray[np.float32]
    """(V, 3), or (F, V, 3) for a film; metres, Y up."""
    look: Look
    colours: NDArray[np.uint8] | None = None
    """(V, 3) red, green and blue of the vertices, instead of their look."""


def look_of(character: Character) -> Look:
    """Materials' colours and base colour pictures of the skinned parts."""
    parts, start = [], 0
    for part in character.skinned_parts:
        material = None if part.material is None else character.materials[part.material]
        use = None if material is None else material.base_color_texture
        drawn = use is not None and use.coordinates == 0 and part.texture_coordinates is not None
        picture = character.textures[use.texture].data if use is not None and drawn else None
        colour = _SKIN if material is None else _display(material.base_color)
        coordinates = part.texture_coordinates if drawn else None
        parts.append((start, start + len(part.vertices), coordinates, picture, colour))
        start += len(part.vertices)
    return Look(character.faces, tuple(parts))


def still(views: Sequence[View], direction: Sequence[float], *, size: tuple[int, int]) -> bytes:
    """The views side by side as a PNG, seen from ``direction``, all to one scale."""
    with _plotter(views, size) as (plotter, _):
        _look_at(plotter, views, direction)
        pixels = plotter.screenshot(return_img=True)
    return _png(pixels)


def film(
    views: Sequence[View],
    direction: Sequence[float],
    path: str | Path,
    *,
    frame_time: float,
    size: tuple[int, int],
    advance: Progress = lambda frame: None,
) -> None:
    """The views side by side as an MP4 (H.264), 30 frames a second, in real time; the camera goes along.

    ``advance`` hears of each frame that is done.
    """
    writer = _film_writer(path, size)
    try:
        with _plotter([_at(view, 0) for view in views], size) as (plotter, drawn):
            for number, frame in enumerate(film_frames(len(views[0].vertices), frame_time)):
                now = [_at(view, frame) for view in views]
                for meshes, view in zip(drawn, now, strict=True):
                    _move(meshes, view)
                _look_at(plotter, now, direction)
                plotter.render()
                writer.send(np.ascontiguousarray(plotter.screenshot(return_img=True)))
                advance(number + 1)
    finally:
        writer.close()


def film_frames(frame_count: int, frame_time: float) -> list[int]:
    """Which frames a film in real time shows."""
    shown = np.arange(0, frame_count * frame_time, 1 / _FILM_RATE) / frame_time
    return [min(round(place), frame_count - 1) for place in shown.tolist()]


def _at(view: View, frame: int) -> View:
    return View(view.title, view.vertices[frame], view.look, view.colours)


@contextmanager
def _plotter(
    views: Sequence[View], size: tuple[int, int]
) -> Iterator[tuple[pyvista.Plotter, list[list[pyvista.PolyData]]]]:
    """The views drawn, and the meshes of each: its parts, then the ground."""
    try:
        import pyvista
    except ImportError:
        raise MissingExtraError("pyvista", "render", "Drawing skinned meshes") from None
    # VTK tries a screen first, and where there is none says so before it goes on without.
    pyvista.vtk_verbosity("off")
    plotter = pyvista.Plotter(shape=(1, len(views)), off_screen=True, window_size=list(size), border=False)
    try:
        plotter.set_background("white")
        drawn = []
        for column, view in enumerate(views):
            plotter.subplot(0, column)
            plotter.add_text(view.title, position="upper_edge", font_size=11, color="#16191d")
            drawn.append(_draw(plotter, view))
        yield plotter, drawn
    finally:
        plotter.close()


def _draw(plotter: pyvista.Plotter, view: View) -> list[pyvista.PolyData]:
    meshes = []
    for start, end, coordinates, picture, colour in view.look.parts:
        mesh = _mesh(view, start, end)
        meshes.append(mesh)
        options: dict[str, Any] = {"color": colour, "smooth_shading": True, "specular": 0.15}
        if view.colours is not None:
            mesh["colours"] = view.colours[start:end]
            options = {"scalars": "colours", "rgb": True, "smooth_shading": True, "ambient": 0.2}
        elif picture is not None and coordinates is not None:
            # VTK counts pictures from below, glTF from above.
            mesh.active_texture_coordinates = coordinates * [1, -1] + [0, 1]
            options = {"texture": _texture(picture), "smooth_shading": True}
        plotter.add_mesh(mesh, split_sharp_edges=False, **options)
    meshes.append(_ground(view))
    plotter.add_mesh(meshes[-1], color=_GROUND, lighting=False)
    return meshes


def _mesh(view: View, start: int, end: int) -> pyvista.PolyData:
    import pyvista

    own = view.look.faces[(view.look.faces[:, 0] >= start) & (view.look.faces[:, 0] < end)] - start
    cells = np.concatenate([np.full((len(own), 1), 3), own], axis=1)
    mesh = pyvista.PolyData(view.vertices[start:end].copy(), cells.reshape(-1))
    return mesh.compute_normals(cell_normals=False, split_vertices=False, consistent_normals=False)


def _ground(view: View) -> pyvista.PolyData:
    import pyvista

    extent = float(np.ptp(view.vertices, axis=0).max())
    disc = pyvista.Disc(inner=0, outer=0.5 * extent, normal=(0, 1, 0), c_res=60)
    disc.points += _foot(view)
    return disc


def _foot(view: View) -> NDArray[np.float32]:
    """The point below a mesh on which it stands; a little lower, so that soles are seen."""
    low, high = view.vertices.min(axis=0), view.vertices.max(axis=0)
    foot: NDArray[np.float32] = 0.5 * (low + high)
    foot[1] = low[1] - 0.002 * (high - low).max()
    return foot


def _move(meshes: Sequence[pyvista.PolyData], view: View) -> None:
    """Puts a view's meshes where its vertices are; the ground stays below them, at its height."""
    *parts, ground = meshes
    for mesh, (start, end, *_) in zip(parts, view.look.parts, strict=True):
        mesh.points = view.vertices[start:end].copy()
        mesh.compute_normals(cell_normals=False, split_vertices=False, consistent_normals=False, inplace=True)
    way = _foot(view) - ground.points.mean(axis=0)
    way[1] = 0
    ground.points = ground.points + way


def _look_at(plotter: pyvista.Plotter, views: Sequence[View], direction: Sequence[float]) -> None:
    """All cameras from one side, to one scale, each on the middle of its mesh."""
    toward = np.asarray(direction, float) / np.linalg.norm(direction)
    extent = max(float(np.ptp(view.vertices, axis=0).max()) for view in views)
    for column, view in enumerate(views):
        plotter.subplot(0, column)
        middle = 0.5 * (view.vertices.min(axis=0) + view.vertices.max(axis=0)).astype(float)
        plotter.camera.parallel_projection = True
        plotter.camera.focal_point = middle
        plotter.camera.position = middle + 5 * extent * toward
        plotter.camera.up = (0, 1, 0)
        plotter.camera.parallel_scale = 0.58 * extent
        plotter.reset_camera_clipping_range()


def _texture(picture: bytes) -> pyvista.Texture:
    import pyvista
    from PIL import Image

    with Image.open(io.BytesIO(picture)) as opened:
        return pyvista.numpy_to_texture(np.asarray(opened.convert("RGB")))


def _png(pixels: NDArray[np.uint8]) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(pixels).quantize(200).save(file, "PNG", optimize=True)
    return file.getvalue()


def _film_writer(path: str | Path, size: tuple[int, int]) -> Any:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise MissingExtraError("imageio-ffmpeg", "render", "Writing a film") from None
    writer = imageio_ffmpeg.write_frames(
        str(path),
        size,
        fps=_FILM_RATE,
        codec="libx264",
        macro_block_size=2,
        output_params=["-crf", "26", "-preset", "fast", "-movflags", "+faststart"],
    )
    writer.send(None)
    return writer


def _display(linear: tuple[float, float, float, float]) -> str:
    """A linear colour as a screen shows it (sRGB)."""
    shown = [12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055 for c in linear[:3]]
    return "#" + "".join(f"{round(255 * min(max(c, 0.0), 1.0)):02x}" for c in shown)
