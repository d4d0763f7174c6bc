"""Draws what each edit does, before and after, as strips of figures: docs/images/edit_*.svg.

python tools/editing_pictures.py docs/images

The clips are those that ship with gmr. Left limbs are blue, right ones red, the rest grey.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import gmr
from gmr import Motion
from gmr.demo import demo_folder
from gmr.editing import (
    Bar,
    Contacts,
    GroundPath,
    grip,
    ground_path,
    lock_feet,
    reach,
    splice,
    warp_path,
)
from gmr.partial import below

Floats = NDArray[np.float64]

UNIT = 0.0254 / 0.45
"""Metres in a unit of the demo clips."""

LEFT, RIGHT, MIDDLE = "#2a6ea9", "#b5452c", "#5a5f66"
GROUND, MARK, FAINT = "#9aa0a6", "#1d8a4e", "#c9cdd2"
ALONG = np.array([0.0, 0.0, 1.0])
"""Where the demo clips walk to; to the right in side views, which look at their right side."""

SMALL = 'font-size="12" fill="#5a5f66"'
SIDES = (LEFT, "left limbs"), (RIGHT, "right limbs")

SKIPPED = ("Thumb", "Finger", "Index", "_end")
"""Parts of names of joints whose bones are too small to draw, but the tips of toes."""


@dataclass
class Camera:
    """An orthographic view.

    Args:
        right: (3,) unit vector that points to the right of the picture.
        pixels: to a metre.
        origin: (2,) pixels of the world's origin.
        elevation: radians from which the ground is seen; 0: edge-on.
    """

    right: Floats
    pixels: float
    origin: tuple[float, float]
    elevation: float = 0.0

    def __call__(self, points: Floats) -> Floats:
        """(..., 2) pixels of (..., 3) points in metres."""
        x, up = points @ self.right, points[..., 1]
        away = points @ np.cross([0.0, 1.0, 0.0], self.right)
        height = up * np.cos(self.elevation) + away * np.sin(self.elevation)
        return np.stack([self.origin[0] + self.pixels * x, self.origin[1] - self.pixels * height], axis=-1)


@dataclass
class Page:
    """An SVG that grows."""

    width: float
    height: float
    parts: list[str] = field(default_factory=list)

    def line(self, points: Floats, colour: str, width: float, extra: str = "") -> None:
        """A line through points."""
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(
            f'<polyline points="{path}" stroke="{colour}" stroke-width="{width:g}" fill="none" {extra}/>'
        )

    def circle(self, at: Floats, radius: float, style: str) -> None:
        """A disc or ring."""
        self.parts.append(f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius:g}" {style}/>')

    def text(self, x: float, y: float, words: str, extra: str = "") -> None:
        """Words."""
        self.parts.append(f'<text x="{x:g}" y="{y:g}" {extra}>{words}</text>')

    def write(self, path: Path) -> None:
        """The page as a file."""
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width:g} {self.height:g}" '
            f'width="{self.width:g}" height="{self.height:g}" font-family="sans-serif" font-size="14" '
            'fill="#22262b" stroke-linecap="round" stroke-linejoin="round">'
            '<rect width="100%" height="100%" fill="white"/>'
        )
        path.write_text("\n".join([head, *self.parts, "</svg>\n"]), encoding="utf-8")


def metres(motion: Motion) -> Floats:
    return motion.positions(dtype=np.float64) * UNIT


def drawn(motion: Motion) -> list[tuple[int, int, str]]:
    """Parent, joint and colour of the bones worth drawing."""
    names, parents = motion.skeleton.names, motion.skeleton.parents.tolist()
    found = []
    for joint, parent in enumerate(parents):
        small = any(part in names[joint] for part in SKIPPED) and "Toe" not in names[joint]
        if parent < 0 or small or names[joint] == "Head":
            continue
        side = LEFT if names[joint].startswith(("Left", "LHip")) else RIGHT
        found.append(
            (
                parent,
                joint,
                side if names[joint].startswith(("L", "R")) and names[joint] != "LowerBack" else MIDDLE,
            )
        )
    return found


def figure(
    page: Page,
    motion: Motion,
    pose: Floats,
    camera: Camera,
    *,
    opacity: float = 1.0,
    width: float = 0.045,
    colour: str | None = None,
    only: set[int] | None = None,
) -> None:
    """One pose; the limb that is farther away is drawn first."""
    at = camera(pose)
    away = pose @ np.cross([0.0, 1.0, 0.0], camera.right)
    bones = sorted(drawn(motion), key=lambda bone: -(away[bone[0]] + away[bone[1]]))
    page.parts.append(f'<g opacity="{opacity:g}">')
    for parent, joint, side in bones:
        if (only is None or joint in only) and np.linalg.norm(pose[parent] - pose[joint]) > 1e-6:
            page.line(at[[parent, joint]], colour or side, width * camera.pixels)
    neck, head = (motion.skeleton.index(name) for name in ("Neck1", "Head"))
    if only is None or head in only:
        page.line(at[[neck, head]], colour or MIDDLE, width * camera.pixels)
        crown = motion.skeleton.index("Head_end")
        page.circle((at[head] + at[crown]) / 2, 0.095 * camera.pixels, f'fill="{colour or MIDDLE}"')
    page.parts.append("</g>")


def ground(page: Page, x0: float, x1: float, y: float) -> None:
    page.line(np.array([[x0, y], [x1, y]]), GROUND, 1.5)


def strip(
    page: Page,
    motion: Motion,
    frames: Iterable[int],
    x: float,
    y: float,
    step: float,
    pixels: float,
    **looks: object,
) -> None:
    """Side views of some frames, each with its hips above a place of its own."""
    places, hips = metres(motion), motion.skeleton.index("Hips")
    for k, frame in enumerate(frames):
        camera = Camera(ALONG, pixels, (x + k * step, y))
        figure(page, motion, places[frame] - places[frame, hips] * [1, 0, 1], camera, **looks)  # type: ignore[arg-type]


def title(page: Page, words: str, more: str, *key: tuple[str, str]) -> None:
    """The heading, and below it what each colour means."""
    page.text(24, 28, f'<tspan font-weight="bold">{words}</tspan>: {more}')
    said = [f'<tspan fill="{colour}" font-weight="bold">{name}</tspan>' for colour, name in key]
    page.text(24, 48, " &#160;&#160; ".join(said), SMALL)


def locked(folder: Path) -> None:
    """A stance of each foot: the lower leg in every third frame, before and after, and when feet rest."""
    motion = gmr.read(demo_folder() / "07_01.bvh")
    edited = lock_feet(motion)
    held = edited.report.contacts
    page = Page(960, 592)
    title(page, "lock_feet", "a walk, and the same with its feet held where they stand", *SIDES,
          (MARK, "ball of the left foot"))  # fmt: skip
    frames = list(range(20, 317, 24))
    for y, clip, words in ((214, motion, "before"), (384, edited.motion, "after")):
        ground(page, 24, 936, y)
        strip(page, clip, frames, 62, y, 69, 78)
        page.text(24, y - 138, words)
    contact_bars(page, held, 62, 420, 69 / 24, frames[0], frames[-1])
    stance = held.of("LeftToeBase")[0]
    for x, clip, words in ((60, motion, "before"), (532, edited.motion, "after")):
        joints = [
            clip.skeleton.index(name) for name in ("LeftLeg", "LeftFoot", "LeftToeBase", "LeftToeBase_end")
        ]
        legs = metres(clip)[stance.first : stance.end, joints]
        middle = np.median(metres(motion)[stance.first : stance.end, joints[2]], axis=0)
        camera = Camera(ALONG, 620, (x + 170, 576))
        page.parts.append(
            f'<clipPath id="{words}"><rect x="{x - 36}" y="464" width="440" height="124"/></clipPath>'
        )
        page.parts.append(f'<g clip-path="url(#{words})">')
        shown = legs - middle * [1, 0, 1]
        for leg in shown[::3]:
            page.line(camera(leg), LEFT, 3, 'opacity="0.35"')
        page.line(camera(shown[:, 2]), MARK, 1.6)
        for leg in shown[::3]:
            page.circle(camera(leg[2]), 3.2, f'fill="{MARK}"')
        page.parts.append("</g>")
        ground(page, x - 36, x + 404, 576)
        slid = edited.report.slide_before_mm if words == "before" else edited.report.slide_after_mm
        page.text(x + 216, 482, f"{words}, one stance overlaid:")
        page.text(x + 216, 500, f"the ball goes {slid[0]:.0f} mm")
    page.write(folder / "edit_lock_feet.svg")


def contact_bars(page: Page, held: Contacts, x: float, y: float, step: float, first: int, last: int) -> None:
    """When each foot rests, as bars under a strip."""
    for row, (name, colour) in enumerate((("LeftToeBase", LEFT), ("RightToeBase", RIGHT))):
        for one in held.of(name):
            a, b = max(one.first, first), min(one.end - 1, last)
            if a < b:
                ends = np.array(
                    [[x + (a - first) * step, y + 11 * row], [x + (b - first) * step, y + 11 * row]]
                )
                page.line(ends, colour, 6)
    page.text(
        24, y - 12, "when each foot rests on the ground, found in the walk before; time as above", SMALL
    )


def gripped(folder: Path) -> None:
    """A walker who pushes a trolley: the bar goes ahead of the body at one height."""
    motion = gmr.read(demo_folder() / "07_01.bvh")
    path = ground_path(motion)
    ahead = np.stack([np.sin(path.heading), np.zeros(len(path)), np.cos(path.heading)], axis=1)
    place = np.insert(path.ground, 1, 0.0, axis=1) * UNIT + 0.34 * ahead + [0, 1.0, 0]
    edited = grip(motion, bar=Bar(place / UNIT, np.cross(ahead, [0, 1, 0])), spacing=0.5 / UNIT)
    page = Page(960, 452)
    title(
        page, "grip", "a walk with both hands on a bar that goes ahead of the body", *SIDES, (MARK, "the bar")
    )
    right = np.array([np.sin(1.0), 0.0, np.cos(1.0)])
    for y, clip in ((218, motion), (420, edited.motion)):
        places = metres(clip)
        page.text(24, y - 142, "before" if clip is motion else "after")
        for k, frame in enumerate(range(20, 317, 36)):
            moved = places[frame] - np.insert(path.ground[frame] * UNIT, 1, 0.0)
            camera = Camera(right, 84, (80 + 100 * k, y), 0.2)
            figure(page, clip, moved, camera)
            if clip is not motion:
                hands = moved[[clip.skeleton.index(name) for name in ("LeftHand", "RightHand")]]
                over = 0.12 * (hands[1] - hands[0]) / np.linalg.norm(hands[1] - hands[0])
                page.line(camera(np.stack([hands[0] - over, hands[1] + over])), MARK, 4.5)
    page.write(folder / "edit_grip.svg")


def spliced(folder: Path) -> None:
    """The legs of a walk and the arms of a run."""
    walk, run = (gmr.read(demo_folder() / f"{name}.bvh") for name in ("07_01", "09_01"))
    edited = splice(walk, run, "Spine")
    page = Page(960, 644)
    below, above = "#5a5f66", "#d08a1d"
    title(page, "splice", "the legs of a walk, the upper body of a run", (below, "of the walk"),
          (above, "of the run"))  # fmt: skip
    frames = list(range(8, 149, 12))
    for y, clip, words in (
        (224, walk, "lower: a walk"),
        (416, run, "upper: a run"),
        (608, edited.motion, "spliced"),
    ):
        ground(page, 24, 936, y)
        page.text(24, y - 140, words)
        places, hips = metres(clip), clip.skeleton.index("Hips")
        for k, frame in enumerate(frames):
            pose = places[frame] - places[frame, hips] * [1, 0, 1]
            camera = Camera(ALONG, 88, (90 + 72 * k, y))
            if clip is edited.motion:
                halves(page, clip, pose, camera, below, above)
            else:
                figure(page, clip, pose, camera, colour=below if clip is walk else above)
    page.write(folder / "edit_splice.svg")


def halves(page: Page, motion: Motion, pose: Floats, camera: Camera, lower: str, upper: str) -> None:
    """A pose with what hangs on the seam in another colour."""
    hanging = set(below(motion.skeleton, "Spine")) - {motion.skeleton.index("Spine")}
    figure(page, motion, pose, camera, colour=upper, only=hanging)
    figure(page, motion, pose, camera, colour=lower, only=set(range(len(pose))) - hanging)


def warped(folder: Path) -> None:
    """Seen from above: a straight walk, and the same bent to the left, with where the feet rest."""
    motion = gmr.read(demo_folder() / "07_01.bvh")
    bent = warp_path(motion, turn_deg=70)
    held = warp_path(motion, turn_deg=70, lock=True)
    page = Page(960, 700)
    title(
        page,
        "warp_path",
        "a straight walk, sent around a bend of 70 degrees",
        (LEFT, "left foot where it rests"),
        (RIGHT, "right foot where it rests"),
        (MARK, "way of its ball"),
        (GROUND, "path of the body"),
    )
    rows = ((motion, bent.report.before, "before, from above"),
            (bent.motion, bent.report.path, "turn_deg=70, from above"),
            (held.motion, held.report.path, "turn_deg=70, lock=True, from above"))  # fmt: skip
    slides = [warp_path(motion).report.slide_mm, bent.report.slide_mm, held.report.lock.slide_after_mm]  # type: ignore[union-attr]
    spots = ((24, 186, 84), (24, 434, 214), (500, 434, 214))
    for (x, y, above), (clip, path, words), slid in zip(spots, rows, slides, strict=True):
        page.text(x, above, words)
        page.text(x, above + 18, f"a foot slides {slid.mean():.0f} mm while it rests", SMALL)
        footprints(page, clip, bent.report.contacts, path, Camera(ALONG, 112, (x + 290, y), np.pi / 2))
    page.text(24, 500, "turn_deg=70, lock=True, from the side")
    camera = Camera(ALONG, 112, (480, 690), 0.35)
    places = metres(held.motion)
    page.line(camera(np.insert(held.report.path.ground * UNIT, 1, 0.0, axis=1)), FAINT, 2)
    for frame in range(310, 3, -34):
        figure(page, held.motion, places[frame], camera)
    page.write(folder / "edit_warp_path.svg")


def footprints(page: Page, motion: Motion, held: Contacts | None, path: GroundPath, camera: Camera) -> None:
    """The path, and each foot in every fourth frame of its contacts."""
    page.line(camera(np.insert(path.ground * UNIT, 1, 0.0, axis=1)), FAINT, 2.5)
    places = metres(motion)
    for one in held or ():
        side = one.joint.removesuffix("ToeBase")
        joints = [motion.skeleton.index(f"{side}{part}") for part in ("Foot", "ToeBase", "ToeBase_end")]
        for foot in places[one.first : one.end : 4, joints]:
            page.line(camera(foot), LEFT if side == "Left" else RIGHT, 6, 'opacity="0.3"')
        page.line(camera(places[one.first : one.end, joints[1]]), MARK, 2)


def reached(folder: Path) -> None:
    """A hand that passes through a point: its path, and the figure around that frame."""
    motion = gmr.read(demo_folder() / "07_01.bvh")
    frame, hand = 100, motion.skeleton.index("RightHand")
    before = metres(motion)
    target = before[frame, motion.skeleton.index("RightArm")] + [-0.14, 0.08, 0.42]
    edited = reach(motion, "RightHand", target / UNIT, frame, window=0.6)
    after = metres(edited.motion)
    page = Page(960, 372)
    title(
        page,
        "reach",
        "the right hand of a walker passes through a point, with 0.6 s to get there and 0.6 s to get back",
        *SIDES,
        (MARK, "the point, and the path of the hand"),
        (GROUND, "before: the arm, and the path of the hand (dashed)"),
    )
    camera = Camera(np.array([np.sin(0.3), 0.0, np.cos(0.3)]), 176, (0, 356), 0.08)
    middle = camera(before[frame, motion.skeleton.index("Hips")])
    camera.origin = (440 - middle[0], 348)
    ground(page, 24, 936, 352)
    for moment in range(frame - 96, frame + 145, 24):
        looks = 1.0 if moment == frame else 0.45
        figure(page, motion, before[moment], camera, opacity=0.18, colour="#5a5f66")
        figure(page, edited.motion, after[moment], camera, opacity=looks)
    span = slice(frame - 98, frame + 150)
    page.line(camera(before[span, hand]), GROUND, 1.6, 'stroke-dasharray="2 5"')
    page.line(camera(after[span, hand]), MARK, 2.2)
    page.circle(camera(target), 8, f'fill="none" stroke="{MARK}" stroke-width="2.5"')
    page.circle(camera(target), 2.5, f'fill="{MARK}"')
    page.write(folder / "edit_reach.svg")


def main() -> None:
    folder = Path(sys.argv[1])
    for draw in (locked, gripped, spliced, warped, reached):
        draw(folder)


if __name__ == "__main__":
    main()
