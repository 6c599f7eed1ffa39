"""Random edits of whole scenes, during jobs too, of copies of sets, and transforms that are no numbers."""

from __future__ import annotations

import pytest

bpy = pytest.importorskip("bpy")

from support.artist import Artist  # noqa: E402
from support.blender import core, empty_scene, extension, hasty, reports, timers, window  # noqa: E402, F401
from support.drawings import generate, outlive, poly_curve, snapshot, star, text  # noqa: E402
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
def test_flocks_outlive_random_edits(tmp_path, seed) -> None:
    outlive(Flock(tmp_path / "flock.blend", seed), 10, seed)


NO_NUMBERS = [0.0, float("nan"), float("inf"), 1e38]


def call(name: str) -> bool:
    """Whether an operator refuses; never with a traceback."""
    operator = getattr(bpy.ops.object, f"nested_cages_{name}")
    if operator.poll():
        try:
            operator()
        except RuntimeError as error:
            assert "Python" not in str(error), error
            return True
    return False


@pytest.mark.parametrize("value", NO_NUMBERS)
@pytest.mark.parametrize("name", ["location", "rotation_euler", "scale"])
@pytest.mark.parametrize("kind", ["curve", "text"])
def test_transforms_of_drawings_that_are_no_numbers(kind: str, name: str, value: float) -> None:
    drawing = poly_curve("Drawing", [star()]) if kind == "curve" else text("Drawing", "ab")
    getattr(drawing, name)[0] = value
    bpy.context.view_layer.update()
    before = repr(snapshot())
    for operator in ("generate", "verify", "bind", "silhouette", "live", "remove_animation"):
        refused = call(operator)
        bpy.context.view_layer.update()  # what is hidden on this frame is
        if refused:
            assert repr(snapshot()) == before
        before = repr(snapshot())


@pytest.mark.parametrize("which", ["Drawing", "Drawing Cage 1"])
@pytest.mark.parametrize("value", NO_NUMBERS)
@pytest.mark.parametrize("name", ["location", "scale"])
def test_transforms_of_outputs_that_are_no_numbers(which: str, name: str, value: float) -> None:
    poly_curve("Drawing", [star()])
    generate("12")
    getattr(bpy.data.objects[which], name)[0] = value
    bpy.context.view_layer.update()
    for operator in ("verify", "bind", "add_handles", "rebind", "unbind", "live", "generate"):
        call(operator)
