"""Pictures of closed loops, rendered by Cycles on the CPU: panels side by side on white, each with a line of text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

SAMPLES = 24  # per pixel; the light is flat, so they only smooth edges
PIXELS = 560  # width of a panel without its margins
MARGIN, TEXT, LAYER = 0.05, 0.055, 1e-3  # around a panel, height of its text, between layers: in widths of a panel
CIRCLE = np.exp(2j * np.pi * np.arange(24) / 24).view(float).reshape(-1, 2)


def colour(code: str) -> tuple[float, float, float]:
    """Linear colour of an sRGB code such as ``#0072b2``."""
    values = np.array([int(code[place : place + 2], 16) / 255 for place in (1, 3, 5)])
    red, green, blue = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    return float(red), float(green), float(blue)


@dataclass(frozen=True)
class Shape:
    """Loops, each (k, 2), in a colour: filled, or as lines of a width with dots of a radius, in widths of a panel."""

    loops: Sequence[np.ndarray]
    colour: str
    width: float = 0.0
    dots: float = 0.0


@dataclass(frozen=True)
class Panel:
    """Shapes from the lowest layer to the highest, above one line of text."""

    text: str
    shapes: Sequence[Shape]


def extent(panels: Sequence[Panel]) -> np.ndarray:
    """Lower left and upper right corner of all shapes, (2, 2)."""
    points = np.concatenate([loop for panel in panels for shape in panel.shapes for loop in shape.loops])
    return np.stack((points.min(axis=0), points.max(axis=0)))


def render(
    path: Path, panels: Sequence[Panel], corners: np.ndarray, pixels: int = PIXELS, samples: int = SAMPLES
) -> None:
    """Render panels, which all show the rectangle between two corners (2, 2), into a PNG file."""
    scene = bpy.data.scenes.new("Picture")
    scale, step = 1.0 / np.ptp(corners[:, 0]), 1.0 + 2.0 * MARGIN
    for place, panel in enumerate(panels):
        for layer, shape in enumerate(panel.shapes, 1):
            loops = [(loop - corners[0]) * scale + (place * step + MARGIN, 0.0) for loop in shape.loops]
            data = _lines(loops, shape.width, shape.dots) if shape.width else _area(loops)
            _add(scene, data, shape.colour, (0.0, 0.0, layer * LAYER))
        text = bpy.data.curves.new("Picture", "FONT")
        text.body, text.size, text.align_x = panel.text, TEXT, "CENTER"
        _add(scene, text, "#202124", ((place + 0.5) * step, -MARGIN - TEXT, LAYER))
    low, high = -2.0 * MARGIN - 1.5 * TEXT, np.ptp(corners[:, 1]) * scale + MARGIN
    width, height = step * len(panels), high - low
    camera = bpy.data.objects.new("Picture", bpy.data.cameras.new("Picture"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", max(width, height)
    camera.location = (width / 2.0, (low + high) / 2.0, 1.0)
    scene.collection.objects.link(camera)
    scene.camera, scene.world = camera, bpy.data.worlds.new("Picture")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    use_cycles(scene, (round(pixels * width), round(pixels * height)), samples)
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True, scene=scene.name)
    materials = [slot.material for item in scene.objects for slot in item.material_slots]
    bpy.data.batch_remove([*scene.objects, *(item.data for item in scene.objects), *materials, scene.world, scene])


def use_cycles(scene: bpy.types.Scene, size: tuple[int, int], samples: int) -> None:
    """Render a scene by Cycles on the CPU in exact colours, in this many pixels."""
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", samples
    scene.cycles.use_denoising, scene.cycles.max_bounces, scene.render.dither_intensity = False, 0, 0.0
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.image_settings.color_mode, scene.render.image_settings.compression = "RGB", 100


def _area(loops: Sequence[np.ndarray]) -> bpy.types.Curve:
    """The area between closed loops."""
    data = bpy.data.curves.new("Picture", "CURVE")
    data.dimensions, data.fill_mode = "2D", "FRONT"
    for loop in loops:
        spline = data.splines.new("POLY")
        spline.points.add(len(loop) - 1)
        spline.points.foreach_set("co", np.column_stack((loop, np.zeros(len(loop)), np.ones(len(loop)))).ravel())
        spline.use_cyclic_u = True
    return data


def _lines(loops: Sequence[np.ndarray], width: float, dots: float) -> bpy.types.Mesh:
    """Closed lines: a rectangle for each edge, a disc where two meet; a larger one if vertices are marked."""
    start = np.concatenate(loops)
    along = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops]) - start
    side = 0.5 * width * along[:, ::-1] * (-1.0, 1.0) / np.hypot(*along.T)[:, None]
    edges = np.stack((start - side, start + along - side, start + along + side, start + side), axis=1)
    discs = start[:, None] + max(dots, width / 2.0) * CIRCLE
    data = bpy.data.meshes.new("Picture")
    points = np.concatenate((edges.reshape(-1, 2), discs.reshape(-1, 2)))
    faces = [*np.arange(4 * len(edges)).reshape(-1, 4).tolist()]
    faces += (4 * len(edges) + np.arange(discs[..., 0].size)).reshape(len(discs), -1).tolist()
    data.from_pydata(np.column_stack((points, np.zeros(len(points)))), (), faces)
    return data


def _add(scene: bpy.types.Scene, data: bpy.types.ID, code: str, location: tuple[float, float, float]) -> None:
    """Link data into a scene with a material that shows a colour as it is, whatever the light."""
    data.materials.append(glowing(code))
    item = bpy.data.objects.new("Picture", data)
    item.location = location
    scene.collection.objects.link(item)


def glowing(code: str) -> bpy.types.Material:
    """A material that emits a colour."""
    material = bpy.data.materials.new("Picture")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Color"].default_value = (*colour(code), 1.0)
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material
