"""Operators as in a window: work in slices, cancelling at any moment, one job at a time."""

import itertools
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest

from nestedcages_core import Mesh, nested_cages
from support.blender import ESCAPE, GOES_ON, IN_TEXT_EDITOR, OTHER, TIMER, event, running
from support.documents import collection, feature
from support.drawings import Loop, base, bind, generate, image_empty, made, poly_curve, snapshot, star
from support.marks import slow_after

depths = itertools.count(1)


def new_star(count: int = 60) -> Loop:
    """A star that nothing is remembered of."""
    return star(count, 0.25 + 1e-4 * next(depths))


@pytest.fixture
def operator(window: Any) -> Any:
    """Generate in a window, with a drawing selected."""
    poly_curve("Drawing", [new_star()])
    bpy.context.view_layer.update()
    return window.operator("generate", levels="20, 10")


def test_slices_reach_the_same_end_as_one_go(window, operator, hasty) -> None:
    fine = Mesh.from_loops([np.array([point.co[:2] for point in bpy.context.object.data.splines[0].points])])
    assert window.invoke(operator) in GOES_ON and window.finish(operator) == {"FINISHED"}
    for cage, level in zip(made()[1:], nested_cages(fine, [20, 10], stored=np.float32).levels, strict=True):
        np.testing.assert_array_equal(base(cage)[:, :2], level.cage.vertices)


def test_progress_goes_up_and_names_what_is_worked_on(window, operator, hasty) -> None:
    assert window.invoke(operator) in GOES_ON
    said, outcome = [], {"PASS_THROUGH"}
    while outcome in GOES_ON:
        window.log.clear()
        outcome = window.tick(operator)
        said += [text for text in window.log if isinstance(text, str) and "%" in text]
    assert len(said) > 8 and len(set(said)) > 5  # the stages of each cage
    shares = [float(text.partition("%")[0].split()[-1]) for text in said]
    assert shares == sorted(shares) and all("Drawing" in text for text in said if 5.0 < float(text.split()[2]) < 95.0)


def test_while_a_job_runs_there_is_no_second_one_and_disabling_ends_it(extension, window, operator, hasty) -> None:
    window.invoke(operator)
    assert running() and not bpy.ops.object.nested_cages_generate.poll()
    extension.unregister()
    extension.register()
    assert not running() and bpy.ops.object.nested_cages_generate.poll()
    assert "timer" in window.log


def test_escape_cancels_where_it_is_meant(window, operator, hasty) -> None:
    window.invoke(operator)
    for place in (IN_TEXT_EDITOR, (150, 50), (-10, 150)):
        assert operator.modal(window.context, event("ESC", *place)) == {"PASS_THROUGH"}
    assert operator.modal(window.context, event("ESC", value="RELEASE")) == {"PASS_THROUGH"}
    window.context.mode = "EDIT_TEXT"
    assert operator.modal(window.context, ESCAPE) == {"PASS_THROUGH"}
    assert running()
    window.context.mode = "OBJECT"
    assert operator.modal(window.context, ESCAPE) == {"CANCELLED"}
    assert not running()


def test_in_a_window_it_works_on_ticks_and_lets_other_events_through(window, operator, hasty) -> None:
    assert window.invoke(operator) == {"RUNNING_MODAL"}
    assert window.log[0] == "modal" and isinstance(window.log[1], str)
    assert operator.modal(window.context, OTHER) == {"PASS_THROUGH"}
    assert running()
    assert window.finish(operator) == {"FINISHED"} and not running()
    assert "timer" in window.log and None in window.log  # the timer and the status text are gone
    assert len(made()) == 3


@pytest.mark.parametrize("how", ["escape", "button", "Blender"])
@pytest.mark.parametrize("ticks", slow_after(2, [1, 8, 0, 4], thorough_after=2))
def test_in_a_window_cancelling_leaves_the_scene(window, operator, hasty, ticks, how) -> None:
    before = snapshot()
    window.invoke(operator)
    for _ in range(ticks):
        assert window.tick(operator) == {"PASS_THROUGH"}
    if how == "Blender":
        operator.cancel(window.context)
    else:
        if how == "button":
            bpy.ops.object.nested_cages_cancel()
        assert operator.modal(window.context, ESCAPE if how == "escape" else TIMER) == {"CANCELLED"}
        assert window.log[-1][0] == "INFO"
    assert "timer" in window.log and not running()
    assert snapshot() == before


