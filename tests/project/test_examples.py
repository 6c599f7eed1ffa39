"""Examples, the demo and the README's lines do what they say: `make check`."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nestedcages_core import features_from_geojson, read_svg, verify
from support.sources import ROOT

pytestmark = pytest.mark.check

STORIES = "bend butterfly coast cut_or_held fox_walk logo poisson regions sprite_outline warning_area"
NESTED = {"logo": ("logo_cages.svg", "shape", "cage-1", "cage-2"), "butterfly": ("butterfly.svg", "shape", "cage-1")}
"""The drawing that a story writes, and what lies in each other there."""


def run(*command: str | Path, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "MPLCONFIGDIR": str(folder / "matplotlib")}
    return subprocess.run(
        [sys.executable, *map(str, command)],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        timeout=170,
        check=False,
    )


def assert_is_picture(path: Path) -> None:
    """Neither blank nor black, and large enough to see something."""
    pixels = pytest.importorskip("matplotlib.image").imread(path)[:, :, :3]
    assert min(pixels.shape[:2]) > 200
    assert (pixels.min(axis=2) < 0.9).mean() > 0.02 and (pixels.max(axis=2) < 0.1).mean() < 0.5


@pytest.mark.parametrize("story", STORIES.split())
def test_a_story_runs_and_draws_its_picture(story: str, tmp_path: Path) -> None:
    if story == "fox_walk":
        pytest.importorskip("bpy")
    done = run(f"examples/{story}.py", "--small", "--output", tmp_path, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert_is_picture(tmp_path / f"{story}.png")
    if story == "sprite_outline":
        assert len(features_from_geojson((tmp_path / "fox_outline.geojson").read_bytes())[0].mesh.vertices) == 16
    elif story in NESTED:
        name, *elements = NESTED[story]
        parts = [read_svg(tmp_path / name, element=element) for element in elements]
        assert all(verify(outer, inner) for inner, outer in pairwise(parts))
    elif story in {"coast", "regions"}:
        features = features_from_geojson((tmp_path / f"{story}.geojson").read_bytes())
        assert len(features) > 1 and all(feature.mesh.area > 0.0 for feature in features)


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the demo wrote."""
    pytest.importorskip("bpy")
    folder = tmp_path_factory.mktemp("demo")
    done = run("examples/demo.py", folder, folder=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_the_demo_draws_and_leaves_a_file_with_drawing_and_cages_alone(demo: Path) -> None:
    import bpy

    assert_is_picture(demo / "letter_a.png")
    bpy.ops.wm.open_mainfile(filepath=str(demo / "letter_a.blend"))
    # the fine mesh, the cages, the moving copy of the first, and the drawing
    assert sorted(item.type for item in bpy.data.objects) == ["CURVE", "MESH", "MESH", "MESH", "MESH"]
    assert len(bpy.data.scenes) == 1


def no_fault(fine: Any, cage: Any) -> None:
    """The demo as it is."""


def not_home_by_one_bit(fine: Any, cage: Any) -> None:
    for points in (fine.data.vertices, fine.data.shape_keys.key_blocks[0].data):
        points[2].co.x = np.nextafter(np.float32(points[2].co.x), np.float32(np.inf))


def elsewhere(fine: Any, cage: Any) -> None:
    fine.location.x += 1.0


def beside_the_drawing(fine: Any, cage: Any) -> None:
    for key in cage.data.shape_keys.key_blocks:
        for point in key.data:
            point.co.x += 9.0


def crossing_on_the_way(fine: Any, cage: Any) -> None:
    key = cage.data.shape_keys.key_blocks[len(cage.data.shape_keys.key_blocks) // 2]
    places = [tuple(point.co) for point in key.data]
    for point, place in zip(key.data, places[len(places) // 2 :] + places[: len(places) // 2], strict=True):
        point.co = place


def still(fine: Any, cage: Any) -> None:
    for item in (fine, cage):
        item.data.shape_keys.animation_data_clear()


@pytest.mark.parametrize(
    "fault", [no_fault, not_home_by_one_bit, elsewhere, beside_the_drawing, crossing_on_the_way, still]
)
def test_a_file_is_checked_as_blender_plays_it(fault: Callable[[Any, Any], None], demo: Path, tmp_path: Path) -> None:
    import bpy

    bpy.ops.wm.open_mainfile(filepath=str(demo / "letter_a.blend"))
    meshes = {item.name: item for item in bpy.data.objects if item.type == "MESH"}
    fine = max(meshes.values(), key=lambda item: len(item.data.vertices))
    fault(fine, meshes["Letter A Cage 1"])
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "played.blend"))
    done = run("-m", "nestedcages_core", "check", tmp_path / "played.blend", folder=tmp_path)
    assert done.returncode == int(fault is not no_fault), done.stdout + done.stderr


def test_a_file_without_cages_or_that_is_not_there_fails_the_check(tmp_path: Path) -> None:
    bpy = pytest.importorskip("bpy")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "empty.blend"))
    for name in ("empty.blend", "none.blend"):
        assert run("-m", "nestedcages_core", "check", tmp_path / name, folder=tmp_path).returncode == 1


def test_the_lines_of_the_readme_run(tmp_path: Path) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (lines,) = re.findall(r"```python\n(.*?)```", readme, flags=re.DOTALL)
    done = run("-c", lines, folder=tmp_path)
    assert done.returncode == 0 and done.stdout, done.stderr
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert {"demo", "test"} <= set(re.findall(r"(?:^|`)make ([a-z-]+)", readme, flags=re.MULTILINE)) <= set(targets)
