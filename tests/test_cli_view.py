"""``gmr view``: pages from the command line, and what it says where it cannot show anything."""

from __future__ import annotations

import socket
import sys
from pathlib import Path

import pytest

import gmr
from gmr.cli import main
from gmr.demo import demo_folder

DATA = Path(__file__).parent / "data"
WALK = str(demo_folder() / "07_01.bvh")
FIGURE = str(DATA / "rigged_simple.gltf")


def run(*args: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["view", *args])
    return int(ended.value.code or 0)


def test_several_files_become_one_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "new" / "both.html"
    assert run(WALK, FIGURE, "--save", str(page), "--fps", "10") == 0
    said = capsys.readouterr()
    assert said.out.startswith(f"{page}: 2.")
    assert "10 frames a second" in said.out
    assert "07_01.bvh: its unit is not said; taken for cmu" in said.err
    text = page.read_text(encoding="utf-8")
    assert "<title>07_01.bvh, rigged_simple.gltf</title>" in text


def test_a_lower_rate_makes_a_smaller_page(tmp_path: Path) -> None:
    sizes = []
    for fps in ("24", "6"):
        page = tmp_path / f"{fps}.html"
        assert run(FIGURE, "--blending", "dqbs", "--save", str(page), "--fps", fps) == 0
        sizes.append(page.stat().st_size)
    assert sizes[1] < sizes[0]


def test_a_name_is_no_markup(tmp_path: Path) -> None:
    motion = gmr.read(WALK)[:5].with_name("<script>alert(1)</script>")
    gmr.view.save(gmr.view.motion_figure(motion, name=motion.name), tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "<title>&lt;script&gt;alert(1)&lt;/script&gt;</title>" in text
    assert "<script>alert" not in text


def test_a_motion_wears_the_character_that_it_is_of(tmp_path: Path) -> None:
    assert run(FIGURE, "--character", FIGURE, "--save", str(tmp_path / "page.html")) == 0
    gmr.write(gmr.read(FIGURE), tmp_path / "again.gmr")
    page = tmp_path / "worn.html"
    assert run(str(tmp_path / "again.gmr"), "--character", FIGURE, "--save", str(page)) == 0


def test_a_file_that_fails_is_named_and_the_rest_is_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "empty.bvh").write_text("")
    page = tmp_path / "page.html"
    assert run(str(tmp_path / "empty.bvh"), FIGURE, "--save", str(page)) == 1
    assert "empty.bvh" in capsys.readouterr().err
    assert page.exists()
    assert run(str(tmp_path / "empty.bvh"), "--save", str(tmp_path / "none.html")) == 1
    assert not (tmp_path / "none.html").exists()


def test_a_taken_port_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        assert run(FIGURE, "--port", str(port)) == 1
    assert f"port {port} is taken" in capsys.readouterr().err


def test_the_missing_extra_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    assert run(FIGURE, "--save", str(tmp_path / "page.html")) == 1
    assert "pip install 'gmr-motion[view]'" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_weights_of_no_joint_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = str(tmp_path / "page.html")
    assert run(FIGURE, "--weights", "Nose", "--save", page) == 1
    assert "has no joint 'Nose'; it has 'Bone'" in capsys.readouterr().err
    assert run(WALK, "--weights", "Hips", "--save", page) == 1
    assert "nothing here has a skin" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("--fps", "30"), "--fps is for a page"),
        (("--save", "page.html", "--open"), "leave out --port and --open"),
        (("--save", "page.html", "--fps", "0"), "rate above 0"),
        (("--opacity", "0"), "opacity"),
        ((), ""),
    ],
)
def test_wrong_use_is_refused(args: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    files = (FIGURE,) if args else ()
    assert run(*files, *args) == 2
    assert said in capsys.readouterr().err


def test_a_place_that_cannot_be_written_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    assert run(FIGURE, "--save", str(tmp_path / "file" / "page.html")) == 1
    assert "page.html" in capsys.readouterr().err
