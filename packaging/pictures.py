"""Makes the pictures of the documentation: ``make pictures``.

    python packaging/pictures.py [NAME ...]
    blender --factory-startup -p 0 0 1280 800 --python packaging/pictures.py -- [NAME ...]

By Python with bpy and the extra ``examples``: those of README and gallery, from the examples. By a Blender 5.2 with a
window of 1280 x 800 pixels: those of the guide. It needs scipy, shapely and tinycss2 in Blender's own Python, an X
screen as large as its window, xdotool, and ImageMagick's `import`. Look at each before it is committed.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

ROOT = Path(__file__).resolve().parents[1]
DOCS, GUIDE, STORIES = ROOT / "docs", ROOT / "docs" / "guide", ROOT / "build" / "stories"
TAB = "Nested Cages"
GREEN = (0.27, 0.62, 0.47, 1.0)
TEXTS = (b"tEXt", b"zTXt", b"iTXt")
"""Chunks of a PNG that hold texts, such as the path that Blender rendered it to."""

Steps = Iterator[float]
"""Seconds to wait, so that Blender can draw, before a picture goes on."""

Picture = Callable[[], Steps]

Box = tuple[int, int, int, int]
"""Left, top, right and bottom of a part of the window, in pixels."""

PICTURES: dict[str, Picture] = {}


def picture(build: Picture) -> Picture:
    """Register a picture of the guide: a generator of the seconds to wait before it goes on."""
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


def clear(opened: str = "result") -> Steps:
    """A new scene, seen from the top, with the sidebar open and one panel open in it next to the first."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    panels = sys.modules["nested_cages.addon.ui.panels"]
    panels.unregister()
    for name in ("constraints", "animation", "advanced", "result"):
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
        bpy.ops.object.nested_cages_generate("EXEC_DEFAULT", **{"length": 120, **settings})


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


@picture
def live() -> Steps:
    yield from clear()
    angles = np.arange(12) / 6.0 * np.pi
    radius = np.where(np.arange(12) % 2, 0.62, 1.0)[:, None]
    leaf = spline("Leaf", radius * np.column_stack((np.cos(angles), np.sin(angles))), bezier=True)
    look(3.4)
    yield from sidebar()
    generate(levels="32")
    only(leaf)
    with override():
        bpy.ops.object.nested_cages_live("EXEC_DEFAULT")
    leaf.data.splines[0].bezier_points[0].handle_right_type = "FREE"
    leaf.data.splines[0].bezier_points[0].select_right_handle = True
    with override():
        bpy.ops.object.mode_set(mode="EDIT")
    for _ in range(8):  # as a handle is dragged
        leaf.data.splines[0].bezier_points[0].handle_right += Vector((0.03, 0.06, 0.0))
        leaf.data.update_tag()
        yield 0.2
    yield 2.0
    yield from shoot("live", (56, 85, 1035, 720))


@picture
def cutout() -> Steps:
    yield from clear()
    with tempfile.TemporaryDirectory() as folder:
        image = fish()
        image.filepath_raw, image.file_format = str(Path(folder) / "fish.png"), "PNG"
        image.save()
        with override():
            bpy.ops.object.nested_cages_cutout("EXEC_DEFAULT", filepath=image.filepath_raw, levels="16")
            bpy.ops.object.mode_set(mode="POSE")
    bones = bpy.context.object.pose.bones
    size = max(np.ptp([tuple(bone.bone.head_local) for bone in bones], axis=0))
    for bone in bones:
        if bone.bone.head_local.x > 0.62 * max(each.bone.head_local.x for each in bones):
            bone.matrix.translation.y += 0.2 * size
    shading = view()[1].spaces.active.shading
    shading.color_type, shading.light = "TEXTURE", "FLAT"
    look(1.5 * size)
    with override():
        bpy.ops.view3d.view_axis(type="FRONT")
    yield 1.0
    yield from shoot("cutout", (56, 85, 775, 720))


