"""Flat drawings of loops, rendered by Cycles on the CPU: panels side by side on white, each with a line of text below.

Lengths are in the units of the drawing; the scene is made for one picture and thrown away afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

Colour = tuple[float, float, float]

SAMPLES = 24  # per pixel; the light is flat, so they only smooth the edges of lines
PANEL_PIXELS = 560  # width of a panel's drawing area at full resolution
CIRCLE_POINTS = 24  # points of a disc that marks a vertex
LAYER = 1e-3  # height between layers, in widths of a panel
TEXT_SIZE = 0.055  # of a panel's width
MARGIN = 0.05  # around every panel, of its width


def colour(code: str) -> Colour:
    """Linear colour of an sRGB code such as ``#0072b2``."""
    values = [int(code[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    linear = [value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4 for value in values]
    return linear[0], linear[1], linear[2]


@dataclass(frozen=True)
class Fill:
    """The area between loops, each (k, 2); loops inside loops are holes."""

    loops: Sequence[np.ndarray]
    colour: Colour


@dataclass(frozen=True)
class Outline:
    """Closed lines through loops, each (k, 2); `width` in widths of a panel, `dots` marks the vertices."""

    loops: Sequence[np.ndarray]
    colour: Colour
    width: float = 0.005
    dots: float = 0.0


@dataclass(frozen=True)
class Panel:
    """What is drawn above one line of text, from the lowest layer to the highest."""

    text: str
    shapes: Sequence[Fill | Outline]


def extent(panels: Sequence[Panel]) -> tuple[np.ndarray, np.ndarray]:
    """The lower left and the upper right corner of everything that is drawn."""
    points = np.concatenate([loop for panel in panels for shape in panel.shapes for loop in shape.loops])
    return points.min(axis=0), points.max(axis=0)


def render(
    path: Path,
    panels: Sequence[Panel],
    *,
    corners: tuple[np.ndarray, np.ndarray] | None = None,
    pixels: int = PANEL_PIXELS,
    samples: int = SAMPLES,
) -> None:
    """Draws `panels` side by side, in one common scale, into the PNG file `path`.

    corners: lower left and upper right of a panel in the drawing's units, so that several pictures fit on each other.
    """
    scene = bpy.data.scenes.new("Picture")
    try:
        low, high = corners if corners is not None else extent(panels)
        scale = 1.0 / (high - low)[0]
        height = (high - low)[1] * scale
        step = 1.0 + 2 * MARGIN
        for place, panel in enumerate(panels):
            origin = np.array([place * step + MARGIN, 0.0])
            for layer, shape in enumerate(panel.shapes, start=1):
                loops = [(loop - low) * scale + origin for loop in shape.loops]
                draw(scene, shape, loops, layer * LAYER)
            write(scene, panel.text, (place + 0.5) * step, -MARGIN - TEXT_SIZE)
        below, above = -2 * MARGIN - 1.5 * TEXT_SIZE, height + MARGIN
        aim(scene, step * len(panels), below, above)
        set_up(scene, path, (round(pixels * step * len(panels)), round(pixels * (above - below))), samples)
        bpy.ops.render.render(write_still=True, scene=scene.name)
    finally:
        remove(scene)


def draw(scene: bpy.types.Scene, shape: Fill | Outline, loops: Sequence[np.ndarray], layer: float) -> None:
    """Puts a shape, given in the picture's units, at the height `layer`."""
    if isinstance(shape, Fill):
        fill(scene, loops, shape.colour, layer)
        return
    line(scene, loops, shape.colour, layer, shape.width)
    if shape.dots:
        discs(scene, np.concatenate(loops), shape.colour, layer, shape.dots)


def fill(scene: bpy.types.Scene, loops: Sequence[np.ndarray], paint: Colour, layer: float) -> None:
    """Adds the area between loops, as a filled curve."""
    data = bpy.data.curves.new("Picture", "CURVE")
    data.dimensions = "2D"
    data.fill_mode = "FRONT"
    for loop in loops:
        spline = data.splines.new("POLY")
        spline.points.add(len(loop) - 1)
        spline.points.foreach_set("co", np.column_stack((loop, np.zeros(len(loop)), np.ones(len(loop)))).ravel())
        spline.use_cyclic_u = True
    place_in(scene, data, paint, (0.0, 0.0, layer))


def line(scene: bpy.types.Scene, loops: Sequence[np.ndarray], paint: Colour, layer: float, width: float) -> None:
    """Adds closed lines of even `width`: a rectangle for each edge and a disc where two meet."""
    starts = np.concatenate(loops)
    along = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops]) - starts
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(float).tiny)
    side = 0.5 * width * np.column_stack((-along[:, 1], along[:, 0])) / length
    faces(
        scene,
        np.stack((starts - side, starts + along - side, starts + along + side, starts + side), axis=1),
        paint,
        layer,
    )
    discs(scene, starts, paint, layer, width / 2)


