"""Panels, menus and dialogs: what fits the selection is offered, every setting is there, and results are said."""

from types import SimpleNamespace
from typing import Any

import bpy
import pytest

from support import drawings
from support.blender import refused
from support.drawings import (
    base,
    bezier_circle,
    bind,
    certificate,
    choose,
    generate,
    grid_face,
    made,
    poly_curve,
    star,
    text,
    wire,
)
from support.marks import slow_after
from support.panels import Layout, draw, ours, own_settings, shows, sidebar

SHOW = "object.nested_cages_select_fault"
"""The button that goes to the place of the last message."""


def test_the_panel_shows_the_settings() -> None:
    poly_curve("Drawing", [star()])
    drawn = draw(bpy.types.VIEW3D_PT_nested_cages)
    assert {"levels", "clearance", "object.nested_cages_generate", "object.nested_cages_bind"} <= set(drawn)
    assert not {"energy", "length", "as_published"} & set(drawn)


def squares(*places: float) -> list[Any]:
    """Overlapping or separate faces, all selected."""
    made = [grid_face(f"Part {number}", 1) for number, _ in enumerate(places)]
    for obj, x in zip(made, places, strict=True):
        obj.location = (x, 0.0, 0.01 * x)
    bpy.context.view_layer.update()
    return made


def sprite() -> None:
    drawings.image_empty(bpy.data.images.new("sprite", 8, 8, alpha=True))


def rigged() -> None:
    squares(0.0, 0.8, 1.6)
    assert bpy.ops.object.nested_cages_puppet(source="ONE_CAGE") == {"FINISHED"}


def handles() -> None:
    poly_curve("Drawing", [star()])
    generate("8")
    assert bpy.ops.object.nested_cages_bind() == bpy.ops.object.nested_cages_puppet(source="HANDLES") == {"FINISHED"}
    assert bpy.context.mode == "POSE"


def drawing_mode() -> None:
    drawings.add("Sketch", getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new("Sketch"))
    bpy.ops.object.mode_set(mode="PAINT_GREASE_PENCIL" if bpy.app.version >= (4, 3, 0) else "PAINT_GPENCIL")


# What is selected, and whether the panel says what to do first.
SELECTED = {
    "nothing": (lambda: None, True),
    "a camera": (bpy.ops.object.camera_add, True),
    "a drawing": (lambda: poly_curve("Drawing", [star()]), False),
    "drawings side by side": (lambda: squares(0.0, 2.0, 4.0), False),
    "an armature": (bpy.ops.object.armature_add, True),
    "a picture": (sprite, True),
    "a drawing of Grease Pencil in Draw Mode": (drawing_mode, True),
    "a curve in Edit Mode": (lambda: (bezier_circle("Curve"), bpy.ops.object.mode_set(mode="EDIT")), True),
    "a rig in Pose Mode": (rigged, False),
    "handles in Pose Mode": (handles, False),
}


@pytest.mark.parametrize("name", slow_after(8, SELECTED))
def test_the_panels_say_what_to_do_in_lines_that_fit(name) -> None:
    select, hint = SELECTED[name]
    select()
    drawn = draw(bpy.types.VIEW3D_PT_nested_cages)
    button = drawn.index("object.nested_cages_generate")
    assert hint == bool({"object.nested_cages_import", "object.mode_set"} & set(drawn[:button]))
    assert all(line and len(line) < 50 for line in draw() if " " in line or not line)
    if bpy.context.object is not None and not hint:
        assert drawn[0].startswith(bpy.context.object.name)


def test_nothing_is_left_over_from_another_object() -> None:
    other = poly_curve("Other", [star() + 5.0])
    choose(poly_curve("Drawing", [star()]))
    generate("8")
    assert any("Drawing" in line for line in draw())
    choose(other)
    assert not any("Drawing" in line for line in draw())
    assert bpy.types.VIEW3D_PT_nested_cages_result not in [each for each in sidebar() if shows(each)]


UNFIT = [
    ("nothing", "generate", {}, ""),
    *(("nothing", name, {}, "") for name in ("puppet", "cutout", "export")),
    ("a camera", "generate", {}, "'Camera'"),
    ("a camera", "import", {"outlines": "SELECTED"}, ""),
    ("a drawing", "verify", {}, ""),
    ("an open line", "import", {"outlines": "SELECTED"}, "'Open'"),
]


