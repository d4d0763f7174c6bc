"""A corpus is written: the same bytes by whomever, and on from wherever it was left."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gmr
from clusters import HERE, cluster
from corpora import asked, tree, write
from gmr import GmrError

PROGRAM = """
import sys
from corpora import asked, write
if __name__ == "__main__":
    folder, variations, workers = sys.argv[1:]
    write(folder, asked(int(variations)), workers=int(workers))
"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A corpus of 18 takes."""
    folder = tmp_path_factory.mktemp("whole") / "corpus"
    done = write(folder)
    assert (done.made, done.there, done.failed) == (18, 0, {})
    return folder


def program(folder: Path, variations: int = 9, workers: int = 1, **options: Any) -> subprocess.Popen[str]:
    """The same as a process of its own."""
    paths = os.pathsep.join(filter(None, [str(HERE), os.environ.get("PYTHONPATH", "")]))
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(folder), str(variations), str(workers)],
        env=os.environ | {"PYTHONPATH": paths}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options,
    )  # fmt: skip


def test_a_corpus_is_its_plan_its_motions_its_labels_and_a_manifest(whole: Path) -> None:
    files = tree(whole)
    motions = [name for name in files if name.endswith(".gmrb")]
    assert set(files) == {"corpus.json", "takes.jsonl", "manifest.parquet", *motions}
    assert len(motions) == 18
    assert list(gmr.read_folder(whole)) == motions
    labels = [json.loads(line) for line in files["takes.jsonl"].splitlines()]
    assert [label["file"] for label in labels] == sorted(motions, key=lambda name: (name[0] != "s", name))


def test_two_workers_make_the_same_bytes(whole: Path, tmp_path: Path) -> None:
    write(tmp_path / "corpus", workers=2)
    assert tree(tmp_path / "corpus") == tree(whole)


def test_a_cluster_whose_worker_is_killed_makes_the_same_bytes(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    write(tmp_path / "alone", asked(15))
    with cluster(tmp_path) as held:

        def kill(done: int, of: int, seconds: float) -> None:
            if done > of // 4:
                held.workers[0].kill()

        written = write(tmp_path / "corpus", asked(15), workers=None, cluster=held.address, progress=kill)
        assert held.workers[0].wait(5) == -signal.SIGKILL
        assert held.workers[1].poll() is None
    assert written.made + len(written.failed) == 30
    assert tree(tmp_path / "corpus") == tree(tmp_path / "alone")


def test_workers_that_see_another_folder_send_their_files(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gmr.actionlets.corpus.making.is_held", lambda folder, word: False)
    write(tmp_path / "corpus")
    assert tree(tmp_path / "corpus") == tree(whole)


def test_nothing_is_made_again_where_all_is_there(whole: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in whole.rglob("*") if path.is_file()}
    done = write(whole)
    assert (done.made, done.there) == (0, 18)
    assert {path: path.stat().st_mtime_ns for path in whole.rglob("*") if path.is_file()} == before


def test_takes_that_cannot_be_made_are_named_and_the_others_made(tmp_path: Path) -> None:
    plan = asked(4, parameters={"nod.tempo": "0.5,2"}, settings={"seconds": "0.8", "variation": "0"})
    for there, made in ((0, 6), (6, 0)):
        done = write(tmp_path / "corpus", plan)
        assert (done.there, done.made) == (there, made)
        assert done.failed == dict.fromkeys(
            ("nod/000/nod_000000.gmrb", "nod/000/nod_000002.gmrb"),
            "'nod' takes 1 s with these parameters; give that many seconds or more (it rests afterwards), "
            "or none",
        )
    assert len(gmr.actionlets.corpus.Corpus(tmp_path / "corpus")) == 6


Damage = st.lists(
    st.tuples(
        st.sampled_from(["cut", "remove", "garble", "leave"]),
        st.integers(0, 10**6),
        st.floats(0, 1, exclude_max=True),
    ),
    max_size=5,
)


@settings(max_examples=25)
@given(Damage)
def test_whatever_was_lost_is_made_again_to_the_byte(
    whole: Path, damage: list[tuple[str, int, float]]
) -> None:
    folder = whole.parent / "damaged"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(whole, folder)
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != "corpus.json")
    for kind, which, share in damage:
        path = files[which % len(files)]
        data = path.read_bytes() if path.exists() else b""
        at = int(share * len(data))
        if kind == "cut":
            path.write_bytes(data[:at])
        elif kind == "remove":
            path.unlink(missing_ok=True)
        elif kind == "garble" and path.name != "takes.jsonl" and path.suffix != ".gmrb":
            path.write_bytes(data[:at] + b"\0\xff\n" + data[at + 3 :])
        elif kind == "leave":
            path.with_name(f".{path.name}.{which % 16**8:08x}").write_bytes(data[:at])
    write(folder)
    assert tree(folder) == tree(whole)


def test_a_line_of_the_labels_that_is_no_line_is_made_again(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path / "corpus")
    lines = (whole / "takes.jsonl").read_bytes().splitlines(keepends=True)
    lines[3], lines[5], lines[7] = b"{nonsense}\n", b"[]\n", b'{"take":7}\n'
    lines.insert(9, lines[2].replace(b'"bytes":', b'"bytes":1'))
    (tmp_path / "corpus" / "takes.jsonl").write_bytes(b"".join(lines))
    assert write(tmp_path / "corpus").made == 3
    assert tree(tmp_path / "corpus") == tree(whole)


def kill_when(folder: Path, motions: int, **how: Any) -> None:
    """Begins to write, and is killed as soon as there are so many motions."""
    with program(folder, 15, **how) as running:
        while len(list(folder.rglob("*.gmrb"))) < motions:
            assert running.poll() is None
            time.sleep(0.002)
        running.kill()


@pytest.mark.parametrize("workers", [1, 2])
def test_a_run_that_is_killed_at_any_moment_is_gone_on_with(tmp_path: Path, workers: int) -> None:
    write(tmp_path / "whole", asked(15))
    folder = tmp_path / "corpus"
    for motions in (1, 12) if workers == 1 else (13,):
        kill_when(folder, motions, workers=workers)
        assert (folder / ".lock").exists()
        assert not (folder / "manifest.parquet").exists()
    done = write(folder, asked(15))
    assert done.there >= 6
    assert tree(folder) == tree(tmp_path / "whole")


def test_two_runs_at_once_into_one_folder_are_told_so(tmp_path: Path) -> None:
    folder = tmp_path / "corpus"
    heard: list[str] = []

    def another(done: int, of: int, seconds: float) -> None:
        if not heard:
            with program(folder) as second:
                heard.append(second.communicate()[1])

    write(folder, progress=another)
    assert f"{folder}: process {os.getpid()} on " in heard[0]
    assert "is writing into this folder; wait for it" in heard[0]
    assert not list(folder.glob(".*"))


def test_another_command_is_refused_with_what_differs(whole: Path) -> None:
    before = tree(whole)
    with pytest.raises(GmrError) as refused:
        write(whole, asked(10, settings={"height": "1.5..1.8"}, fps=60))
    said = str(refused.value)
    assert "another corpus is in this folder" in said
    for part in (
        "variations: 9 there, 10 asked for",
        "height: 1.5..1.9 there, 1.5..1.8 asked for",
        "fps: 120.0",
    ):
        assert part in said
    assert tree(whole) == before


def test_a_folder_with_other_things_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(GmrError, match=r"no corpus in this folder, but 'thesis\.txt'"):
        write(tmp_path)
    for other in (b'{"name": "thesis"}', b'{"takes": ', b"\xff\xfe", b"[" * 100_000, b""):
        (tmp_path / "corpus.json").write_bytes(other)
        with pytest.raises(GmrError, match=r"corpus\.json: this is no plan of a corpus"):
            write(tmp_path)
        assert len(tree(tmp_path)) == 2


def test_a_place_that_is_no_folder_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "file", tmp_path / "file" / "corpus"):
        with pytest.raises(GmrError, match=f"^{tmp_path}/file"):
            write(place)


