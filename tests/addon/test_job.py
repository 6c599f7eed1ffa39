"""The job's slices, and cancelling it at every stage."""

from __future__ import annotations

import json
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from support.drawings import poly_curve, set_in, snapshot, star
from support.marks import slow_after


def job(addon):
    drawing = addon.scene.convert.fine_drawing(addon.scene.convert.read(bpy.context, poly_curve("Drawing", [star()])))
    options = addon.generation.generate.Options(levels=(20, 10))
    generation = addon.generation.generate.Generation([addon.generation.generate.Request(drawing)], options)

    work = addon.generation.job.Job(iter(generation))
    work.results = generation.results
    return work


def test_slices_reach_the_same_end_as_one_go(addon) -> None:
    slow, fast = job(addon), job(addon)
    slices = 1
    while not slow.advance(0.0):
        slices += 1
    while not fast.advance(float("inf")):
        pass
    assert slices > 8
    for one, other in zip(slow.results[0].levels, fast.results[0].levels, strict=True):
        assert one.cage == other.cage


def test_while_a_job_runs_there_is_no_second_one(addon) -> None:
    work = job(addon)
    work.start()
    try:
        assert not bpy.ops.object.nested_cages_generate.poll()
        assert bpy.ops.object.nested_cages_cancel.poll()
        bpy.ops.object.nested_cages_cancel()
        assert work.cancelled
    finally:
        work.stop()
    assert not bpy.ops.object.nested_cages_cancel.poll()


def test_disabling_the_add_on_ends_the_job(extension, addon) -> None:
    work, ended = job(addon), []

    def end(context) -> None:
        ended.append(context.window_manager)
        work.stop()

    work.start(end)
    extension.unregister()
    extension.register()
    assert ended == [bpy.context.window_manager]
    assert addon.generation.job.running() is None
    job(addon).start()
    extension.unregister()
    extension.register()
    assert addon.generation.job.running() is None
    assert bpy.ops.object.nested_cages_generate.poll()


def test_a_fault_in_the_background_ends_its_job_alone(addon, capsys) -> None:
    driver, done = addon.generation.job, []

    def works():
        for number in range(3):
            yield driver.Progress(0.0, "", 1e-9)
            done.append(number)

    def fails():
        yield driver.Progress(0.0, "", 1e-9)
        raise MemoryError("no room")

    driver.Job(fails(), background=True).start()
    driver.Job(works(), background=True).start()
    work = job(addon)
    work.start()
    while not work.done:
        assert driver._on_timer() == driver.TICK and not done  # while another job is at work
    assert driver._on_timer() == driver.TICK and work.results and not done  # which its operator takes
    work.stop()
    while driver._on_timer() is not None:
        assert driver.running() is None
    assert done == [0, 1, 2] and "no room" in capsys.readouterr().err


STAGES = ("decimation", "flow", "reinflation", "tightening", "verification")


def test_a_slice_ends_by_time_and_not_by_stage(addon) -> None:
    work = job(addon)
    shown = []
    while not work.advance(0.0):
        shown.append(work.message)
    for stage in STAGES:
        assert f"Drawing, cage 1: {addon.generation.generate.STAGES[stage]}" in shown
    assert job(addon).advance(1e9)


class Event(SimpleNamespace):
    """What Blender tells a modal operator."""


# A 3D view beside a text editor.
VIEW = SimpleNamespace(
    shading=SimpleNamespace(light="FLAT", color_type="TEXTURE", wireframe_color_type="OBJECT"),
    overlay=SimpleNamespace(wireframe_threshold=0.5),
)
AREAS = [
    SimpleNamespace(type=kind, x=x, y=100, width=300, height=200, spaces=SimpleNamespace(active=VIEW))
    for kind, x in (("VIEW_3D", 0), ("TEXT_EDITOR", 300))
]


