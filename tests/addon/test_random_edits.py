"""Random edits of scenes, during jobs too, of copies, characters and puppets; and transforms that are no numbers."""

from random import Random

import bpy
import pytest

from support.animator import Animator, Puppeteer
from support.artist import Artist
from support.drawings import generate, outlive, poly_curve, snapshot, star, text, try_operator
from support.flock import Flock
from support.marks import slow_after

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore::RuntimeWarning")]

CRASHED = 41
"""A sequence in which Verify Cages crashed Blender 5.0."""
SCENES = [(0, 16), (CRASHED, 16), *((seed, 40) for seed in range(100))]
"""Seeds and numbers of steps."""


@pytest.mark.usefixtures("hasty")
@pytest.mark.parametrize(("seed", "steps"), slow_after(2, SCENES, thorough_after=2))
def test_a_scene_outlives_random_edits_between_and_during_jobs(
    extension, window, reports, tmp_path, seed, steps
) -> None:
    """Every tick does one step, so that a seed says what happens when."""
    Artist(seed, extension, window, tmp_path).live_through(steps)
    reports.read()  # without a traceback


LIVES = [
    *((Flock, 10, 0), (Animator, 4, 0), (Puppeteer, 4, 0)),
    *((kind, edits, seed) for kind, edits in ((Flock, 10), (Animator, 20), (Puppeteer, 20)) for seed in range(12)),
]


@pytest.mark.parametrize(("kind", "edits", "seed"), slow_after(3, LIVES, thorough_after=3))
def test_a_flock_a_character_and_a_puppet_outlive_random_edits(kind, edits, seed, tmp_path) -> None:
    pytest.importorskip("shapely")
    outlive(kind(Random(seed), str(tmp_path / "scene")), edits, seed)


@pytest.mark.thorough
@pytest.mark.parametrize("value", [0.0, float("nan"), float("inf"), 1e38])
@pytest.mark.parametrize("name", ["location", "rotation_euler", "scale"])
@pytest.mark.parametrize("which", ["curve", "text", "Drawing", "Drawing Cage 1"])
def test_transforms_that_are_no_numbers(which: str, name: str, value: float) -> None:
    """Of drawings, and of what was made of one: operators work, or refuse without a traceback and change nothing."""
    text("Drawing", "ab") if which == "text" else poly_curve("Drawing", [star()])
    if "Drawing" in which:
        generate("12")
    getattr(bpy.data.objects[which if "Drawing" in which else "Drawing"], name)[0] = value
    for operator in ("generate", "verify", "bind", "puppet", "bind", "live"):
        bpy.context.view_layer.update()  # what is hidden on this frame is
        before = repr(snapshot())
        found = getattr(bpy.ops.object, f"nested_cages_{operator}")
        if found.poll() and try_operator(found) == {"CANCELLED"}:
            bpy.context.view_layer.update()
            assert repr(snapshot()) == before
