"""Live: cages that follow edits, without a window: its timer's work is called as the timer would."""

from __future__ import annotations

import time
from itertools import pairwise
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from support.drawings import circle, edges_of, evaluated, facts, poly_curve, set_in, solid, star, wire
from support.marks import slow_after


@pytest.fixture
def live(addon):
    yield addon.following.live
    addon.following.live.stop()


@pytest.fixture
def job(addon):
    return addon.generation.job


@pytest.fixture
def tick(live, job):
    """Ticks until the cages are up to date again, or cannot be."""

    def work(most: float = 20.0) -> None:
        bpy.context.view_layer.update()
        end = time.perf_counter() + most
        while live.current() is not None and time.perf_counter() < end:
            job._on_timer()
            now = live.current()
            if now is not None and not now._dirty and job.running() is None:
                return

    return work


def switched_on(make, levels="24, 12"):
    """A drawing with cages, and Live switched on."""
    obj = make()
    bpy.ops.object.nested_cages_generate(levels=levels)
    for other in bpy.context.selected_objects:
        other.select_set(False)
    obj.hide_viewport = False
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    assert bpy.ops.object.nested_cages_live() == {"FINISHED"}
    return obj, bpy.data.collections[f"{obj.name} Cages"]


def holds(core, addon, collection, obj) -> bool:
    """Whether the cages enclose the drawing of now, as stored."""
    drawing = addon.following.moving.drawing_now(bpy.context, obj, addon.scene.convert.ReadingOptions())
    meshes = [drawing.mesh()]
    for member in set_in(collection).members[1:]:
        meshes.append(core.Mesh(evaluated(member)[:, :2].astype(float), edges_of(member)))
    return all(core.verify(outer, inner).holds for inner, outer in pairwise(meshes))


def handlers():
    """Those of Live, of all kinds."""
    found = [getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)]
    kinds = [kind for kind in found if isinstance(kind, list)]
    return [function for kind in kinds for function in kind if ".following.live" in function.__module__]


def star_curve():
    return poly_curve("Drawing", [star()])


def star_mesh():
    return wire("Drawing", [star()])


def move_points(obj, factor: float) -> None:
    if obj.type == "CURVE":
        for point in list(obj.data.splines[0].points)[:8]:
            point.co = (factor * point.co[0], factor * point.co[1], 0.0, 1.0)
    else:
        for vertex in list(obj.data.vertices)[:8]:
            vertex.co = factor * vertex.co
        obj.data.update()
    obj.data.update_tag()


@pytest.mark.slow
@pytest.mark.parametrize("make", slow_after(1, [star_curve, star_mesh]))
def test_an_edit_is_followed_by_a_step(addon, core, live, tick, make) -> None:
    obj, collection = switched_on(make)
    tick()
    assert not live.current().behind
    cages = set_in(collection).members[1:]
    meshes = [cage.data for cage in cages]
    for factor in (1.1, 1.05, 0.9):
        move_points(obj, factor)
        bpy.context.view_layer.update()
        assert live.current()._dirty
        tick()
        assert not live.current().behind and not live.current().problem
        assert holds(core, addon, collection, obj)
    assert [cage.data for cage in cages] == meshes  # by steps: these are the same meshes
    assert "Certified as stored" in facts(cages[0])["certificate"]


def test_a_step_is_certified_as_it_is_stored(core, live, tick, monkeypatch) -> None:
    followed, found = core.followed, []
    monkeypatch.setattr(live.core, "followed", lambda *given: found.append(followed(*given)) or found[-1])
    obj, _ = switched_on(star_curve)
    tick()
    move_points(obj, 1.1)
    tick()
    assert len(found) == 2
    assert all(np.array_equal(mesh.vertices, mesh.vertices.astype(np.float32)) for mesh in found)


@pytest.mark.parametrize("make", slow_after(1, [star_curve, star_mesh]))
def test_edit_mode_is_followed(addon, core, live, tick, make) -> None:
    obj, collection = switched_on(make)
    tick()
    bpy.ops.object.mode_set(mode="EDIT")
    select = bpy.ops.curve.select_all if obj.type == "CURVE" else bpy.ops.mesh.select_all
    select(action="SELECT")
    bpy.ops.transform.resize(value=(1.2, 1.0, 1.0))
    bpy.context.view_layer.update()
    assert live.current()._dirty
    tick()
    assert not live.current().behind and obj.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert holds(core, addon, collection, obj)
    assert solid(collection.objects[1]).contains(solid(collection.objects[0]))


