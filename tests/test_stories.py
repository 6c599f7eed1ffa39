"""The stories in examples/ run in their small form, write what they say, and draw something."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from nestedcages_core import (
    features_from_geojson,
    from_engine_json,
    read_geojson,
    read_svg,
    verify,
)
from support.engine_json import frames_of
from support.marks import slow_after

pytest.importorskip("matplotlib")
from matplotlib.image import imread

ROOT = Path(__file__).resolve().parents[1]
STORIES = ("bend", "butterfly", "coast", "fox_walk", "logo", "regions", "sprite_outline", "walk", "warning_area")
RARE = ("character", "cut_or_held", "five_levels", "glyphs", "needs", "poisson", "waving")
NESTED = {
    "logo": ("logo_cages.svg", "shape", "cage-1", "cage-2"),
    "butterfly": ("butterfly.svg", "shape", "cage-1"),
    "needs": ("needs.svg", "inner", "fine", "outer"),
    "five_levels": ("five_levels.svg", "shape", "cage-1", "cage-2", "cage-3"),
}
"""The drawing that a story writes, and what lies in each other there."""
NEED_BLENDER = ("character", "fox_walk", "waving")


@pytest.mark.parametrize("story", slow_after(0, STORIES + RARE, thorough_after=len(STORIES)))
def test_a_story_runs_and_draws_its_picture(story: str, tmp_path: Path) -> None:
    if story in NEED_BLENDER:
        pytest.importorskip("bpy")
    command = [sys.executable, f"examples/{story}.py", "--small", "--output", str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "MPLCONFIGDIR": str(tmp_path / "matplotlib")}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=170, check=False)
    assert done.returncode == 0, done.stderr
    picture = tmp_path / f"{story}.png"
    assert f"Wrote {picture}" in done.stdout
    pixels = imread(picture)
    assert min(pixels.shape[:2]) > 200
    assert (pixels[:, :, :3].min(axis=2) < 0.9).mean() > 0.02
    _check_files(story, tmp_path)


def _check_files(story: str, folder: Path) -> None:
    """What a story writes beside its picture can be read and holds."""
    if story == "sprite_outline":
        text = (folder / "fox_outline.json").read_text()
        assert len(from_engine_json(text).vertices) == 16
        assert json.loads(text)["triangles"]
    elif story in NESTED:
        name, *elements = NESTED[story]
        parts = [read_svg(folder / name, element=element) for element in elements]
        assert all(verify(outer, inner) for inner, outer in pairwise(parts))
    elif story == "coast":
        features = json.loads((folder / "coast.geojson").read_text())["features"]
        assert len(features) == 2
        (folder / "one.geojson").write_text(json.dumps(features[0]))
        assert read_geojson(folder / "one.geojson").area > 0.0
    elif story == "regions":
        features = features_from_geojson((folder / "regions.geojson").read_bytes())
        assert len({feature.properties["name"] for feature in features}) == len(features) > 3
    elif story == "walk":
        frames = frames_of((folder / "walk_body.json").read_text())
        assert len(frames) >= 9
        assert {len(outline.vertices) for _, outline in frames} == {8}
    elif story in NEED_BLENDER:
        assert (folder / f"{story}.blend").stat().st_size > 0
