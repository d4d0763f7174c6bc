"""The report as a file: self-contained, small, harmless whatever the names, whole or not there."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fake_evaluation import fake_evaluation, with_names
from gmr.evaluation import Table
from gmr.evaluation.report import write_report
from gmr.evaluation.report.film import packed_film
from gmr.evaluation.report.page import page
from gmr.evaluation.report.replay import sides
from gmr.evaluation.result import Evaluation
from gmr.pages.columns import packed, steps
from gmr.pages.document import json_text

NASTY = "a</script><script>document.title='owned'</script><b onclick=\"x\">&amp;'\u2028.bvh"


class Elements(HTMLParser):
    """What a browser makes of the page: tags with their attributes, and the text of scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.scripts: list[str] = []
        self.words: list[str] = []
        self._open = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._open = tag
        if tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        self._open = ""

    def handle_data(self, data: str) -> None:
        if self._open == "script":
            self.scripts[-1] += data
        elif self._open != "style":
            self.words.append(data)


@pytest.fixture(scope="module")
def evaluation() -> Evaluation:
    return fake_evaluation()


@pytest.fixture(scope="module")
def html(evaluation: Evaluation) -> str:
    return page(evaluation)


def data_of(html: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(Elements(html).scripts[0])
    return found


def unpacked(column: dict[str, Any]) -> Any:
    values = np.frombuffer(base64.b64decode(column["bytes"]), "<" + column["type"])
    if "step" in column:
        return np.where(values == 65535, np.nan, column["low"] + values * column["step"])
    return np.array(column["labels"], object)[values] if "labels" in column else values


def test_the_page_refers_to_nothing_outside_of_itself(html: str) -> None:
    for tag, attributes in Elements(html).tags:
        assert tag not in {"iframe", "object", "embed", "img", "audio", "video", "base", "form"}
        for name in ("src", "srcset", "action", "data", "poster"):
            assert name not in attributes, (tag, attributes)
        assert (attributes.get("href") or "#").startswith(("#", "data:,")), attributes
    style = html[html.index("<style>") : html.index("</style>")]
    assert "url(" not in style
    assert "@import" not in style


def test_only_the_scripts_that_the_policy_names_can_run(html: str) -> None:
    parsed = Elements(html)
    policy = next(a["content"] or "" for tag, a in parsed.tags if a.get("http-equiv"))
    allowed = set(re.findall(r"'sha256-([^']+)'", policy))
    digests = {
        base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in parsed.scripts[1:]
    }
    assert allowed == digests
    assert len(parsed.scripts) == 3
    assert "default-src 'none'" in policy
    assert "unsafe-eval" not in policy
    assert "unsafe-inline" not in policy.split("script-src")[1].split(";")[0]


def test_the_page_carries_the_licences_of_what_it_holds(html: str) -> None:
    vega = Elements(html).scripts[1]
    assert "University of Washington Interactive Data Lab" in vega
    assert "Redistribution and use in source and binary forms" in vega
    assert "Mike Bostock" in vega


def test_a_page_of_usual_size_takes_at_most_two_and_a_half_megabytes(html: str) -> None:
    assert len(html.encode()) < 2_500_000


def test_a_large_dataset_still_fits_into_five_megabytes() -> None:
    large = fake_evaluation(98, 1240, mirrored=True, replay_seconds=60)
    assert len(page(large).encode()) < 5_000_000


def test_the_words_come_before_the_charts(html: str, evaluation: Evaluation) -> None:
    place = html.index(evaluation.verdict.headline.split(";")[0])
    assert place < html.index('class="chart"')
    for sentence in evaluation.verdict.sentences:
        assert sentence in html


def test_names_and_sentences_are_text_whatever_they_hold(evaluation: Evaluation, html: str) -> None:
    nasty = replace(
        with_names(evaluation, {evaluation.measured.clips["clip"][0]: NASTY}),
        dataset=NASTY,
        notes=(NASTY,),
        failed={NASTY: NASTY},
        verdict=replace(evaluation.verdict, headline=NASTY, sentences=(NASTY + "!",)),
        summary=replace(evaluation.summary, unit=NASTY, joints={NASTY: NASTY}, settings={NASTY: NASTY}),
    )
    parsed = Elements(page(nasty))
    assert [tag for tag, _ in parsed.tags if tag == "script"] == ["script"] * 3
    assert not [tag for tag, attributes in parsed.tags if tag == "b" or "onclick" in attributes]
    assert NASTY in parsed.words
    assert NASTY in json.loads(parsed.scripts[0])["clips"]
    assert parsed.scripts[1:] == Elements(html).scripts[1:]


def test_json_in_a_script_holds_no_sign_that_html_reads() -> None:
    text = json_text({"<!--": ["</script>", "&", "\u2028\u2029"]})
    assert not re.search("[<>&\u2028\u2029]", text)
    assert json.loads(text) == {"<!--": ["</script>", "&", "\u2028\u2029"]}


def test_braces_in_a_name_fill_nothing_in(evaluation: Evaluation) -> None:
    assert "{{style}}" in page(replace(evaluation, dataset="{{style}}"))


def test_failed_files_and_notes_are_shown_where_there_are_any(evaluation: Evaluation, html: str) -> None:
    shown = page(replace(evaluation, failed={"bad.bvh": "it is empty"}, notes=("A guess.",)))
    assert "1 file could not be used" in shown
    assert "bad.bvh" in shown
    assert "A guess." in shown
    assert 'id="failed"' not in html
    assert 'id="notes"' not in html


def test_a_note_that_the_verdict_repeats_is_shown_once(evaluation: Evaluation) -> None:
    verdict = replace(evaluation.verdict, sentences=(*evaluation.verdict.sentences, "A guess."))
    assert page(replace(evaluation, verdict=verdict, notes=("A guess.",))).count("A guess.") == 1


def test_the_same_evaluation_gives_the_same_bytes(evaluation: Evaluation, html: str) -> None:
    assert page(evaluation) == html


def test_tables_come_back_exactly_from_the_page(evaluation: Evaluation, html: str) -> None:
    columns = data_of(html)["tables"]["trials"]["columns"]
    assert list(columns) == list(evaluation.measured.trials.column_names)
    for name, column in columns.items():
        np.testing.assert_array_equal(unpacked(column), evaluation.measured.trials[name])


def test_a_long_table_is_packed_exactly_where_that_is_asked_for() -> None:
    values = np.random.default_rng(3).normal(size=5000)
    column = packed(Table({"real": values}), exact=True)["columns"]["real"]
    np.testing.assert_array_equal(unpacked(column), values)


@pytest.mark.parametrize("length", [0, 1, 5, 3000])
def test_packed_columns_keep_their_values(length: int) -> None:
    random = np.random.default_rng(length)
    table = Table(
        {
            "text": np.array([f"clip {i % 300}" for i in range(length)], object),
            "small": np.arange(length) % 200,
            "large": np.arange(length) * 100_000,
            "negative": -np.arange(length),
            "flag": np.arange(length) % 2 == 0,
            "real": np.where(np.arange(length) % 7 == 3, np.nan, random.normal(0, 100, length)),
        }
    )
    columns = packed(table)["columns"]
    for name in ("text", "small", "large", "negative", "flag"):
        np.testing.assert_array_equal(unpacked(columns[name]), table[name])
    step = columns["real"].get("step", 0.0)
    np.testing.assert_allclose(unpacked(columns["real"]), table["real"], rtol=0, atol=0.51 * step)


@pytest.mark.parametrize("values", [[], [np.nan], [3.0], [3.0, 3.0], [-1.0, np.nan, 1.0], [0.0, 1e300]])
def test_steps_of_odd_columns_come_back(values: list[float]) -> None:
    column = steps(np.array(values, float))
    np.testing.assert_allclose(unpacked(column), values, rtol=0, atol=0.51 * column["step"])


def test_hips_that_are_the_root_keep_the_whole_body(evaluation: Evaluation) -> None:
    replays = evaluation.replays
    assert replays is not None
    assert packed_film(replays, "fake", "Hips", 0) == packed_film(replays, "fake", None, 0)


def test_a_root_above_the_hips_is_not_drawn(evaluation: Evaluation) -> None:
    replays = evaluation.replays
    assert replays is not None
    far = np.full((len(replays.positions), 1, 3), 500.0, np.float32)
    rooted = replace(
        replays,
        positions=np.concatenate([far, replays.positions], axis=1),
        parents=np.append(np.int32(-1), replays.parents + 1).astype(np.int32),
        joint_names=("Root", *replays.joint_names),
    )
    assert packed_film(rooted, "fake", "Hips", 0) == packed_film(replays, "fake", "Hips", 0)


def test_left_and_right_are_found_in_the_names_of_many_skeletons() -> None:
    left = [
        "LeftUpLeg",
        "mixamorig:LeftFoot",
        "lfemur",
        "lhipjoint",
        "LHipJoint",
        "Hand_L",
        "L_Knee",
        "lClavicle",
    ]
    right = ["RightArm", "mixamorig:RightHand", "rtibia", "RThumb", "Foot_R", "Bip01 R Thigh", "rradius"]
    middle = ["Hips", "lowerback", "root", "Spine1", "Head", "LowerBack", "Ribs", "Chest_end", "thorax"]
    assert sides((*left, *right, *middle)) == [1] * len(left) + [2] * len(right) + [0] * len(middle)


def test_a_report_replaces_the_one_before_it_whole(tmp_path: Path, evaluation: Evaluation) -> None:
    path = tmp_path / "report.html"
    path.write_text("before")
    write_report(evaluation, path)
    assert path.read_text(encoding="utf-8") == page(evaluation)
    assert [file.name for file in tmp_path.iterdir()] == ["report.html"]


def test_a_report_that_cannot_be_made_leaves_the_one_before_it(
    tmp_path: Path, evaluation: Evaluation
) -> None:
    path = tmp_path / "report.html"
    path.write_text("before")
    broken = replace(evaluation, measured=replace(evaluation.measured, trials=Table({})))
    with pytest.raises(KeyError):
        write_report(broken, path)
    assert path.read_text() == "before"
    assert [file.name for file in tmp_path.iterdir()] == ["report.html"]
    with pytest.raises(OSError, match="missing"):
        write_report(evaluation, tmp_path / "missing" / "report.html")
