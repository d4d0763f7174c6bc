"""Draws a part of a page that gmr wrote, for the documentation.

python tools/page_picture.py pruned.html docs/images/pruning.png --part "#pruning"
python tools/page_picture.py completed/index.html docs/images/completion.png --height 3750
"""

from __future__ import annotations

import argparse
import io
from pathlib import Path

from PIL import Image
from playwright.sync_api import FloatRect, sync_playwright

CHROMIUM = "/usr/bin/chromium"


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("page", type=Path)
    asked.add_argument("target", type=Path)
    asked.add_argument("--part", default="body", help="a CSS selector")
    asked.add_argument("--width", type=int, default=1000)
    asked.add_argument("--height", type=int, help="what is below is cut off")
    given = asked.parse_args()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": given.width, "height": 1000}, color_scheme="light")
        page.goto(given.page.resolve().as_uri())
        page.wait_for_selector("html[data-drawn=yes]")
        page.evaluate("document.dispatchEvent(new Event('draw-all'))")
        page.wait_for_selector("html[data-drawn=yes]")
        box = page.locator(given.part).bounding_box()
        assert box is not None, f"{given.page} shows no {given.part}"
        clip = FloatRect(x=0, y=box["y"], width=given.width, height=box["height"])
        image = Image.open(io.BytesIO(page.screenshot(full_page=True, clip=clip))).convert("RGB")
        browser.close()
    height = min(image.height, given.height or image.height)
    image.crop((0, 0, image.width, height)).quantize(128).save(given.target, optimize=True)


if __name__ == "__main__":
    main()
