"""The comparison in a real browser: nothing is loaded, nothing complains, every chart and picture appears."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, ViewportSize

import gmr
from browsers import chromium, opened
from gmr.skinning import comparison

pytestmark = pytest.mark.browser

RIGGED = Path(__file__).parent / "data" / "rigged_simple.gltf"
NASTY = "<script>document.title='owned'</script>"
SIZES: list[ViewportSize] = [{"width": 1280, "height": 900}, {"width": 390, "height": 844}]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    yield from chromium("--disable-gpu")


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    character = gmr.read_character(RIGGED)
    compared = comparison.compare(character, character.animation(fps=30), 1 / 30, motion=NASTY)
    still = comparison.Picture("frame", "clip", NASTY, NASTY, _grey_png())
    path = tmp_path_factory.mktemp("compared") / "index.html"
    path.write_text(comparison.page(compared, [still], None), encoding="utf-8")
    return path


@pytest.mark.parametrize("size", SIZES, ids=["desktop", "phone"])
def test_the_page_draws_itself_without_a_network(
    browser: Browser, page_file: Path, size: ViewportSize
) -> None:
    page, complaints = opened(browser, page_file, size)
    assert page.locator(".chart svg").count() == 9
    assert page.locator("img.still").evaluate("image => image.naturalWidth") == 2
    assert page.title() == "rigged_simple: skinning compared"
    assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
    assert complaints == []
    page.close()


def _grey_png() -> bytes:
    """Two pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", 2, 1, 8, 0, 0, 0, 0)
    pixels = zlib.compress(b"\x00\x80\x80")
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")
