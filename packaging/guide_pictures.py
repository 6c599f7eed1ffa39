"""Sets up the pictures of docs/guide that show a Blender window; run by Blender with a window of 1280 x 800 pixels:

    GUIDE_PICTURE=levels blender --factory-startup -p 0 0 1280 800 --python packaging/guide_pictures.py

Blender's own Python needs scipy. When the window shows the picture, "READY levels 735x635+40+85" is printed: its name,
and the part of a screenshot that it is, as ImageMagick's ``convert -crop`` takes it. Look at each before it is
committed. That of the redo panel is there after F9.
"""

from __future__ import annotations

import importlib.util
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

ROOT = Path(__file__).resolve().parents[1]
GUIDE = ROOT / "docs" / "guide"
TAB = "Nested Cages"
GREEN = (0.27, 0.62, 0.47, 1.0)

Steps = Iterator[float]
PICTURES: dict[str, Callable[[], Steps]] = {}


def picture(build: Callable[[], Steps]) -> Callable[[], Steps]:
    """Registers a picture: a generator that yields the seconds to wait before it goes on."""
    PICTURES[build.__name__] = build
    return build


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


def clear() -> None:
    """An empty scene, seen from the top, with the sidebar open."""
    if bpy.context.mode != "OBJECT":
        with override():
            bpy.ops.object.mode_set(mode="OBJECT")
    for blocks in (bpy.data.objects, bpy.data.meshes, bpy.data.curves, bpy.data.collections, bpy.data.actions):
        bpy.data.batch_remove(list(blocks))
    scene = bpy.context.scene
    scene.timeline_markers.clear()
    scene.frame_start, scene.frame_end = 1, 250
    scene.frame_set(1)
    settings = scene.nested_cages
    for name in settings.bl_rna.properties.keys():  # noqa: SIM118
        if name not in ("rna_type", "name"):
            settings.property_unset(name)
    settings.level_list.clear()
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
    area.tag_redraw()
    yield 0.7
    next(region for region in area.regions if region.type == "UI").active_panel_category = TAB
    area.tag_redraw()


def open_panel(name: str) -> None:
    """Shows one closed panel open, and the result closed; before the tab is drawn."""
    panels = sys.modules["nested_cages.addon.ui.panels"]
    panels.unregister()
    getattr(panels, f"VIEW3D_PT_nested_cages_{name}").bl_options = set()
    panels.VIEW3D_PT_nested_cages_result.bl_options = {"DEFAULT_CLOSED"}
    panels.register()


def letter(text: str = "&", size: float = 2.0) -> Any:
    """A text, selected and active."""
    data = bpy.data.curves.new(f"Letter {text}", "FONT")
    data.body, data.size = text, size
    obj = bpy.data.objects.new(f"Letter {text}", data)
    return put(obj)


def outline(name: str, points: np.ndarray, *, filled: bool = True) -> Any:
    """A flat mesh around points (k, 2), with a face if it is filled."""
    data, count = bpy.data.meshes.new(name), len(points)
    edges = [] if filled else [(k, (k + 1) % count) for k in range(count)]
    data.from_pydata([(x, y, 0.0) for x, y in points], edges, [list(range(count))] if filled else [])
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


def shoot(name: str, box: tuple[int, int, int, int] | None = None) -> None:
    """Says that the window shows a picture, and which box of it (left, top, right, bottom) in pixels it is."""
    window = bpy.context.window_manager.windows[0]
    left, top, right, bottom = box or (0, 0, window.width, window.height)
    print(f"READY {name} {right - left}x{bottom - top}+{left}+{top}", flush=True)


def panel_box(bottom: int = 560) -> tuple[int, int, int, int]:
    """The sidebar alone."""
    _, area, _ = view()
    region = next(region for region in area.regions if region.type == "UI")
    window = bpy.context.window_manager.windows[0]
    top = window.height - (region.y + region.height)
    return region.x, top, region.x + region.width, top + bottom