@pytest.fixture
def modal(addon, monkeypatch):
    """Operators as Blender invokes them in a window: their methods on a stand-in, with the window's parts noted."""
    log = []
    window = SimpleNamespace(
        event_timer_add=lambda *_, **__: "timer",
        event_timer_remove=lambda timer: log.append(timer),
        modal_handler_add=lambda _operator: log.append("modal"),
        windows=[],
    )
    workspace = SimpleNamespace(status_text_set=lambda words: log.append(words))
    names = ("scene", "mode", "view_layer", "evaluated_depsgraph_get", "selected_objects", "collection")
    context = SimpleNamespace(
        window=SimpleNamespace(screen=SimpleNamespace(areas=AREAS)),
        window_manager=window,
        workspace=workspace,
        space_data=None,
        **{name: getattr(bpy.context, name) for name in names},
    )
    blender = SimpleNamespace(app=SimpleNamespace(background=False), types=bpy.types, ops=bpy.ops, path=bpy.path)
    monkeypatch.setattr(addon.operators.base, "bpy", blender)

    def operator(name, **values):
        kind = next(cls for cls in addon.operators.CLASSES if cls.bl_idname == f"object.nested_cages_{name}")
        bases = tuple(base for base in kind.__bases__ if base.__module__.startswith(addon.__name__))
        own = {key: value for key, value in vars(kind).items() if callable(value) or key == "needs_bound"}
        made = type("StandIn", bases, own)()
        made.properties = SimpleNamespace(is_property_set=lambda _name: True)
        made.exclusive = kind.exclusive
        made.report = lambda level, words: log.append((*level, words))
        for key, value in values.items():
            setattr(made, key, value)
        return made

    settings = {name: getattr(bpy.context.scene.nested_cages, name) for name in addon.properties.settings.NAMES}
    generate = operator("generate", **settings | {"levels": "20, 10"})
    return SimpleNamespace(operator=generate, context=context, log=log, other=operator)


def tick(addon, operator, context):
    """What happens in a window from time to time: the driver works, and the operator gets an event."""
    addon.generation.job._on_timer()
    return operator.modal(context, TIMER)


def on_selection(modal):
    """The window's context with what is selected now."""
    modal.context.selected_objects = list(bpy.context.selected_objects)
    modal.context.scene = bpy.context.scene
    return modal.context


TIMER, ESCAPE, OTHER = (Event(type=kind, value="PRESS", mouse_x=150, mouse_y=150) for kind in ("TIMER", "ESC", "A"))


def test_escape_cancels_where_it_is_meant(addon, modal) -> None:
    poly_curve("Drawing", [star()])
    operator, context = modal.operator, on_selection(modal)
    operator.invoke(context, None)
    for x, y in ((450, 150), (150, 50), (-10, 150)):
        elsewhere = Event(type="ESC", value="PRESS", mouse_x=x, mouse_y=y)
        assert operator.modal(context, elsewhere) == {"PASS_THROUGH"}
    assert operator.modal(context, Event(**vars(ESCAPE) | {"value": "RELEASE"})) == {"PASS_THROUGH"}
    context.mode = "EDIT_TEXT"
    assert operator.modal(context, ESCAPE) == {"PASS_THROUGH"}
    assert addon.generation.job.running() is operator._job
    context.mode = "OBJECT"
    assert operator.modal(context, ESCAPE) == {"CANCELLED"}
    assert addon.generation.job.running() is None


def test_in_a_window_it_works_on_ticks_and_lets_other_events_through(addon, modal) -> None:
    poly_curve("Drawing", [star()])
    operator, context = modal.operator, on_selection(modal)
    assert operator.invoke(context, None) == {"RUNNING_MODAL"}
    assert modal.log[0] == "modal" and modal.log[1].startswith("Nested Cages 0 %")
    assert operator._job.end == operator.cancel
    assert operator.modal(context, OTHER) == {"PASS_THROUGH"}
    outcome = {"PASS_THROUGH"}
    while outcome != {"FINISHED"}:
        assert addon.generation.job.running() is operator._job and outcome <= {"PASS_THROUGH", "RUNNING_MODAL"}
        outcome = tick(addon, operator, context)
    assert addon.generation.job.running() is None
    assert "timer" in modal.log and None in modal.log  # the timer and the status text are gone
    assert len(bpy.data.collections["Drawing Cages"].objects) == 3