def fish(size: int = 512) -> Any:
    """An image with a transparent background."""
    y, x = np.mgrid[-1.0 : 1.0 : size * 1j, -1.0 : 1.0 : size * 1j]
    pixels = np.zeros((size, size, 4), np.float32)
    body = np.hypot((x + 0.2) / 0.65, y / 0.36) < 1.0
    tail = (x > 0.3) & (x < 0.85) & (np.abs(y) < 0.08 + 0.55 * (x - 0.35))
    fins = (np.abs(x + 0.1 + 0.35 * np.abs(y)) < 0.5 * (0.6 - np.abs(y))) & (np.abs(y) < 0.6)
    pixels[tail | fins] = (0.85, 0.32, 0.1, 1.0)
    pixels[body] = (0.97, 0.55, 0.2, 1.0)
    pixels[body & (np.abs((x + 0.32) % 0.3 - 0.15) < 0.05) & (x > -0.35)] = (1.0, 0.9, 0.8, 1.0)
    for radius, colour in ((0.09, (1.0, 1.0, 1.0, 1.0)), (0.045, (0.05, 0.05, 0.1, 1.0))):
        pixels[np.hypot(x + 0.6, y - 0.08) < radius] = colour
    image = bpy.data.images.new("fish", size, size, alpha=True)
    image.pixels.foreach_set(pixels.ravel())
    return image


@picture
def silhouette() -> Steps:
    yield from clear()
    angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    circle = np.column_stack((np.cos(angles), np.sin(angles)))
    parts = [
        outline(name, circle * size + place)
        for name, size, place in (
            ("Arm L", (0.5, 0.15), (-0.65, 0.2)),
            ("Arm R", (0.5, 0.15), (0.65, 0.2)),
            ("Head", (0.45, 0.45), (0.0, 1.15)),
            ("Body", (0.6, 0.85), (0.0, 0.0)),
        )
    ]
    colours = ((0.65, 0.4, 0.35), (0.65, 0.4, 0.35), (0.7, 0.65, 0.55), (0.35, 0.5, 0.65))
    for k, (obj, colour) in enumerate(zip(parts, colours, strict=True)):
        obj.color, obj.location.z = (*colour, 1.0), 0.01 * k
    parts.insert(0, hat())
    only(*parts)
    with override():
        bpy.ops.object.nested_cages_import("EXEC_DEFAULT", outlines="SELECTED", plane="TOP")
    made = bpy.context.object
    made.location.x = 2.6
    made.color = (0.35, 0.5, 0.65, 1.0)
    generate(levels="32", clearance=0.04)
    look(6.4, (1.5, 0.6))
    yield from sidebar()
    yield from shoot("silhouette", (56, 85, 775, 720))


def hat() -> Any:
    """A stroke of Grease Pencil."""
    data = bpy.data.grease_pencils.new("Hat")
    drawing = data.layers.new("Layer").frames.new(1).drawing
    drawing.add_strokes([5])
    places = ((-0.55, 1.55), (-0.25, 1.7), (0.0, 2.1), (0.25, 1.7), (0.55, 1.55))
    for point, (x, y) in zip(drawing.strokes[0].points, places, strict=True):
        point.position, point.radius = (x, y, 0.05), 0.07
    material = bpy.data.materials.new("Ink")
    bpy.data.materials.create_gpencil_data(material)
    material.grease_pencil.color = (0.3, 0.08, 0.4, 1.0)
    data.materials.append(material)
    return put(bpy.data.objects.new("Hat", data))


@picture
def message() -> Steps:
    yield from clear()
    spline("Line", np.array([(-1.0, -0.6), (-0.4, 0.7), (0.4, -0.3), (1.0, 0.6)]), closed=False)
    look(3.0)
    yield from sidebar()
    yield 1.0
    # an error opens its window only for a button that a mouse has pressed
    subprocess.run(["xdotool", "mousemove", "900", "159", "sleep", "0.5", "click", "1"], check=True)
    yield 2.0
    yield from shoot("message", (450, 95, 1035, 280))


@picture
def image_dialog() -> Steps:
    yield from clear()
    shown = bpy.data.objects.new("fish", None)
    shown.empty_display_type, shown.data = "IMAGE", fish(128)
    put(shown)
    yield from sidebar()
    yield 0.5
    with override():
        bpy.ops.object.nested_cages_import("INVOKE_DEFAULT", outlines="SELECTED")
    yield from shoot("image_dialog", (340, 340, 690, 585))