def creature(count: int = 240) -> np.ndarray:
    """(count, 2) outline of a round body with a beak and two feet, not quite symmetric."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    radius = 1.0 + 0.22 * np.exp(-(((angles - 0.35) / 0.12) ** 2)) + 0.12 * np.cos(3 * angles + 0.4)
    radius += 0.25 * np.exp(-(((angles - 4.3) / 0.1) ** 2)) + 0.25 * np.exp(-(((angles - 5.1) / 0.1) ** 2))
    radius += 0.035 * np.cos(17 * angles)
    return np.column_stack((radius * np.cos(angles), radius * np.sin(angles)))


@picture
def panel() -> Steps:
    clear()
    letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    yield 1.0
    shoot("panel")


@picture
def result() -> Steps:
    clear()
    letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    generate(levels="20%, 8%")
    yield 1.5
    shoot("result")


@picture
def levels() -> Steps:
    clear()
    letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    generate(levels="2 cm, +40 %")
    yield 1.5
    shoot("levels")


@picture
def inside() -> Steps:
    clear()
    obj = letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    generate(levels="24")
    only(obj)
    generate(levels="24", inside=True)
    yield 1.5
    shoot("inside")


@picture
def shape() -> Steps:
    clear()
    open_panel("rules")
    points = creature()
    obj = outline("Creature", points)
    group = obj.vertex_groups.new(name="Beak")
    near = np.exp(-((np.hypot(*(points - points[24]).T) / 0.5) ** 2))
    for k, weight in enumerate(near):
        group.add([k], float(max(weight, 0.04)), "REPLACE")
    look(3.4)
    yield from sidebar()
    generate(levels="18", weight_group="Beak")
    with override():
        bpy.ops.object.nested_cages_remove_animation()
    yield 1.5
    shoot("shape")


@picture
def pieces() -> Steps:
    clear()
    letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    generate(levels="30")
    with override():
        bpy.ops.object.nested_cages_pieces(most=6)
    for obj in bpy.data.objects:
        obj.hide_set("Piece" not in obj.name)
    yield 1.5
    shoot("pieces", (0, 30, 775, 720))


@picture
def level_list() -> Steps:
    clear()
    outline("Mine", 1.4 * np.column_stack([np.cos(np.arange(14) / 7 * np.pi), np.sin(np.arange(14) / 7 * np.pi)]))
    letter()
    yield from sidebar()
    panel = bpy.context.scene.nested_cages
    panel.level_objects, panel.levels = "Mine", "32, 5 mm, +25%, *"
    panel.clearance = 0.03
    look(2.6, (0.75, 0.7))
    yield 1.0
    shoot("level_list", panel_box(330))


@picture
def own_before() -> Steps:
    yield from _own()
    shoot("own_before", (40, 85, 775, 720))


@picture
def own_after() -> Steps:
    yield from _own()
    generate(levels="*", level_objects="Mine", use_selected_as_levels=False)
    yield 1.5
    shoot("own_after", (40, 85, 1035, 720))


def _own() -> Steps:
    clear()
    drawing = letter("S")
    angles = np.linspace(0.0, 2.0 * np.pi, 14, endpoint=False)
    circle = np.column_stack([0.95 * np.cos(angles) + 0.58, 0.95 * np.sin(angles) + 0.7])
    only(outline("Mine", circle, filled=False), drawing)
    look(2.6, (0.6, 0.7))
    yield from sidebar()


@picture
def verify() -> Steps:
    yield from _broken()
    with override():
        bpy.ops.object.nested_cages_verify("EXEC_DEFAULT")
    only(bpy.data.objects["Letter &"])
    yield 1.5
    shoot("verify", (40, 85, 1035, 720))


@picture
def faults() -> Steps:
    yield from _broken()
    with override():
        bpy.ops.object.nested_cages_verify("EXEC_DEFAULT")
        bpy.ops.object.mode_set(mode="EDIT")
    yield 1.5
    shoot("faults", (40, 85, 775, 720))


def _broken() -> Steps:
    """A cage with one vertex in the letter."""
    clear()
    letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    generate(levels="20%, 8%")
    with override():
        bpy.ops.object.nested_cages_remove_animation()
    cage = bpy.data.objects["Letter & Cage 1"]
    places = np.array([tuple(vertex.co) for vertex in cage.data.vertices])
    k = int(np.argmax(places[:, 0] - 0.2 * places[:, 1]))
    cage.data.vertices[k].co.x -= 0.35
    cage.data.vertices[k].co.y += 0.12
    cage.data.update()
    yield 1.0


@picture
def advanced() -> Steps:
    clear()
    open_panel("advanced")
    letter()
    yield from sidebar()
    groups = sys.modules["nested_cages.addon.properties.groups"]
    groups.shows_research = lambda: True
    yield 1.0
    shoot("advanced", panel_box(630))


@picture
def use() -> Steps:
    yield from use_bound()
    shoot("use")


def use_bound() -> Steps:
    """The letter, bound to its cages."""
    clear()
    letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    generate(levels="20%, 8%")
    with override():
        bpy.ops.object.nested_cages_bind("EXEC_DEFAULT")
    view()[1].spaces.active.overlay.wireframe_threshold = 0.5  # as the button does
    yield 1.5


@picture
def posed() -> Steps:
    yield from use_bound()
    cage = bpy.data.objects["Letter & Cage 2"]
    only(cage)
    with override():
        bpy.ops.object.nested_cages_add_handles("EXEC_DEFAULT")
        for bone in bpy.context.object.pose.bones:
            lean = Matrix.Translation((0.35 * bone.bone.head_local.y, 0.0, 0.0))
            bone.matrix = lean @ bone.matrix
    yield 1.5
    shoot("posed")


@picture
def playing() -> Steps:
    clear()
    letters = [letter(text) for text in ("A", "g", "&")]
    for obj, x, colour in zip(letters, (0.0, 1.6, 3.1), ((0.7, 0.35, 0.3), (0.3, 0.45, 0.7), GREEN[:3]), strict=True):
        obj.location.x, obj.color = x, (*colour, 1.0)
    only(*letters)
    look(4.6, (2.2, 0.6))
    yield from sidebar()
    generate(levels="40%, 30%")
    bpy.context.scene.frame_set(80)
    yield 1.5
    shoot("playing")


@picture
def running() -> Steps:
    clear()
    outline("Coast", coast())
    look(3.0)
    yield from sidebar()
    bpy.context.scene.nested_cages.levels = "200, 60"
    yield 1.0
    with override():
        bpy.ops.object.nested_cages_generate("INVOKE_DEFAULT", levels="200, 60")
    yield 1.2
    shoot("running", (40, 85, 1035, 720))


def coast(count: int = 9000) -> np.ndarray:
    """(count, 2) a rugged closed line, large enough that its cages take seconds."""
    rng = np.random.default_rng(3)
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    radius = np.ones(count)
    for k in range(1, 60):
        radius += 0.45 / k**1.35 * np.cos(k * angles + rng.uniform(0.0, 2.0 * np.pi)) * 0.35
    return np.column_stack((radius * np.cos(angles), radius * np.sin(angles)))


@picture
def redo() -> Steps:
    clear()
    letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    with override():
        bpy.ops.object.nested_cages_generate("EXEC_DEFAULT", True, levels="20%, 8%", fit_length=True)
    yield 2.0
    shoot("redo")


@picture
def image_dialog() -> Steps:
    clear()
    y, x = np.mgrid[0:128, 0:128]
    pixels = np.zeros((128, 128, 4), np.float32)
    pixels[np.hypot(x - 64, y - 64) < 40 + 10 * np.cos(5 * np.arctan2(y - 64, x - 64))] = (1.0, 0.6, 0.1, 1.0)
    image = bpy.data.images.new("sprite", 128, 128, alpha=True)
    image.pixels.foreach_set(pixels.ravel())
    yield from sidebar()
    yield 0.5
    with override():
        bpy.ops.object.nested_cages_from_image("INVOKE_DEFAULT", image="sprite")
    yield 1.0
    shoot("image_dialog", (340, 340, 690, 585))


@picture
def export() -> Steps:
    clear()
    letter()
    generate(levels="20%, 8%")
    yield 0.5
    with override():
        bpy.ops.object.nested_cages_export("INVOKE_DEFAULT", filepath="/tmp/letter.json", kind="ENGINE")
    yield 2.0
    shoot("export", (945, 130, 1195, 330))


def show(name: str) -> None:
    """Sets a picture up, in slices of a timer."""

    def steps() -> Steps:
        try:
            yield from PICTURES[name]()
        except Exception:
            traceback.print_exc()
            print("READY", flush=True)

    running_steps = steps()
    bpy.app.timers.register(lambda: next(running_steps, None), first_interval=1.0)


if __name__ == "__main__":
    bpy.context.preferences.view.show_splash = False
    register_extension()
    show(os.environ["GUIDE_PICTURE"])
