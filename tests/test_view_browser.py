"""The viewer in a real browser: the live page and the saved one draw, move, and ask nothing of a network."""

from __future__ import annotations

import base64
import io
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal
from urllib.parse import urlsplit

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, ConsoleMessage, Page

import gmr
from browsers import chromium
from gmr.demo import demo_folder
from gmr.view import Look

pytestmark = pytest.mark.browser

DATA = Path(__file__).parent / "data"
WALK = demo_folder() / "07_01.bvh"
SLOW = 60_000
"""Milliseconds: the scene is drawn without a graphics card."""

FRAMES = """count => new Promise(done => {
    const next = () => count-- > 0 ? requestAnimationFrame(next) : done();
    next();
})"""

Pixels = NDArray[np.int16]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    yield from chromium("--use-angle=swiftshader", "--enable-unsafe-swiftshader")


@dataclass
class Watched:
    """A page, what went wrong in it, and what it asked for."""

    page: Page
    shots: Path
    complaints: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)

    def open(self, address: str) -> None:
        self.page.set_default_timeout(SLOW)
        self.page.on("console", self._heard)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("websocket", lambda socket: self.asked.append(socket.url))
        # Else a slow machine is given a coarser picture.
        self.page.goto(f"{address}?fixedDpr=1")
        self.page.locator("canvas[data-engine]").wait_for()

    def settled(self, name: str, *, other_than: Pixels | None = None) -> Pixels:
        """(H, W, 3) the scene when it does not change any more; kept as a picture.

        Args:
            name: of the picture.
            other_than: the scene before, where it must change: a slow machine may yet rest in it.
        """
        before = self.pixels()
        for _ in range(120):
            self.frames(10)
            now = self.pixels()
            at_rest = np.ptp(now) > 100 and differing(before, now) == 0
            if at_rest and (other_than is None or differing(other_than, now) > 0):
                break
            before = now
        else:
            pytest.fail(f"the scene is blank, does not come to rest, or has not changed: {name}")
        Image.fromarray(now.astype(np.uint8)).save(self.shots / f"{name}.png")
        return now

    def frames(self, count: int) -> None:
        """Wait until the browser has drawn so many frames, however long it takes, and for 0.3 s at least."""
        self.page.evaluate(FRAMES, count)
        self.page.wait_for_timeout(300)

    def pixels(self) -> Pixels:
        url = self.page.locator("canvas[data-engine]").evaluate("canvas => canvas.toDataURL()")
        picture = Image.open(io.BytesIO(base64.b64decode(url.partition(",")[2]))).convert("RGBA")
        white = Image.new("RGBA", picture.size, "white")
        return np.asarray(Image.alpha_composite(white, picture).convert("RGB"), np.int16)

    def press(self, role: Literal["button", "option"], name: str) -> None:
        # A click with the mouse waits for a still page, which a playing one never is.
        self.page.get_by_role(role, name=name, exact=True).dispatch_event("click")

    def _heard(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self.complaints.append(message.text)


def differing(one: Pixels, other: Pixels) -> int:
    """How many pixels differ visibly."""
    return int((np.abs(one - other).max(axis=-1) > 24).sum())


def coloured(pixels: Pixels) -> int:
    """How many pixels have a colour, which ground and sky have not."""
    return int((np.ptp(pixels, axis=-1) > 25).sum())


@pytest.fixture
def watched(browser: Browser, tmp_path: Path) -> Iterator[Watched]:
    page = browser.new_page(viewport={"width": 640, "height": 480})
    yield Watched(page, tmp_path)
    page.close()


def go_to(watched: Watched, seconds: str, *, other_than: Pixels | None = None) -> Pixels:
    """The saved page at a time, which pauses it; another than it shows at first, or nothing is asked."""
    shown = watched.page.locator("input").first
    # A playing page may step on between the key and the pause.
    while float(shown.input_value() or "nan") != float(seconds):
        shown.fill(seconds)
        watched.frames(3)
    return watched.settled(f"at_{seconds}", other_than=other_than)


def test_a_saved_page_plays_alone(watched: Watched, tmp_path: Path) -> None:
    path = tmp_path / "walk.html"
    page = gmr.view.save(gmr.read(WALK), path)
    assert path.stat().st_size < 2_000_000
    assert page.seconds == pytest.approx(gmr.read(WALK).duration, abs=1 / 30)
    watched.open(path.as_uri())
    assert watched.page.title() == "07_01.bvh"
    early = go_to(watched, "0.7")
    late = go_to(watched, "1.9", other_than=early)
    assert coloured(early) > 300
    assert coloured(late) > 300
    assert differing(early, late) > 500
    again = go_to(watched, "0.7", other_than=late)
    assert differing(early, again) < differing(early, late) / 5
    shown = watched.page.locator("input").first
    shown.locator("xpath=preceding::button[1]").dispatch_event("click")
    watched.page.wait_for_function(
        "([element, before]) => element.value !== before", arg=[shown.element_handle(), shown.input_value()]
    )
    assert watched.complaints == []
    assert watched.asked == [f"{path.as_uri()}?fixedDpr=1"]


@pytest.mark.parametrize(
    "look",
    [Look("lbs"), Look("dqbs"), Look(weights="Bone")],
    ids=["lbs", "dqbs", "weights"],
)
def test_a_saved_skin_bends(watched: Watched, tmp_path: Path, look: Look) -> None:
    path = tmp_path / "figure.html"
    character = gmr.read_character(DATA / "rigged_simple.gltf")
    if look.weights:
        look = Look(weights=character.joint_names[1])
    gmr.view.save(character, path, look=look)
    watched.open(path.as_uri())
    straight = go_to(watched, "0.1")
    bent = go_to(watched, "1.0", other_than=straight)
    assert differing(straight, bent) > 500
    assert watched.complaints == []
    assert watched.asked == [f"{path.as_uri()}?fixedDpr=1"]


@pytest.fixture
def served(request: pytest.FixtureRequest) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """``gmr view`` as a process of its own, and its address."""
    command = [sys.executable, "-m", "gmr", "view", *map(str, request.param)]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert server.stdout is not None
    try:
        yield server.stdout.readline().split()[0], server
    finally:
        server.kill()
        server.communicate()


def only_this_machine(watched: Watched) -> bool:
    hosts = {urlsplit(url.removeprefix("blob:")).hostname for url in watched.asked if url[:5] != "data:"}
    return hosts == {"127.0.0.1"}


@pytest.mark.parametrize("served", [[WALK]], indirect=True, ids=["walk"])
def test_the_live_page_plays_pauses_and_steps(
    watched: Watched, served: tuple[str, subprocess.Popen[str]]
) -> None:
    address, server = served
    motion = gmr.read(WALK)
    watched.open(address)
    page = watched.page
    time = page.get_by_text(" of 2.", exact=False).first
    before = time.inner_text()
    page.wait_for_function("([e, before]) => e.innerText !== before", arg=[time.element_handle(), before])
    watched.press("button", "Pause")
    page.get_by_role("button", name="Play").wait_for()
    watched.press("button", "Start")
    page.get_by_text("0.00 of 2.", exact=False).wait_for()
    first = watched.settled("first")
    watched.press("button", "Back")
    page.get_by_text(f"{motion.duration - motion.frame_time:.2f} of 2.", exact=False).wait_for()
    watched.press("button", "Back")
    slider = page.get_by_role("slider").first
    last = int(slider.get_attribute("aria-valuemax") or 0)
    assert last == motion.frame_count - 1
    page.wait_for_function(
        "([e, value]) => e.ariaValueNow === value", arg=[slider.element_handle(), str(last - 1)]
    )
    end = watched.settled("end", other_than=first)
    assert coloured(end) > 300
    assert differing(first, end) > 500
    page.get_by_label("Skeleton").dispatch_event("click")
    bare = watched.settled("without_skeleton", other_than=end)
    assert coloured(bare) < coloured(end)
    assert watched.complaints == []
    assert only_this_machine(watched)
    page.goto("about:blank")
    server.send_signal(signal.SIGINT)
    _, said = server.communicate(timeout=20)
    assert server.returncode == 130
    guessed, *_, ended = said.splitlines()
    assert "its unit is not said" in guessed
    assert ended == "gmr: interrupted; no file was left half-written"
    assert len(said.split("gmr: ")) == 3


def test_a_name_does_nothing_but_be_shown(watched: Watched) -> None:
    nasty = "<img src=x onerror=\"document.title='owned'\">{document.title='owned'}"
    motion = gmr.read(WALK)[20:21].with_name(nasty)
    with gmr.view.show(gmr.view.motion_figure(motion, name=nasty), port=0) as live:
        watched.open(live.address)
        watched.page.get_by_text(f"{nasty}: its unit is not said").wait_for()
        assert coloured(watched.settled("one_frame")) > 300
        assert watched.page.title() != "owned"
        assert watched.complaints == []
        assert only_this_machine(watched)
        watched.page.goto("about:blank")


@pytest.mark.parametrize("served", [[DATA / "rigged_simple.gltf"]], indirect=True, ids=["character"])
def test_the_live_page_blends_and_colours_skins(
    watched: Watched, served: tuple[str, subprocess.Popen[str]]
) -> None:
    watched.open(served[0])
    page = watched.page
    watched.press("button", "Pause")
    page.get_by_role("button", name="Play").wait_for()
    watched.press("button", "Start")
    page.get_by_text("0.00 of ", exact=False).wait_for()
    straight = watched.settled("straight")
    slider = page.locator("input[inputmode=decimal]").first
    slider.fill("22")
    slider.press("Enter")
    watched.settled("boned", other_than=straight)
    page.get_by_label("Skeleton").dispatch_event("click")
    page.wait_for_timeout(1000)
    linear = watched.settled("lbs")
    choose(watched, "Blending", "DQBS")
    dual = watched.settled("dqbs", other_than=linear)
    choose(watched, "Blending", "LBS")
    again = watched.settled("lbs_again", other_than=dual)
    assert 0 < differing(linear, dual) < 2_000, "the elbow alone looks other"
    assert differing(linear, again) == 0
    # Coloured by weights the vertices are those of gmr's kernels, in their place among the browser's.
    choose(watched, "Colours", gmr.read_character(DATA / "rigged_simple.gltf").joint_names[1])
    weights = watched.settled("weights", other_than=linear)
    page.get_by_label("Skin", exact=True).dispatch_event("click")
    bare = watched.settled("bare", other_than=weights)
    covered, by_kernels = (np.abs(one - bare).max(axis=-1) > 24 for one in (linear, weights))
    assert (covered ^ by_kernels).sum() < 0.05 * covered.sum()
    assert differing(linear, weights) > 2_000
    assert watched.complaints == []
    assert only_this_machine(watched)


def choose(watched: Watched, label: str, option: str) -> None:
    field = watched.page.get_by_role("combobox", name=label)
    field.evaluate("element => element.scrollIntoView()")
    field.dispatch_event("click")
    watched.press("option", option)
