"""The trials as the page unpacks them, in a real browser, against what the core plays."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser, Page

import gmr
from browsers import chromium
from gmr.demo import demo_folder
from gmr.evaluation import Evaluation, Strafe
from gmr.evaluation.replay import worst_trial
from gmr.evaluation.replays import Replays
from gmr.evaluation.report import film as films
from gmr.evaluation.report.film import packed_film
from gmr.pages.document import own

SOME = slice(400, 700)
"""Steps whose poses are compared."""


@pytest.fixture(scope="module")
def evaluation() -> Evaluation:
    asked = ("constant", "switching", Strafe((1.0,), (90.0,)))
    return gmr.evaluate(demo_folder(), scenarios=asked, speeds=[1.0, 2.5], turn_rates_deg=[-50.0, 0.0, 50.0])


def replays_of(evaluation: Evaluation) -> Replays:
    assert evaluation.replays is not None
    return evaluation.replays


def packed(evaluation: Evaluation) -> dict[str, Any]:
    return packed_film(replays_of(evaluation), "takes", "Hips", worst_trial(evaluation.measured.trials))


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    yield from chromium("--disable-gpu")


@pytest.fixture(scope="module")
def opened(browser: Browser, evaluation: Evaluation) -> Iterator[Page]:
    page = browser.new_page()
    page.add_script_tag(content=own("gmr.evaluation.report", "film.js"))
    page.evaluate("async (film) => { window.opened = await openFilm(film); }", packed(evaluation))
    yield page
    page.close()


def unpacked_trial(page: Page, number: int) -> dict[str, NDArray[np.float64]]:
    found = page.evaluate(
        """([number, from, to]) => {
            const trial = opened.trial(number), poses = [];
            for (let step = from; step < to; step += 1) {
                const pose = new Float64Array(opened.joints * 3);
                trial.poseAt(step, pose);
                poses.push(Array.from(pose));
            }
            const source = Array.from({ length: trial.steps }, (_, step) => trial.sourceAt(step).seconds);
            return { poses, path: Array.from(trial.path), plan: Array.from(trial.plan), source };
        }""",
        [number, SOME.start, SOME.stop],
    )
    return {name: np.array(values) for name, values in found.items()}


@pytest.mark.browser
def test_the_page_plays_what_the_core_played(opened: Page, evaluation: Evaluation) -> None:
    replays = replays_of(evaluation)
    for number in (0, 5, 12):
        played = replays.trials[number]
        found = unpacked_trial(opened, number)
        path = np.stack([played.x, played.z], axis=1)
        np.testing.assert_allclose(found["path"].reshape(-1, 2), path, rtol=0, atol=0.005)
        plan = np.stack([played.ref_x, played.ref_z], axis=1)
        np.testing.assert_allclose(found["plan"].reshape(-1, 2), plan, rtol=0, atol=1e-4)
        np.testing.assert_allclose(found["source"], replays.frames.seconds[played.row], rtol=0, atol=1e-3)


@pytest.mark.browser
def test_the_worst_trial_is_posed_and_smoothed_as_by_the_core(opened: Page, evaluation: Evaluation) -> None:
    worst = worst_trial(evaluation.measured.trials)
    assert np.count_nonzero(replays_of(evaluation).trials[worst].jumped[SOME]) > 5
    found = unpacked_trial(opened, worst)["poses"].reshape(SOME.stop - SOME.start, -1, 3)
    cores = evaluation.replay.positions[SOME]
    apart = np.linalg.norm(found - cores, axis=2)
    # The core smooths rotations and the root, the page the places of the joints.
    assert float(np.median(apart)) < 0.02
    assert float(np.percentile(apart, 95)) < 0.1
    steps, known = (np.linalg.norm(np.diff(poses, axis=0), axis=2) for poses in (found, cores))
    assert steps.max() < 1.1 * known.max()


def whole_numbers(film: dict[str, Any]) -> dict[str, NDArray[np.int64]]:
    stream = np.frombuffer(zlib.decompress(base64.b64decode(film["packed"])), np.uint8)
    columns: dict[str, NDArray[np.int64]] = {}
    start = 0
    for name, count, width in film["layout"]:
        planes = stream[start : start + count * width].reshape(width, count).astype(np.int64)
        unsigned = np.sum([plane << (8 * place) for place, plane in enumerate(planes)], axis=0)
        columns[name] = (unsigned >> 1) ^ -(unsigned & 1)
        start += count * width
    assert start == len(stream)
    return columns


def test_every_row_that_a_trial_shows_is_held(evaluation: Evaluation) -> None:
    film, replays = packed(evaluation), replays_of(evaluation)
    columns = whole_numbers(film)
    assert columns["runs"].tolist() == [
        int(np.count_nonzero(np.diff(played.row) != 1)) + 1 for played in replays.trials
    ]
    assert columns["steps"].sum() == sum(len(played.row) for played in replays.trials)
    starts = np.concatenate([[0], np.cumsum(film["ranges"]["rows"])])
    assert len(columns["ways"]) == 3 * starts[-1]
    ends = columns["rows"] + columns["steps"]
    holder = np.searchsorted(starts, columns["rows"], side="right")
    assert (ends <= starts[holder]).all()


def test_what_is_too_much_leaves_out_the_trials_that_stray_least(
    evaluation: Evaluation, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(films, "MOST_BYTES", 100_000)
    film, replays = packed(evaluation), replays_of(evaluation)
    kept = {told["index"] for told in film["trials"]}
    assert 0 < len(kept) < len(replays.trials)
    assert film["leftOut"] == len(replays.trials) - len(kept)
    worst = worst_trial(evaluation.measured.trials)
    assert film["trials"][film["first"]]["index"] == worst
    away = [float(played.offset.mean()) for played in replays.trials]
    others = set(range(len(away))) - kept
    assert min(away[index] for index in kept - {worst}) >= max(away[index] for index in others)


def test_the_same_trials_give_the_same_bytes(evaluation: Evaluation) -> None:
    assert packed(evaluation) == packed(evaluation)
