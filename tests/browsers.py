"""A real headless Chromium, where there is one."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

FLAGS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def opened(browser: Browser, file: Path, size: ViewportSize) -> tuple[Page, list[str]]:
    """A page of ours when all of it is drawn, and what was complained of, or asked of a network, by then."""
    page = browser.new_page(viewport=size)
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on(
        "request",
        lambda request: (
            None if request.url.startswith(("file:", "data:")) else complaints.append(request.url)
        ),
    )
    page.goto(file.as_uri())
    draw_all(page)
    return page, complaints


def draw_all(page: Page) -> None:
    """Have the charts drawn that are out of view, too."""
    page.wait_for_selector("html[data-drawn=yes]", timeout=60_000)
    page.evaluate("document.dispatchEvent(new Event('draw-all'))")
    page.wait_for_selector("html[data-drawn=yes]", timeout=60_000)


def chromium(*flags: str) -> Iterator[Browser]:
    """A browser for a fixture to yield from; skips without one, but on CI, where it must be."""
    names = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
    path = next(filter(None, map(shutil.which, names)), None)
    if path is None:
        reason = "no Chromium is installed (Debian: apt-get install chromium)"
        if os.environ.get("CI"):
            pytest.fail(f"{reason}; on CI pages must be tested in one")
        pytest.skip(reason)
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=path, args=[*FLAGS, *flags])
        yield opened
        opened.close()
