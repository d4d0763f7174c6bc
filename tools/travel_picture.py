"""Draws the picture of docs/travel.md: the rough gait of the tests walks, walks a bend and runs.

python tools/travel_picture.py docs/images/travel.svg
"""

from __future__ import annotations

import sys
from math import radians
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from gaits import gait
from gmr.actionlets import Body, film_strip, posing
from gmr.actionlets.travel import carried

ROWS = (
    ("Walking, 1.3 m/s", 1.3, 0.0, False),
    ("Walking, 1.0 m/s, turning left by 60 degrees a second", 1.0, 60.0, False),
    ("Running, 3.5 m/s", 3.5, 0.0, True),
)


def main() -> None:
    (target,) = map(Path, sys.argv[1:])
    body, strips = Body.of(), []
    for _, speed, turn_rate, runs in ROWS:
        angles, plan = gait(body, speed, radians(turn_rate), runs=runs)
        found = carried(body, angles, plan)
        begin, end = (round(time * 120) for time in plan.contacts["left"][3:5, 0])
        one = slice(begin, end + 1)
        strips.append(posing.motion(body, found.angles[one], found.root[one], found.heading[one]))
    film_strip(strips, target, count=9, titles=[title for title, *_ in ROWS])


if __name__ == "__main__":
    main()
