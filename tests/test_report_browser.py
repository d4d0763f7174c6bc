"""The report in a real browser: nothing is loaded, nothing complains, and every control does something."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, ViewportSize

from browsers import chromium, draw_all
from fake_evaluation import fake_evaluation, with_names
from gmr.evaluation import Evaluation
from gmr.evaluation.report import write_report

pytestmark = pytest.mark.browser

DESKTOP: ViewportSize = {"width": 1280, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}
RING_IS_ON_CELL = """(number) => {
    const map = document.querySelector("#trial_map_holds .map");
    const ring = map.querySelector(".cell-ring").getBoundingClientRect();
    const cell = map.querySelectorAll(".mark-rect path")[number].getBoundingClientRect();
    return Math.hypot(ring.x - cell.x, ring.y - cell.y) < 3 && Math.abs(ring.width - cell.width) < 3;
}"""
IN_VIEW = """(element) => {
    const { top, bottom } = element.getBoundingClientRect();
    return bottom > 0 && top < innerHeight;
}"""
NASTY = "<script>document.title='owned'</script><img src=x onerror=\"document.title='owned'\">.bvh"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    yield from chromium("--disable-gpu")


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report with everything that a report can have, of half the usual size."""
    made = fake_evaluation(60, 146, mirrored=True, trackings=("time", "velocity"), replay_seconds=20)
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(
        replace(
            with_names(made, {made.measured.clips["clip"][0]: NASTY}),
            dataset=NASTY,
            notes=("The unit was taken for centimetres.",),
            failed={NASTY: NASTY},
        ),
        path,
    )
    return path


@dataclass
class Opened:
    """A page, and what went wrong in it."""

    page: Page
    complaints: list[str] = field(default_factory=list)

    def part(self, name: str) -> Locator:
        return self.page.locator(f".player [data-part='{name}']")


def open_page(browser: Browser, path: Path, *, whole: bool = True, **settings: object) -> Opened:
    """The page in a browser; ``whole``: with all its charts, not only those in view."""
    page = browser.new_page(**settings)  # type: ignore[arg-type]  # playwright's keywords, by name
    opened = Opened(page)
    page.on("console", lambda message: opened.complaints.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: opened.complaints.append(f"error: {error}"))

    def watch(url: str) -> None:
        if url != path.as_uri() and not url.startswith(("data:", "blob:")):
            opened.complaints.append(f"request: {url}")

    page.on("request", lambda request: watch(request.url))
    page.goto(path.as_uri())
    page.locator("html[data-drawn=yes]").wait_for()
    page.locator(".player[data-ready=yes]").wait_for()
    if whole:
        draw_all(page)
    return opened


@pytest.fixture(scope="module", params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def kept_open(request: pytest.FixtureRequest, browser: Browser, report: Path) -> Iterator[Opened]:
    found = open_page(browser, report, viewport=request.param, has_touch=request.param is PHONE)
    yield found
    found.page.close()


@pytest.fixture
def opened(kept_open: Opened) -> Iterator[Opened]:
    """The page as it was opened but for what tests before chose in it; whoever makes it complain fails."""
    kept_open.page.evaluate(
        "document.querySelectorAll('details').forEach(folded => { folded.open = false; })"
    )
    kept_open.page.mouse.move(0, 0)
    yield kept_open
    complaints, kept_open.complaints[:] = list(kept_open.complaints), []
    assert complaints == []


def looks_different(seen: Locator, act: Callable[[], object]) -> None:
    """Do something, and wait until the element looks different from before."""
    seen.scroll_into_view_if_needed()
    before = seen.screenshot(animations="disabled")
    act()
    for _ in range(50):
        if seen.screenshot(animations="disabled") != before:
            return
        seen.page.wait_for_timeout(100)
    pytest.fail(f"nothing changed in {seen}")


def test_it_opens_without_complaint_and_fits_the_screen(opened: Opened) -> None:
    page = opened.page
    for chart in page.locator(".chart:visible").all():
        assert chart.get_attribute("data-drawn") == "yes"
        box = chart.locator("svg, canvas").first.bounding_box()
        assert box is not None
        assert box["height"] > 100
        assert box["width"] > 250
    width = page.viewport_size
    assert width is not None
    assert page.evaluate("document.documentElement.scrollWidth") <= width["width"]


def test_no_name_becomes_markup(opened: Opened) -> None:
    page = opened.page
    assert page.title() == f"{NASTY}: locomotion dataset evaluation"
    assert page.locator("h1").inner_text() == NASTY
    assert page.locator("img").count() == 0
    assert page.locator("script").count() == 3


def test_clips_and_groups_can_be_picked_out_of_the_scatter(opened: Opened) -> None:
    page = opened.page
    select, chart = page.locator("#clip-select"), page.locator("#coverage_scatter .chart")
    for value in ("group:0", "group:1", "clip:5", ""):
        looks_different(chart, lambda value=value: select.select_option(value))  # type: ignore[misc]
    select.select_option(label=NASTY)
    page.get_by_text(re.compile(r"^[\d,]+ of [\d,]+ points$")).wait_for()


def test_pointing_at_the_scatter_tells_clip_and_time(opened: Opened) -> None:
    page = opened.page
    chart = page.locator("#coverage_scatter canvas")
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] * 0.53, box["y"] + box["height"] * 0.6)
    told = page.locator("#vg-tooltip-element.visible")
    told.wait_for()
    assert page.title() == f"{NASTY}: locomotion dataset evaluation"
    assert re.search(r"Clip\s*\S.*\.bvh.*At second\s*\d+\.\d\d", told.inner_text(), re.DOTALL)


