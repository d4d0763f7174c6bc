"""Draws the picture of docs/travel.md of the paper's body, whose ankles are rigid.

python tools/travel_rigid_picture.py docs/images/travel_rigid.svg
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from gmr.actionlets import Body, film_strip, library

ROWS: tuple[tuple[str, str, float, float, dict[str, Any]], ...] = (
    ("walk, 1.3 m/s", "walk", 1.2, 2.4, {"speed": 1.3}),
    ("run, 3.5 m/s", "run", 1.2, 1.95, {"speed": 3.5}),
    ("squat", "squat", 0.1, 2.5, {"depth": 0.9}),
    ("jump, 0.3 m", "jump", 0.1, 2.0, {"height": 0.3}),
)
FPS = 60


def main() -> None:
    (target,) = map(Path, sys.argv[1:])
    body, known = Body.of(detailed=False), library()
    strips = [
        known[name].take(None, FPS, body=body, **asked).motion[round(begin * FPS) : round(end * FPS)]
        for _, name, begin, end, asked in ROWS
    ]
    film_strip(strips, target, count=9, titles=[title for title, *_ in ROWS], plan=False)


if __name__ == "__main__":
    main()
