"""Draws the pictures that explain the General Motion Representation.

python tools/gmr_pictures.py docs/images
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import gmr
from gmr import Motion
from gmr.demo import demo_folder

BLUE, ORANGE, GREEN, PURPLE, TEAL, RED = "#2a6ea9", "#c8711a", "#3a8a4d", "#7a4fa3", "#12a3a3", "#c0392b"
INK, GREY, PALE = "#1c1c1c", "#777777", "#bbbbbb"
RADIUS = 7.0
PANEL_WIDTH, TREE_HEIGHT, LINE = 330.0, 190.0, 21.0

Place = tuple[float, float]


@dataclass(frozen=True)
class Panel:
    """A forest: joints in their places, what hangs on what, and what is stored.

    Args:
        title: above it.
        places: of each joint.
        bones: (parent, child, colour of the rotation that turns the bone).
        roots: joints with a place of their own in the world.
        links: soft links, (joint, old parent).
        notes: below it.
        hollow: joints drawn as rings.
        beside: where names stand as seen from their joints; above them by default.
    """

    title: str
    places: Mapping[str, Place]
    bones: Sequence[tuple[str, str, str]]
    roots: Sequence[str]
    links: Sequence[tuple[str, str]] = ()
    notes: Sequence[str] = ()
    hollow: Sequence[str] = ()
    beside: Mapping[str, Place] = field(default_factory=dict)


def text(x: float, y: float, words: str, *, size: int = 14, colour: str = INK, style: str = "") -> str:
    """Words; ``_x`` is a subscript, and ``^-1`` a superscript."""
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{colour}" {style}>{marked(words)}</text>'


def marked(words: str) -> str:
    """Words with their sub- and superscripts."""
    made, rest = "", words
    while (at := min((k for k in (rest.find("_"), rest.find("^")) if k >= 0), default=-1)) >= 0:
        end = at + 1
        while end < len(rest) and (rest[end].isalnum() or rest[end] == "-"):
            end += 1
        shift = 4 if rest[at] == "_" else -5
        made += f'{rest[:at]}<tspan dy="{shift}" font-size="75%">{rest[at + 1 : end]}</tspan>'
        made += f'<tspan dy="{-shift}">&#8203;</tspan>'
        rest = rest[end:]
    return made + rest


def bone(start: Place, end: Place, colour: str) -> str:
    """A bone, with the head of an arrow in its middle that points at the child."""
    a, b = np.array(start), np.array(end)
    along = (b - a) / np.hypot(*(b - a))
    across = np.array([-along[1], along[0]])
    head = (a + b) / 2 + 7 * along
    corners = (head, head - 13 * along + 6 * across, head - 13 * along - 6 * across)
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return (
        f'<line x1="{a[0]}" y1="{a[1]}" x2="{b[0]}" y2="{b[1]}" stroke="{colour}" stroke-width="3.5"/>'
        f'<polygon points="{points}" fill="{colour}"/>'
    )


def joint(place: Place, name: str, beside: Place, *, is_root: bool, is_hollow: bool) -> str:
    """A joint: a root is a square."""
    x, y = place
    if is_root:
        side = 2 * RADIUS + 3
        shape = f'<rect x="{x - side / 2}" y="{y - side / 2}" width="{side}" height="{side}" fill="{RED}"/>'
    else:
        fill = f'fill="white" stroke="{INK}" stroke-width="2"' if is_hollow else f'fill="{INK}"'
        shape = f'<circle cx="{x}" cy="{y}" r="{RADIUS}" {fill}/>'
    return shape + text(x + beside[0], y + beside[1], name)


def drawn(panel: Panel) -> str:
    """A panel, its corner at the origin."""
    parts = [text(PANEL_WIDTH / 2, 18, panel.title, style='font-weight="bold"')]
    for lower, upper in panel.links:
        (x1, y1), (x2, y2) = panel.places[lower], panel.places[upper]
        parts.append(
            f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{GREY}" stroke-width="2.5" '
            'stroke-dasharray="3 6"/>'
        )
    for upper, lower, colour in panel.bones:
        parts.append(bone(panel.places[upper], panel.places[lower], colour))
    for name, place in panel.places.items():
        beside = panel.beside.get(name, (0.0, -14.0))
        parts.append(joint(place, name, beside, is_root=name in panel.roots, is_hollow=name in panel.hollow))
    for k, note in enumerate(panel.notes):
        parts.append(text(PANEL_WIDTH / 2, TREE_HEIGHT + 26 + k * LINE, note))
    return "\n".join(parts)


def figure(panels: Sequence[Panel], between: str = "", key: Iterable[str] = ()) -> str:
    """Panels side by side, with an arrow between two of which one becomes the other."""
    gap = 90.0 if between else 16.0
    notes = max(len(panel.notes) for panel in panels)
    key = list(key)
    width = len(panels) * PANEL_WIDTH + (len(panels) - 1) * gap + 24
    height = TREE_HEIGHT + 26 + notes * LINE + (34 if key else 0)
    parts = []
    for k, panel in enumerate(panels):
        left = 12 + k * (PANEL_WIDTH + gap)
        parts.append(f'<g transform="translate({left} 8)">\n{drawn(panel)}\n</g>')
        if between and k:
            x, y = left - gap / 2, 8 + TREE_HEIGHT / 2
            parts.append(
                f'<path d="M{x - 32},{y} h54 m-10,-9 l12,9 l-12,9" fill="none" stroke="{GREY}" '
                f'stroke-width="3"/>' + text(x, y - 18, between, colour=GREY)
            )
    if key:
        parts.append(text(width / 2, height - 12, " &#160;&#160; ".join(key), size=13, colour=GREY))
    return page(width, height, parts)


def page(width: float, height: float, parts: Iterable[str]) -> str:
    """A picture on white, which stays readable where a page is dark."""
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" '
            f'height="{height:g}" font-family="sans-serif" text-anchor="middle" stroke-linejoin="round">',
            '<rect width="100%" height="100%" rx="6" fill="white"/>',
            *parts,
            "</svg>\n",
        ]
    )


KEY = ("red square: a root, placed in the world", "arrow: from a joint to what hangs on it")

HIP = {"hips": (165.0, 115.0), "spine": (165.0, 58.0), "left": (85.0, 170.0), "right": (245.0, 170.0)}
HIP_NAMES = {"hips": (32.0, 4.0), "spine": (34.0, 5.0), "left": (-26.0, 5.0), "right": (28.0, 5.0)}


def two_forms() -> str:
    """Post- and pre-rotation: what a rotation turns."""
    post = Panel(
        "post-rotation: BVH, glTF",
        HIP,
        [("hips", name, BLUE) for name in ("spine", "left", "right")],
        ["hips"],
        beside=HIP_NAMES,
        notes=("P_child = P_hips + R_hips t_child", "one rotation, in the joint, turns all three"),
    )
    pre = Panel(
        "pre-rotation: GMR, ASF/AMC",
        HIP,
        [("hips", "spine", GREEN), ("hips", "left", ORANGE), ("hips", "right", PURPLE)],
        ["hips"],
        beside=HIP_NAMES,
        notes=("P_child = P_hips + R_child t_child", "each bone has a rotation of its own"),
    )
    slots = Panel(
        "stored: rotation slots",
        HIP,
        [("hips", "spine", BLUE), ("hips", "left", BLUE), ("hips", "right", ORANGE)],
        ["hips"],
        beside=HIP_NAMES,
        notes=("bone j turns with slot s(j)", "bones that turn alike share a slot (one colour)"),
    )
    return figure([post, pre, slots], key=(KEY[0], "one colour: bones that one rotation turns"))


SHIFTED = {
    "0": (130.0, 120.0),
    "1": (215.0, 85.0),
    "0i": (50.0, 75.0),
    "0k": (70.0, 175.0),
    "1j": (290.0, 40.0),
    "1l": (295.0, 135.0),
}


def shift_root() -> str:
    """The tree hangs on joint 1 instead of joint 0."""
    before = Panel(
        "root 0",
        SHIFTED,
        [("0", "1", BLUE), ("0", "0i", GREEN), ("0", "0k", ORANGE), ("1", "1j", PURPLE), ("1", "1l", TEAL)],
        ["0"],
        notes=(
            "place in the world: g",
            "root: R_0",
            "bone 0 to 1: R_1, t_1",
            "0's other children: R_0i, t_0i",
            "1's children: R_1j, t_1j",
        ),
    )
    after = Panel(
        "root 1",
        SHIFTED,
        [("1", "0", BLUE), ("0", "0i", GREEN), ("0", "0k", ORANGE), ("1", "1j", PURPLE), ("1", "1l", TEAL)],
        ["1"],
        notes=(
            "g' = R_0 R_1 t_1 + g",
            "root: R_1' = R_0",
            "bone 1 to 0: R_0' = R_1, t_0' = -t_1",
            "R_0i' = R_1^-1 R_0i, t_0i stays",
            "R_1j' = R_1 R_1j, t_1j stays",
        ),
    )
    return figure([before, after], "shift root", KEY)


SPLIT = {
    "hips": (65.0, 150.0),
    "chest": (125.0, 80.0),
    "0": (195.0, 85.0),
    "1": (255.0, 130.0),
    "tip": (305.0, 90.0),
}
ARM_NAMES = {"hips": (-32.0, 5.0), "1": (0.0, 24.0)}
ARM = [("hips", "chest", GREEN), ("chest", "0", ORANGE), ("0", "1", BLUE), ("1", "tip", PURPLE)]
APART = [edge for edge in ARM if edge[1] != "1"]


def split_tree() -> str:
    """Joint 1 becomes a root of its own."""
    before = Panel(
        "one tree",
        SPLIT,
        ARM,
        ["hips"],
        beside=ARM_NAMES,
        notes=("bone 0 to 1: R_1, t_1", "M_1 = [ R_s t_s; 0 1 ]"),
    )
    after = Panel(
        "two trees, and a soft link",
        SPLIT,
        APART,
        ["hips", "1"],
        [("1", "0")],
        beside=ARM_NAMES,
        notes=("R_1' = R_s, g_1 = t_s in every frame", "what hangs on 1 stays as it is"),
    )
    return figure([before, after], "split", (*KEY, "dotted: soft link"))


def join_trees() -> str:
    """Root 1 hangs on its old parent again, also where somebody moved it."""
    edited = {**SPLIT, "1": (262.0, 160.0), "tip": (312.0, 120.0)}
    before = Panel(
        "two trees; somebody moved 1",
        edited,
        APART,
        ["hips", "1"],
        [("1", "0")],
        beside=ARM_NAMES,
        notes=("M_0 = [ R_p t_p; 0 1 ], &#160; M_1' = [ R_s t_s; 0 1 ]",),
    )
    after = Panel(
        "one tree",
        edited,
        ARM,
        ["hips"],
        beside=ARM_NAMES,
        notes=("R_1 = R_p^-1 R_s, &#160; t_1 = R_s^-1 (t_s - t_p)", "the offset again, unless it was moved"),
    )
    return figure([before, after], "join", (*KEY, "dotted: soft link"))


def dummies() -> str:
    """A joint without length goes; its rotation goes into those of its children."""
    with_dummy = {
        "hips": (85.0, 110.0),
        "LHipJoint": (150.0, 110.0),
        "LeftUpLeg": (225.0, 165.0),
        "spine": (85.0, 52.0),
    }
    names = {"hips": (-32.0, 5.0), "LHipJoint": (46.0, 0.0), "LeftUpLeg": (48.0, 5.0), "spine": (34.0, 5.0)}
    lean = {name: place for name, place in with_dummy.items() if name != "LHipJoint"}
    before = Panel(
        "BVH: a joint of zero length",
        with_dummy,
        [("hips", "LHipJoint", BLUE), ("LHipJoint", "LeftUpLeg", ORANGE), ("hips", "spine", BLUE)],
        ["hips"],
        notes=(
            "drawn apart; it lies in hips in every frame",
            "so that the leg need not turn as the spine does",
        ),
        hollow=["LHipJoint"],
        beside=names,
    )
    after = Panel(
        "GMR: none is needed",
        lean,
        [("hips", "LeftUpLeg", GREEN), ("hips", "spine", BLUE)],
        ["hips"],
        beside=names,
        notes=("R_c'' = R_d' R_c' for each child c of dummy d", "c hangs on d's parent by its own offset"),
    )
    key = (KEY[0], "ring: the dummy", "one colour: bones that one rotation turns")
    return figure([before, after], "drop", key)


def configurations() -> str:
    """One frame of a walk in four configurations."""
    motion = gmr.read(demo_folder() / "07_01.bvh").drop_dummies()
    proper = [name for name, end in zip(motion.skeleton.names, motion.skeleton.ends, strict=True) if not end]
    choices: list[tuple[str, Motion]] = [
        ("C_1: the hips", motion),
        ("C_1: the head", motion.with_roots(["Head"])),
        (
            "C_5: hips, hands, feet",
            motion.with_roots(["Hips", "LeftHand", "RightHand", "LeftFoot", "RightFoot"]),
        ),
        (f"C_{len(proper)}: all joints but tips", motion.with_roots(proper)),
    ]
    width, height, head = 205.0, 330.0, 40.0
    places = motion.positions(dtype=float)[130]
    angle = np.radians(60)
    flat = np.stack([places[:, 0] * np.cos(angle) - places[:, 2] * np.sin(angle), -places[:, 1]], axis=1)
    low, high = flat.min(axis=0), flat.max(axis=0)
    scale = (height - 40) / (high - low)[1]

    def place(index: int) -> Place:
        x, y = (flat[index] - (low + high) / 2) * scale
        return width / 2 + float(x), head + height / 2 + float(y)

    parts = [
        f'<g transform="translate({12 + k * width} 0)">{_body(title, one, place, width)}</g>'
        for k, (title, one) in enumerate(choices)
    ]
    key = " &#160;&#160; ".join(
        (
            "red square: a root, placed in the world",
            "dot: any other joint",
            "line: a bone",
            "dotted: a bone that is cut, a soft link",
        )
    )
    total = 4 * width + 24
    parts.append(text(total / 2, head + height + 22, key, size=13, colour=GREY))
    return page(total, head + height + 38, parts)


def _body(title: str, motion: Motion, place: Callable[[int], Place], width: float) -> str:
    skeleton = motion.skeleton
    lines, dots = [], []
    for below, (parent, link) in enumerate(
        zip(skeleton.parents.tolist(), skeleton.links.tolist(), strict=True)
    ):
        (x, y) = place(below)
        if parent >= 0 or link >= 0:
            x2, y2 = place(parent if parent >= 0 else link)
            style = f'stroke="{BLUE}" stroke-width="4"'
            if parent < 0:
                style = f'stroke="{GREY}" stroke-width="2" stroke-dasharray="2 5"'
            lines.append(f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" {style}/>')
        if below in skeleton.roots:
            dots.append(f'<rect x="{x - 5.5:.1f}" y="{y - 5.5:.1f}" width="11" height="11" fill="{RED}"/>')
        else:
            dots.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{INK}"/>')
    return "\n".join([text(width / 2, 26, title, style='font-weight="bold"', size=13), *lines, *dots])


PICTURES: Mapping[str, Callable[[], str]] = {
    "gmr_forms": two_forms,
    "gmr_shift": shift_root,
    "gmr_split": split_tree,
    "gmr_join": join_trees,
    "gmr_dummies": dummies,
    "gmr_configurations": configurations,
}


def main() -> None:
    folder = Path(sys.argv[1])
    for name, picture in PICTURES.items():
        (folder / f"{name}.svg").write_text(picture(), encoding="utf-8")


if __name__ == "__main__":
    main()
