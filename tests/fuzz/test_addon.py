"""Random edits of scenes, during jobs too, of copies, characters and puppets; and transforms that are no numbers."""

from random import Random

import pytest

bpy = pytest.importorskip("bpy")

from support.animator import Animator, Puppeteer  # noqa: E402
from support.artist import Artist  # noqa: E402
from support.blender import core, empty_scene, extension, hasty, reports, timers, window  # noqa: E402, F401
from support.drawings import generate, outlive, poly_curve, snapshot, star, text, try_operator  # noqa: E402
from support.flock import Flock  # noqa: E402

pytestmark = [pytest.mark.thorough, pytest.mark.filterwarnings("ignore::RuntimeWarning")]


@pytest.mark.usefixtures("hasty")
@pytest.mark.parametrize("seed", range(100))
def test_scenes_outlive_random_edits_between_and_during_jobs(
    extension,  # noqa: F811
    window,  # noqa: F811
    reports,  # noqa: F811
    tmp_path,
    seed,
) -> None:
    Artist(seed, extension, window, tmp_path).live_through(40)
    reports.read()  # without a traceback


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize(("kind", "edits"), [(Flock, 10), (Animator, 20), (Puppeteer, 20)])
def test_flocks_characters_and_puppets_outlive_random_edits(kind, edits, seed, tmp_path) -> None:
    pytest.importorskip("shapely")
    outlive(kind(Random(seed), str(tmp_path / "scene")), edits, seed)


NO_NUMBERS = [0.0, float("nan"), float("inf"), 1e38]


@pytest.mark.parametrize("value", NO_NUMBERS)
@pytest.mark.parametrize("name", ["location", "rotation_euler", "scale"])
@pytest.mark.parametrize("which", ["curve", "text", "Drawing", "Drawing Cage 1"])
def test_transforms_that_are_no_numbers(which: str, name: str, value: float) -> None:
    """Of drawings, and of what was made of one: operators work, or refuse without a traceback and change nothing."""
    text("Drawing", "ab") if which == "text" else poly_curve("Drawing", [star()])
    if "Drawing" in which:
        generate("12")
    getattr(bpy.data.objects[which if "Drawing" in which else "Drawing"], name)[0] = value
    for operator in ("generate", "verify", "bind", "add_handles", "rebind", "unbind", "silhouette", "live"):
        bpy.context.view_layer.update()  # what is hidden on this frame is
        before = repr(snapshot())
        found = getattr(bpy.ops.object, f"nested_cages_{operator}")
        if found.poll() and try_operator(found) == {"CANCELLED"}:
            bpy.context.view_layer.update()
            assert repr(snapshot()) == before
