"""Every example of the documentation runs as it is printed."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import figures
import gmr
from c3d_files import as_written_by, recorded
from gmr.demo import demo_folder
from marker_scene import noisy, worn

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```(python|console|toml)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def blocks(page: Path, language: str) -> list[str]:
    return [text for found, text in BLOCK.findall(page.read_text(encoding="utf-8")) if found == language]


def pages_with(language: str) -> list[Path]:
    return [page for page in PAGES if blocks(page, language)]


@pytest.fixture
def reader_folder(tmp_path: Path) -> Path:
    """What the documentation assumes: two walks as walk.bvh and walk.c3d, the latter as mips.c3d too,
    figure.gltf, man.glb, 07_01.amc, 07.asf, mine.toml with the action of docs/actions.md, clips in takes/."""
    takes = tmp_path / "takes"
    takes.mkdir()
    for clip in ("02_01", "07_01", "07_12", "08_01", "09_01", "09_02"):
        shutil.copy(demo_folder() / f"{clip}.bvh", takes)
    shutil.copy(demo_folder() / "07_01.bvh", tmp_path / "walk.bvh")
    for file in ("07.asf", "07_01.amc"):
        shutil.copy(ROOT / "tests" / "data" / "amc" / file, tmp_path)
    shutil.copy(ROOT / "tests" / "data" / "rigged_simple.gltf", tmp_path / "figure.gltf")
    walk = recorded(tmp_path / "walk.c3d", noisy(worn(), 0.5)).read_bytes()
    (tmp_path / "mips.c3d").write_bytes(as_written_by(walk, "MIPS"))
    gmr.write_character(figures.body(), tmp_path / "man.glb")
    (tmp_path / "mine.toml").write_text(blocks(ROOT / "docs" / "actions.md", "toml")[0], encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize("page", pages_with("python"), ids=lambda page: page.name)
def test_python_examples_run(page: Path, reader_folder: Path) -> None:
    program = "\n".join(blocks(page, "python"))
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=reader_folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_the_recipe_for_files_of_mips_computers_keeps_every_place(reader_folder: Path) -> None:
    (recipe,) = (block for block in blocks(ROOT / "docs" / "markers.md", "python") if "mips.c3d" in block)
    subprocess.run([sys.executable, "-c", f"import gmr\n{recipe}"], cwd=reader_folder, check=True)
    walk, found = (gmr.read_markers(reader_folder / name) for name in ("walk.c3d", "intel.c3d"))
    assert (found.labels, found.fps, found.unit) == (walk.labels, walk.fps, walk.unit)
    np.testing.assert_allclose(found.positions, walk.positions, rtol=0, atol=0.001)


@pytest.mark.parametrize("page", pages_with("console"), ids=lambda page: page.name)
def test_console_examples_run(page: Path, reader_folder: Path) -> None:
    for block in blocks(page, "console"):
        for line in block.splitlines():
            if not line.startswith("$ gmr "):
                continue
            command = [sys.executable, "-m", "gmr", *shlex.split(line.removeprefix("$ gmr "), comments=True)]
            done = subprocess.run(command, cwd=reader_folder, capture_output=True, text=True, check=False)
            assert done.returncode == 0, f"{line}\n{done.stdout}\n{done.stderr}"


EXAMPLES = {
    "actionlet_figures.py": ["figures", "walk.bvh"],
    "fastest_foot.py": ["takes"],
    "compare_with_mirrored.py": ["takes"],
    "drive_a_character.py": ["takes", "poses.npz"],
    "x3d_postures.py": ["takes/09_01.bvh", "postures"],
}


@pytest.mark.parametrize("example", EXAMPLES)
def test_example_programs_run(example: str, reader_folder: Path) -> None:
    program = [sys.executable, str(ROOT / "examples" / example), *EXAMPLES[example]]
    done = subprocess.run(program, cwd=reader_folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()


def test_every_example_program_is_run() -> None:
    assert set(EXAMPLES) == {file.name for file in (ROOT / "examples").glob("*.py")}


def test_there_are_examples() -> None:
    assert ROOT / "README.md" in pages_with("python")
    assert ROOT / "README.md" in pages_with("console")