def test_pointing_at_a_trial_tells_its_figures(opened: Opened) -> None:
    cell = opened.page.locator("#trial_map_holds .mark-rect path").nth(40)
    # The text on the cell is in the way of the cell, and tells the same.
    cell.hover(force=True)
    told = opened.page.locator("#vg-tooltip-element.visible")
    told.wait_for()
    for figure in ("Mean offset", "95%", "Largest offset", "Speed error", "Turn rate error"):
        assert figure in told.inner_text()
    for row in told.locator("tr").all():
        key, value = (row.locator(f"td.{part}").bounding_box() for part in ("key", "value"))
        assert key is not None
        assert value is not None
        assert key["x"] + key["width"] <= value["x"]
        assert key["width"] > 60


def test_every_measure_of_every_tracking_has_its_map(opened: Opened) -> None:
    page = opened.page
    titles = set()
    for tracking in ("0", "1"):
        page.locator("#set-select").select_option(tracking)
        for radio in page.locator("input[name=measure]").all():
            radio.check()
            figure = page.locator("#accuracy figure:visible")
            figure.locator(".chart[data-drawn=yes] svg").wait_for()
            assert figure.count() == 1
            titles.add(figure.get_attribute("id"))
    assert len(titles) == 2 * page.locator("input[name=measure]").count()


def test_folded_lists_and_tables_unfold(opened: Opened) -> None:
    for name in ("never-played", "table-trials", "table-clips", "table-jumps"):
        details = opened.page.locator(f"details#{name}")
        inside = details.locator(".inside")
        assert not inside.is_visible()
        details.locator("summary").click()
        inside.wait_for()
        width = opened.page.viewport_size
        assert width is not None
        assert opened.page.evaluate("document.documentElement.scrollWidth") <= width["width"]


def test_tables_sort_by_every_header_both_ways(opened: Opened) -> None:
    for name in ("trials", "clips", "jumps"):
        details = opened.page.locator(f"details#table-{name}")
        details.locator("summary").click()
        for header in details.locator("th").all():
            text = "text" in (header.get_attribute("class") or "")
            place = header.evaluate("cell => cell.cellIndex")
            cells = f"table => [...table.tBodies[0].rows].map(row => row.children[{place}].dataset.value)"
            orders = []
            for _ in range(2):
                header.locator("button").dispatch_event("click")
                orders.append(header.get_attribute("aria-sort"))
                values = details.locator("table").evaluate(cells)
                if not text:
                    numbers = [float(value or "-inf") for value in values]
                    assert numbers == sorted(numbers, reverse=orders[-1] == "descending")
            assert sorted(orders, key=str) == ["ascending", "descending"]


def test_tables_are_saved_as_csv(opened: Opened, tmp_path: Path) -> None:
    for name, header in {
        "trials": "dataset,scenario,tracking,speed,turn_rate_deg,",
        "clips": "clip,seconds,",
        "jumps": "from_clip,to_clip,count",
    }.items():
        details = opened.page.locator(f"details#table-{name}")
        details.locator("summary").click()
        with opened.page.expect_download() as download:
            details.get_by_role("button", name=f"Save {name}.csv").click()
        assert download.value.suggested_filename == f"{name}.csv"
        download.value.save_as(tmp_path / name)
        lines = (tmp_path / name).read_text(encoding="utf-8").splitlines()
        assert lines[0].startswith(header)
        assert len(lines) > 60
        assert len({line.count(",") for line in lines if '"' not in line}) == 1


