"""Sets up a Blender window for the pictures of the guide, and saves parts of it."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
GUIDE = ROOT / "docs" / "guide"
TAB = "Nested Cages"
GREEN = (0.27, 0.62, 0.47, 1.0)

Steps = Iterator[float]
"""Seconds to wait, so that Blender can draw, before a picture goes on."""

Picture = Callable[[], Steps]


def register_extension() -> ModuleType:
    """The extension from the repository."""
    spec = importlib.util.spec_from_file_location(
        "nested_cages", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
    )
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["nested_cages"] = module
    spec.loader.exec_module(module)
    module.register()
    return module


def view() -> tuple[Any, Any, Any]:
    """Window, area and region of the 3D view."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return window, area, next(region for region in area.regions if region.type == "WINDOW")


def override() -> Any:
    window, area, region = view()
    return bpy.context.temp_override(window=window, area=area, region=region)


def clear(opened: str = "result") -> Steps:
    """A new scene, seen from the top, with the sidebar open and one panel open in it next to the first."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    panels = sys.modules["nested_cages.addon.ui.panels"]
    panels.unregister()
    for name in ("animation", "rules", "reading", "result", "use"):
        getattr(panels, f"VIEW3D_PT_nested_cages_{name}").bl_options = set() if name == opened else {"DEFAULT_CLOSED"}
    panels.register()
    subprocess.run(["xdotool", "mousemove", "640", "400"], check=True)  # dialogs open there
    yield 0.5
    _, area, _ = view()
    space = area.spaces.active
    space.show_region_ui = True
    space.overlay.show_cursor = space.overlay.show_floor = False
    space.shading.color_type, space.shading.wireframe_color_type = "OBJECT", "OBJECT"


def look(distance: float, place: tuple[float, float] = (0.0, 0.0)) -> None:
    """From the top, with the drawing left of the sidebar."""
    _, area, _ = view()
    region = area.spaces.active.region_3d
    region.view_rotation, region.view_perspective = (1, 0, 0, 0), "ORTHO"
    region.view_distance, region.view_location = distance, (place[0] + 0.14 * distance, place[1], 0.0)


def sidebar() -> Steps:
    """Shows the tab; its names are there once the sidebar was drawn."""
    _, area, _ = view()
    region = next(region for region in area.regions if region.type == "UI")
    for _ in range(20):
        area.tag_redraw()
        yield 0.7
        try:
            region.active_panel_category = TAB
        except AttributeError:  # not yet
            continue
        break
    area.tag_redraw()


def letter(text: str = "&", size: float = 2.0) -> Any:
    """A text, selected and active."""
    data = bpy.data.curves.new(f"Letter {text}", "FONT")
    data.body, data.size = text, size
    obj = bpy.data.objects.new(f"Letter {text}", data)
    return put(obj)


def sign() -> Steps:
    """The sign that most pictures show, seen from the top, with the panel next to it."""
    yield from clear()
    letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()


def outline(name: str, points: np.ndarray, *, filled: bool = True) -> Any:
    """A flat mesh around points (k, 2), with a face if it is filled."""
    data, count = bpy.data.meshes.new(name), len(points)
    edges = [] if filled else [(k, (k + 1) % count) for k in range(count)]
    data.from_pydata([(x, y, 0.0) for x, y in points], edges, [list(range(count))] if filled else [])
    return put(bpy.data.objects.new(name, data))


def spline(name: str, points: np.ndarray, *, closed: bool = True, bezier: bool = False) -> Any:
    """A curve through points (k, 2), with smooth handles if it is a Bezier curve."""
    data = bpy.data.curves.new(name, "CURVE")
    made = data.splines.new("BEZIER" if bezier else "POLY")
    on = made.bezier_points if bezier else made.points
    on.add(len(points) - 1)
    for point, (x, y) in zip(on, points, strict=True):
        point.co = (x, y, 0.0) if bezier else (x, y, 0.0, 1.0)
        if bezier:
            point.handle_left_type = point.handle_right_type = "AUTO"
    made.use_cyclic_u = closed
    return put(bpy.data.objects.new(name, data))


def put(obj: Any) -> Any:
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    only(obj)
    obj.color = GREEN
    return obj


def only(*objects: Any) -> None:
    """Selects these objects alone; the last one is active."""
    for other in bpy.context.view_layer.objects:
        other.select_set(other in objects)
    bpy.context.view_layer.objects.active = objects[-1]


def generate(**settings: Any) -> None:
    """As the button does, and the panel shows these settings."""
    panel = bpy.context.scene.nested_cages
    for name, value in settings.items():
        setattr(panel, name, value)
    with override():
        bpy.ops.object.nested_cages_generate("EXEC_DEFAULT", fit_length=True, **settings)


Box = tuple[int, int, int, int]
"""Left, top, right and bottom of a part of the window, in pixels."""


def shoot(name: str, box: Box | None = None) -> Steps:
    """Save the window, or a part of it, as a picture of the guide."""
    window = bpy.context.window_manager.windows[0]
    for _ in range(3):  # a panel that has changed its height takes its place when it is drawn again
        for area in window.screen.areas:
            area.tag_redraw()
        yield 0.5
    left, top, right, bottom = box or (0, 0, window.width, window.height)
    crop = f"{right - left}x{bottom - top}+{left}+{top}"
    # Blender's own screenshot is black where there is no graphics card
    subprocess.run(["import", "-window", "root", "-crop", crop, "+repage", str(GUIDE / f"{name}.png")], check=True)
    print(f"{name} saved", flush=True)


def region_box(height: int, area_type: str = "VIEW_3D", region_type: str = "UI") -> Box:
    """The upper part of a region, of the sidebar if nothing else is said."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == area_type)
    region = next(region for region in area.regions if region.type == region_type)
    top = window.height - (region.y + region.height)
    return region.x, top, region.x + region.width, top + min(height, region.height)


def creature(count: int = 240) -> np.ndarray:
    """(count, 2) outline of a round body with a beak and two feet, not quite symmetric."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    radius = 1.0 + 0.22 * np.exp(-(((angles - 0.35) / 0.12) ** 2)) + 0.12 * np.cos(3 * angles + 0.4)
    radius += 0.25 * np.exp(-(((angles - 4.3) / 0.1) ** 2)) + 0.25 * np.exp(-(((angles - 5.1) / 0.1) ** 2))
    radius += 0.035 * np.cos(17 * angles)
    return np.column_stack((radius * np.cos(angles), radius * np.sin(angles)))


def coast(count: int = 9000) -> np.ndarray:
    """(count, 2) a rugged closed line, large enough that its cages take seconds."""
    rng = np.random.default_rng(3)
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    radius = np.ones(count)
    for k in range(1, 60):
        radius += 0.45 / k**1.35 * np.cos(k * angles + rng.uniform(0.0, 2.0 * np.pi)) * 0.35
    return np.column_stack((radius * np.cos(angles), radius * np.sin(angles)))