@pytest.mark.slow
@pytest.mark.parametrize("cancel", slow_after(1, [True, False]))
def test_several_drawings_are_written_at_once(window, hasty, cancel) -> None:
    """No slice shows a scene that is half written, so there is nothing to take back."""
    for name in ("One", "Two", "Three"):
        poly_curve(name, [new_star()])
    bpy.ops.object.select_all(action="SELECT")
    generate("12")
    bpy.context.view_layer.update()
    before = snapshot()
    operator = window.operator("generate", levels="20, 10")
    window.invoke(operator)
    ticks = 0
    while (outcome := window.tick(operator)) in GOES_ON:
        assert snapshot() == before
        ticks += 1
        if cancel and ticks == 30:
            assert operator.modal(window.context, ESCAPE) == {"CANCELLED"}
            assert snapshot() == before
            return
    assert outcome == {"FINISHED"} and not cancel
    for name in ("One", "Two", "Three"):
        assert [len(obj.data.vertices) for obj in made(name)] == [60, 20, 10]
    assert len(bpy.data.meshes) == 12 and all(block.users for block in (*bpy.data.meshes, *bpy.data.actions))


def test_a_drawing_that_is_deleted_meanwhile_is_an_error(window, operator, hasty) -> None:
    window.invoke(operator)
    bpy.data.objects.remove(bpy.data.objects["Drawing"])
    assert window.finish(operator) == {"CANCELLED"}
    kind, said = window.log[-1]
    assert kind == "ERROR" and "'Drawing'" in said
    assert not bpy.data.objects and not running()


def test_a_drawing_that_is_renamed_meanwhile_gets_its_cages(window, operator, hasty) -> None:
    window.invoke(operator)
    bpy.data.objects["Drawing"].name = "Other"
    assert window.finish(operator) == {"FINISHED"}
    assert len(made("Other")) == 3


def caged(_folder: Any) -> dict[str, Any]:
    poly_curve("Drawing", [new_star()])
    generate()
    bpy.context.view_layer.update()
    return {}


def bound(folder: Any) -> dict[str, Any]:
    caged(folder)
    bind()
    bpy.context.scene.frame_end = 12
    bpy.context.scene.frame_set(3)
    return {"whole": True}


def map_of(folder: Any) -> dict[str, Any]:
    squares = [[[[x, 0], [x + 1, 0], [x + 1, 1], [x, 1], [x, 0]]] for x in range(0, 20, 2)]
    (folder / "squares.geojson").write_text(collection(*map(feature, squares)))
    return {"filepath": str(folder / "squares.geojson"), "scale": 1.0}


def image_of(_folder: Any) -> dict[str, Any]:
    image = bpy.data.images.new("Disc", 32, 32, alpha=True)
    rows, columns = np.mgrid[:32, :32]
    opaque = np.hypot(rows - 15.5, columns - 15.5) < 8.0 + 0.3 * next(depths) % 5.0
    image.pixels.foreach_set(np.repeat(opaque.astype(np.float32).ravel(), 4))
    image_empty(image)
    return {"outlines": "SELECTED", "vertices": 8}


JOBS = {"verify": bound, "bind": caged, "import": map_of, "import picture": image_of}


@pytest.fixture(params=JOBS)
def other(request, window, tmp_path) -> Any:
    """Every other operator that works in slices."""
    values = JOBS[request.param](tmp_path)
    bpy.context.view_layer.update()
    return window.operator(request.param.partition(" ")[0], **values)


@pytest.mark.slow
def test_every_job_works_on_ticks_to_its_end(window, other, hasty) -> None:
    assert window.invoke(other) == {"RUNNING_MODAL"}
    assert other.modal(window.context, OTHER) == {"RUNNING_MODAL"}  # it changes the scene, and lets nobody else
    assert window.finish(other) == {"FINISHED"}
    assert not running() and None in window.log


@pytest.mark.parametrize("ticks", slow_after(1, [1, 0, 2], thorough_after=1))
def test_every_job_can_be_cancelled_and_leaves_the_scene(window, other, hasty, ticks) -> None:
    before = snapshot()
    window.invoke(other)
    for _ in range(ticks):
        assert window.tick(other) in GOES_ON
    assert other.modal(window.context, ESCAPE) == {"CANCELLED"}
    bpy.context.view_layer.update()
    assert snapshot() == before and not running()


@pytest.mark.parametrize("job", ["import", "import picture"])
def test_a_dialog_is_followed_by_the_job(window, tmp_path, job) -> None:
    """After a dialog Blender executes the operator: it then invokes itself once more, with the options given."""
    options = JOBS[job](tmp_path)
    operator = window.operator("import", **options)
    operator.answered = False
    operator.ask = lambda *_: {"RUNNING_MODAL"}
    asked: list[Any] = []
    called = SimpleNamespace(nested_cages_import=lambda *given, **named: asked.append((given, named)))
    window.ops = SimpleNamespace(object=called)
    assert window.invoke(operator) == {"RUNNING_MODAL"} and not running()
    assert operator.execute(window.context) == {"CANCELLED"}
    assert asked == [(("INVOKE_DEFAULT",), options | {"answered": True})]
