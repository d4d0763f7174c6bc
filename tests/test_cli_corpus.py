"""``gmr synthesize ... --variations`` as people and scripts use it."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import pytest

import gmr
from corpora import tree
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.cli.takes_line import TakesLine, duration
from simple_actions import FILE

DOCS = Path(__file__).parent.parent / "docs" / "corpora.md"
SIMPLE = ("--library", str(FILE), "--fps", "60", "--seconds", "1.2")

Captured = pytest.CaptureFixture[str]


def run(*arguments: object) -> int:
    """The exit code of ``gmr synthesize ARGUMENTS``, in this process."""
    return finished(command, ["synthesize", *map(str, arguments)])


def test_a_corpus_is_made_told_of_and_found_made(tmp_path: Path, capsys: Captured) -> None:
    out = tmp_path / "corpus"
    asked = ("sway,nod", *SIMPLE, "--variations", 3, "--out", out, "--workers", 1)
    assert run(*asked) == 0
    assert re.fullmatch(
        rf"{out}: 6 takes, 8 s of motion, made in \d+ s: \S+ takes/s, \S+x real time\.\n",
        capsys.readouterr().out,
    )
    assert run(*asked, "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["corpus"], told["there"], told["made"], told["failed"]) == (str(out), 6, 0, {})
    corpus = gmr.actionlets.Corpus(out)
    assert len(corpus) == 6
    plan = json.loads((out / "corpus.json").read_text())
    assert FILE.name in plan["library"]
    assert (plan["seconds"], plan["variation"], plan["fps"]) == ("1.2", "0..1", 60.0)


def test_the_same_seed_gives_the_same_bytes_on_processes_and_on_a_local_cluster(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    asked = ("nod", *SIMPLE, "--variations", 10, "--seed", 3, "--height", "1.5..1.9", "-q")
    ways = {"alone": ["--workers", 1], "cluster": ["--cluster", "local", "--workers", 2]}
    for name, how in ways.items():
        assert run(*asked, *how, "--out", tmp_path / name) == 0
    assert tree(tmp_path / "alone") == tree(tmp_path / "cluster")
    assert run("nod", *SIMPLE, "--variations", 10, "--seed", 4, "-q", "--out", tmp_path / "other") == 0
    assert tree(tmp_path / "alone") != tree(tmp_path / "other")


def test_choices_are_written_as_values_ranges_and_lists(tmp_path: Path) -> None:
    out = tmp_path / "corpus"
    chosen = ("--set", "depth=5..6", "--set", "sway.tempo=1,2", "--sex", "male,female", "--variation", "0")
    assert run("sway,nod", *SIMPLE, "--variations", 4, "--out", out, "--workers", 1, "-q", *chosen) == 0
    takes = list(gmr.actionlets.Corpus(out))
    assert all(5 <= take.parameters["depth"] <= 6 and take.labels["variation"] == 0 for take in takes)
    sways = [(take.labels["sex"], take.parameters["tempo"]) for take in takes if take.action == "sway"]
    assert sorted(sways) == [("female", 1.0), ("female", 2.0), ("male", 1.0), ("male", 2.0)]


def test_takes_that_cannot_be_made_are_named_and_the_code_is_1(tmp_path: Path, capsys: Captured) -> None:
    short = ("nod", "--library", FILE, "--seconds", "0.6", "--set", "tempo=0.5,2", "--variation", "0")
    assert run(*short, "--variations", 4, "--out", tmp_path / "corpus", "--workers", 1) == 1
    said = capsys.readouterr()
    assert "2 takes" in said.out
    assert "nod_000000.gmrb, nod/000/nod_000002.gmrb could not be made: 'nod' takes 1 s" in said.err


@pytest.mark.parametrize(
    ("asked", "says", "code"),
    [
        (("swya", "--variations", 2), "no action is called 'swya'. Did you mean sway", 1),
        (("sway,swya", "--variations", 2), "no action is called 'swya'", 1),
        (("sway", "--variations", 2, "--set", "depth=99"), "it goes from 2 to 10 deg", 1),
        (("sway", "--variations", 2, "--set", "dpeth=3"), "Did you mean depth?", 1),
        (("sway", "--variations", 2, "--seconds", "0"), "give more than 0 seconds", 1),
        (("sway", "--variations", 2, "--height", "1.5..20"), "20", 1),
        (("sway", "--variations", 2, "--height", "1.7", "--percentile", "50"), "percentile", 1),
        (("sway", "--variations", 2, "--speed", "1"), "no parameter 'speed'", 1),
        (("sway", "--variations", 0), "--variations", 2),
        (("sway", "--variations", 2, "--set", "depth"), "write NAME=VALUES", 2),
        (("sway", "--variations", 2, "--set", "depth=3", "--set", "depth=4"), "set twice", 2),
        (("sway", "--variations", 2, "--format", "amc"), "amc", 2),
        (("sway", "--variations", 2, "--cluster", "tcp://far:1", "--workers", 2), "workers of its own", 2),
        (("sway", "--seconds", "1..2"), "1..2", 2),
        (("sway", "--sex", "male,female"), "male,female", 2),
    ],
)
def test_what_cannot_be_meant_is_one_sentence(
    asked: tuple[object, ...], says: str, code: int, tmp_path: Path, capsys: Captured
) -> None:
    assert run(*asked, "--library", FILE, "--out", tmp_path / "corpus") == code
    assert says in " ".join(capsys.readouterr().err.split())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("out", [(), ("--out", "-")])
def test_a_corpus_needs_a_folder(out: tuple[str, ...], capsys: Captured) -> None:
    assert run("walk", "--variations", 2, *out) == 2
    assert "--out FOLDER" in capsys.readouterr().err


@pytest.mark.parametrize("how", [("--workers", "2"), ("--cluster", "local", "--workers", "2")])
def test_an_interrupt_is_two_sentences_and_the_same_command_goes_on(
    tmp_path: Path, how: tuple[str, str]
) -> None:
    if "--cluster" in how:
        pytest.importorskip("distributed")
    out = tmp_path / "corpus"
    asked = ["nod", *SIMPLE, "--variations", "2000", "--out", str(out)]
    with subprocess.Popen(
        [sys.executable, "-m", "gmr", "synthesize", *asked, *how], stderr=subprocess.PIPE, text=True,
        process_group=0,
    ) as running:  # fmt: skip
        while not (out / "takes.jsonl").exists() or not (out / "takes.jsonl").stat().st_size:
            assert running.poll() is None
            time.sleep(0.01)
        os.killpg(running.pid, signal.SIGINT)
        said = running.communicate()[1]
    assert running.returncode == 130
    assert said.split("\n") == [
        f"gmr: what was made is in '{out}'; the same command goes on from there",
        "",
        "gmr: interrupted; no file was left half-written",
        "",
    ]
    assert not list(out.rglob(".*"))


def test_the_line_tells_takes_speed_and_what_is_left(
    capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter([0.0, 100.0, 110.0])
    monkeypatch.setattr("gmr.cli.takes_line.time.perf_counter", lambda: next(clock))
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with TakesLine("walk") as line:
        line.tell(1000, 3000, 0.0)
        line.tell(2000, 3000, 4000.0)
    told = capsys.readouterr().err
    assert told.endswith("walk: 2,000 of 3,000 takes, 100 takes/s, 400x real time, 10 s left\n")


def test_times_are_told_as_people_say_them() -> None:
    assert [duration(s) for s in (0, 0.2, 59, 60, 185, 3600, 9660)] == [
        "0 s", "1 s", "59 s", "1 min 00 s", "3 min 05 s", "1 h 00 min", "2 h 41 min"
    ]  # fmt: skip


def test_a_corpus_is_a_folder_that_evaluation_reads(tmp_path: Path, capsys: Captured) -> None:
    out = tmp_path / "corpus"
    paces = ("--set", "speed=1,1.6", "--set", "turn_rate=0", "--seconds", "4", "--fps", "60")
    assert run("walk", "--variations", 2, *paces, "--out", out, "--workers", 1, "-q") == 0
    found = gmr.evaluate(out, speeds=[1.0], turn_rates_deg=[0.0])
    assert found.failed == {}
    clips = set(found.measured.clips["clip"].tolist())
    assert clips == {"walk/000/walk_000000.gmrb", "walk/000/walk_000001.gmrb"}


LOADER = '''
class DataLoader:
    """What PyTorch's does, in arrays: batches of what the indices give, by workers that get the set sent."""

    def __init__(self, dataset, batch_size, shuffle, num_workers):
        self.dataset, self.size, self.workers = dataset, batch_size, num_workers

    def __iter__(self):
        import pickle, random
        import numpy as np
        sets = [pickle.loads(pickle.dumps(self.dataset)) for _ in range(self.workers)]
        order = random.Random(0).sample(range(len(self.dataset)), len(self.dataset))
        for k in range(0, len(order), self.size):
            items = [sets[k % self.workers][index] for index in order[k : k + self.size]]
            yield {key: np.stack([item[key] for item in items]) for key in items[0]}
'''


def test_the_loop_of_the_documentation_runs(tmp_path: Path) -> None:
    page = DOCS.read_text(encoding="utf-8")
    (loop,) = re.findall(r"^```py\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    (command_line, *_) = re.findall(r"^\$ gmr (synthesize .*)$", page, re.MULTILINE)
    words = shlex.split(command_line)
    words[words.index("--out") + 1] = str(tmp_path / "corpus")
    assert finished(command, [*words, "-q"]) == 0
    if find_spec("torch") is None:
        (tmp_path / "torch" / "utils").mkdir(parents=True)
        for place in ("", "utils"):
            (tmp_path / "torch" / place / "__init__.py").touch()
        (tmp_path / "torch" / "utils" / "data.py").write_text(LOADER)
    indented = re.sub("^", "    ", loop, flags=re.MULTILINE)
    program = f"if __name__ == '__main__':\n{indented}    print(rotations.shape)\n"
    (tmp_path / "loop.py").write_text(program)
    done = subprocess.run(
        [sys.executable, "loop.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert re.search(r"\d+, 60, 15, 4", done.stdout)