@pytest.mark.parametrize("how", ["escape", "button", "Blender"])
@pytest.mark.parametrize("ticks", [0, 1, 4, 8])
def test_in_a_window_cancelling_leaves_the_scene(addon, modal, monkeypatch, ticks, how) -> None:
    monkeypatch.setattr(addon.generation.job, "SLICE", 0.0)
    poly_curve("Drawing", [star()])
    bpy.context.view_layer.update()
    before = snapshot()
    operator, context = modal.operator, on_selection(modal)
    operator.invoke(context, None)
    for _ in range(ticks):
        assert tick(addon, operator, context) == {"PASS_THROUGH"}
    if how == "Blender":
        operator.cancel(context)
    else:
        if how == "button":
            bpy.ops.object.nested_cages_cancel()
        assert operator.modal(context, ESCAPE if how == "escape" else TIMER) == {"CANCELLED"}
        assert modal.log[-1] == ("INFO", "Nested Cages: cancelled, nothing was changed")
    assert "timer" in modal.log and addon.generation.job.running() is None
    assert snapshot() == before


@pytest.mark.slow
@pytest.mark.parametrize("cancel", [False, True])
def test_several_drawings_are_written_at_once(addon, modal, monkeypatch, cancel) -> None:
    """No slice shows a scene that is half written, so there is nothing to take back."""
    monkeypatch.setattr(addon.generation.job, "SLICE", 0.0)
    for name in ("One", "Two", "Three"):
        poly_curve(name, [star()])
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.nested_cages_generate(levels="12")
    bpy.context.view_layer.update()
    before = snapshot()
    assert len(bpy.context.scene.timeline_markers) == 1
    operator, context = modal.operator, on_selection(modal)
    operator.invoke(context, None)
    while operator._job.message != "writing":
        tick(addon, operator, context)
        assert snapshot() == before
    if cancel:
        assert operator.modal(context, ESCAPE) == {"CANCELLED"}
        assert snapshot() == before
        return
    assert tick(addon, operator, context) == {"FINISHED"} and addon.generation.job.running() is None
    for name in ("One", "Two", "Three"):
        made = set_in(addon.record.CageSet.of(bpy.data.objects[name])).members
        assert [len(obj.data.vertices) for obj in made] == [60, 20, 10]
    assert len(bpy.data.meshes) == 12 and all(block.users for block in (*bpy.data.meshes, *bpy.data.actions))


def test_a_drawing_that_is_deleted_meanwhile_ends_in_a_sentence(addon, modal) -> None:
    source = poly_curve("Drawing", [star()])
    operator, context = modal.operator, on_selection(modal)
    operator.invoke(context, None)
    bpy.data.objects.remove(source)
    outcome = {"PASS_THROUGH"}
    while outcome == {"PASS_THROUGH"}:
        outcome = tick(addon, operator, context)
    assert outcome == {"CANCELLED"}
    assert modal.log[-1] == ("ERROR", "'Drawing' was deleted meanwhile, so its cages were discarded")
    assert not bpy.data.objects and addon.generation.job.running() is None


def cages(**values):
    """A star with two cages, the star being selected and active."""
    source = poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20, 10", **values)
    bpy.context.view_layer.update()
    return source


