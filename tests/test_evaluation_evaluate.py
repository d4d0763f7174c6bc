"""From files to an evaluation, on made-up walkers of which everything is known."""

from __future__ import annotations

import math
import pickle
import shutil
import statistics
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.evaluation import Evaluation, Table
from gmr.evaluation.usage import plays
from gmr.matching import Database
from gmr.matching.trial import Profile, run_trials
from locomotion import Arc
from walker import walker_bvh, write_walkers

GRID = {"speeds": (1.0, 2.0), "turn_rates_deg": (-50.0, 0.0, 50.0)}
WALKS = {
    "slow/straight.bvh": Arc(6.0, 1.0),
    "slow/left.bvh": Arc(6.0, 1.0, 50.0),
    "fast/straight.bvh": Arc(6.0, 2.0),
    "fast/left.bvh": Arc(6.0, 2.0, 50.0),
}
COLUMNS = {
    "trials": "dataset scenario tracking speed turn_rate_deg speed_error turn_rate_error_deg speed_deviation "
    "turn_rate_deviation_deg offset_mean offset_rms offset_p95 offset_max offset_final "
    "transitions_per_second search_cost_mean pose_discontinuity_mean",
    "coverage": "dataset clip frame speed turn_rate_deg",
    "usage": "dataset scenario clip frame count",
    "transitions": "dataset scenario from_clip from_frame to_clip to_frame kind count",
    "pose_coverage": "dataset speed turn_rate_deg seconds clips nearest_mean nearest_p95 entropy",
    "coverage_symmetry": "dataset speed turn_rate_deg left_seconds right_seconds symmetry",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("takes")
    write_walkers(top, WALKS)
    return top


@pytest.fixture(scope="module")
def found(folder: Path) -> Evaluation:
    return gmr.evaluate(folder, **GRID)  # type: ignore[arg-type]


def trial(found: Evaluation, column: str, speed: float, turn_rate: float, kind: str = "constant") -> float:
    trials = found.measured.trials
    chosen = (
        (trials["speed"] == speed) & (trials["turn_rate_deg"] == turn_rate) & (trials["scenario"] == kind)
    )
    return float(trials[column][chosen][0])


def constant(found: Evaluation) -> Table:
    trials = found.measured.trials
    return trials.take(trials["scenario"] == "constant")


def test_what_is_in_the_clips_is_kept_and_what_is_not_is_not(found: Evaluation) -> None:
    for speed in (1.0, 2.0):
        assert trial(found, "offset_mean", speed, 0.0) < 0.01
        assert abs(trial(found, "speed_error", speed, 0.0)) < 0.01
        assert abs(trial(found, "turn_rate_error_deg", speed, 50.0)) < 1.0
        assert abs(trial(found, "turn_rate_error_deg", speed, -50.0)) > 50.0
        assert trial(found, "offset_mean", speed, -50.0) > 2 * trial(found, "offset_mean", speed, 50.0)


def test_the_headline_counts_the_trials_within_the_limits(found: Evaluation) -> None:
    trials, limits = constant(found), found.summary.settings["limits"]
    held = trials["offset_mean"] <= limits["offset"]
    held &= np.abs(trials["speed_error"]) <= limits["speed"] * trials["speed"]
    held &= np.abs(trials["turn_rate_error_deg"]) <= limits["turn_rate_deg"]
    assert 2 <= held.sum() < 6
    assert found.verdict.headline.startswith(
        f"This dataset does what it is asked in {held.sum()} of 6 trials"
    )


def test_mirrored_copies_make_left_and_right_alike(folder: Path) -> None:
    found = gmr.evaluate(folder, mirror=True, **GRID)  # type: ignore[arg-type]
    for speed in (1.0, 2.0):
        left, right = (trial(found, "offset_mean", speed, turn) for turn in (50.0, -50.0))
        assert left == pytest.approx(right, rel=0.02)
        assert left < 0.6
    assert found.summary.mirrored_count == found.summary.clip_count == 4
    clips = found.measured.clips
    assert clips["clip"].tolist()[:2] == ["fast/left.bvh", "fast/left.bvh (mirrored)"]
    assert clips["mirrored"].sum() == 4
    turns = dict(zip(clips["clip"], clips["turn_rate_mean_deg"], strict=True))
    assert turns["slow/left.bvh (mirrored)"] == pytest.approx(-turns["slow/left.bvh"])


def test_the_tables_have_the_columns_that_were_promised_first(found: Evaluation) -> None:
    for name, columns in COLUMNS.items():
        assert found.tables()[name].column_names[: len(columns.split())] == tuple(columns.split())
    single = {"segments", "timeline", "error_bins", "error_fits"}
    assert set(found.tables()) == {*COLUMNS, "clips", "graph", "paths", *single}


def test_coverage_has_the_speeds_and_turns_of_the_clips(found: Evaluation) -> None:
    coverage = found.measured.coverage
    for name, arc in WALKS.items():
        windows = coverage.take(coverage["clip"] == name)
        np.testing.assert_allclose(windows["speed"], arc.speed, rtol=0.01)
        np.testing.assert_allclose(windows["turn_rate_deg"], arc.turn_rate_deg, atol=1.0)
    assert coverage["weight"].sum() == pytest.approx(24.0)


def test_usage_has_every_frame_with_its_time_in_the_file(found: Evaluation) -> None:
    usage = found.measured.usage
    assert len(usage) == 2 * 4 * 361
    np.testing.assert_allclose(usage["seconds"], usage["frame"] / 60)
    for scenario in ("constant", "switching"):
        assert usage["count"][usage["scenario"] == scenario].sum() == 6 * 30 * 60
    both = plays(usage)
    assert both["frame"].tolist() == usage["frame"][: 4 * 361].tolist()
    assert both["count"].sum() == 2 * 6 * 30 * 60
    played = found.measured.clips["played_seconds"]
    assert played.sum() == pytest.approx(2 * 6 * 30)


def test_the_replay_is_the_trial_that_strayed_farthest(found: Evaluation) -> None:
    worst = int(np.argmax(constant(found)["offset_mean"]))
    replay = found.replay
    assert replay.speed == found.measured.trials["speed"][worst]
    assert replay.turn_rate_deg == found.measured.trials["turn_rate_deg"][worst]
    steps, joints = 35 * 60 + 1, found.summary.joint_count
    assert replay.positions.shape == (steps, joints, 3)
    assert replay.positions.dtype == np.float32
    assert len(replay.joint_names) == len(replay.parents) == joints
    np.testing.assert_allclose(replay.offset, np.hypot(*(replay.path - replay.reference).T))
    assert replay.offset.max() == pytest.approx(found.measured.trials["offset_max"][worst])
    hips = replay.joint_names.index("Hips")
    assert np.abs(replay.positions[:, hips, [0, 2]] - replay.path).max() < 0.5
    for array in (replay.clip, replay.frame, replay.jumped, replay.path, replay.reference):
        assert len(array) == steps


def test_the_summary_says_what_was_taken_for_what(found: Evaluation, folder: Path) -> None:
    summary = found.summary
    assert found.dataset == summary.dataset == folder.name
    assert (summary.clip_count, summary.mirrored_count, summary.frame_count) == (4, 0, 4 * 361)
    assert summary.seconds == pytest.approx(24.0)
    assert summary.joints["left_foot"] == "LeftFoot"
    assert "0.01 m" in summary.unit
    assert "guessed" in summary.unit
    assert any("Unit guessed" in note for note in found.notes)
    assert found.failed == {}


@pytest.mark.parametrize("threads", [1, 2])
def test_threads_do_not_change_a_byte(found: Evaluation, folder: Path, tmp_path: Path, threads: int) -> None:
    again = gmr.evaluate(folder, threads=threads, **GRID)  # type: ignore[arg-type]
    pytest.importorskip("pyarrow")
    first = found.write_tables(tmp_path / "first", ("csv", "json", "parquet"))
    second = again.write_tables(tmp_path / "second", ("csv", "json", "parquet"))
    for one, other in zip(first, second, strict=True):
        assert one.read_bytes() == other.read_bytes()
    assert again.verdict == found.verdict


def test_motions_can_be_given_without_files(folder: Path, found: Evaluation) -> None:
    takes = gmr.read_folder(folder)
    by_name = gmr.evaluate(dict(takes), **GRID)  # type: ignore[arg-type]
    np.testing.assert_array_equal(
        by_name.measured.trials["offset_mean"], found.measured.trials["offset_mean"]
    )
    listed = gmr.evaluate(list(takes.values()), **GRID)  # type: ignore[arg-type]
    np.testing.assert_array_equal(listed.measured.trials["offset_mean"], found.measured.trials["offset_mean"])


def test_the_grid_can_be_an_array(folder: Path) -> None:
    found = gmr.evaluate(folder, speeds=np.array([2.0, 1.0]), turn_rates_deg=np.zeros(1))  # type: ignore[arg-type]
    assert found.measured.trials["speed"].tolist() == [1.0, 2.0] * 2


def test_open_loop_does_not_track_the_path(folder: Path) -> None:
    found = gmr.evaluate(folder, tracking="velocity", **GRID)  # type: ignore[arg-type]
    assert set(found.measured.trials["tracking"]) == {"velocity"}
    assert "planned path" not in str(found.verdict)
    assert abs(trial(found, "speed_error", 1.0, 50.0)) < 0.05


def test_both_trackings_are_run_beside_each_other_as_each_alone(folder: Path, found: Evaluation) -> None:
    small = {"speeds": (1.0,), "turn_rates_deg": (-50.0, 0.0)}
    both = gmr.evaluate(folder, tracking=("time", "velocity"), **small)  # type: ignore[arg-type]
    alone = [gmr.evaluate(folder, tracking=name, **small) for name in ("time", "velocity")]  # type: ignore[arg-type]
    for name in ("trials", "usage", "transitions"):
        assert both.tables()[name] == Table.joined([one.tables()[name] for one in alone])
    assert both.measured.trials["scenario"].tolist() == (["constant"] * 2 + ["switching"] * 2) * 2
    assert both.verdict.headline == alone[0].verdict.headline
    assert "Asked for speed and turn rate only, it does so in 1 of 2 trials." in both.verdict.sentences


def test_every_row_of_the_trials_finds_its_log(folder: Path, found: Evaluation) -> None:
    assert found.simulation is not None
    for row, wanted in enumerate(found.measured.trials.rows()):
        asked, log, place = found.simulation[row]
        assert (asked.scenario, asked.speed, asked.turn_rate_deg, log.tracking) == (
            *(wanted["scenario"], wanted["speed"], wanted["turn_rate_deg"], wanted["tracking"]),
        )
        recorded = slice(int(log.recorded_from[place]), int(log.lengths[place]))
        away = np.hypot(log.x - log.ref_x, log.z - log.ref_z)[place, recorded]
        assert away.mean() == pytest.approx(wanted["offset_mean"])
    assert len(found.simulation.profiles) == 12


def test_an_evaluation_is_pickled_without_what_was_simulated(found: Evaluation) -> None:
    again = pickle.loads(pickle.dumps(found))
    assert again.simulation is None
    assert again.tables() == found.tables()
    assert again.verdict == found.verdict


def test_the_authors_pacing_can_be_asked_for(folder: Path) -> None:
    found = gmr.evaluate(folder, preset="mig2022", **GRID)  # type: ignore[arg-type]
    assert constant(found)["seconds"].tolist() == [25.0, 5.0, 25.0] * 2
    switching = found.measured.trials.take(found.measured.trials["scenario"] == "switching")
    assert switching["seconds"].tolist() == [25.0] * 6


def test_a_broken_file_is_named_and_the_others_are_evaluated(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "takes")
    (tmp_path / "takes" / "broken.bvh").write_text("HIERARCHY\nROOT Hips\n{\n")
    (tmp_path / "takes" / "pose.bvh").write_text(walker_bvh(Arc(0.0, 1.0)))
    found = gmr.evaluate(tmp_path / "takes", **GRID)  # type: ignore[arg-type]
    assert set(found.failed) == {"broken.bvh", "pose.bvh"}
    assert "broken.bvh:4" in found.failed["broken.bvh"]
    assert "at least 2 frames" in found.failed["pose.bvh"]
    assert found.summary.clip_count == 4
    assert "2 files could not be used and were left out: broken.bvh and pose.bvh." in found.verdict.sentences
    with pytest.raises(gmr.FormatError, match=r"broken\.bvh"):
        gmr.evaluate(tmp_path / "takes", errors="raise", **GRID)  # type: ignore[arg-type]


def test_a_short_clip_counts_for_coverage_only(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "takes")
    (tmp_path / "takes" / "short.bvh").write_text(walker_bvh(Arc(0.5, 3.0)))
    found = gmr.evaluate(tmp_path / "takes", **GRID)  # type: ignore[arg-type]
    assert found.failed == {}
    assert (found.measured.coverage["clip"] == "short.bvh").sum() == 1
    assert found.measured.usage["count"][found.measured.usage["clip"] == "short.bvh"].sum() == 0
    assert any("'short.bvh'" in note for note in found.notes)


def test_a_folder_without_motions_is_refused_with_a_remedy(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("nothing here")
    with pytest.raises(gmr.DatasetError, match=r"holds no motion files \(\.bvh.*give the folder"):
        gmr.evaluate(tmp_path)
    with pytest.raises(gmr.DatasetError, match="at least one"):
        gmr.evaluate([])


def test_a_folder_of_broken_files_is_refused_with_the_first_reason(tmp_path: Path) -> None:
    (tmp_path / "a.bvh").write_text("nonsense")
    with pytest.raises(gmr.DatasetError, match=r"the only motion file of .* could not be read: .*a\.bvh"):
        gmr.evaluate(tmp_path)


def test_clips_shorter_than_the_horizon_are_refused_with_the_length_needed(tmp_path: Path) -> None:
    write_walkers(tmp_path, {"short.bvh": Arc(0.5, 1.0)})
    with pytest.raises(gmr.DatasetError, match=r"no clip lasts the 1\.0\d s .* 'short\.bvh', lasts 0\.50 s"):
        gmr.evaluate(tmp_path)


def test_a_body_without_feet_is_refused_with_the_remedy(tmp_path: Path) -> None:
    snake = "".join(
        f"JOINT S{k} {{ OFFSET 0 0 20 CHANNELS 3 Zrotation Xrotation Yrotation\n" for k in range(6)
    )
    text = f"HIERARCHY\nROOT S {{ OFFSET 0 0 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
Yrotation\n{snake}End Site {{ OFFSET 0 0 20 }} {'}' * 7}\nMOTION\nFrames: 90\nFrame Time: 0.0333\n"
    (tmp_path / "snake.bvh").write_text(text + "\n".join(" ".join(["0"] * 24) for _ in range(90)) + "\n")
    with pytest.raises(gmr.DatasetError, match="names="):
        gmr.evaluate(tmp_path, **GRID)  # type: ignore[arg-type]


def test_settings_that_make_no_sense_are_refused_before_anything_is_read(tmp_path: Path) -> None:
    missing = tmp_path / "missing"
    with pytest.raises(ValueError, match="unknown tracking"):
        gmr.evaluate(missing, tracking="speed")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="unknown scenario"):
        gmr.evaluate(missing, scenarios="stroll")
    with pytest.raises(ValueError, match="each tracking once"):
        gmr.evaluate(missing, tracking=("time", "time"))
    with pytest.raises(ValueError, match="switched speed must be"):
        gmr.evaluate(missing, switched_speed=0.0)
    with pytest.raises(TypeError, match="list of numbers"):
        gmr.evaluate(missing, switch_every="5")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="unknown preset"):
        gmr.evaluate(missing, preset="mig2023")
    with pytest.raises(ValueError, match="at least one speed"):
        gmr.evaluate(missing, speeds=[])
    with pytest.raises(ValueError, match="there cannot be -1 threads"):
        gmr.evaluate(missing, threads=-1)
    with pytest.raises(gmr.FormatError, match="no such folder"):
        gmr.evaluate(missing)


