"""The figures: what they count, what they say, and that their colours can be read."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fake_evaluation import fake_evaluation, with_names
from gmr.errors import MissingExtraError
from gmr.evaluation import Evaluation, Table, Tables
from gmr.evaluation.figures import figures, svg
from gmr.evaluation.figures.classes import Classes, two_sided
from gmr.evaluation.figures.clip_circles import clip_circles, jumps_with
from gmr.evaluation.figures.clip_usage import clip_usage, never_played, recordings
from gmr.evaluation.figures.compared_coverage import compared_coverage
from gmr.evaluation.figures.coverage_density import coverage_density
from gmr.evaluation.figures.coverage_scatter import coverage_scatter
from gmr.evaluation.figures.frame_usage import frame_usage
from gmr.evaluation.figures.holds_map import holds_map
from gmr.evaluation.figures.pose_distance import pose_distance
from gmr.evaluation.figures.transition_matrix import flows
from gmr.evaluation.figures.wording import short_names
from gmr.evaluation.regions import Grid, Limits
from gmr.matching.naming import recording_of
from gmr.pages.theme import DARK, LIGHT, STEPS


@pytest.fixture(scope="module")
def evaluation() -> Evaluation:
    return fake_evaluation()


@pytest.fixture(scope="module")
def mirrored() -> Evaluation:
    return fake_evaluation(40, mirrored=True)


def without(evaluation: Evaluation, **changes: Table) -> Evaluation:
    return replace(evaluation, measured=replace(evaluation.measured, **changes))


def test_every_figure_has_a_name_of_its_own_and_a_sentence(evaluation: Evaluation) -> None:
    drawn = list(figures(evaluation))
    assert len({figure.name for figure in drawn}) == len(drawn)
    for figure in drawn:
        assert figure.sentence.endswith(".")
        assert "nan" not in figure.sentence.split()
        assert figure.title


def test_a_description_is_complete_and_plain_json(evaluation: Evaluation) -> None:
    for figure in figures(evaluation):
        text = json.dumps(figure.description(), allow_nan=True)
        assert "var(--" not in text
        assert json.loads(text)["datasets"].keys() == figure.data.keys()


def test_svg_writes_one_file_a_figure(tmp_path: Path, mirrored: Evaluation) -> None:
    pytest.importorskip("vl_convert")
    written = svg(mirrored, tmp_path / "figures")
    assert {path.stem for path in written} == {figure.name for figure in figures(mirrored)}
    for path in written:
        text = path.read_text(encoding="utf-8")
        assert text.startswith("<svg")
        assert "var(--" not in text
        assert len(text) < 4_000_000
    circles = (tmp_path / "figures" / "clip_circles.svg").read_text(encoding="utf-8")
    names = {figure.name: figure for figure in figures(mirrored)}["clip_circles"].data["names"]
    for number, clip in enumerate(names["clip"].tolist(), 1):
        assert f"{number} {clip}" in circles


def test_svg_without_its_extra_says_what_to_install(
    tmp_path: Path, mirrored: Evaluation, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "vl_convert", None)
    with pytest.raises(MissingExtraError, match=r"gmr-motion\[report\]"):
        svg(mirrored, tmp_path / "figures")
    assert not (tmp_path / "figures").exists()


def test_figures_of_hardly_any_data_are_drawn_too(evaluation: Evaluation) -> None:
    measured = evaluation.measured
    nothing: dict[str, Any] = {
        name: getattr(measured, name).take(np.arange(0)) for name in ("coverage", "transitions")
    }
    usage = Table({**dict(measured.usage), "count": np.zeros(len(measured.usage), int)})
    clips = Table(
        {
            **dict(measured.clips),
            **dict.fromkeys(("played_seconds", "played_share"), np.zeros(len(measured.clips))),
        }
    )
    bare = without(evaluation, usage=usage, clips=clips, trials=measured.trials.take([0]), **nothing)
    for figure in figures(bare):
        assert figure.sentence.endswith(".")
        json.dumps(figure.description())


def test_density_holds_all_of_the_time_but_what_it_says_is_left_out(evaluation: Evaluation) -> None:
    drawn = coverage_density(evaluation).data["cells"]["seconds"].sum()
    windows = evaluation.measured.coverage
    assert drawn <= windows["weight"].sum() + 1e-6
    assert drawn >= 0.99 * windows["weight"].sum()


def test_scatter_draws_every_window_until_they_are_too_many(evaluation: Evaluation) -> None:
    assert len(coverage_scatter(evaluation).data["windows"]) == len(evaluation.measured.coverage)
    many = coverage_scatter(fake_evaluation(159, 500))
    assert 12_000 < len(many.data["windows"]) <= 24_000
    assert "One window in 4" in many.sentence


def test_shares_of_the_motion_are_those_of_its_time(evaluation: Evaluation) -> None:
    windows = evaluation.measured.coverage
    turns = np.arange(100) < 90
    columns = {
        "turn_rate_deg": np.where(turns, -30.0, 5.0),
        "speed": np.where(turns, 1.0, 2.0),
        "weight": np.where(turns, 0.5, 5.5),
    }
    one = without(evaluation, coverage=Table({**dict(windows.take(np.arange(100))), **columns}))
    assert "45% of it turns faster than 25 degrees/s, 0% faster than 75" in coverage_scatter(one).sentence
    assert "lies between 1.0 and 2.0 m/s" in coverage_scatter(one).sentence
    calm = without(one, coverage=Table({**dict(one.measured.coverage), "weight": np.ones(100)}))
    assert "45% of fake and 90% of fake turn faster" in compared_coverage([one, calm]).sentence


def test_a_few_spins_do_not_stretch_the_scatter_and_are_counted(evaluation: Evaluation) -> None:
    windows = evaluation.measured.coverage
    turn = np.clip(windows["turn_rate_deg"], -90.0, 90.0)
    turn[:7] = 580.0
    turn[7:9] = -600.0
    spun, calm = (
        without(evaluation, coverage=Table({**dict(windows), "turn_rate_deg": each}))
        for each in (turn, np.clip(turn, -90, 90))
    )
    one, two = coverage_scatter(spun), compared_coverage([spun, calm])
    for figure, layers in ((one, one.chart["layer"]), (two, [two.chart])):
        for layer in layers:
            scale = layer["encoding"]["x"]["scale"]
            assert scale["domain"] == [-100.0, 100.0]
            assert scale["clamp"] is True
        assert (np.abs(figure.data["windows"]["turn_rate_deg"]) > 100).any()
    assert f"9 of {len(windows):,} windows turn faster than 100 degrees/s, up to 600, and are" in one.sentence
    assert f"9 of {2 * len(windows):,} windows turn faster" in two.sentence
    whole = without(evaluation, coverage=Table({**dict(windows), "turn_rate_deg": np.clip(turn, -140, 140)}))
    assert "edge" not in coverage_scatter(whole).sentence


def test_maps_of_cells_say_how_much_turns_too_fast_to_be_drawn(evaluation: Evaluation) -> None:
    poses = evaluation.measured.pose_coverage
    fast = np.argsort(poses["seconds"])[-1:]
    turn = poses["turn_rate_deg"].copy()
    turn[fast] = 1000.0
    spun = pose_distance(without(evaluation, pose_coverage=Table({**dict(poses), "turn_rate_deg": turn})))
    drawn = sum(float(spun.data[name]["seconds"].sum()) for name in ("cells", "alone"))
    assert drawn < poses["seconds"].sum() - 1
    assert re.search(r"\d seconds of turning faster than \d+ degrees/s are not drawn\.$", spun.sentence)


def test_scatter_thinned_keeps_every_clip() -> None:
    many = fake_evaluation(159, 500)
    windows = many.measured.coverage
    short = windows.take((windows["clip"] != windows["clip"][0]) | (windows["frame"] == 17))
    drawn = coverage_scatter(without(many, coverage=short)).data["windows"]
    assert set(drawn["clip"]) == set(many.measured.clips["clip"])
    assert len(drawn) <= 24_000 + len(many.measured.clips)


def test_recordings_add_up_to_what_was_played(mirrored: Evaluation) -> None:
    clips = mirrored.measured.clips
    table = recordings(clips)
    assert len(table) == 40
    assert table["played_share"].sum() == pytest.approx(1.0)
    assert table["played_seconds"].sum() == pytest.approx(clips["played_seconds"].sum())
    assert table["seconds"].sum() == pytest.approx(clips["seconds"][~clips["mirrored"]].sum())
    np.testing.assert_allclose(table["share_recorded"] + table["share_mirrored"], table["played_share"])
    assert (np.diff(table["played_share"]) <= 0).all()


def test_never_played_are_those_without_a_played_frame(mirrored: Evaluation) -> None:
    usage = mirrored.measured.usage
    played = {recording_of(clip) for clip in usage["clip"][usage["count"] > 0]}
    everything = {recording_of(clip) for clip in usage["clip"]}
    assert set(never_played(mirrored.measured.clips)) == everything - played
    assert f"{len(everything - played)} of 40 clips" in clip_usage(mirrored).sentence


def test_flows_keep_every_jump(mirrored: Evaluation) -> None:
    transitions = mirrored.measured.transitions
    table = flows(transitions)
    assert table["count"].sum() == transitions["count"].sum()
    start, end = table["from_clip"][0], table["to_clip"][0]
    expected = sum(
        row["count"]
        for row in transitions.rows()
        if (recording_of(row["from_clip"]), recording_of(row["to_clip"])) == (start, end)
    )
    assert table["count"][0] == expected


def test_frame_usage_keeps_every_play_of_the_clips_that_it_draws(evaluation: Evaluation) -> None:
    usage = evaluation.measured.usage
    pieces = frame_usage(evaluation).data["pieces"]
    name = pieces["clip"][0]
    frames = usage["count"][usage["clip"] == name]
    drawn = pieces["plays"][pieces["clip"] == name]
    size = np.bincount(np.arange(len(frames)) * 40 // len(frames))
    assert (drawn * size).sum() == pytest.approx(frames.sum())


def test_clip_circles_draw_no_more_lines_than_can_be_seen(evaluation: Evaluation) -> None:
    lines = clip_circles(evaluation).data["lines"]
    assert 0 < len(lines) <= 400
    assert (np.abs(lines["x"]) <= 1.4).all()
    assert (np.abs(lines["y"]) <= 1.0).all()


def test_clip_circles_say_with_how_many_clips_one_exchanges_jumps(evaluation: Evaluation) -> None:
    assert jumps_with(11, 11) == "exchanges jumps with each of the other 11 clips"
    assert jumps_with(3, 11) == "exchanges jumps with 3 of the other 11 clips"
    assert jumps_with(1, 1) == "exchanges jumps with the other clip"
    assert jumps_with(0, 0) == jumps_with(0, 5) == "jumps only within itself"
    assert re.search(r" of the other \d+ clips\. Frames run", clip_circles(evaluation).sentence)


def test_the_map_of_the_verdict_agrees_with_the_verdict(evaluation: Evaluation) -> None:
    drawn = holds_map(evaluation, "constant", "time").data["trials"]
    grid = Grid.of(evaluation.measured.trials, evaluation.measured.coverage, Limits())
    assert (drawn["outcome"] == "as asked").sum() == grid.held.sum()
    trials = evaluation.measured.trials
    speed = np.abs(trials["speed_error_share"]) / Limits().speed
    turn = np.abs(trials["turn_rate_error_deg"]) / Limits().turn_rate_deg
    strays = drawn["outcome"] == "strays from the path"
    assert (strays == ((trials["offset_mean"] > Limits().offset) & (speed <= 1) & (turn <= 1))).all()
    assert ((drawn["outcome"] == "wrong speed") == ((speed > 1) & (speed >= turn))).all()
    assert ((drawn["outcome"] == "wrong turn rate") == ((turn > 1) & (turn > speed))).all()


def test_the_map_of_the_verdict_says_by_what_the_others_fail(evaluation: Evaluation) -> None:
    trials = evaluation.measured.trials
    off = {name: np.zeros(81) for name in ("speed_error_share", "turn_rate_error_deg", "offset_mean")}

    def said(**failing: tuple[int, float]) -> str:
        columns = dict(off)
        for name, (first, value) in failing.items():
            columns[name] = np.where(np.arange(81) < first, value, 0.0)
        changed = Table({name: columns.get(name, trials[name]) for name in trials.column_names})
        measured = replace(evaluation.measured, trials=changed)
        return holds_map(replace(evaluation, measured=measured), "constant", "time").sentence

    assert said().endswith("No trial fails.")
    assert said(speed_error_share=(81, -0.5)) == "No trial goes as asked. All 81 fail by speed."
    assert said(offset_mean=(1, 2.0)).endswith("The other one fails by straying alone.")
    assert said(speed_error_share=(9, -0.5)).endswith("The other 9 fail by speed.")
    told = said(speed_error_share=(9, -0.5), turn_rate_error_deg=(4, 80.0), offset_mean=(12, 2.0))
    assert told.endswith(
        "The other 12 fail: 5 by speed, 4 by turn rate (whichever is farther off) and 3 by straying alone."
    )


def test_classes_sort_values_at_their_borders() -> None:
    classes = Classes("error", (0.1, 1.0))
    assert classes.of(np.array([0.0, 0.1, 0.5, 1.0, 9.0, np.nan, np.inf])).tolist() == [0, 1, 1, 2, 2, -1, -1]
    assert two_sided((1.0, 2.0)).of(np.array([-3.0, -1.5, 0.0, 1.5, 3.0])).tolist() == [0, 1, 2, 3, 4]
    with pytest.raises(ValueError, match="7 colours"):
        Classes("error", tuple(map(float, range(STEPS))))


def luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


def contrast(first: str, second: str) -> float:
    low, high = sorted(map(luminance, (first, second)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_text_can_be_read_on_its_ground(colours: dict[str, str]) -> None:
    for name, colour in colours.items():
        if name.startswith("on-"):
            assert contrast(colour, colours[name.removeprefix("on-")]) >= 4.5, name
    for ink in ("ink", "ink-soft", "accent"):
        assert contrast(colours[ink], colours["page"]) >= 4.5, ink
        assert contrast(colours[ink], colours["panel"]) >= 4.5, ink
    assert contrast(colours["warning"], colours["warning-panel"]) >= 4.5
    assert colours.keys() == LIGHT.keys()


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
@pytest.mark.parametrize("scale", ["amount", "error"])
def test_scales_are_ordered_by_lightness(colours: dict[str, str], scale: str) -> None:
    steps = [luminance(colours[f"{scale}-{step}"]) for step in range(STEPS)]
    assert steps in (sorted(steps), sorted(steps, reverse=True))


@given(st.lists(st.text(min_size=1, max_size=60), unique=True, max_size=12))
def test_short_names_stay_different(names: list[str]) -> None:
    labels = short_names(names)
    assert len(set(labels)) == len(names)


def test_short_names_drop_what_tells_nothing() -> None:
    assert short_names(["a/walk_01.bvh", "b/walk_02.bvh"]) == ["walk_01", "walk_02"]
    assert short_names(["a/walk.bvh", "b/walk.bvh"]) == ["a/walk", "b/walk"]
    assert short_names(["a/walk.bvh", "a/walk.bvh (mirrored)"]) == ["walk", "walk (mirrored)"]
    (label,) = short_names(["dataset-1_walk_with_a_very_long_name_and_number_017.bvh"])
    assert label.startswith("…")
    assert label.endswith("number_017")


def test_clips_of_other_names_are_drawn_alike(evaluation: Evaluation) -> None:
    first = evaluation.measured.clips["clip"][0]
    renamed = with_names(evaluation, {first: "x"})
    assert isinstance(renamed.measured, Tables)
    assert len(clip_usage(renamed).data["bars"]) == len(clip_usage(evaluation).data["bars"])


def test_every_scenario_and_tracking_has_maps_of_its_own() -> None:
    both = fake_evaluation(20, scenarios=("constant", "switching"), trackings=("time", "velocity"))
    maps = {
        figure.name: figure.title for figure in figures(both) if figure.name.startswith("trial_map_holds")
    }
    assert list(maps) == [
        "trial_map_holds",
        "trial_map_holds_switching",
        "trial_map_holds_velocity",
        "trial_map_holds_switching_velocity",
    ]
    assert len(set(maps.values())) == 4