@pytest.mark.slow
def test_another_topology_is_made_anew_in_slices(addon, core, live, job, tick) -> None:
    obj, collection = switched_on(star_curve)
    tick()
    spline = obj.data.splines.new("POLY")
    spline.points.add(19)
    loop = circle(20, 0.4, (4.0, 0.0))
    spline.points.foreach_set("co", np.column_stack([loop, np.zeros(20), np.ones(20)]).ravel())
    spline.use_cyclic_u = True
    obj.data.update_tag()
    bpy.context.view_layer.update()
    time.sleep(live.current().seconds)
    job._on_timer()
    assert live.current().behind
    tick()
    assert not live.current().behind and holds(core, addon, collection, obj)
    assert [len(o.data.vertices) for o in set_in(collection).members] == [80, 24, 12]
    assert job.running() is None
    move_points(obj, 1.1)
    tick()
    assert not live.current().behind and holds(core, addon, collection, obj)


def test_what_cannot_be_caged_is_said_and_nothing_changes(addon, live, tick) -> None:
    obj, collection = switched_on(star_curve)
    tick()
    before = [evaluated(o) for o in collection.objects]
    obj.data.splines[0].use_cyclic_u = False
    obj.data.update_tag()
    tick()
    assert live.current().behind and "open" in live.current().problem
    assert all(np.array_equal(b, evaluated(o)) for b, o in zip(before, collection.objects, strict=True))
    obj.data.splines[0].use_cyclic_u = True
    obj.data.update_tag()
    tick()
    assert not live.current().behind and not live.current().problem


def test_other_objects_do_not_make_it_look(live, tick) -> None:
    switched_on(star_curve)
    tick()
    other = poly_curve("Other", [circle()])
    bpy.context.view_layer.update()
    tick()
    live.current()._dirty = False
    move_points(other, 1.2)
    bpy.context.view_layer.update()
    assert not live.current()._dirty


def test_nothing_is_left_behind_when_it_is_switched_off(live, job) -> None:
    switched_on(star_curve)
    assert handlers() and bpy.app.timers.is_registered(job._on_timer)
    bpy.ops.object.nested_cages_live()
    assert live.current() is None and not handlers()
    assert job._on_timer() is None


def test_nothing_is_left_behind_when_another_file_is_opened(live, job, tmp_path) -> None:
    switched_on(star_curve)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "live.blend"))
    assert live.current() is not None  # saving goes on
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "live.blend"))
    assert live.current() is None and not handlers()
    assert job._on_timer() is None


def test_nothing_is_left_behind_by_the_add_on(extension, live) -> None:
    switched_on(star_curve)
    extension.unregister()
    found = live.current(), handlers()
    extension.register()
    assert found == (None, [])


@pytest.mark.slow
def test_it_ends_with_its_drawing_and_with_animation(live, job) -> None:
    obj, _ = switched_on(star_curve)
    bpy.data.objects.remove(obj)
    assert job._on_timer() is None and live.current() is None
    obj, _ = switched_on(star_mesh)
    bpy.ops.object.nested_cages_generate(levels="20")
    assert job._on_timer() is None and live.current() is None


@pytest.mark.slow
def test_making_cages_again_can_be_cancelled(addon, live, job, tick, monkeypatch) -> None:
    obj, collection = switched_on(star_curve)
    tick()
    before = [evaluated(member) for member in collection.objects]
    monkeypatch.setattr(job, "BACKGROUND_SLICE", 0.0)
    obj.data.splines[0].points.add(1)
    obj.data.splines[0].points[-1].co = (1.0, -0.2, 0.0, 1.0)
    obj.data.update_tag()
    bpy.context.view_layer.update()
    while job.running() is None:
        job._on_timer()
    assert job.running() is live.current().job and bpy.ops.object.nested_cages_cancel.poll()
    bpy.ops.object.nested_cages_cancel()
    tick()
    assert live.current().behind and live.current().problem.startswith("Cancelled")
    assert all(np.array_equal(b, evaluated(o)) for b, o in zip(before, collection.objects, strict=True))
    move_points(obj, 1.0)
    tick()
    assert not live.current().behind and not live.current().problem


