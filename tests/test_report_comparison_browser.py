"""The report of several datasets in a real browser, by mouse and by keyboard."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from browsers import chromium, opened
from fake_evaluation import fake_evaluation
from gmr.evaluation import comparison_of
from gmr.evaluation.compare import renamed

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    yield from chromium("--disable-gpu")


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = [fake_evaluation(6, 40, seed=seed, replay_seconds=2) for seed in (1, 2)]
    path = tmp_path_factory.mktemp("report") / "both.html"
    named = [renamed(each, name) for each, name in zip(made, ("one", "<b>two</b>"), strict=True)]
    comparison_of(named).report(path)
    return path


@pytest.mark.parametrize("width", [1400, 390])
def test_any_trial_of_any_dataset_is_replayed(browser: Browser, report: Path, width: int) -> None:
    page, complaints = opened(browser, report, {"width": width, "height": 900})
    page.locator(".player[data-ready=yes]").wait_for()
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    for film in ("1", "0"):
        cell = page.locator(f"#trial_map_holds--{int(film) + 1} .mark-rect path").nth(20)
        cell.scroll_into_view_if_needed()
        cell.click(force=True)
        page.locator(f".player[data-film='{film}'][data-trial='20']").wait_for()
    dataset = page.locator("[data-part=dataset]")
    assert dataset.locator("option").all_inner_texts() == ["one", "<b>two</b>"]
    dataset.select_option("1")
    page.locator(".player[data-film='1'][data-trial='20']").wait_for()
    page.locator("#compared_trials .map").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    page.locator(".player[data-film='1'][data-trial='21']").wait_for()
    page.locator("input[value=offset_mean]").check()
    for place in (1, 2):
        page.locator(f"#trial_map_offset_mean--{place} .chart[data-drawn]").wait_for()
    assert page.locator("b").count() == 0
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    page.close()
    assert complaints == []
