"""`make demo` does what it says, and leaves a file that holds the drawing and its cages and nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import bpy
import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
PNG = b"\x89PNG\r\n\x1a\n"


def run(*command: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *map(str, command)], cwd=ROOT, capture_output=True, text=True, timeout=150, check=False
    )


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder that the demo wrote, and what it said."""
    folder = tmp_path_factory.mktemp("demo")
    done = run("examples/demo.py", folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder, done.stdout


def test_it_certifies_both_levels(demo: tuple[Path, str]) -> None:
    _, said = demo
    assert said.count("Certified as stored: simple, all loops kept, strictly encloses level") == 2
    assert "no cage touches what it encloses" in said
    assert "bit by bit" in said


def test_the_picture_is_drawn(demo: tuple[Path, str]) -> None:
    content = (demo[0] / "letter_a.png").read_bytes()
    assert content.startswith(PNG)
    image = bpy.data.images.load(str(demo[0] / "letter_a.png"))
    width, height = image.size
    assert width >= 1200
    pixels = image.pixels[:]
    dark = sum(1 for red in pixels[0::4] if red < 0.5)
    assert 0.02 < dark / (width * height) < 0.5, "neither a blank picture nor a black one"


def test_the_file_holds_drawing_and_cages_alone(demo: tuple[Path, str]) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(demo[0] / "letter_a.blend"))
    assert len(bpy.data.scenes) == 1
    assert [item.type for item in bpy.data.objects].count("MESH") == 4  # the fine mesh, the cages and the moving copy
    assert [item.type for item in bpy.data.objects].count("CURVE") == 1
    assert len(bpy.data.objects) == 5
    assert not bpy.data.cameras


def test_every_level_shows_how_it_came_about(addon: ModuleType, demo: tuple[Path, str]) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(demo[0] / "letter_a.blend"))
    (found,) = addon.record.CageSet.everywhere()
    assert len(found) == 2
    for certificate in found.certificates:
        assert certificate.start == "flow"
        assert list(certificate.frames) == sorted(set(certificate.frames))


def test_the_check_runs_on_the_file(demo: tuple[Path, str]) -> None:
    done = run("examples/check_animation.py", demo[0] / "letter_a.blend")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 problems" in done.stdout


def test_the_check_fails_on_a_file_without_cages(tmp_path: Path) -> None:
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "empty.blend"))
    done = run("examples/check_animation.py", tmp_path / "empty.blend")
    assert done.returncode == 1
    assert "no cages" in done.stderr


def test_the_check_names_what_it_needs() -> None:
    done = run("examples/check_animation.py")
    assert done.returncode == 2
    assert "FILE.blend" in done.stderr
