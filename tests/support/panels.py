"""Panels, menus and dialogs drawn without a window, by a layout that knows Blender's names and notes what is drawn."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import bpy


class Layout:
    """Takes what is drawn and notes labels, properties and operators; `given`: values that buttons were given."""

    def __init__(self, drawn: list[str], given: list[tuple[str, str, Any]] | None = None, button: str = "") -> None:
        self.__dict__.update(drawn=drawn, given=[] if given is None else given, button=button)

    def _part(self, button: str = "") -> Layout:
        return Layout(self.drawn, self.given, button)

    def __getattr__(self, _name: str) -> Any:
        return lambda *_arguments, **_named: self._part()

    def __setattr__(self, name: str, value: Any) -> None:
        if self.button:
            self.given.append((self.button, name, value))

    def panel(self, _identifier: str, **_named: Any) -> tuple[Layout, Layout]:
        return self._part(), self._part()

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
        return self._part(name)

    def operator_menu_enum(self, name: str, prop: str, **_named: Any) -> None:
        assert prop in getattr(bpy.ops.object, name.partition(".")[2]).get_rna_type().properties
        self.drawn.append(name)

    def template_list(self, kind: str, _id: str, data: Any, name: str, active: Any, index: str, **_named: Any) -> None:
        assert hasattr(bpy.types, kind)
        assert name in data.bl_rna.properties and index in active.bl_rna.properties
        self.drawn.append(name)


def own_settings() -> list[str]:
    """The settings that Generate and the scene share."""
    operator = bpy.ops.object.nested_cages_generate.get_rna_type().properties
    scene = bpy.context.scene.nested_cages.bl_rna.properties
    return sorted({prop.identifier for prop in operator} & {prop.identifier for prop in scene} - {"rna_type", "name"})


def ours(base: type) -> list[Any]:
    """The registered panels or menus of the add-on, by name."""
    return [getattr(bpy.types, name) for name in sorted(dir(bpy.types)) if "nested_cages" in name.lower()
            and issubclass(getattr(bpy.types, name), base)]  # fmt: skip


def draw(*kinds: Any, given: list[tuple[str, str, Any]] | None = None) -> list[str]:
    """What these panels or menus draw, those that show now; all panels of the sidebar if none are named."""
    bpy.context.view_layer.update()
    drawn: list[str] = []
    for kind in kinds or sidebar():
        if shows(kind):
            kind.draw(SimpleNamespace(layout=Layout(drawn, given), bl_label=kind.bl_label), bpy.context)
    return drawn


def shows(kind: Any) -> bool:
    """Whether a panel shows now."""
    return not hasattr(kind, "poll") or bool(kind.poll(bpy.context))


def sidebar() -> list[Any]:
    """The panels of the sidebar of the 3D view, those that others are in first."""
    panels = [each for each in ours(bpy.types.Panel) if each.bl_space_type == "VIEW_3D" and each.bl_region_type == "UI"]
    return sorted(panels, key=lambda each: bool(getattr(each, "bl_parent_id", "")))