def test_undo_is_followed(addon, core, live, tick) -> None:
    obj, collection = switched_on(star_curve)
    tick()
    bpy.ops.ed.undo_push(message="before")
    move_points(obj, 1.3)
    tick()
    bpy.ops.ed.undo_push(message="edited")
    bpy.ops.ed.undo()
    assert live.current() is not None and live.current()._dirty
    tick()
    obj, collection = bpy.data.objects["Drawing"], bpy.data.collections["Drawing Cages"]
    assert not live.current().behind and holds(core, addon, collection, obj)
    bpy.ops.ed.redo()
    assert addon.following.live._on_undo in bpy.app.handlers.redo_post
    assert live.current()._dirty
    tick()
    obj, collection = bpy.data.objects["Drawing"], bpy.data.collections["Drawing Cages"]
    assert not live.current().behind and holds(core, addon, collection, obj)


@pytest.mark.slow
def test_bound_and_moving_cages_are_refused(live) -> None:
    wire("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20")
    bpy.ops.object.nested_cages_bind()
    assert not bpy.ops.object.nested_cages_live.poll()


def test_the_panel_says_whether_the_cages_are_behind(addon, live, tick) -> None:
    obj, _ = switched_on(star_curve)
    said: list[str] = []
    layout = SimpleNamespace(operator=lambda *_, **__: None, label=lambda text, **_: said.append(text))
    layout.column = lambda **_: layout
    tick()
    addon.ui.results.draw_live(layout)
    move_points(obj, 1.1)
    bpy.context.view_layer.update()
    addon.ui.results.draw_live(layout)
    tick()
    addon.ui.results.draw_live(layout)
    bpy.ops.object.nested_cages_live()
    addon.ui.results.draw_live(layout)
    assert said == ["Up to date", "Out of date", "Up to date"]


@pytest.mark.slow
def test_a_modifiers_slider_is_followed(addon, core, live, tick) -> None:
    obj, collection = switched_on(star_mesh)
    tick()
    bend = obj.modifiers.new("Stretch", "SIMPLE_DEFORM")
    bend.deform_method, bend.factor = "TAPER", 0.0
    for factor in (0.1, 0.2):
        bend.factor = factor
        bpy.context.view_layer.update()
        assert live.current().behind
        tick()
        assert not live.current().behind and holds(core, addon, collection, obj)


@pytest.mark.slow
@pytest.mark.parametrize(("levels", "settings"), [("0.05u", {}), ("24, +20%", {}), ("24, 12", {"clearance": 0.05})])
def test_a_cage_keeps_the_promises_that_it_was_made_with(addon, core, live, tick, levels, settings) -> None:
    """Whatever the panel shows; a step that would break one makes the cages again."""
    bpy.context.scene.nested_cages.clearance = 0.0
    obj = star_curve()
    bpy.ops.object.nested_cages_generate(levels=levels, **settings)
    collection = bpy.data.collections["Drawing Cages"]
    obj.hide_viewport = False
    assert bpy.ops.object.nested_cages_live() == {"FINISHED"}
    tick()
    for factor in (1.3, 1.2, 0.8):
        move_points(obj, factor)
        tick()
        assert not live.current().behind and holds(core, addon, collection, obj)
        fine, *cages = (core.Mesh(evaluated(o)[:, :2].astype(float), edges_of(o)) for o in collection.objects)
        member = addon.record.node_of(set_in(collection).members[-1])
        promise = dict(addon.record.notes(member)).get("note.tolerance", {})
        if levels == "0.05u":
            assert core.Within(distance=0.05).is_met(cages[0], fine) and promise["taken"] <= 0.05
        elif settings:
            found = [core.verify(o, i) for i, o in pairwise([fine, *cages])]
            assert min(each.clearance for each in found) >= 0.05 * (1.0 - 1e-6)
        else:
            assert core.Within(excess=0.2).is_met(cages[1], fine) and promise["taken"] <= 0.2
        assert set_in(collection).record.settings.levels == levels


def test_the_window_of_the_drawing_s_scene_is_worked_in(addon) -> None:
    """With two windows on two scenes, whichever was opened first."""
    windows = [SimpleNamespace(scene=SimpleNamespace(name=name)) for name in ("Other", "Scene")]
    window_of = addon.generation.job.window_of
    assert window_of("Scene", windows) is windows[1] and window_of("Other", windows) is windows[0]
    assert window_of("Gone", windows) is windows[0] and window_of("Scene", []) is None
