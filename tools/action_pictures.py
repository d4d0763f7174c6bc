"""Draws the film strips of docs/actions.md, and prints the rows of its table of actions.

python tools/action_pictures.py docs/images
"""

from __future__ import annotations

import io
import re
import sys
import tempfile
from pathlib import Path

from gmr import actionlets

PAGE = Path(__file__).parent.parent / "docs" / "actions.md"

STRIPS = {
    "actions_gait": ("walk", "run", "sneak", "march", "turn"),
    "actions_gestures": ("wave", "punch", "kick", "clap"),
    "actions_body": ("jump", "squat", "sit_down", "stand_up", "bow"),
}
SECONDS = {"walk": 2.6, "run": 1.5, "sneak": 3.6, "march": 2.2, "clap": 2.4}
VIEWS = {"wave": "front", "clap": "three-quarter", "turn": "three-quarter"}


def table() -> list[str]:
    """A row of the page's table for each action that ships."""
    library = actionlets.library()
    rows = []
    for name in library:
        action = library[name]
        said = [
            f"{p.name} {p.low:g} to {p.high:g}{' ' + p.unit if p.unit else ''} [{p.default:g}]"
            for p in action.parameters.values()
        ]
        rows.append(f"| `{name}` | {', '.join(action.aliases)} | {action.about} | {'; '.join(said)} |")
    return rows


def limp(folder: Path) -> actionlets.Action:
    """The action of the page's example."""
    found = re.search(r"```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    if found is None:
        raise SystemExit(f"{PAGE} has no example in TOML")
    file = folder / "mine.toml"
    file.write_text(found[1], encoding="utf-8")
    return actionlets.library(file)["limp"]


def drawn(name: str, action: actionlets.Action) -> str:
    """The film strip of an action as an SVG element."""
    motion = action.motion(seconds=SECONDS.get(name))
    return actionlets.film_strip(motion, None, 9, VIEWS.get(name, "side"), titles=[name], plan=False)


def stacked(strips: list[str]) -> str:
    """SVGs below each other, all as wide as the widest."""
    sizes = [re.search(r'width="(\d+)" height="(\d+)"', svg) for svg in strips]
    wide = max(int(size[1]) for size in sizes if size)
    body, top = [], 0.0
    for svg, size in zip(strips, sizes, strict=True):
        if size is None:
            raise SystemExit("a film strip without a size")
        body.append(svg.replace("<svg ", f'<svg y="{top:.0f}" ', 1))
        top += int(size[2])
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {top:.0f}" width="{wide}" '
        f'height="{top:.0f}"><rect width="100%" height="100%" fill="#ffffff"/>{"".join(body)}</svg>\n'
    )


def main(folder: Path) -> None:
    """Writes the pictures into a folder."""
    import vl_convert
    from PIL import Image

    library = actionlets.library()
    with tempfile.TemporaryDirectory() as scratch:
        pictures = {file: [drawn(n, library[n]) for n in names] for file, names in STRIPS.items()}
        pictures["actions_limp"] = [drawn("limp", limp(Path(scratch)))]
    for file, strips in pictures.items():
        png = vl_convert.svg_to_png(stacked(strips), scale=1.0)
        with Image.open(io.BytesIO(png)) as picture:
            picture.convert("RGB").quantize(24).save(folder / f"{file}.png", optimize=True)
    print("\n".join(table()))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