def test_a_file_that_cannot_be_written_stops_the_work(whole: Path, tmp_path: Path) -> None:
    folder = tmp_path / "corpus"
    limit = (60_000, 60_000)  # lets the shorter takes through
    with program(folder, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit)) as running:
        said = running.communicate()[1]
    assert f"GmrError: {folder}/sway/000/sway_000002.gmrb: cannot be written: File too large" in said
    assert f". 2 of 18 takes are in '{folder}'; the same command goes on from there" in said
    assert write(folder).there == 2
    assert tree(folder) == tree(whole)


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of its own with 400 kB, where this user may mount one."""
    place = tmp_path / "disk"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", str(place)]
    if shutil.which("mount") is None or subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("this user may not mount a file system")
    yield place
    subprocess.run(["umount", str(place)], check=True)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_disk_that_fills_up_stops_the_work_where_it_can_go_on(
    whole: Path, small_disk: Path, tmp_path: Path, workers: int
) -> None:
    folder = small_disk / "corpus"
    with pytest.raises(GmrError) as stopped:
        write(folder, workers=workers)
    said = str(stopped.value)
    assert "No space left on device" in said
    assert f"of 18 takes are in '{folder}'; the same command goes on from there" in said
    there = len([line for line in (folder / "takes.jsonl").read_bytes().splitlines() if json.loads(line)])
    assert there > 0
    assert f" {there} of 18" in said
    subprocess.run(["mount", "-o", "remount,size=20m", str(small_disk)], check=True)
    assert write(folder).there == there
    assert tree(folder) == tree(whole)


def test_without_pyarrow_the_extra_is_named_before_any_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(GmrError, match=r"gmr-motion\[corpus\]"):
        write(tmp_path / "corpus")
    assert not (tmp_path / "corpus").exists()


def test_a_worker_with_other_versions_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = asked()
    monkeypatch.setattr("gmr.actionlets.corpus.making.versions", lambda: {"gmr": "0.0.9", "numpy": "1.26.0"})
    with pytest.raises(GmrError, match=r"has gmr 0\.0\.9, numpy 1\.26\.0, but gmr .* is needed"):
        write(tmp_path / "corpus", plan)
