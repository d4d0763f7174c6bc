"""Draws the picture of docs/actionlets.md: the score of a walk, out of the page that gmr decompose writes.

gmr decompose python/gmr/data/demo/07_01.bvh --out score.html
python tools/score_picture.py score.html docs/images/score.png
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

CHROMIUM = "/usr/bin/chromium"
EDGE = 24


def main() -> None:
    page_file, target = map(Path, sys.argv[1:])
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": 1100, "height": 1000}, color_scheme="light")
        page.goto(page_file.resolve().as_uri())
        page.locator(".score[data-drawn=yes]").wait_for()
        drawn = Image.open(io.BytesIO(page.locator(".score").screenshot())).convert("RGB")
        browser.close()
    whole = Image.new("RGB", (drawn.width + 2 * EDGE, drawn.height + 2 * EDGE), "white")
    whole.paste(drawn, (EDGE, EDGE))
    whole.quantize(96).save(target, optimize=True)


if __name__ == "__main__":
    main()
