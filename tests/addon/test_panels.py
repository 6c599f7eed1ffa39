"""The panels draw without a window: a layout that checks that all names are known to Blender stands in for one."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import bpy
import pytest

from drawings import poly_curve, star


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

    def label(self, text: str = "", **_named: Any) -> None:
        self.drawn.append(text)

    def prop(self, data: Any, name: str, **_named: Any) -> None:
        assert name in data.bl_rna.properties
        self.drawn.append(name)

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
        panel.draw(SimpleNamespace(layout=Layout(drawn), names=getattr(panel, "names", ())), bpy.context)
        return drawn

    return drawn_by


def test_the_panel_shows_the_settings_and_the_list_once_there_is_one(draw) -> None:
    drawn = draw("VIEW3D_PT_nested_cages")
    assert {"levels", "energy", "ease", "loop_back", "object.nested_cages_generate"} <= set(drawn)
    assert "level_list" not in drawn
    bpy.ops.scene.nested_cages_level_add()
    assert "level_list" in draw("VIEW3D_PT_nested_cages")
    assert "resolution" in draw("VIEW3D_PT_nested_cages_reading")


def test_every_setting_is_in_one_of_the_panels_and_in_the_redo_panel(draw, addon) -> None:
    names = sorted(set(addon.properties.settings.NAMES) - {"level_objects"})
    parts = ("", "_reading", "_advanced")
    drawn = [name for part in parts for name in draw(f"VIEW3D_PT_nested_cages{part}")]
    assert sorted(name for name in drawn if name in names) == names
    drawn = []
    operator, settings = bpy.ops.object.nested_cages_generate.get_rna_type(), bpy.context.scene.nested_cages
    values = SimpleNamespace(bl_rna=operator, layout=Layout(drawn), **{n: getattr(settings, n) for n in names})
    addon.operators.generate.OBJECT_OT_nested_cages_generate.draw(values, bpy.context)
    assert sorted(name for name in drawn if name in names) == names


def test_the_panel_shows_the_length_as_soon_as_it_is_known(draw) -> None:
    poly_curve("Drawing", [star()])
    assert not any(text.startswith("Length") for text in draw("VIEW3D_PT_nested_cages"))
    bpy.ops.object.nested_cages_generate(levels="20")
    settings, end = bpy.context.scene.nested_cages, bpy.data.collections["Drawing Cages"]["nested_cages_end"]
    assert f"Length as before: {end} frames, {end / 24:.1f} s" in draw("VIEW3D_PT_nested_cages")
    settings.loop_back = True
    assert f"Length as before: {2 * end + 3} frames, {(2 * end + 3) / 24:.1f} s" in draw("VIEW3D_PT_nested_cages")


def test_results_are_shown_with_and_without_animation(draw) -> None:
    poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20")
    assert "Frames" in draw("VIEW3D_PT_nested_cages_result")
    assert {"object.nested_cages_bake_action", "object.nested_cages_remove_animation"} <= set(
        draw("VIEW3D_PT_nested_cages_use")
    )
    bpy.ops.object.nested_cages_remove_animation()
    drawn = draw("VIEW3D_PT_nested_cages_result")
    assert "Frames" not in drawn and "Excess" in drawn


@pytest.mark.parametrize("kind", ["COUNT", "PERCENT", "OBJECT"])
def test_each_level_is_a_line(extension, kind) -> None:
    bpy.ops.scene.nested_cages_level_add()
    settings = bpy.context.scene.nested_cages
    settings.level_list[0].kind = kind
    drawn: list[str] = []
    levels = sys.modules[f"{extension.__name__}.addon.ui.panels"].NESTEDCAGES_UL_levels
    levels.draw_item(None, None, Layout(drawn), settings, settings.level_list[0], 0, settings, "level_index")
    assert drawn == ["kind", {"COUNT": "count", "PERCENT": "percent", "OBJECT": "own"}[kind]]