@pytest.mark.parametrize(("selected", "name", "options", "named"), UNFIT)
def test_operators_say_what_they_cannot_work_on(selected, name, options, named) -> None:
    if selected == "an open line":
        poly_curve("Open", [star()], cyclic=False)
    else:
        SELECTED[selected][0]()
    with refused(named):
        getattr(bpy.ops.object, f"nested_cages_{name}")(**options)


def test_every_setting_is_in_one_of_the_panels_and_in_the_redo_panel() -> None:
    poly_curve("Drawing", [star()])
    names = own_settings()
    assert sorted(name for name in draw() if name in names) == names
    drawn: list[str] = []
    operator, settings = bpy.ops.object.nested_cages_generate.get_rna_type(), bpy.context.scene.nested_cages
    values = SimpleNamespace(bl_rna=operator, layout=Layout(drawn), **{n: getattr(settings, n) for n in names})
    bpy.types.OBJECT_OT_nested_cages_generate.draw(values, bpy.context)
    assert sorted(name for name in drawn if name in names) == names


def test_all_operators_are_in_the_submenu() -> None:
    drawn = draw(*ours(bpy.types.Menu))
    known = {f"object.{name}" for name in dir(bpy.ops.object) if name.startswith("nested_cages")}
    assert known - set(drawn) == {"object.nested_cages_cancel"}


COUNTED = {
    "curve": (lambda: poly_curve("Drawing", [star(465)]), 465),
    "Bezier curve": (lambda: drawings.bezier_circle("Drawing", resolution=12), 48),
    "edges": (lambda: wire("Drawing", [star(60), drawings.circle(12, 0.3)]), 72),
    "faces": (lambda: grid_face("Drawing", 4), 16),
    "text": (lambda: text("Drawing", "Ag&"), None),
}


@pytest.mark.parametrize("name", COUNTED)
def test_levels_are_told_in_vertices_next_to_them(name) -> None:
    make, count = COUNTED[name]
    make()
    bpy.context.scene.nested_cages.levels = "20%, 50%"
    drawn = " ".join(draw())
    if count is None:
        generate("40%")
        count = len(base(made(bpy.context.object.name)[0]))
    assert f"50 % = {round(0.5 * count)}, 20 % = {max(3, round(0.2 * count))} " in drawn and "weight_group" in drawn


@pytest.mark.slow
def test_results_are_short() -> None:
    poly_curve("Drawing", [star()])
    generate("20, 8")
    first, second = (1.0 + certificate(cage).excess for cage in made()[1:])
    drawn = draw()
    assert any("20" in text and f"{100.0 * (first - 1.0):.2g} %" in text for text in drawn)
    assert any("8" in text and f"{100.0 * (first * second - 1.0):.0f} %" in text for text in drawn)  # than the drawing
    assert "object.nested_cages_remove_animation" in drawn
    bind()
    drawn = draw()
    assert not any("error" in line or "Harmonic" in line for line in drawn)


def test_an_outline_that_does_not_fit_is_said_without_numbers_of_loops() -> None:
    own = wire("Mine", [0.1 * star() + 5.0])
    choose(own, poly_curve("Drawing", [star()]))
    generate(use_selected_as_levels=True)
    assert certificate(made()[1]).notes and not any(char.isdigit() for char in certificate(made()[1]).notes[0])
    choose(wire("Eight", [drawings.circle(4)[[0, 2, 1, 3]]]))
    with refused("'Eight'"):
        generate("4")
    assert SHOW in draw()


def test_a_shortcut_uses_the_values_of_the_panel(window) -> None:
    """Nothing is remembered from the last time; what a shortcut gives itself counts."""
    known = bpy.ops.object.nested_cages_generate.get_rna_type().properties
    assert all(known[name].is_skip_save for name in own_settings())
    settings = bpy.context.scene.nested_cages
    settings.levels, settings.clearance, settings.inside = "18", 0.25, True
    poly_curve("Drawing", [star()])
    operator = window.operator("generate", clearance=0.01)
    window.invoke(operator)
    window.finish(operator)
    _, cage = made(inside=True)
    assert len(cage.data.vertices) == 18 and 0.01 <= certificate(cage).clearance < 0.25


def test_the_panels_are_in_the_tab_of_the_preferences(extension) -> None:
    addon = bpy.context.preferences.addons.new()
    addon.module = extension.__name__
    try:
        for tab, shown in (("Animation", "Animation"), ("", "Nested Cages")):
            addon.preferences.category = tab
            extension.unregister()
            extension.register()
            assert {panel.bl_category for panel in sidebar()} == {shown}
    finally:
        bpy.context.preferences.addons.remove(addon)