def test_what_a_progress_callback_raises_ends_the_evaluation(folder: Path) -> None:
    phases: list[str] = []

    def stop(phase: str, done: int, of: int) -> None:
        phases.append(phase)
        if phase == "simulating":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gmr.evaluate(folder, progress=stop, **GRID)  # type: ignore[arg-type]
    assert list(dict.fromkeys(phases)) == ["reading", "preparing", "simulating"]


def test_odd_files_are_noted(folder: Path, tmp_path: Path) -> None:
    text = (folder / "slow" / "straight.bvh").read_text()
    (tmp_path / "odd.bvh").write_text(text + text.splitlines()[-1] + "\n")
    found = gmr.evaluate(tmp_path, **GRID)  # type: ignore[arg-type]
    assert any("odd.bvh" in note for note in found.notes)


def test_tables_are_arrow_where_pyarrow_is_installed(
    found: Evaluation, monkeypatch: pytest.MonkeyPatch
) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    assert isinstance(found.trials, pyarrow.Table)
    assert found.trials.column_names == list(found.measured.trials.column_names)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    for name in ("trials", "coverage", "usage", "transitions", "clips"):
        assert isinstance(getattr(found, name), Table)


def test_tables_are_written_whole_or_not_at_all(
    found: Evaluation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = found.write_tables(tmp_path / "tables", ("csv", "json"))
    assert sorted(path.name for path in (tmp_path / "tables").iterdir()) == sorted(
        path.name for path in written
    )

    def full_disk(table: Table, file: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setitem(gmr.table.FORMATS, "csv", full_disk)
    with pytest.raises(OSError, match="No space left"):
        found.write_tables(tmp_path / "full", ("json", "csv"))
    assert not (tmp_path / "full").exists()
    with pytest.raises(ValueError, match="unknown table format 'xls'"):
        found.write_tables(tmp_path / "full", ("xls",))


def test_a_simulated_trial_agrees_with_loops_that_read_like_the_formulas(
    folder: Path, found: Evaluation
) -> None:
    database = Database.build(gmr.read_folder(folder))
    log = run_trials(database, [Profile.constant(2.0, math.radians(-50.0))])
    x, z, heading, row = (getattr(log, name)[0].tolist() for name in ("x", "z", "heading", "row"))
    steps = range(5 * 60, 35 * 60)
    speeds = [math.hypot(x[i + 1] - x[i], z[i + 1] - z[i]) * 60 for i in steps]
    turns = [math.degrees(heading[i + 1] - heading[i]) * 60 for i in steps]
    offsets = [math.hypot(x[i] - log.ref_x[0, i], z[i] - log.ref_z[0, i]) for i in range(5 * 60, 35 * 60 + 1)]
    jumps = [(row[i - 1], row[i]) for i in steps if row[i] != row[i - 1] + 1]
    wanted = {
        "speed_error": statistics.fmean(speeds) - 2.0,
        "turn_rate_error_deg": statistics.fmean(turns) + 50.0,
        "speed_deviation": statistics.pstdev(speeds),
        "turn_rate_deviation_deg": statistics.pstdev(turns),
        "offset_mean": statistics.fmean(offsets),
        "offset_rms": math.sqrt(statistics.fmean(e * e for e in offsets)),
        "offset_max": max(offsets),
        "offset_final": offsets[-1],
        "offset_sum": sum(offsets),
        "transitions_per_second": len(jumps) / 30,
    }
    assert len(jumps) > 10
    for name, value in wanted.items():
        assert trial(found, name, 2.0, -50.0) == pytest.approx(value, rel=1e-9), name