def discs(scene: bpy.types.Scene, centres: np.ndarray, paint: Colour, layer: float, radius: float) -> None:
    """Adds a disc about each of the `centres` (n, 2)."""
    angles = 2 * np.pi * np.arange(CIRCLE_POINTS) / CIRCLE_POINTS
    disc = radius * np.column_stack((np.cos(angles), np.sin(angles)))
    faces(scene, centres[:, None] + disc, paint, layer)


def faces(scene: bpy.types.Scene, polygons: np.ndarray, paint: Colour, layer: float) -> None:
    """Adds polygons (n, k, 2) as one mesh object."""
    count, sides, _ = polygons.shape
    points = np.concatenate((polygons.reshape(-1, 2), np.zeros((count * sides, 1))), axis=1)
    data = bpy.data.meshes.new("Picture")
    data.from_pydata(points, (), np.arange(count * sides).reshape(count, sides))
    place_in(scene, data, paint, (0.0, 0.0, layer))


def write(scene: bpy.types.Scene, line: str, x: float, y: float) -> None:
    """Adds a line of text, centred about `x`."""
    data = bpy.data.curves.new("Picture", "FONT")
    data.body = line
    data.size = TEXT_SIZE
    data.align_x = "CENTER"
    place_in(scene, data, colour("#202124"), (x, y, LAYER))


def place_in(
    scene: bpy.types.Scene,
    data: bpy.types.Curve | bpy.types.Mesh,
    paint: Colour,
    location: tuple[float, float, float],
) -> None:
    """Links `data` into `scene` with a material that shows `paint` as it is, whatever the light."""
    material = bpy.data.materials.new("Picture")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Color"].default_value = (*paint, 1.0)
    links.new(emission.outputs[0], output.inputs["Surface"])
    data.materials.append(material)
    item = bpy.data.objects.new("Picture", data)
    item.location = location
    scene.collection.objects.link(item)


def aim(scene: bpy.types.Scene, width: float, below: float, above: float) -> None:
    """Gives the scene a camera that looks straight down on the whole picture."""
    data = bpy.data.cameras.new("Picture")
    data.type = "ORTHO"
    data.ortho_scale = max(width, above - below)
    camera = bpy.data.objects.new("Picture", data)
    camera.location = (width / 2, (below + above) / 2, 1.0)
    scene.collection.objects.link(camera)
    scene.camera = camera


def set_up(scene: bpy.types.Scene, path: Path, size: tuple[int, int], samples: int) -> None:
    """Chooses Cycles on the CPU, exact colours on white, and the size in pixels."""
    world = bpy.data.worlds.new("Picture")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    scene.world = world
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 100
    scene.render.dither_intensity = 0.0
    scene.render.filepath = str(path)


def remove(scene: bpy.types.Scene) -> None:
    """Takes the scene and all that was made for it out of the file."""
    materials = [slot.material for item in scene.objects for slot in item.material_slots]
    bpy.data.batch_remove([*scene.objects, *(item.data for item in scene.objects), *materials, scene.world, scene])
