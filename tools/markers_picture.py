"""Draws the picture of docs/markers.md: a walk of CMU's wears markers, and a skeleton is fitted to them.

python tools/markers_picture.py docs/images/markers.svg
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from marker_scene import noisy, worn


def main() -> None:
    (target,) = map(Path, sys.argv[1:])
    target.write_text(noisy(worn(), 1.0).fit("ior").picture(7), encoding="utf-8")


if __name__ == "__main__":
    main()