@picture
def export() -> Steps:
    yield from clear()
    letter()
    generate(levels="20%, 8%")
    yield 0.5
    with override():
        bpy.ops.object.nested_cages_export("INVOKE_DEFAULT", filepath="//letter.geojson", kind="GEOJSON")
    yield 2.0
    yield from shoot("export", region_box(230, "FILE_BROWSER", "TOOL_PROPS"))


@picture
def panel() -> Steps:
    yield from sign()
    yield from shoot("panel")


@picture
def result() -> Steps:
    yield from sign()
    generate(levels="20%, 8%")
    yield from shoot("result")


@picture
def levels() -> Steps:
    yield from sign()
    generate(levels="2 cm, +40 %")
    yield from shoot("levels")


@picture
def inside() -> Steps:
    yield from clear()
    obj = letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    generate(levels="24")
    only(obj)
    generate(levels="24", inside=True)
    yield from shoot("inside")


@picture
def shape() -> Steps:
    yield from clear("constraints")
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
    yield from shoot("shape")


@picture
def own_before() -> Steps:
    yield from _own()
    yield from shoot("own_before", (56, 85, 775, 720))


@picture
def own_after() -> Steps:
    yield from _own()
    generate(use_selected_as_levels=True)
    yield from shoot("own_after", (56, 85, 1035, 720))


def _own() -> Steps:
    yield from clear()
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
    yield from shoot("verify", (56, 85, 1035, 720))


@picture
def faults() -> Steps:
    yield from _broken()
    with override():
        bpy.ops.object.nested_cages_verify("EXEC_DEFAULT")
        bpy.ops.object.mode_set(mode="EDIT")
    yield from shoot("faults", (56, 85, 775, 720))


def _broken() -> Steps:
    """A cage with one vertex in the letter."""
    yield from sign()
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
def use() -> Steps:
    yield from use_bound()
    yield from shoot("use")


def use_bound() -> Steps:
    """The letter, bound to its cages."""
    yield from sign()
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
        bpy.ops.object.nested_cages_puppet("EXEC_DEFAULT", source="HANDLES")
        for bone in bpy.context.object.pose.bones:
            lean = Matrix.Translation((0.35 * bone.bone.head_local.y, 0.0, 0.0))
            bone.matrix = lean @ bone.matrix
    yield from shoot("posed")


@picture
def playing() -> Steps:
    yield from clear()
    letters = [letter(text) for text in ("A", "g", "&")]
    for obj, x, colour in zip(letters, (0.0, 1.6, 3.1), ((0.7, 0.35, 0.3), (0.3, 0.45, 0.7), GREEN[:3]), strict=True):
        obj.location.x, obj.color = x, (*colour, 1.0)
    only(*letters)
    look(4.6, (2.2, 0.6))
    yield from sidebar()
    generate(levels="40%, 30%")
    bpy.context.scene.frame_set(80)
    yield from shoot("playing")


@picture
def running() -> Steps:
    yield from clear()
    outline("Coast", coast(60_000))
    look(3.0)
    yield from sidebar()
    bpy.context.scene.nested_cages.levels = "200, 60"
    yield 1.0
    with override():
        bpy.ops.object.nested_cages_generate("INVOKE_DEFAULT", levels="200, 60")
    yield 1.2
    yield from shoot("running", (56, 85, 1035, 720))
    bpy.ops.object.nested_cages_cancel()
    yield 2.0


@picture
def redo() -> Steps:
    yield from sign()
    with override():
        bpy.ops.object.nested_cages_generate("EXEC_DEFAULT", True, levels="20%, 8%", length=120)
    yield 2.0
    with override():
        bpy.ops.screen.redo_last("INVOKE_DEFAULT")
    yield from shoot("redo")


def make(names: list[str]) -> Steps:
    """Make pictures of the guide one after the other, and end Blender; with a status of 1 if one fails."""
    failed = False
    for name in names:
        try:
            yield from PICTURES[name]()
        except Exception:
            traceback.print_exc()
            failed = True
    yield 2.0
    os._exit(1 if failed else 0)