def test_the_replay_plays_pauses_and_ends(opened: Opened) -> None:
    stage, play = opened.part("stage"), opened.part("play")
    looks_different(stage, opened.part("start").click)
    assert opened.part("time").inner_text().startswith("0.0 of 20.0 s")
    looks_different(stage, play.click)
    assert play.inner_text() == "Pause"
    play.click()
    assert play.inner_text() == "Play"
    stood = opened.part("time").inner_text()
    opened.page.wait_for_timeout(200)
    assert opened.part("time").inner_text() == stood
    looks_different(stage, opened.part("worst").click)
    opened.part("pace").select_option("4")
    opened.part("scrubber").fill("1150")
    play.click()
    opened.page.locator(".player [data-part=time]", has_text="20.0 of 20.0 s").wait_for()
    assert play.inner_text() == "Play"


def test_the_scrubber_moves_the_skeleton_and_its_readings(opened: Opened) -> None:
    scrubber, source = opened.part("scrubber"), opened.part("source")
    for step in ("1", "350", "900"):
        before = source.inner_text()
        looks_different(opened.part("stage"), lambda step=step: scrubber.fill(step))  # type: ignore[misc]
        assert source.inner_text() != before
    assert opened.part("time").inner_text() == "15.0 of 20.0 s"
    assert re.fullmatch(r"\d+\.\d\d m", opened.part("offset").inner_text())
    assert "metres from the plan" in (scrubber.get_attribute("aria-valuetext") or "")
    scrubber.focus()
    looks_different(opened.part("strip"), lambda: opened.page.keyboard.press("Home"))


def test_the_camera_turns_zooms_and_lets_go(opened: Opened) -> None:
    stage, page = opened.part("stage"), opened.page
    for control in ("follow", "nearer", "farther", "reset", "nearer", "reset"):
        if control == "farther":
            opened.part("nearer").click()
        looks_different(stage, opened.part(control).click)

    def drag() -> None:
        box = stage.bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 60, y + 20, steps=4)
        page.mouse.up()

    looks_different(stage, drag)
    stage.focus()
    for key in ("ArrowLeft", "ArrowUp"):
        looks_different(stage, lambda key=key: page.keyboard.press(key))  # type: ignore[misc]
    looks_different(stage, lambda: page.keyboard.press(" "))
    assert opened.part("play").inner_text() == "Pause"
    page.keyboard.press(" ")


def test_a_click_on_a_cell_replays_its_trial(opened: Opened) -> None:
    page = opened.page
    page.locator("#set-select").select_option("0")
    page.locator("input[value=holds]").check()
    cells = page.locator("#trial_map_holds .mark-rect path")
    for number in (3, 40):
        cell = cells.nth(number)
        cell.scroll_into_view_if_needed()
        box = cell.bounding_box()
        assert box is not None
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.locator(f".player[data-trial='{number}']").wait_for()
        assert opened.part("play").inner_text() == "Pause"
        assert opened.part("trial").input_value() == str(number)
        assert "Asked for " in opened.part("sentence").inner_text()
        opened.part("play").click()
        opened.part("back").click()
        page.wait_for_function(RING_IS_ON_CELL, arg=number)


def test_arrow_keys_and_enter_on_a_map_replay_a_trial(opened: Opened) -> None:
    page = opened.page
    page.locator("#set-select").select_option("0")
    page.locator("input[value=offset_mean]").check()
    held = page.locator("figure#trial_map_offset_mean .map")
    held.locator(".chart[data-drawn]").wait_for()
    held.focus()
    cursor = held.locator(".cell-ring.cursor")
    cursor.wait_for()
    for _ in range(10):
        page.keyboard.press("ArrowDown")
        page.keyboard.press("ArrowLeft")
    page.keyboard.press("ArrowRight")
    held.locator("[role=status]", has_text="1 m/s turning right by 75 degrees/s: ").wait_for(state="attached")
    page.keyboard.press("Enter")
    page.locator(".player[data-trial='1']").wait_for()
    assert page.evaluate("document.activeElement.dataset.part") == "stage"
    page.keyboard.press(" ")
    opened.part("back").focus()
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.className") == "map"
    assert cursor.is_visible()


def test_every_trial_can_be_chosen_from_the_list_and_the_worst_again(opened: Opened) -> None:
    options = opened.part("trial").locator("option")
    assert options.count() == 2 * 81
    sentences = set()
    for number in (0, 80, 161):
        opened.part("trial").select_option(str(number))
        opened.page.locator(f".player[data-trial='{number}']").wait_for()
        sentences.add(opened.part("sentence").inner_text())
    opened.part("farthest").click()
    sentences.add(opened.part("sentence").inner_text())
    assert len(sentences) >= 3
    assert not opened.part("dataset").is_visible()


def test_links_lead_to_their_sections(opened: Opened) -> None:
    links = opened.page.locator("nav a").all()
    assert len(links) == 7
    for link in links:
        assert opened.page.locator(link.get_attribute("href") or "none").count() == 1