def import_of(tmp_path):
    path = tmp_path / "squares.geojson"
    squares = [[[[x, 0], [x + 1, 0], [x + 1, 1], [x, 1], [x, 0]]] for x in range(0, 20, 2)]
    features = [
        {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": square}}
        for square in squares
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    options = {"directory": "", "files": [], "y": "AUTO", "scale": 1.0, "outlines": "AUTO", "answered": True}
    placing = {"plane": "AUTO", "centre": True, "hidden": False, "repaint": False}
    return {"filepath": str(path), **options, **placing}


def image_of():
    image = bpy.data.images.new("Disc", 32, 32, alpha=True)
    rows, columns = np.mgrid[:32, :32]
    opaque = np.hypot(rows - 15.5, columns - 15.5) < 12.0
    image.pixels.foreach_set(np.repeat(opaque.astype(np.float32).ravel(), 4))
    return {"image": "Disc", "vertices": 8, "padding": 1.0, "threshold": 0.0, "holes": False, "answered": True}


JOBS = {
    "verify": lambda _: (cages(), {"whole": True})[1],
    "bind": lambda _: (cages(), {"method": "AUTO"})[1],
    "import": import_of,
    "from_image": lambda _: image_of(),
}


@pytest.fixture(params=JOBS)
def other(request, addon, modal, tmp_path):
    """Every other operator that works in slices, ready to be invoked, and whether others may work meanwhile."""
    values = JOBS[request.param](tmp_path)
    if request.param == "verify":
        bpy.ops.object.nested_cages_bind()
        bpy.context.scene.frame_end = 12
        bpy.context.scene.frame_set(3)
    bpy.context.view_layer.update()
    return modal.other(request.param, **values), request.param in {"import", "from_image"}


@pytest.mark.slow
def test_every_job_works_on_ticks_to_its_end(addon, modal, other) -> None:
    operator, shared = other
    onward = {"PASS_THROUGH"} if shared else {"RUNNING_MODAL"}
    context = on_selection(modal)
    assert operator.invoke(context, None) == {"RUNNING_MODAL"}
    assert operator.modal(context, OTHER) == onward  # what changes the scene before its end lets nobody else
    outcome = onward
    while outcome == onward:
        outcome = tick(addon, operator, context)
    assert outcome == {"FINISHED"}
    assert addon.generation.job.running() is None and None in modal.log


@pytest.mark.parametrize("name", ["import", "from_image"])
def test_a_dialog_is_followed_by_the_job(addon, modal, monkeypatch, tmp_path, name) -> None:
    """After a dialog Blender executes the operator: it then invokes itself once more, with the options given."""
    values = JOBS[name](tmp_path)
    options = {key: value for key, value in values.items() if key != "answered"}
    operator = modal.other(name, **options | {"answered": False})
    kind = next(cls for cls in addon.operators.CLASSES if cls.bl_idname == f"object.nested_cages_{name}")
    registered = getattr(bpy.types, f"OBJECT_OT_nested_cages_{name}")
    operator.bl_rna, operator.as_keywords = registered.bl_rna, lambda: dict(options)
    operator.ask = lambda *_: {"RUNNING_MODAL"}
    asked = []
    called = SimpleNamespace(**{f"nested_cages_{name}": lambda *given, **named: asked.append((given, named))})
    monkeypatch.setattr(addon.operators.base.bpy, "ops", SimpleNamespace(object=called))
    assert operator.invoke(on_selection(modal), None) == {"RUNNING_MODAL"}
    assert addon.generation.job.running() is None
    assert operator.execute(modal.context) == {"CANCELLED"}
    assert asked == [(("INVOKE_DEFAULT",), options | {"answered": True})]
    assert kind.bl_rna == registered.bl_rna


@pytest.mark.parametrize("ticks", slow_after(0, [1, 0, 2], thorough_after=1))
def test_every_job_can_be_cancelled_and_leaves_the_scene(addon, modal, other, ticks) -> None:
    operator, _ = other
    before = snapshot()
    context = on_selection(modal)
    operator.invoke(context, None)
    for _ in range(ticks):
        assert not operator._job.advance(0.0)
    assert operator.modal(context, ESCAPE) == {"CANCELLED"}
    bpy.context.view_layer.update()
    assert snapshot() == before
    assert addon.generation.job.running() is None


@pytest.mark.slow
@pytest.mark.parametrize("change", [{"levels": "12"}, {"frames_per_step": 9}, {"energy": "SHAPE_KEEPING"}])
def test_the_redo_panel_leaves_nothing_of_the_first_result(addon, change) -> None:
    """What Blender does when a setting is changed there: it undoes the operator and executes it anew."""
    poly_curve("Drawing", [star()])
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.object.nested_cages_generate(**{"levels": "20, 10"} | change)
    expected = snapshot()
    bpy.ops.ed.undo_push(message="directly")
    bpy.ops.ed.undo()
    bpy.ops.object.nested_cages_generate(levels="20, 10")
    bpy.ops.ed.undo_push(message="first")
    bpy.ops.ed.undo()
    bpy.ops.object.nested_cages_generate(**{"levels": "20, 10"} | change)
    assert snapshot() == expected