def guide(names: list[str]) -> None:
    """Start making pictures of the guide in this window."""
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    register_extension()
    steps = make(names or list(PICTURES))
    bpy.app.timers.register(lambda: next(steps, None), first_interval=1.0, persistent=True)


def stories(names: list[str]) -> None:
    """Run examples, and renew what the documentation shows of them."""
    clips = DOCS / "demo.png", DOCS / "letter_a.gif", DOCS / "fox_walk.gif"
    for target in (*clips, *sorted((DOCS / "gallery").glob("*.png"))):
        if names and target.stem not in names:
            continue
        example = ROOT / "examples" / f"{target.stem}.py"
        if target.stem == "letter_a":
            clip(target)
        elif target.suffix == ".gif":
            join(sorted((STORIES / target.stem).glob("*.png")), 60, target)
        else:
            subprocess.run([sys.executable, str(example)], cwd=ROOT, check=True)
            made = ROOT / "build" / "demo" / "letter_a.png" if target.stem == "demo" else STORIES / target.name
            target.write_bytes(without_texts(made.read_bytes()))
        print(f"{target.relative_to(ROOT)} made", flush=True)


def without_texts(data: bytes) -> bytes:
    """A PNG without its texts."""
    kept, at = [data[:8]], 8
    while at < len(data):
        end = at + 12 + int.from_bytes(data[at : at + 4], "big")
        kept += [data[at:end]] if data[at + 4 : at + 8] not in TEXTS else []
        at = end
    return b"".join(kept)


def clip(target: Path) -> None:
    """The demo's animation: the drawing shrinks, grows back, and pushes its cages out."""
    import demo
    from extension import registered
    from picture import Panel, Shape, extent, render

    with registered():
        made = demo.drawn_cages()
        fine, (inner, outer), (first, second) = made.fine, list(made), [each.frames for each in made.certificates]
    stills: list[tuple[Panel, int]] = []
    ghost = Shape(demo.loops_at(fine, first[0]), demo.GHOST)
    for text, line, cages, begin, end, count in (
        ("a drawing and a coarse mesh", demo.COARSE, [inner], first[0], first[0], 1),
        ("the drawing shrinks into the mesh", demo.COARSE, [inner], first[0], first[1], 14),
        ("it grows back and pushes the mesh out", demo.CAGES[0], [inner], first[1], first[2], 22),
        ("the cage becomes tight", demo.CAGES[0], [inner], first[2], first[3], 16),
        ("a coarser cage encloses the first", demo.CAGES[1], [inner, outer], second[0], second[3], 18),
    ):
        for frame in np.linspace(end, begin, count, endpoint=False)[::-1]:
            body = demo.loops_at(fine, frame)
            lines = [
                Shape(demo.loops_at(cage, frame), colour, demo.LINE, demo.DOT)
                for cage, colour in zip(cages[::-1], (line, demo.CAGES[0]), strict=False)
            ]
            shown = Panel(text, [ghost, Shape(body, demo.BODY), Shape(body, demo.INK, demo.LINE), *lines])
            stills.append((shown, 160 if frame != end else 3600 if end == second[3] else 1600))
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{number:03}.png" for number in range(len(stills))]
        for path, (panel, _) in zip(paths, stills, strict=True):
            render(path, [panel], extent([panel for panel, _ in stills]), pixels=436, samples=6)
        join(paths, [shown for _, shown in stills], target)


def join(paths: list[Path], milliseconds: list[int] | int, target: Path) -> None:
    """Write an animated GIF that repeats, all of its pictures in the colours of one palette."""
    from PIL import Image

    opened = [Image.open(path).convert("RGB") for path in paths]
    sheet = Image.new("RGB", (opened[0].width, 2 * opened[0].height))
    sheet.paste(opened[0], (0, 0))
    sheet.paste(opened[-1], (0, opened[0].height))
    palette = sheet.quantize(48, dither=Image.Dither.NONE)
    few = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in opened]
    few[0].save(target, save_all=True, append_images=few[1:], duration=milliseconds, loop=0, optimize=True)


if __name__ == "__main__":
    if bpy.app.background:
        sys.path.insert(0, str(ROOT / "examples"))
        stories(sys.argv[1:])
    else:
        guide(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
