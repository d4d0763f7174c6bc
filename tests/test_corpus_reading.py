"""A corpus is read: takes with labels, and windows as training wants them."""

from __future__ import annotations

import mmap
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
from gmr import FormatError, GmrError
from gmr.actionlets.corpus import Corpus, Windows, planned, write_corpus
from simple_actions import simple


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("read") / "corpus"
    plan = planned(
        simple(), ["sway", "nod"], 4, fps=60,
        settings={"seconds": "1.0,1.5", "height": "1.5..1.9", "sex": "female"},
        parameters={"nod.depth": "7"},
    )  # fmt: skip
    write_corpus(plan, simple(), place, workers=1)
    return place


@pytest.fixture(scope="module")
def corpus(folder: Path) -> Corpus:
    return Corpus(folder)


def test_a_take_has_the_labels_that_it_was_made_with(corpus: Corpus, folder: Path) -> None:
    assert len(corpus) == 8
    assert corpus.actions == ("sway", "nod")
    take = corpus[5]
    assert take.path == folder / "nod" / "000" / "nod_000001.gmrb"
    assert (take.action, take.parameters["depth"], take.labels["sex"]) == ("nod", 7.0, "female")
    assert 0.5 <= take.parameters["tempo"] <= 2
    assert take.phases == (("down", 0.0, take.phases[0][2]), ("up", take.phases[0][2], 1.5))
    assert take.motion.frame_count == take.labels["frames"] == 91
    assert take.contacts["left"].tolist() == [[0.0, 91 / 60]]
    assert len(corpus[1].contacts["left"]) > 1
    assert take.motion == gmr.read(take.path)


def test_a_take_is_made_again_from_its_labels_alone(corpus: Corpus) -> None:
    take = corpus[2]
    body = gmr.actionlets.Body.of(height=take.labels["height"], sex=take.labels["sex"])
    again = simple()[take.action].take(
        seconds=take.labels["seconds"], fps=take.labels["fps"], seed=take.labels["seed"], body=body,
        variation=take.labels["variation"], **take.parameters,
    )  # fmt: skip
    assert again.motion == take.motion


def test_motions_are_mapped_not_read(corpus: Corpus) -> None:
    owner: Any = corpus[0].motion.rotations
    while isinstance(owner, np.ndarray) and owner.base is not None:
        owner = owner.base
    assert isinstance(owner.obj if isinstance(owner, memoryview) else owner, mmap.mmap)


def test_takes_are_chosen_by_index_slice_and_mask(corpus: Corpus) -> None:
    files = [take.labels["file"] for take in corpus]
    assert [corpus[k].labels["file"] for k in range(-8, 0)] == files
    assert [take.labels["file"] for take in corpus[1:7:2]] == files[1:7:2]
    nods = corpus.where(np.array(corpus.table["action"]) == "nod")
    assert [take.labels["file"] for take in nods] == files[4:]
    assert [take.labels["file"] for take in corpus.where([3, 0])] == [files[3], files[0]]
    assert [take.labels["file"] for take in corpus.where([-1])] == files[-1:]
    assert len(corpus.where([])) == len(corpus.where([]).windows(10)) == 0
    with pytest.raises(IndexError):
        corpus[8]
    for wrong in ([True], np.ones(9, bool), [8], [-9], [0.5, 1.0], np.ones((2, 2), int), 3, ["nod"]):
        with pytest.raises(GmrError, match=r"takes cannot be chosen by .* give 8 booleans, or whole numbers"):
            corpus.where(wrong)


@pytest.mark.parametrize(
    ("frames", "step"), [(1, None), (20, None), (20, 7), (30, 1), (45, 10), (60, 60), (91, 1)]
)
def test_windows_are_all_that_fit_and_nothing_else(corpus: Corpus, frames: int, step: int | None) -> None:
    windows = corpus.windows(frames, step)
    expected = [
        (take, start)
        for take, held in enumerate(corpus)
        for start in range(0, held.motion.frame_count - frames + 1, step or frames)
    ]
    assert len(windows) == len(expected)
    found = list(windows)
    assert [(window["take"], window["frame"]) for window in found] == expected
    for window in found:
        take = corpus[window["take"]]
        part = slice(window["frame"], window["frame"] + frames)
        assert np.array_equal(window["rotations"], take.motion.rotations[part].astype(np.float32))
        assert np.array_equal(window["translations"], take.motion.translations[part].astype(np.float32))
        times = np.arange(part.start, part.stop) / 60
        for column, side in enumerate(("left", "right")):
            inside = [any(a <= time < b for a, b in take.contacts[side]) for time in times]
            assert window["contacts"][:, column].tolist() == inside
        assert corpus.actions[window["action"]] == take.action