def test_every_control_can_be_reached_by_keyboard(opened: Opened) -> None:
    page = opened.page
    wanted = page.locator("main button:visible, main select:visible, main input:visible, summary").count()
    named = "(active => `${active.id} ${active.dataset.part} ${active.name}`)(document.activeElement)"
    reached = set()
    for _ in range(wanted + 60):
        page.keyboard.press("Tab")
        reached.update(page.evaluate(named).split())
    player = {"stage", "scrubber", "play", "start", "worst", "pace", "follow", "nearer", "farther", "reset"}
    player |= {"trial", "farthest"}
    assert player | {"clip-select", "set-select", "measure"} <= reached


@pytest.mark.parametrize("viewport", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_light_and_dark_follow_the_reader(browser: Browser, report: Path, viewport: ViewportSize) -> None:
    opened = open_page(browser, report, whole=False, viewport=viewport, color_scheme="light")
    chart = opened.page.locator("#trial_map_holds .chart")
    for seen in (chart, opened.part("stage"), opened.page.locator("h1")):
        opened.page.emulate_media(color_scheme="light")
        looks_different(seen, lambda: opened.page.emulate_media(color_scheme="dark"))
    assert opened.page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(18, 21, 24)"
    opened.page.close()
    assert opened.complaints == []


def undrawn(page: Page) -> list[str]:
    """The charts that are on the page and not drawn."""
    charts = "[...document.querySelectorAll('.chart')].filter(chart => chart.getClientRects().length)"
    names: list[str] = page.evaluate(
        f"{charts}.filter(chart => chart.dataset.drawn !== 'yes').map(chart => chart.dataset.figure)"
    )
    return names


def test_charts_are_drawn_when_they_come_near_and_all_of_them_on_white_paper(
    browser: Browser, report: Path
) -> None:
    opened = open_page(browser, report, whole=False, viewport=DESKTOP, color_scheme="dark")
    page = opened.page
    far = page.locator(".chart[data-figure=clip_circles]")
    assert "clip_circles" in undrawn(page)
    far.scroll_into_view_if_needed()
    page.locator(".chart[data-figure=clip_circles][data-drawn=yes]").wait_for()
    page.locator("html[data-drawn=yes]").wait_for()
    seen = page.locator(".chart:visible:not([data-drawn])")
    assert not any(page.evaluate(IN_VIEW, chart.element_handle()) for chart in seen.all())
    assert undrawn(page)
    assert len(page.pdf()) > 100_000
    assert undrawn(page) == []
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    swatches = page.locator(".swatch").evaluate_all(
        "all => all.map(one => getComputedStyle(one).printColorAdjust)"
    )
    assert swatches == ["exact"] * 4
    assert not page.locator("#tables").is_visible()
    page.locator("#tables details").first.evaluate("one => { one.open = true }")
    assert page.locator("#tables table").first.is_visible()
    page.close()
    assert opened.complaints == []


def test_charts_follow_a_window_that_changes_while_they_are_hidden(browser: Browser, report: Path) -> None:
    opened = open_page(browser, report, viewport=DESKTOP)
    page = opened.page
    page.locator("input[value=speed_error]").check()
    page.locator("#trial_map_speed_error .chart[data-drawn]").wait_for()
    page.set_viewport_size(PHONE)
    page.locator("input[value=holds]").check()
    for chart in page.locator(".chart:visible").all():
        for _ in range(100):
            box = chart.locator("svg, canvas").first.bounding_box()
            if box is not None and 250 < box["width"] <= PHONE["width"]:
                break
            page.wait_for_timeout(100)
        else:
            pytest.fail(f"{chart.get_attribute('data-figure')} does not fit: {box}")
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    page.close()
    assert opened.complaints == []


def test_without_scripts_the_words_and_tables_are_there(browser: Browser, report: Path) -> None:
    page = browser.new_page(java_script_enabled=False, viewport=PHONE)
    page.goto(report.as_uri())
    assert page.locator("noscript p").is_visible()
    assert not page.locator(".player").is_visible()
    assert page.locator("#verdict h2").is_visible()
    assert page.locator("#table-trials tbody tr").count() == 2 * 81
    page.close()


def test_the_smallest_evaluation_opens_too(browser: Browser, tmp_path: Path) -> None:
    made: Evaluation = fake_evaluation(1, 30, replay_seconds=0.1)
    write_report(made, tmp_path / "small.html")
    opened = open_page(browser, tmp_path / "small.html", viewport=PHONE)
    opened.part("play").click()
    opened.page.close()
    assert opened.complaints == []
