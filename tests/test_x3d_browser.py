"""Written humanoids in X_ITE, an X3D browser, in a real headless Chromium: they are seen, and they move."""

from __future__ import annotations

import io
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Page

import gmr
from browsers import chromium
from gmr.demo import demo_folder

pytestmark = pytest.mark.browser

X_ITE = Path(__file__).parent.parent / ".node" / "node_modules" / "x_ite" / "dist"
DATA = Path(__file__).parent / "data"
SLOW = 60_000
"""Milliseconds: the scene is drawn without a graphics card."""

Pixels = NDArray[np.int16]

PAGE = """<!DOCTYPE html>
<html><head><link rel="icon" href="data:,"><script src="x_ite/x_ite.min.js"></script>
<style>body {{ margin: 0 }} x3d-canvas {{ width: 480px; height: 360px; display: block }}</style></head>
<body><x3d-canvas src="{file}" splashScreen="false" notifications="false"></x3d-canvas></body></html>
"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    if not X_ITE.exists():
        reason = "X_ITE is not installed (make develop, with npm)"
        if os.environ.get("CI"):
            pytest.fail(f"{reason}; on CI written files must be played in it")
        pytest.skip(reason)
    yield from chromium("--use-angle=swiftshader", "--enable-unsafe-swiftshader")


class Silent(SimpleHTTPRequestHandler):
    def log_message(self, format: str, *args: Any) -> None:
        pass


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[tuple[Path, str]]:
    """A folder beside which X_ITE lies, and the address at which a server shows it."""
    (tmp_path / "x_ite").symlink_to(X_ITE)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Silent, directory=str(tmp_path)))
    thread = Thread(target=server.serve_forever)
    thread.start()
    yield tmp_path, f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()


@contextmanager
def opened(browser: Browser, folder: tuple[Path, str], file: str) -> Iterator[Page]:
    """The page that shows a file, when its scene is loaded; nothing may be complained of meanwhile."""
    place, address = folder
    complaints: list[str] = []
    (place / "page.html").write_text(PAGE.format(file=file))
    page = browser.new_page(viewport={"width": 480, "height": 360})
    page.set_default_timeout(SLOW)
    page.on("console", lambda m: complaints.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    try:
        page.goto(f"{address}/page.html")
        page.wait_for_function(
            "() => document.querySelector('x3d-canvas')?.browser?.currentScene?.rootNodes?.length > 3"
        )
        yield page
    finally:
        page.close()
    assert complaints == []


def shown(page: Page, path: Path) -> Pixels:
    """(H, W, 3) what is seen; kept as a picture."""
    data = page.screenshot(path=path)
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), np.int16)


def figure(pixels: Pixels) -> NDArray[np.bool_]:
    """Where the blue left or the orange right of the body is: sky, ground and trunk are grey."""
    return np.asarray(np.ptp(pixels, axis=-1) > 70)


def quietly_written(motion: gmr.Motion, path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        gmr.write(motion, path)


@pytest.mark.parametrize(
    "source", [demo_folder() / "09_01.bvh", DATA / "amc" / "07_01.amc"], ids=["run.bvh", "walk.amc"]
)
def test_a_humanoid_is_seen_and_moves(browser: Browser, folder: tuple[Path, str], source: Path) -> None:
    place, _ = folder
    quietly_written(gmr.read(source), place / "motion.x3d")
    with opened(browser, folder, "motion.x3d") as page:
        page.wait_for_timeout(1000)
        early = shown(page, place / "early.png")
        for _ in range(20):
            page.wait_for_timeout(300)
            late = shown(page, place / "late.png")
            if (figure(early) ^ figure(late)).sum() > 100:
                break
    assert figure(early).sum() > 100
    assert figure(late).sum() > 100
    assert (figure(early) ^ figure(late)).sum() > 100


def test_a_posture_is_seen_and_stays(browser: Browser, folder: tuple[Path, str]) -> None:
    place, _ = folder
    quietly_written(gmr.read(demo_folder() / "09_01.bvh")[60:61], place / "posture.x3d")
    with opened(browser, folder, "posture.x3d") as page:
        page.wait_for_timeout(2000)
        early = shown(page, place / "early.png")
        page.wait_for_timeout(700)
        late = shown(page, place / "late.png")
    assert figure(early).sum() > 300
    assert (figure(early) ^ figure(late)).sum() == 0


PLACES = """() => {
    const scene = document.querySelector('x3d-canvas').browser.currentScene;
    const found = {};
    const walk = (joint, above) => {
        const own = new X3D.SFMatrix4f();
        own.setTransform(
            joint.translation, joint.rotation, joint.scale, joint.scaleOrientation, joint.center);
        const world = own.multRight(above), place = world.multVecMatrix(joint.center);
        found[joint.name] = [place.x, place.y, place.z];
        for (const child of joint.children)
            if (child.getNodeTypeName() === 'HAnimJoint') walk(child, world);
    };
    walk(scene.getNamedNode('hanim_humanoid_root'), new X3D.SFMatrix4f());
    return found;
}"""
"""Where the browser has the joints: row vectors, so that a joint's own matrix goes before that above."""


def test_the_browser_has_the_joints_where_the_motion_has_them(
    browser: Browser, folder: tuple[Path, str]
) -> None:
    motion = gmr.read(DATA / "cmu_07_01.bvh").with_unit("cmu")[40:41]
    gmr.write(motion, folder[0] / "posture.x3d")
    with opened(browser, folder, "posture.x3d") as page:
        places = page.evaluate(PLACES)
    named = {
        "l_talocrural": "LeftFoot",
        "r_radiocarpal": "RightHand",
        "skullbase": "Head",
        "l_elbow": "LeftForeArm",
    }
    true = motion.to_unit("m").positions(joints=named.values())[0]
    for name, place in zip(named, true, strict=True):
        np.testing.assert_allclose(places[name], place, rtol=0, atol=1.5e-4)
