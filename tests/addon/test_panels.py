"""The panels draw without a window: a layout that checks that all names are known to Blender stands in for one."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest

from support.drawings import bezier_circle, choose, circle, facts, grid_face, poly_curve, star, text, wire
from support.marks import slow_after


class Layout:
    """Takes what panels draw and notes labels, properties and operators."""

    def __init__(self, drawn: list[str]) -> None:
        object.__setattr__(self, "drawn", drawn)

    def __getattr__(self, _name: str) -> Any:
        return lambda *_arguments, **_named: Layout(self.drawn)

    def __setattr__(self, name: str, value: Any) -> None:
        """Settings of the layout and of operators are not looked at."""

    def panel(self, _identifier: str, **_named: Any) -> tuple[Layout, Layout]:
        return Layout(self.drawn), Layout(self.drawn)

    def menu(self, name: str, **_named: Any) -> None:
        assert hasattr(bpy.types, name)
        self.drawn.append(name)

    def label(self, text: str = "", **_named: Any) -> None:
        self.drawn.append(text)

    def prop(self, data: Any, name: str, **_named: Any) -> None:
        assert name in data.bl_rna.properties
        self.drawn.append(name)

    def prop_search(self, data: Any, name: str, found_in: Any, collection: str, **_named: Any) -> None:
        assert hasattr(found_in, collection)
        self.prop(data, name)

    def operator(self, name: str, **_named: Any) -> Layout:
        group, _, operator = name.partition(".")
        getattr(getattr(bpy.ops, group), operator).get_rna_type()
        self.drawn.append(name)
        return Layout(self.drawn)

    def operator_menu_enum(self, name: str, prop: str, **_named: Any) -> None:
        assert prop in getattr(bpy.ops.object, name.partition(".")[2]).get_rna_type().properties
        self.drawn.append(name)

    def template_list(self, kind: str, _id: str, data: Any, name: str, active: Any, index: str, **_named: Any) -> None:
        assert hasattr(bpy.types, kind)
        assert name in data.bl_rna.properties and index in active.bl_rna.properties
        self.drawn.append(name)


@pytest.fixture
def draw(extension):
    """Draws the panel of a name; what it drew."""
    panels = sys.modules[f"{extension.__name__}.addon.ui.panels"]

    def drawn_by(name: str) -> list[str]:
        drawn: list[str] = []
        panel = getattr(panels, name)
        panel.draw(SimpleNamespace(layout=Layout(drawn), bl_label=panel.bl_label), bpy.context)
        return drawn

    return drawn_by


def test_the_panel_shows_the_settings(draw) -> None:
    poly_curve("Drawing", [star()])
    drawn = draw("VIEW3D_PT_nested_cages")
    assert {"levels", "clearance", "object.nested_cages_generate", "object.nested_cages_bind"} <= set(drawn)
    assert not {"energy", "fit_length", "shrink", "as_published"} & set(drawn)
    assert {"fit_length", "show_flow", "shrink"} <= set(draw("VIEW3D_PT_nested_cages_animation"))
    assert "resolution" in draw("VIEW3D_PT_nested_cages_reading")


def squares(*places: float) -> list[Any]:
    """Overlapping or separate faces, all selected."""
    made = [grid_face(f"Part {number}", 1) for number, _ in enumerate(places)]
    for obj, x in zip(made, places, strict=True):
        obj.location = (x, 0.0, 0.01 * x)
    bpy.context.view_layer.update()
    return made


def image_empty() -> None:
    obj = bpy.data.objects.new("Sprite", None)
    obj.empty_display_type, obj.data = "IMAGE", bpy.data.images.new("sprite", 8, 8, alpha=True)
    bpy.context.scene.collection.objects.link(obj)
    obj.select_set(True)


def rigged() -> None:
    squares(0.0, 0.8, 1.6)
    assert bpy.ops.object.nested_cages_rig() == {"FINISHED"}


def cut_out() -> None:
    image_empty()
    bpy.data.images["sprite"].pixels.foreach_set([1.0] * 256)
    assert bpy.ops.object.nested_cages_cutout(levels="4") == {"FINISHED"}


def handles() -> None:
    poly_curve("Drawing", [star()])
    assert bpy.ops.object.nested_cages_generate(levels="8") == {"FINISHED"}
    assert bpy.ops.object.nested_cages_bind() == bpy.ops.object.nested_cages_add_handles() == {"FINISHED"}
    assert bpy.context.mode == "POSE"


def own_outline() -> None:
    squares(0.0, 0.5)
    bpy.context.scene.nested_cages.use_selected_as_levels = True


# What is selected, the title of the door that opens, and the button to press, which is the first in it.
FITTING = {
    "nothing": (lambda: None, "", ""),
    "a camera": (bpy.ops.object.camera_add, "", ""),
    "a drawing": (lambda: poly_curve("Drawing", [star()]), "CAGES", "generate"),
    "drawings side by side": (lambda: squares(0.0, 2.0, 4.0), "CAGES", "generate"),
    "overlapping parts": (lambda: squares(0.0, 0.5, 1.0), "RIG", "puppet"),
    "an armature": (bpy.ops.object.armature_add, "RIG", "rig"),
    "a picture": (image_empty, "PICTURE", "cutout"),
    "a rig in Pose Mode": (rigged, "RIG", "rig"),
    "a cutout in Pose Mode": (cut_out, "PICTURE", "cutout"),
    "handles in Pose Mode": (handles, "CAGES", "generate"),
    "an outline of one's own": (own_outline, "CAGES", "generate"),
}


@pytest.mark.parametrize("name", slow_after(7, FITTING))
def test_the_door_that_fits_is_open_and_its_first_button_is_the_one_to_press(draw, addon, name) -> None:
    select, door, button = FITTING[name]
    select()
    assert addon.ui.doors.opened(bpy.context) == door
    drawn = draw("VIEW3D_PT_nested_cages")
    assert drawn[:3] == ["scene.nested_cages_door"] * 3
    pressed = next(each for each in drawn if each.startswith("object."))
    assert pressed == f"object.nested_cages_{button or 'import'}"
    operator = getattr(bpy.ops.object, pressed.partition(".")[2])
    assert operator.poll() or bpy.context.mode == "POSE" or name == "an armature"
    assert (addon.ui.doors.NOTHING in drawn) == (not door)


def test_a_door_opened_by_hand_stays_until_another_one_fits(addon) -> None:
    doors = addon.ui.doors
    drawing = poly_curve("Drawing", [star()])
    bpy.ops.scene.nested_cages_door(door="RIG")
    assert doors.opened(bpy.context) == "RIG"
    image_empty()
    drawing.select_set(False)
    assert doors.opened(bpy.context) == "PICTURE"


@pytest.mark.slow
def test_buttons_stay_in_their_places_whatever_is_selected(draw, addon) -> None:
    """What is drawn above and between the buttons of an open door does not depend on the selection."""
    places = set()
    poly_curve("Drawing", [star()])
    for step in (
        lambda: None,
        lambda: bpy.ops.object.nested_cages_generate(levels="20, 10"),
        lambda: choose(bpy.data.objects["Drawing Cage 1"]),
        bpy.ops.object.nested_cages_bind,
        lambda: choose(bpy.data.objects["Drawing"]),
        lambda: squares(4.0, 8.0),
    ):
        step()
        drawn = draw("VIEW3D_PT_nested_cages")
        places.add(tuple((k, each) for k, each in enumerate(drawn) if "nested_cages" in each))
    assert len(places) == 1


def test_every_setting_is_in_one_of_the_panels_and_in_the_redo_panel(draw, addon) -> None:
    poly_curve("Drawing", [star()])
    names = sorted(set(addon.properties.settings.NAMES) - {"level_objects"})
    parts = ("", "_animation", "_rules", "_reading")
    drawn = [name for part in parts for name in draw(f"VIEW3D_PT_nested_cages{part}")]
    assert sorted(name for name in drawn if name in names) == names
    drawn = []
    operator, settings = bpy.ops.object.nested_cages_generate.get_rna_type(), bpy.context.scene.nested_cages
    values = SimpleNamespace(bl_rna=operator, layout=Layout(drawn), **{n: getattr(settings, n) for n in names})
    addon.operators.generate.OBJECT_OT_nested_cages_generate.draw(values, bpy.context)
    assert sorted(name for name in drawn if name in names) == names


def test_the_panel_shows_the_length_as_soon_as_it_is_known(draw) -> None:
    poly_curve("Drawing", [star()])
    assert not any(text.startswith("Length") for text in draw("VIEW3D_PT_nested_cages_animation"))
    bpy.ops.object.nested_cages_generate(levels="20")
    settings, end = bpy.context.scene.nested_cages, facts(bpy.data.collections["Drawing Cages"])["end"]
    assert "Length as before: 120 frames, 5.0 s" in draw("VIEW3D_PT_nested_cages_animation")
    settings.fit_length = False
    assert f"Length as before: {end} frames, {end / 24:.1f} s" in draw("VIEW3D_PT_nested_cages_animation")


COUNTED = {
    "curve": (lambda: poly_curve("Drawing", [star(465)]), 465),
    "Bezier curve": (lambda: bezier_circle("Drawing", resolution=12), 48),
    "edges": (lambda: wire("Drawing", [star(60), circle(12, 0.3)]), 72),
    "faces": (lambda: grid_face("Drawing", 4), 16),
    "text": (lambda: text("Drawing", "Ag&"), None),
}


@pytest.mark.parametrize("name", COUNTED)
def test_levels_are_told_in_vertices_beside_them(draw, addon, name) -> None:
    make, count = COUNTED[name]
    obj = make()
    if count is None:
        count = len(addon.scene.convert.read(bpy.context, obj).points)
    bpy.context.scene.nested_cages.levels = "20%, 50%"
    drawn = draw("VIEW3D_PT_nested_cages")
    assert f"50 % = {round(0.5 * count)}, 20 % = {max(3, round(0.2 * count))} vertices" in drawn


def test_levels_are_told_for_all_selected_drawings(draw) -> None:
    for count in (40, 300, 100):
        poly_curve("Drawing", [star(count)]).location.x = count
    bpy.context.view_layer.update()
    bpy.context.scene.nested_cages.levels = "20%, 2"
    assert "20 % = 8 to 60 vertices" in draw("VIEW3D_PT_nested_cages")
    bpy.context.scene.nested_cages.levels = "10"
    assert "of 40 to 300 vertices" in draw("VIEW3D_PT_nested_cages")


@pytest.mark.slow
def test_results_are_short_and_the_numbers_are_in_a_report(draw) -> None:
    poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20, 8")
    first, second = (1.0 + facts(bpy.data.objects[f"Drawing Cage {k}"])["excess"] for k in (1, 2))
    drawn = draw("VIEW3D_PT_nested_cages_result")
    assert f"Cage 1: 20 vertices, {100.0 * (first - 1.0):.2g} % larger" in drawn
    assert f"Cage 2: 8 vertices, {100.0 * (first * second - 1.0):.0f} % larger" in drawn  # than the drawing
    assert "object.nested_cages_remove_animation" in draw("VIEW3D_PT_nested_cages_animation")
    bpy.ops.object.nested_cages_bind()
    drawn = draw("VIEW3D_PT_nested_cages_result")
    assert not any("error" in line or "Harmonic" in line for line in drawn)
    assert {"object.nested_cages_add_handles", "object.nested_cages_unbind"} <= set(draw("VIEW3D_PT_nested_cages"))
    assert bpy.ops.object.nested_cages_report() == {"FINISHED"}
    report = bpy.data.texts["Nested Cages Report"].as_string()
    for words in ("Drawing Cage 1", "clearance: ", "at rest", "Certified as stored"):
        assert words in report


@pytest.mark.slow
def test_a_button_takes_the_better_count(draw, monkeypatch) -> None:
    """Thirteen vertices cannot follow the sixteen corners of four squares."""
    squares = [
        np.array([[0.0, 0.0], [1.4, 0.0], [1.4, 1.4], [0.0, 1.4]]) + np.array([3.0 * x, 3.0 * y])
        for x, y in np.ndindex(2, 2)
    ]
    poly_curve("Drawing", squares)
    bpy.ops.object.nested_cages_generate(levels="13")
    buttons: list[str] = []
    monkeypatch.setattr(Layout, "__setattr__", lambda _self, name, value: name == "levels" and buttons.append(value))
    drawn = draw("VIEW3D_PT_nested_cages_result")
    assert buttons == ["16"] and "object.nested_cages_generate" in drawn
    bpy.ops.object.nested_cages_generate(levels=buttons[0])
    buttons.clear()
    draw("VIEW3D_PT_nested_cages_result")
    assert not buttons and len(bpy.data.objects["Drawing Cage 1"].data.vertices) == 16


def test_sizes_are_over_the_drawing_on_each_level(addon) -> None:
    text("Text", "Hi")
    bpy.ops.object.nested_cages_generate(levels="20%, 8%")
    nodes = [addon.record.node_of(bpy.data.objects[f"Text Cage {number}"]) for number in (1, 2)]
    size = (1.0 + nodes[0].excess) * (1.0 + nodes[1].excess)
    (told,) = (data for code, data in addon.record.notes(nodes[1]) if code == "note.knee")
    assert told["excess"] == pytest.approx(size - 1.0, rel=1e-4) and 0.0 < told["less"] < told["excess"]


def test_a_crossing_is_marked_where_it_is(addon) -> None:
    poly_curve("Eight", [np.array([(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)])])
    with pytest.raises(RuntimeError, match="'Eight' crosses or touches itself: move points apart"):
        bpy.ops.object.nested_cages_generate()
    assert addon.operators.base.last_fault[0].places[0] == (1.0, 1.0, 0.0)


@pytest.mark.parametrize("fall_back", [True, False])
def test_an_outline_that_does_not_fit_is_said_without_numbers_of_loops(addon, capfd, fall_back) -> None:
    own = wire("Mine", [0.1 * star() + 5.0])
    choose(own, poly_curve("Drawing", [star()]))
    bpy.context.view_layer.objects.active = bpy.data.objects["Drawing"]
    options = {"use_selected_as_levels": True, "fall_back": fall_back}
    if fall_back:
        bpy.ops.object.nested_cages_generate(**options)
        health = addon.ui.results.health(bpy.context, bpy.data.objects["Drawing Cage 1"])[1]
        assert health.startswith("Your outline could not be used") and "loop" not in capfd.readouterr().out
        return
    with pytest.raises(RuntimeError, match="'Drawing', cage 1: your outline has not the parts and holes of the draw"):
        bpy.ops.object.nested_cages_generate(**options)
    assert addon.operators.base.last_fault[0].places


def test_a_fault_is_offered_in_the_panel(draw, addon) -> None:
    addon.operators.base.last_fault.clear()
    assert "object.nested_cages_select_fault" not in draw("VIEW3D_PT_nested_cages")
    poly_curve("Open", [star()], cyclic=False)
    with pytest.raises(RuntimeError):
        bpy.ops.object.nested_cages_generate()
    assert "object.nested_cages_select_fault" in draw("VIEW3D_PT_nested_cages")