def test_windows_of_chosen_takes_have_their_contacts(corpus: Corpus) -> None:
    chosen = corpus.where([6, 1])
    (first, *_) = chosen.windows(30)
    whole = next(window for window in corpus.windows(30) if window["take"] == 6)
    assert np.array_equal(first["contacts"], whole["contacts"])
    assert np.array_equal(first["rotations"], whole["rotations"])


def test_windows_of_nothing_are_none(corpus: Corpus) -> None:
    assert len(corpus.windows(92)) == 0
    assert len(corpus.where([]).windows(10)) == 0
    with pytest.raises(IndexError):
        corpus.windows(92)[0]
    for frames, step in ((0, None), (10, 0)):
        with pytest.raises(GmrError, match="at least 1"):
            corpus.windows(frames, step)


def test_what_a_window_holds_may_be_changed(corpus: Corpus) -> None:
    window = corpus.windows(20)[0]
    for key in ("rotations", "translations", "contacts"):
        window[key][:] = 0
    assert corpus.windows(20)[0]["rotations"].any()


def total(windows: Windows, indices: list[int]) -> float:
    """What a worker of a loader does."""
    return float(sum(np.abs(windows[index]["rotations"]).sum() for index in indices))


def test_workers_of_a_loader_see_the_same_windows(corpus: Corpus) -> None:
    windows = corpus.windows(20, 5)
    windows[3]
    assert len(pickle.dumps(windows)) < 20_000  # nothing that is open goes with it
    halves = [list(range(0, len(windows), 2)), list(range(1, len(windows), 2))]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        assert list(pool.map(total, [windows] * 2, halves)) == [total(windows, half) for half in halves]


def test_torch_loads_windows_where_it_is_installed(corpus: Corpus) -> None:
    data = pytest.importorskip("torch.utils.data")
    windows = corpus.windows(20)
    loader = data.DataLoader(windows, batch_size=4, num_workers=2)
    batches = list(loader)
    assert sum(len(batch["rotations"]) for batch in batches) == len(windows)
    assert tuple(batches[0]["rotations"].shape) == (4, 20, *windows[0]["rotations"].shape[1:])


def test_a_corpus_that_is_none_is_said(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="no such folder"):
        Corpus(tmp_path / "nowhere")
    with pytest.raises(FormatError, match="no manifest, the corpus is not finished; give the command"):
        Corpus(tmp_path)
    whole = (folder / "manifest.parquet").read_bytes()
    for cut in (0, 3, len(whole) // 2, len(whole) - 1):
        (tmp_path / "manifest.parquet").write_bytes(whole[:cut])
        with pytest.raises(FormatError, match="the manifest is damaged"):
            Corpus(tmp_path)
    parquet = pytest.importorskip("pyarrow.parquet")
    arrow = pytest.importorskip("pyarrow")
    parquet.write_table(arrow.table({"a": [1]}), tmp_path / "manifest.parquet")
    with pytest.raises(FormatError, match="no column 'file'"):
        Corpus(tmp_path)


@pytest.mark.parametrize("format", ["bvh", "gmr", "glb"])
def test_a_corpus_is_written_in_other_formats(corpus: Corpus, tmp_path: Path, format: str) -> None:
    plan = planned(
        simple(), ["sway"], 2, fps=60, format=format,
        settings={"seconds": "1.0,1.5", "height": "1.5..1.9", "sex": "female"},
    )  # fmt: skip
    write_corpus(plan, simple(), tmp_path, workers=1)
    for take, other in zip(Corpus(tmp_path), corpus, strict=False):
        names = other.motion.skeleton.names
        columns = [take.motion.skeleton.names.index(name) for name in names]
        assert take.path.suffix == f".{format}"
        apart = take.motion.positions()[:, columns] - other.motion.positions()
        assert np.abs(apart).max() < 1e-5
