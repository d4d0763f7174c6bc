"""Draws the picture of the README: the verdict, the map of trials and the replay, out of one report.

python tools/report_picture.py gmr-demo/report.html docs/images/report.png
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

CHROMIUM = "/usr/bin/chromium"
GAP = 48


def picture_of(page: Page, selector: str, height: int | None = None) -> Image.Image:
    """One element as drawn, its lower part cut off where it is higher than ``height`` pixels."""
    image = Image.open(io.BytesIO(page.locator(selector).screenshot())).convert("RGB")
    return image if height is None else image.crop((0, 0, image.width, min(height, image.height)))


def side_by_side(left: Image.Image, right: list[Image.Image]) -> Image.Image:
    """The left picture, and beside it the others under one another."""
    height = max(left.height, sum(image.height + GAP for image in right) - GAP) + 2 * GAP
    whole = Image.new("RGB", (left.width + max(image.width for image in right) + 3 * GAP, height), "white")
    whole.paste(left, (GAP, GAP))
    top = GAP
    for image in right:
        whole.paste(image, (left.width + 2 * GAP, top))
        top += image.height + GAP
    return whole


def main() -> None:
    report, target = map(Path, sys.argv[1:])
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": 980, "height": 1000}, color_scheme="light")
        page.goto(report.resolve().as_uri())
        page.wait_for_selector("html[data-drawn=yes]")
        page.evaluate("document.dispatchEvent(new Event('draw-all'))")
        page.locator("#trial_map_holds svg").wait_for()
        page.locator("#replay").scroll_into_view_if_needed()
        page.wait_for_timeout(1000)
        verdict = picture_of(page, "#verdict")
        others = [picture_of(page, "#trial_map_holds"), picture_of(page, "#replay canvas[data-part=stage]")]
        browser.close()
    whole = side_by_side(verdict, others)
    whole.thumbnail((1600, 1600))
    whole.quantize(128).save(target, optimize=True)


if __name__ == "__main__":
    main()
